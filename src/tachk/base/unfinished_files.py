"""Files that a program has begun to write, so that one that ends without unwinding can remove them.

Imports nothing heavy: each start of the program pays for it.
"""

from __future__ import annotations

import os
from contextlib import suppress

UNFINISHED: set[str] = set()
"""The paths of the files that are being written, by this process and by those that it is a copy of."""


def own_prefix() -> str:
    """The beginning of the names of the files that this process writes."""
    return f".tachk-{os.getpid()}-"


def remove_unfinished() -> None:
    """Removes the files that this process is writing."""
    for part in [part for part in UNFINISHED if os.path.basename(part).startswith(own_prefix())]:
        remove(part)


def remove(part: str) -> None:
    """Removes a file, if it is there."""
    with suppress(OSError):
        os.unlink(part)
    UNFINISHED.discard(part)
