"""The destination of a report: a file, standard output or nowhere."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from pathlib import Path


@contextmanager
def destination(output: Path | None, quiet: bool = False) -> Iterator[TextIO | None]:
    """The file of a report, which appears when the report is whole; without one standard output, or None if quiet."""
    if output is not None:
        from tachk.base.whole_files import whole_text

        with whole_text(output) as file:
            yield file
    else:
        yield None if quiet else sys.stdout


@contextmanager
def growing_destination(output: Path | None, quiet: bool = False) -> Iterator[TextIO | None]:
    """Like `destination`, for a report that is read while it is written."""
    if output is None:
        yield None if quiet else sys.stdout
        return
    with output.open("w", encoding="utf-8") as file:
        yield file
