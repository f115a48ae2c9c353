"""Searches one after the other, as long as that is quick, and how they share the seconds that there are."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import partial
from time import monotonic

from tachk.base.job import answering, current_job
from tachk.base.records import replace
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import INTERRUPTED
from tachk.verify.plan import Search
from tachk.verify.verdict import Verdict, none_begun

ALONE = 1.0
"""After so many seconds other processes are worth while."""

Answer = Callable[[Search, Limits, int], dict[int, Verdict]]
"""The function that finds the verdicts of a search, by the numbers of its tasks, on so many cores."""


class Shares:
    """The shares of time, states and memory for the searches that have not begun."""

    def __init__(self, limits: Limits, tasks: int) -> None:
        """Args:
        tasks: the number of tasks of all searches.
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

    def drop(self, tasks: int) -> None:
        """So many tasks have been decided otherwise."""
        self._left -= tasks

    def used(self) -> float:
        """The seconds since the verification began."""
        return monotonic() - self._started


def processes(options: Options) -> int:
    """The number of searches that run at the same time."""
    if not hasattr(os, "fork"):
        return 1
    return options.processes or min(os.cpu_count() or 1, 8)


def in_order(
    searches: Sequence[Search],
    answer: Answer,
    shares: Shares,
    processes: int,
) -> dict[int, Verdict]:
    """The verdicts of all searches: one after the other, and those that are left side by side once that is worth while;
    first those that are likely to take longest.

    Args:
        processes: how many may run at the same time.
    """
    verdicts: dict[int, Verdict] = {}
    for number, search in enumerate(searches):
        if any(verdict.reason == INTERRUPTED for verdict in verdicts.values()):
            verdicts |= none_begun(search.tasks, INTERRUPTED)
        elif min(processes, len(searches) - number) > 1 and shares.used() > ALONE:
            from tachk.verify.scheduling.side_by_side import SideBySide

            begin = partial(shares.begin, processes=processes)
            rest = sorted(searches[number:], key=lambda search: not search.explores_everything)
            cores = max(processes // len(rest), 1)
            return verdicts | SideBySide(rest, _on(cores, answer), begin).answered(processes)
        else:
            with answering(search.names):
                verdicts |= answer(search, shares.begin(search), processes)
    return verdicts


def _on(cores: int, answer: Answer) -> Callable[[Search, Limits], dict[int, Verdict]]:
    return lambda search, limits: answer(search, limits, cores)
