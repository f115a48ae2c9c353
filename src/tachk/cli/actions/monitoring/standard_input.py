"""A value change dump on standard input: it is kept in a file, for it is read twice."""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def begins_dump() -> bool:
    """Whether standard input begins as a value change dump does, with a keyword such as ``$date``."""
    peek = getattr(sys.stdin.buffer, "peek", None)
    return peek is not None and bytes(peek(64)).lstrip().startswith(b"$")


@contextmanager
def dump_in_a_file() -> Iterator[str]:
    """Reads standard input to its end; gives the path of a file that has it, as long as it is used."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "standard_input.vcd"
        with path.open("wb") as file:
            shutil.copyfileobj(sys.stdin.buffer, file)
        yield str(path)
