"""The clocks of a bridge."""

from __future__ import annotations

import time
from typing import Protocol


class Clock(Protocol):
    """Counts nanoseconds; it never goes back."""

    def now(self) -> int:
        """The time in nanoseconds."""
        ...


class WallClock:
    """As time passes, ``speed`` times as fast."""

    def __init__(self, speed: float = 1.0) -> None:
        self.speed = speed
        self._begin = time.monotonic_ns()

    def now(self) -> int:
        """Nanoseconds of its time since it was made."""
        return int((time.monotonic_ns() - self._begin) * self.speed)


class SteppedClock:
    """A clock that is set by its user, for tests and for simulations: nothing waits."""

    def __init__(self, now: int = 0) -> None:
        self._now = now

    def now(self) -> int:
        """The moment to which it was last stepped, in nanoseconds."""
        return self._now

    def step_to(self, moment: int) -> None:
        """Raises ValueError for a moment in the past."""
        if moment < self._now:
            raise ValueError(f"the time is {self._now} already, it cannot become {moment}")
        self._now = moment
