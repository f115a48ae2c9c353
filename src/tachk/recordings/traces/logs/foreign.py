"""The common part of all readers that use other libraries."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tachk.base.diagnostics.diagnostic import TachkError, UsageError
from tachk.base.job import StoppedError


@contextmanager
def library_errors(path: Path, what: str) -> Iterator[None]:
    """Turns any exception of a library about a damaged file into a UsageError."""
    if not path.exists():
        raise UsageError(f"there is no file {path}")
    try:
        yield
    except (TachkError, StoppedError, MemoryError):
        raise
    except Exception as error:
        reason = next(iter(str(error).strip().splitlines()), "") or type(error).__name__
        raise UsageError(f"{path} is not a readable {what}: {reason}") from None
