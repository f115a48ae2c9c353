"""The reductions of searches in words, below the table of answers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tachk.engine.outcome import Statistics
from tachk.verify.strategies import is_plain
from tachk.verify.verdict import Verdict


def reduction_lines(verdicts: Sequence[Verdict]) -> Iterator[str]:
    """One line for each group of processes and for local times, with the queries that were searched for so."""
    queries: dict[str, list[str]] = {}
    for verdict in verdicts:
        for line in (*_strategy(verdict), *_reductions(verdict.statistics)):
            queries.setdefault(line, []).append(verdict.query.name)
    for line, names in queries.items():
        yield line if len(names) == len(verdicts) else f"{', '.join(names)}: {line}"


def _strategy(verdict: Verdict) -> Iterator[str]:
    """The strategy that decided it, where it is none of those that search as one expects."""
    if verdict.strategy and not is_plain(verdict.strategy):
        yield f"decided by the strategy {verdict.strategy}"


def for_all(members: str) -> str:
    """The symmetry reduction for the members of a group, by which one state stands for several."""
    ring = members.removesuffix(" in a ring")
    return f"symmetry: {ring} {'are interchangeable' if ring == members else 'can be rotated'}"


def _reductions(statistics: Statistics) -> Iterator[str]:
    for members in statistics.exchanged:
        yield for_all(members)
    if statistics.asked_of_all:
        yield "the query about some of these processes was checked for all of them"
    if statistics.less_known:
        names = ", ".join(statistics.less_known)
        yield f"the order in which {names} goes through processes was left open, which can only add states"
    if statistics.local_times:
        yield "each process had a time of its own (local times)"
