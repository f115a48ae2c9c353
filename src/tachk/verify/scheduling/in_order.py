"""Searches one after the other, as long as that is quick."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import partial

from tachk.base.job import answering
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import INTERRUPTED
from tachk.verify.plan import Search
from tachk.verify.scheduling.shares import Shares
from tachk.verify.verdict import Verdict, none_begun

ALONE = 1.0
"""After so many seconds other processes are worth while."""

Answer = Callable[[Search, Limits], dict[int, Verdict]]
"""What looks for the verdicts of a search, by the numbers of its tasks."""


def processes(options: Options) -> int:
    """How many searches run at the same time."""
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
            return verdicts | SideBySide(rest, answer, begin).answered(processes)
        else:
            with answering(search.names):
                verdicts |= answer(search, shares.begin(search))
    return verdicts
