"""The reductions of a search in words."""

from __future__ import annotations

from collections.abc import Sequence

from tachk.base.records import replace
from tachk.engine.compiler.program import Program
from tachk.engine.outcome import Statistics

_MOST = 4
"""The number of members above which only the first and the last are listed."""


def members_in_words(slots: Sequence[Sequence[int]], cyclic: bool, processes: Sequence[str]) -> str:
    """The members of a group by the names of their processes: ``P(1), P(2)``, ``P(1) to P(9) (9) in a ring``.

    Args:
        slots: of each member those that belong to it; those of processes are the first of all slots.
        cyclic: the members are only moved on.
    """
    members = [" with ".join(processes[slot] for slot in own if slot < len(processes)) for own in slots]
    listed = ", ".join(members) if len(members) <= _MOST else f"{members[0]} to {members[-1]} ({len(members)})"
    return f"{listed} in a ring" if cyclic else listed


def with_orbits(statistics: Statistics, program: Program) -> Statistics:
    """The statistics of a search for a program, with the permutations in it."""
    names = [slot.name for slot in program.slots[: len(program.locations)]]
    return replace(
        statistics,
        interchangeable=sum(len(group.slots) for group in program.interchangeable),
        exchanged=tuple(members_in_words(group.slots, group.cyclic, names) for group in program.interchangeable),
    )
