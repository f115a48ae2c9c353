"""How the seconds that a verification may take are divided among its searches."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from time import monotonic

from tachk.base.job import current_job
from tachk.engine.options import Limits
from tachk.verify.plan import Search


class Shares:
    """What is left for the searches that have not begun."""

    def __init__(self, limits: Limits, tasks: int) -> None:
        """Args:
        tasks: how many all searches have.
        """
        self._limits = limits
        self._started = monotonic()
        self._left = tasks

    def begin(self, search: Search, processes: int = 1) -> Limits:
        """The limits of a search that begins now: each of its tasks has the same share of the seconds that are left as
        those of the searches behind it, or so many of them where so many searches run at the same time."""
        part = min(Fraction(len(search.tasks) * processes, self._left), Fraction(1))
        self._left -= len(search.tasks)
        left = current_job().seconds_left
        of_all = None if left is None else left * part.numerator / part.denominator
        allowed = [seconds for seconds in (of_all, self._limits.seconds_each) if seconds is not None]
        return replace(self._limits, seconds=min(allowed, default=None))

    def used(self) -> float:
        """The seconds since the verification began."""
        return monotonic() - self._started
