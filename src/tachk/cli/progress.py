"""A line on the terminal that shows that a long search is alive."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence

from tachk.cli.terminal import width_of
from tachk.engine.outcome import Statistics
from tachk.model.quantity import bytes_, grouped

_INTERVAL = 0.2
_LONGEST_NAME = 30


class ProgressLine:
    """Rewrites one line of standard error; callable as the progress function of `verify`."""

    def __init__(self) -> None:
        self._next = time.monotonic() + 2 * _INTERVAL
        self._last = Statistics()
        self._visible = False

    def __call__(self, statistics: Statistics, names: Sequence[str]) -> None:
        now = time.monotonic()
        if now < self._next:
            return
        self._next = now + _INTERVAL
        if statistics.seconds < self._last.seconds:
            self._last = Statistics()
        elapsed = statistics.seconds - self._last.seconds
        explored = statistics.states_explored - self._last.states_explored
        parts = [
            f"{_together(names)}: {grouped(statistics.states_explored)} states explored",
            f"{grouped(statistics.states_stored)} stored",
            *([f"{grouped(int(explored / elapsed))}/s"] if elapsed > 0 else []),
            bytes_(statistics.peak_bytes),
            f"{statistics.seconds:.1f} s",
        ]
        self._last = statistics
        self._visible = True
        # A line as wide as the terminal would already wrap on some.
        line = ", ".join(parts)[: width_of(sys.stderr) - 1]
        print(f"\r\x1b[K{line}", end="", file=sys.stderr, flush=True)

    def clear(self) -> None:
        """Removes the line."""
        if self._visible:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)
            self._visible = False


def _together(names: Sequence[str]) -> str:
    """The queries of one search: the first and how many others, since there is little room."""
    first = names[0] if len(names[0]) <= _LONGEST_NAME else names[0][: _LONGEST_NAME - 3] + "..."
    return first if len(names) == 1 else f"{first} and {len(names) - 1} more"
