"""A slice that preserves liveness: without processes that runs which go on for ever do not notice.

A process that only blocks (`tachk.transform.blocking_processes`) makes nothing possible for the processes that count.
Here nothing is left out that could hinder them either, now or in the end. An *unobtrusive* process

- never keeps a broadcast from happening by the invariant behind an edge that receives it, and stops no clock;
- moves at once where it forbids delays, and in time where its invariant ends: then one of its own edges is enabled,
  whatever the variables are;
- takes no edges for ever in finite time, unless others move for ever, too.

So every run of the others, however it goes on or ends, is one with the unobtrusive processes, and the reverse. Whether
a run avoids a goal for ever does not depend on them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import product
from math import prod

from tachk.analysis.conditions import ClockAtom, split_conjunction
from tachk.analysis.edge_steps import steps_of
from tachk.analysis.fold import Known, fold, fold_place, known_values
from tachk.analysis.recurrent_edges import suspicious
from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.base.operators import COMPARISONS, CONNECTIVES, UnaryOperator
from tachk.base.records import replace
from tachk.base.words import Direction
from tachk.model.expressions import Assign, Binary, Constant, Expression, Reference, Unary, Variable
from tachk.model.network import Edge, Location, Network, Process
from tachk.model.traversal import process_expressions, roots, written_variables
from tachk.model.types import BoolType, ChannelType, ClockType, IntType, bounds
from tachk.transform.blocking_processes import only_blocking, trimmed_to
from tachk.transform.cone_of_influence import frozen, is_broadcast
from tachk.transform.transformation import Exactness, Transformation, reduced, unchanged

MOST_COMBINATIONS = 4096
"""The limit on combinations of values of variables for which it is tried if one of the edges is enabled."""

Ends = Mapping[Expression, int]
"""The latest values of clocks that an invariant allows."""


def liveness_preserving_slice(network: Network, targets: list[Expression]) -> Transformation:
    """The network without its unobtrusive processes that only block, and without the updates that no target needs.

    Processes and variables keep their numbers. Run-time errors of what is left out are not looked for.
    """
    left_out = only_blocking(network, targets)
    if not left_out:
        return unchanged(network)
    known = known_values(network, [])
    writers = _writers(network)
    required = {number for number in left_out if not _never_hinders(network.processes[number], known, writers)}
    while left_out := only_blocking(network, targets, required):
        noticed = _for_ever(network, left_out, known)
        if not noticed:
            return reduced(network, trimmed_to(network, targets, required), Exactness.INFINITE_RUNS)
        required |= noticed
    return unchanged(network)


def _writers(network: Network) -> Counter[Variable]:
    """The number of processes that may write each variable."""
    return Counter(v for process in network.processes for v in written_variables(list(process_expressions(process))))


def _for_ever(network: Network, left_out: set[int], known: Known) -> set[int]:
    """The processes of some of a network that may move for ever in finite time while the others do nothing."""
    processes = enumerate(network.processes)
    alone = replace(network, processes=tuple(p if n in left_out else frozen(p) for n, p in processes))
    return {step.process for step in suspicious(frozenset(steps_of(alone, known)))}


def _never_hinders(process: Process, known: Known, writers: Counter[Variable]) -> bool:
    ends = [_ends(location, known) for location in process.locations]
    certain = [end for end in ends if end is not None]
    if len(certain) < len(ends) or any(location.rates for location in process.locations):
        return False
    if any(bound < 0 for bound in certain[process.initial].values()):
        return False
    clocks = {variable for end in certain for clock in end for variable in roots(clock)}
    own = written_variables(list(process_expressions(process)))
    if any(writers[clock] > (clock in own) for clock in clocks):
        return False
    return all(_lets_happen(edge, certain, known) for edge in process.edges) and all(
        _goes_on(process, source, certain, known) for source in range(len(process.locations))
    )


def _ends(location: Location, known: Known) -> Ends | None:
    """The upper bounds of an invariant; None if it is not a conjunction of fixed upper bounds that are reached."""
    if location.invariant is None:
        return {}
    ends: dict[Expression, int] = {}
    try:
        parts = split_conjunction(location.invariant, known)
    except UnsupportedError:
        return None
    if parts.integers:
        return None
    for condition, atom in parts.clocks:
        if condition is not None or atom.right is not None or atom.strict or not isinstance(atom.bound, Constant):
            return None
        assert atom.left is not None
        clock = fold_place(atom.left, known)
        if not isinstance(clock, Reference):
            return None
        ends[clock] = min(atom.bound.value, ends.get(clock, atom.bound.value))
    return ends


def _lets_happen(edge: Edge, ends: list[Ends], known: Known) -> bool:
    """True if the edge neither hurries others nor keeps a broadcast from them."""
    if edge.synchronisation is None:
        return True
    channel = edge.synchronisation.channel
    if is_broadcast(channel) and edge.synchronisation.direction is Direction.RECEIVE:
        return _may_enter(edge, ends, known)
    return isinstance(channel.type, ChannelType) and not channel.type.urgent


def _may_enter(edge: Edge, ends: list[Ends], known: Known) -> bool:
    """True if the invariant behind an edge holds certainly when it has been taken."""
    return all(_is_bounded(clock, end, edge, ends[edge.source], known) for clock, end in ends[edge.target].items())


def _is_bounded(clock: Expression, end: int, edge: Edge, before: Ends, known: Known) -> bool:
    is_bounded = before.get(clock, end + 1) <= end
    for update in edge.updates:
        if written_variables([update]).isdisjoint(roots(clock)):
            continue
        is_bounded = False
        if isinstance(update, Assign) and isinstance(update.target.type, ClockType) and update.target == clock:
            value = fold(update.value, known)
            is_bounded = isinstance(value, Constant) and 0 <= value.value <= end
    return is_bounded


def _goes_on(process: Process, source: int, ends: list[Ends], known: Known) -> bool:
    """True if the process can move by itself, whatever the variables are, where it lets no more time pass."""
    location = process.locations[source]
    own = [edge for edge in process.edges if edge.source == source and _is_own(edge) and _may_enter(edge, ends, known)]
    if location.urgent or location.committed:
        return _some_is_enabled(own, {}, None, known)
    return all(_some_is_enabled(own, ends[source], clock, known) for clock in ends[source])


def _is_own(edge: Edge) -> bool:
    """True if taking the edge needs no partner."""
    if edge.selects:
        return False
    synchronisation = edge.synchronisation
    return synchronisation is None or (
        synchronisation.direction is Direction.SEND and is_broadcast(synchronisation.channel)
    )


def _some_is_enabled(edges: list[Edge], ends: Ends, clock: Expression | None, known: Known) -> bool:
    """True if one of the edges is certainly enabled where a clock has the latest value allowed and no other a later
    one; without a clock, wherever the clocks are."""
    conditions = []
    for edge in edges:
        if edge.guard is None:
            return True
        try:
            parts = split_conjunction(edge.guard, known)
        except UnsupportedError:
            continue
        if all(_is_met(atom, ends, clock, known) for _, atom in parts.clocks):
            conditions.append(parts.integers)
    return _covers(conditions, known)


def _is_met(atom: ClockAtom, ends: Ends, clock: Expression | None, known: Known) -> bool:
    if not isinstance(atom.bound, Constant):
        return False
    if atom.right is None:
        assert atom.left is not None
        latest = ends.get(fold_place(atom.left, known))
        return latest is not None and latest + atom.strict <= atom.bound.value
    if atom.left is not None or clock is None or fold_place(atom.right, known) != clock:
        return atom.left is None and -atom.bound.value + atom.strict <= 0
    return ends[clock] >= -atom.bound.value + atom.strict


def _covers(alternatives: list[tuple[Expression, ...]], known: Known) -> bool:
    """True if for all values of the variables all conditions of one of the alternatives are true."""
    if any(not conditions for conditions in alternatives):
        return True
    tested: dict[Variable, set[int]] = {}
    for conditions in alternatives:
        for condition in conditions:
            for variable, value in _tests(condition):
                if variable is None:
                    return False
                tested.setdefault(variable, set()).update((value - 1, value, value + 1))
    choices = []
    for variable, values in tested.items():
        assert isinstance(variable.type, IntType | BoolType)
        low, high = bounds(variable.type)
        choices.append(sorted({low, high, *(value for value in values if low <= value <= high)}))
    if prod(map(len, choices)) > MOST_COMBINATIONS:
        return False
    for combination in product(*choices):
        slots = {variable: (value,) for variable, value in zip(tested, combination, strict=True)}
        there = Known({**known.values, **slots}, known.bound)
        if not any(all(_is_true(fold(c, there)) for c in conditions) for conditions in alternatives):
            return False
    return bool(alternatives)


def _is_true(condition: Expression) -> bool:
    return isinstance(condition, Constant) and condition.value != 0


def _tests(condition: Expression) -> Iterator[tuple[Variable | None, int]]:
    """The comparisons of single variables with constants that a condition consists of; None for anything else."""
    if isinstance(condition, Reference) and isinstance(condition.variable.type, BoolType):
        yield condition.variable, 0
    elif isinstance(condition, Unary) and condition.operator is UnaryOperator.NOT:
        yield from _tests(condition.operand)
    elif isinstance(condition, Binary) and condition.operator in CONNECTIVES:
        yield from _tests(condition.left)
        yield from _tests(condition.right)
    elif isinstance(condition, Binary) and condition.operator in COMPARISONS:
        left, right = condition.left, condition.right
        if isinstance(left, Constant):
            left, right = right, left
        if (
            isinstance(left, Reference)
            and isinstance(right, Constant)
            and isinstance(left.variable.type, IntType | BoolType)
        ):
            yield left.variable, right.value
        else:
            yield None, 0
    elif not isinstance(condition, Constant):
        yield None, 0
