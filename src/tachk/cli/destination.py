"""Where a report goes."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from tachk.base.whole_files import whole_text


@contextmanager
def destination(output: Path | None, quiet: bool = False) -> Iterator[TextIO | None]:
    """The file, which is there when the report is whole; standard output without one, or None for nowhere."""
    if output is not None:
        with whole_text(output) as file:
            yield file
    else:
        yield None if quiet else sys.stdout


@contextmanager
def growing_destination(output: Path | None, quiet: bool = False) -> Iterator[TextIO | None]:
    """As `destination`, for a report that is read while it is written."""
    if output is None:
        yield None if quiet else sys.stdout
        return
    with output.open("w", encoding="utf-8") as file:
        yield file
