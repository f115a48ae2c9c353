"""Clock bounds for the abstraction of zones: for each location, the largest constants that still matter.

``lower[x]`` is the largest constant in constraints ``x > c``, ``x >= c`` that can be evaluated from here on before
``x`` is reset, ``upper[x]`` the same for ``x < c``, ``x <= c``; they are L and U of Behrmann, Bouyer, Larsen, Pelánek,
"Lower and upper bounds in zone-based abstractions of timed automata" (2006), computed by a backward fixpoint for each
location (Behrmann, Bouyer, Fleury and Larsen, "Static guard analysis in timed automata verification", 2003). A state's
bound is the largest over its locations, which is sound for shared clocks: a transition that does not reset the clock
meets the edge condition of the fixpoint in every process that moves, and nothing changes in the others.

Three kinds of constraints are evaluated in both directions and count as lower and upper:

- guards of receivers on broadcast channels, because a receiver stays behind only where its guard is false;
- with priorities every constraint, because an action waits while one of higher priority is enabled;
- the clocks of a difference ``x - y < c``, which moreover have a bound of at least ``|c|`` in every location, as the
  splitting normalisation needs (Bengtsson and Yi, "On clock difference constraints and termination in reachability
  analysis of timed automata", 2003); where ``x`` or ``y`` may be set to ``v``, at least ``|c| + v``, because the
  difference then compares the other clock with ``v - c``.

Where an edge may set ``x`` to ``y + c`` with ``c >= 0``, a comparison of ``x`` with ``k`` behind it is one of ``y``
with ``k - c`` before it: the bounds of ``x`` in the target of the edge, and in all locations of other processes, pass
to ``y`` in its source, lowered by the least ``c`` (Bouyer, Dufourd, Fleury and Petit, "Updatable timed automata", 2004;
Bouyer, "Forward analysis of updatable timed automata", 2004). Bounds never grow on the way, so this comes to an end. A
bound below 0 counts as 0, so that ``y`` is kept for as long as ``x`` matters. A difference ``x - z < k`` becomes one of
``y - z`` with ``k - c``, which counts in every location like those that are written. Where this goes on without end, as
it can with constants other than 0, the differences are refused: reachability is undecidable then.

Stopped clocks need nothing more. The simulation behind the bounds relates two valuations if for each clock they agree,
or both lie beyond the bound that matters; letting the same time pass, with the same clocks stopped in both, since what
stops them is part of the discrete state, keeps that: a stopped clock does not move in either, a running clock moves by
the same amount in both. A clock that is stopped and not read before its next reset may therefore be inactive.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

from tachk.base.records import dataclass, field
from tachk.base.span import NOWHERE, Span

ClockBounds = tuple[tuple[int, int], ...]
"""Pairs (clock, bound) in ascending order of clocks; a clock that is missing does not matter."""


@dataclass(frozen=True, slots=True)
class ConstraintRange:
    """A constraint ``x - y < c`` or ``<= c`` of which only a range of possibilities is known.

    Attributes:
        lefts, rights: the numbers ``x`` and ``y`` may have; ``(0,)`` for the reference clock.
        low, high: the smallest and the largest ``c``.
    """

    lefts: tuple[int, ...]
    rights: tuple[int, ...]
    low: int
    high: int
    strict: bool = False
    span: Span = field(default=NOWHERE, compare=False, repr=False)

    @property
    def is_diagonal(self) -> bool:
        return self.lefts != (0,) and self.rights != (0,)


@dataclass(frozen=True, slots=True)
class ClockCopy:
    """``clock := source + offset``.

    Attributes:
        least, largest: the smallest and the largest offset.
    """

    clock: int
    source: int
    least: int = 0
    largest: int = 0


@dataclass(frozen=True, slots=True)
class BoundEdge:
    """The parts of an edge that the analysis needs.

    Attributes:
        resets: the clocks it sets in every case.
        copies: the clocks it may set to the values of clocks; what it does step by step is there in one step too.
        both_directions: the falsity of the guard is observed too.
    """

    source: int
    target: int
    resets: frozenset[int] = frozenset()
    constraints: tuple[ConstraintRange, ...] = ()
    copies: tuple[ClockCopy, ...] = ()
    both_directions: bool = False


@dataclass(frozen=True, slots=True)
class LocationBounds:
    lower: ClockBounds = ()
    upper: ClockBounds = ()


def network_bounds(
    invariants: Sequence[Sequence[Sequence[ConstraintRange]]],
    edges: Sequence[Sequence[BoundEdge]],
    everywhere: tuple[Mapping[int, int], Mapping[int, int]] = ({}, {}),
    symmetric: frozenset[int] | None = frozenset(),
) -> list[tuple[LocationBounds, ...]]:
    """The bounds at every location of each process. Arguments as for `process_bounds`, for each process."""
    copied: list[CopiedBounds] = [([{} for _ in own], [{} for _ in own]) for own in invariants]
    while True:
        found = [
            process_bounds(own, leaving, everywhere, symmetric, more)
            for own, leaving, more in zip(invariants, edges, copied, strict=True)
        ]
        lower = [[dict(location.lower) for location in process] for process in found]
        upper = [[dict(location.upper) for location in process] for process in found]
        changed = [_copy_bounds(lower, edges, [more[0] for more in copied])]
        changed += [_copy_bounds(upper, edges, [more[1] for more in copied])]
        if not any(changed):
            return found


def _copy_bounds(
    bounds: Sequence[Sequence[Mapping[int, int]]],
    edges: Sequence[Sequence[BoundEdge]],
    copied: Sequence[list[dict[int, int]]],
) -> bool:
    """Passes bounds from clocks that copies set to those that they are set to; whether something is new."""
    changed = False
    for process, leaving in enumerate(edges):
        if not any(edge.copies for edge in leaving):
            continue
        others = [here for number, of_other in enumerate(bounds) if number != process for here in of_other]
        for edge in leaving:
            for copy in edge.copies:
                reached = [here[copy.clock] for here in (bounds[process][edge.target], *others) if copy.clock in here]
                if not reached:
                    continue
                passed = max(max(reached) - copy.least, 0)
                if passed > bounds[process][edge.source].get(copy.source, -1):
                    _raise(copied[process][edge.source], copy.source, passed)
                    changed = True
    return changed


CopiedBounds = tuple[list[dict[int, int]], list[dict[int, int]]]
"""Lower and upper bounds, for each location, that copies carry there."""


def process_bounds(
    invariants: Sequence[Sequence[ConstraintRange]],
    edges: Iterable[BoundEdge],
    everywhere: tuple[Mapping[int, int], Mapping[int, int]] = ({}, {}),
    symmetric: frozenset[int] | None = frozenset(),
    copied: CopiedBounds | None = None,
) -> tuple[LocationBounds, ...]:
    """The bounds at every location of one process, copies of clocks not counted.

    Args:
        invariants: for each location.
        everywhere: lower and upper bounds that hold at every location, such as those of the queries.
        symmetric: the clocks whose lower and upper bounds must be equal; None means all.
        copied: more bounds.
    """
    count = len(invariants)
    lower: list[dict[int, int]] = [dict(everywhere[0]) for _ in range(count)]
    upper: list[dict[int, int]] = [dict(everywhere[1]) for _ in range(count)]
    for bounds, more in zip((lower, upper), copied or (), strict=False):
        for here, arriving in zip(bounds, more, strict=True):
            for clock, constant in arriving.items():
                _raise(here, clock, constant)
    for location, constraints in enumerate(invariants):
        for constraint in constraints:
            collect(constraint, lower[location], upper[location])
    common_resets: dict[tuple[int, int], frozenset[int]] = {}
    for edge in edges:
        into_lower = lower[edge.source]
        into_upper = upper[edge.source]
        for constraint in edge.constraints:
            collect(constraint, into_lower, into_upper)
            if edge.both_directions:
                collect(constraint, into_upper, into_lower)
        pair = edge.source, edge.target
        common_resets[pair] = common_resets[pair] & edge.resets if pair in common_resets else edge.resets
    predecessors: list[list[tuple[int, frozenset[int]]]] = [[] for _ in range(count)]
    for (source, target), resets in common_resets.items():
        if source != target:
            predecessors[target].append((source, resets))
    _propagate(lower, predecessors)
    _propagate(upper, predecessors)
    for low, up in zip(lower, upper, strict=True):
        for clock in [*low, *up]:
            if symmetric is None or clock in symmetric:
                low[clock] = up[clock] = max(low.get(clock, -1), up.get(clock, -1))
    return tuple(
        LocationBounds(tuple(sorted(low.items())), tuple(sorted(up.items())))
        for low, up in zip(lower, upper, strict=True)
    )


def collect(constraint: ConstraintRange, lower: dict[int, int], upper: dict[int, int]) -> None:
    """Adds a constraint to the bounds of the place where it is evaluated."""
    if constraint.is_diagonal:
        largest = max(abs(constraint.low), abs(constraint.high))
        for clock in (*constraint.lefts, *constraint.rights):
            _raise(lower, clock, largest)
            _raise(upper, clock, largest)
    elif constraint.rights == (0,):
        for clock in constraint.lefts:
            _raise(upper, clock, constraint.high)
    else:
        for clock in constraint.rights:
            _raise(lower, clock, -constraint.low)


def _raise(bounds: dict[int, int], clock: int, constant: int) -> None:
    bounds[clock] = max(bounds.get(clock, 0), constant)


def _propagate(bounds: list[dict[int, int]], predecessors: Sequence[Sequence[tuple[int, frozenset[int]]]]) -> None:
    """Carries bounds backwards over edges that do not reset the clock.

    For each clock the locations are taken in descending order of their own bounds, so each location is settled once.
    """
    seeds: dict[int, list[tuple[int, int]]] = {}
    for location, own in enumerate(bounds):
        for clock, constant in own.items():
            seeds.setdefault(clock, []).append((constant, location))
    for clock, found in seeds.items():
        found.sort(reverse=True)
        settled: set[int] = set()
        for constant, seed in found:
            if seed in settled:
                continue
            settled.add(seed)
            pending = [seed]
            while pending:
                for source, resets in predecessors[pending.pop()]:
                    if source not in settled and clock not in resets:
                        settled.add(source)
                        bounds[source][clock] = constant
                        pending.append(source)


def diagonal_bounds(diagonals: Iterable[tuple[int, int, int]], reset_values: Mapping[int, int] = {}) -> dict[int, int]:
    """For each clock of a difference constraint (left, right, raw) the bound it needs in every location.

    Args:
        reset_values: the largest value each clock may be set to.
    """
    result: dict[int, int] = {}
    for left, right, raw in diagonals:
        shift = max(reset_values.get(left, 0), reset_values.get(right, 0))
        for clock in (left, right):
            _raise(result, clock, abs(raw >> 1) + shift)
    return result


def joined_copies(copies: Iterable[ClockCopy]) -> tuple[ClockCopy, ...]:
    """The copies that result from copies that an edge may make, in any order and each once or more often; offsets are
    never below 0, and a largest one means nothing here."""
    least: dict[tuple[int, int], int] = {}
    for copy in copies:
        pair = copy.clock, copy.source
        offset = max(copy.least, 0)
        least[pair] = min(least.get(pair, offset), offset)
    clocks = {clock for pair in least for clock in pair}
    for through in clocks:
        for target in clocks:
            for source in clocks:
                if (target, through) in least and (through, source) in least:
                    whole = least[target, through] + least[through, source]
                    least[target, source] = min(least.get((target, source), whole), whole)
    return tuple(ClockCopy(clock, source, offset) for (clock, source), offset in sorted(least.items()))


def copied_diagonals(
    diagonals: Iterable[tuple[int, int, int]], copies: Collection[ClockCopy], most: int
) -> tuple[tuple[int, int, int], ...] | None:
    """The difference constraints (left, right, raw), and those that copies make of them; None if these are more than
    so many, perhaps without end."""
    found = dict.fromkeys(diagonals)
    pending = list(found)
    while pending:
        left, right, raw = pending.pop()
        for copy in copies:
            for offset in range(max(copy.least, 0), copy.largest + 1):
                before = []
                if copy.clock == left and copy.source != right:
                    before.append((copy.source, right, raw - 2 * offset))
                if copy.clock == right and copy.source != left:
                    before.append((left, copy.source, raw + 2 * offset))
                for each in before:
                    if each in found:
                        continue
                    found[each] = None
                    pending.append(each)
                    if len(found) > most:
                        return None
    return tuple(found)
