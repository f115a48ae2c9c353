"""The order of variables and the extra edges that Munta's own preparations need: these edges show it which clock values
matter where.

Munta reads a model, computes a numbering and the largest values that clocks are compared with, and then checks that it
may rely on them. For some networks what it computes is not what it wants to see.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from tachk.api.plugin import Conjunction, bound_value
from tachk_munta.network import IMPOSSIBLE, MuntaEdge, MuntaProcess


def order_of_slots(processes: Iterable[MuntaProcess], slots: Collection[int]) -> tuple[int, ...]:
    """The slots in the order in which `munta` numbers their variables; it insists that they are declared in that order.

    The order of the lists that stand for sets in the code that Isabelle makes of ``make_renaming``.
    """
    edges = [process.edges for process in processes]
    read = [_union([_read(edge) for edge in own]) for own in edges]
    written = [_union([_union([[c] for c, _ in edge.writes if c in slots]) for edge in own]) for own in edges]
    return tuple(_added(_union(read), _union(written)))


def _read(edge: MuntaEdge) -> list[int]:
    found: list[int] = []
    for condition in reversed(edge.conditions):
        found = _added([condition.slot], found)
    return found


def _union(sets: Iterable[list[int]]) -> list[int]:
    found: list[int] = []
    for one in sets:
        found = _added(one, found)
    return found


def _added(new: Iterable[int], old: list[int]) -> list[int]:
    for slot in new:
        if slot not in old:
            old = [slot, *old]
    return old


def add_ceilings(processes: Iterable[MuntaProcess]) -> None:
    """Adds an edge that is never taken to each location where a clock matters only for what is later compared.

    Munta looks for these comparisons itself, but where loops follow one another it misses some, and then refuses the
    network. With the edge, the location compares the clock itself.
    """
    for process in processes:
        own = [_compared(process, place) for place in range(len(process.locations))]
        for place, ceilings in enumerate(_ceilings(process, own)):
            missing = {clock: value for clock, value in ceilings.items() if value > own[place].get(clock, 0)}
            if missing:
                guard: Conjunction = tuple((clock, 0, 2 * value + 1) for clock, value in sorted(missing.items()))
                process.edges.append(MuntaEdge(place, place, clocks=guard, label=IMPOSSIBLE))


def _compared(process: MuntaProcess, place: int) -> dict[int, int]:
    """The largest constant that each clock is compared with in a location and on the edges that leave it."""
    guards = (edge.clocks for edge in process.edges if edge.source == place)
    found: dict[int, int] = {}
    for i, j, raw in (constraint for guard in (process.invariants[place], *guards) for constraint in guard):
        found[i or j] = max(found.get(i or j, 0), abs(bound_value(raw)))
    return found


def _ceilings(process: MuntaProcess, own: Sequence[dict[int, int]]) -> list[dict[int, int]]:
    """The largest constant that each clock may be compared with before it is set to 0."""
    found = [dict(of_place) for of_place in own]
    changed = True
    while changed:
        changed = False
        for edge in process.edges:
            for clock, value in found[edge.target].items():
                if clock not in edge.resets and value > found[edge.source].get(clock, 0):
                    found[edge.source][clock] = value
                    changed = True
    return found
