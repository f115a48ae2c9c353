"""Systems under test that run by the clock of the wall."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterable
from fractions import Fraction

from tachk.simulation.testing.arrivals import Arrival, Arrivals
from tachk.simulation.testing.system_adapter import SeenOutput, SystemEndedError


class RealTimeSystem:
    """What systems by the clock of the wall have in common: the present time, and outputs from what arrives."""

    def __init__(self, nanoseconds: Fraction) -> None:
        """Args: nanoseconds: of a unit of the model."""
        self.arrivals = Arrivals()
        self._nanoseconds = nanoseconds
        self._begun = 0
        self._pending: deque[SeenOutput] = deque()

    def begin(self, moment: int) -> None:
        """The model starts at a moment of `time.monotonic_ns`."""
        self._begun = moment

    def time(self) -> Fraction:
        return self.units(time.monotonic_ns())

    def units(self, moment: int) -> Fraction:
        return self.duration(moment - self._begun)

    def duration(self, nanoseconds: int) -> Fraction:
        """In units of the model."""
        return nanoseconds / self._nanoseconds

    def next_output(self, until: Fraction) -> SeenOutput | None:
        last = self._begun + int(until * self._nanoseconds)
        while not self._pending:
            arrival = self.arrivals.next(last)
            if arrival is None:
                self.check()
                return None  # what is read from now on is later
            self._pending.extend(self.outputs(arrival))
        return self._pending.popleft()

    def waited(self) -> Fraction:
        return Fraction(0)

    def outputs(self, arrival: Arrival) -> Iterable[SeenOutput]:
        """The outputs that an arrival consists of. Raises SystemEndedError, UsageError for what is no event."""
        raise NotImplementedError

    def check(self) -> None:
        """Raises SystemEndedError if the system does not run any more."""
        if self.arrivals.is_over:
            raise SystemEndedError("the system has ended")
