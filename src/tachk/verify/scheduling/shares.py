"""How the seconds that a verification may take are divided among its searches."""

from __future__ import annotations

import time
from dataclasses import replace
from fractions import Fraction

from tachk.engine.options import Limits
from tachk.verify.plan import Search


class Shares:
    """What is left for the searches that have not begun."""

    def __init__(self, limits: Limits, started: float, tasks: int) -> None:
        """Args:
        started: when the verification began, by `time.monotonic`.
        tasks: how many all searches have.
        """
        self._limits = limits
        self._started = started
        self._left = tasks

    def begin(self, search: Search, processes: int = 1) -> Limits:
        """The limits of a search that begins now: each of its tasks has the same share of the seconds that are left as
        those of the searches behind it, or so many of them where so many searches run at the same time."""
        part = min(Fraction(len(search.tasks) * processes, self._left), Fraction(1))
        self._left -= len(search.tasks)
        limits = self._limits.after(self.used())
        of_all = None if limits.seconds is None else limits.seconds * part.numerator / part.denominator
        allowed = [seconds for seconds in (of_all, limits.seconds_each) if seconds is not None]
        return replace(limits, seconds=min(allowed, default=None))

    def used(self) -> float:
        """The seconds since the verification began."""
        return time.monotonic() - self._started
