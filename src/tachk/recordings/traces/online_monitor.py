"""A formula watched while its trace is recorded, by the engine in src/core.

The verdict is decided as early as Kleene's rules allow: as soon as every continuation of the trace leads to the same
value under them. Of several samples for one instant the last one counts, so a sample counts once time has gone on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tachk import _core
from tachk.recordings.traces.monitor_program import MonitorProgram
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Ticks, Values

_TRUTHS = (Truth.FALSE, Truth.TRUE, Truth.UNDETERMINED)


@dataclass(frozen=True, slots=True)
class ViolatedCells:
    """A run of cells, counted from the beginning of the trace, at which what must always hold does not.

    Attributes:
        first, last: cells; cell 2t is the tick t, cell 2t + 1 the open interval from there to the next tick.
        settled: nothing that follows can make it longer, or bring up an earlier one.
    """

    first: int
    last: int
    settled: bool


class OnlineMonitor:
    """One formula on one growing trace. How the trace is cut into calls changes nothing.

    Times are ticks of the program; the first one is the beginning of the trace. All methods that take a time raise
    ValueError if it goes back, or if the trace is over; they have then changed nothing.
    """

    __slots__ = ("_core", "program")

    def __init__(self, program: MonitorProgram, *, robustness: bool = True) -> None:
        """Args:
        robustness: keep bounds of the robustness too, which costs time.
        """
        self.program = program
        self._core = _core.OnlineMonitor(program, quantitative=robustness)

    def update(self, time: int, values: Sequence[float]) -> Truth:
        """The columns of the program, in its order, have these values from this time on. Returns the verdict."""
        return _TRUTHS[self._core.update(time, values)]

    def push(self, times: Ticks, columns: Sequence[Values]) -> Truth:
        """Takes many samples at once: contiguous arrays, the columns in the order of the program."""
        return _TRUTHS[self._core.push(times, columns)]

    def advance(self, time: int) -> Truth:
        """Nothing has changed before this time; something may still change at it."""
        return _TRUTHS[self._core.advance(time)]

    def finish(self, end: int) -> Truth:
        """The trace is over; it includes this time."""
        return _TRUTHS[self._core.finish(end)]

    @property
    def verdict(self) -> Truth:
        return _TRUTHS[self._core.verdict()]

    @property
    def decided_at(self) -> int | None:
        """The time that had been reached when the verdict was decided; None before, and if no sample was needed."""
        return self._core.decided_at()

    @property
    def violation(self) -> ViolatedCells | None:
        """The earliest known run of cells without f, for a violated formula ``G f``."""
        found = self._core.violation()
        if found is None:
            return None
        first, end, settled = found
        return ViolatedCells(first, end - 1, settled)

    @property
    def robustness(self) -> tuple[float, float]:
        """Bounds of the robustness of every continuation of the trace. They never widen.

        Before the end they rest on what is decided, and on the margins seen so far under an outermost ``G`` or ``F``;
        for windows that are not complete they need not be the narrowest bounds. At the end they are.
        """
        return self._core.robustness()

    @property
    def beginning(self) -> int:
        """The time of the first sample; 0 before it."""
        return self._core.origin()

    @property
    def now(self) -> int:
        """The time that has been reached."""
        return self._core.now()

    @property
    def finished(self) -> bool:
        return self._core.finished()

    @property
    def bytes_used(self) -> int:
        """Memory that the engine holds for this monitor."""
        return self._core.bytes()
