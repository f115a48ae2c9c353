"""When Python looks for cycles of objects that it could free."""

from __future__ import annotations

import gc

RARELY = (100_000, 20, 20)
"""The thresholds of the garbage collector: by default it runs every few hundred objects, a tenth of a start."""


def collect_rarely() -> None:
    """Collects cycles of objects rarely from now on: for processes of our own, not for programs that import tachk."""
    gc.set_threshold(*RARELY)
