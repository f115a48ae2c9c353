"""Where a report goes."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO


@contextmanager
def destination(output: Path | None, quiet: bool = False) -> Iterator[TextIO | None]:
    """The file, standard output without one, or None for nowhere."""
    if output is not None:
        with output.open("w", encoding="utf-8") as file:
            yield file
    else:
        yield None if quiet else sys.stdout
