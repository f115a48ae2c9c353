"""A line on the terminal that shows that a long search is alive."""

from __future__ import annotations

import sys
import time

from tachk.engines.protocol import Statistics
from tachk.report.quantity import bytes_, count

_INTERVAL = 0.2


class ProgressLine:
    """Rewrites one line of standard error; callable as the progress function of a search."""

    def __init__(self) -> None:
        self._next = time.monotonic() + 2 * _INTERVAL
        self._last = Statistics()
        self._visible = False

    def __call__(self, statistics: Statistics) -> None:
        now = time.monotonic()
        if now < self._next:
            return
        self._next = now + _INTERVAL
        if statistics.seconds < self._last.seconds:
            self._last = Statistics()
        elapsed = statistics.seconds - self._last.seconds
        explored = statistics.states_explored - self._last.states_explored
        rate = f"{count(int(explored / elapsed))} states/s   " if elapsed > 0 else ""
        self._last = statistics
        self._visible = True
        print(
            f"\r\x1b[K{count(statistics.states_explored)} states explored, {count(statistics.states_stored)} stored   "
            f"{rate}{bytes_(statistics.peak_bytes)}   {statistics.seconds:.1f} s",
            end="",
            file=sys.stderr,
            flush=True,
        )

    def clear(self) -> None:
        """Removes the line."""
        if self._visible:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)
            self._visible = False
