"""Effects of edges on clocks and variables, as far as they matter for cycles."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from tachk.analysis.conditions import conjuncts, split_conjunction
from tachk.analysis.fold import Known, fold, fold_place, network_expressions
from tachk.analysis.intervals import interval
from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass
from tachk.base.words import Direction
from tachk.model.expressions import Assign, Binary, Constant, Expression, Increment, Reference, Variable
from tachk.model.network import Edge, Network
from tachk.model.traversal import (
    reads_clock,
    roots,
    walk,
    with_bodies,
    written_variables,
)
from tachk.model.types import BoolType, ChannelType, ClockType, IntType, bounds

LARGEST_RANGE = 256
"""The number of values of a variable above which its changes are only "larger" and "smaller"."""

Changes = frozenset[tuple[int, int]]
"""Pairs (value before, value after)."""


@dataclass(frozen=True, eq=False, slots=True)
class EdgeStep:
    """An edge.

    Attributes:
        process, number: of the edge.
        source, target: the numbers of its locations.
        resets: the clocks that it sets to 0 in any case.
        waits: the clocks that must be at least 1 where it is taken.
        channels: the variables of which its channel may be one; empty for an internal edge.
        place: which channel it is, where that is known before the run.
        changes: for the variables that it may write what it does to them; None where that is not known.
    """

    process: int
    number: int
    source: int
    target: int
    resets: frozenset[Expression]
    waits: frozenset[Expression]
    channels: frozenset[Variable]
    place: Expression | None
    sends: bool
    broadcast: bool
    changes: dict[Variable, Changes | None]


def steps_of(network: Network, known: Known) -> tuple[EdgeStep, ...]:
    """Every edge of the network."""
    fresh = _clocks_set_to_zero(network, known)
    return tuple(
        _step(network, number, place, edge, known, fresh)
        for number, process in enumerate(network.processes)
        for place, edge in enumerate(process.edges)
    )


def _clocks_set_to_zero(network: Network, known: Known) -> frozenset[Variable]:
    """The clocks (or arrays or records of them) that nothing sets to another value than 0."""
    outer = with_bodies(network_expressions(network))
    every = set(network.all_variables())
    for expression in outer:
        for node in walk(expression):
            if isinstance(node, Assign) and isinstance(node.target.type, ClockType):
                if fold(node.value, known) == Constant(0):
                    continue
                if any(variable.reference for variable in roots(node.target)):
                    return frozenset()
                every -= set(roots(node.target))
    return frozenset(every)


def _step(network: Network, number: int, place: int, edge: Edge, known: Known, fresh: frozenset[Variable]) -> EdgeStep:
    channels: frozenset[Variable] = frozenset()
    channel_place: Expression | None = None
    sends = broadcast = False
    if edge.synchronisation is not None:
        named = fold_place(edge.synchronisation.channel, known)
        channels = frozenset(roots(named))
        channel_place = named if _is_fixed(named) else None
        sends = edge.synchronisation.direction is Direction.SEND
        broadcast = isinstance(named.type, ChannelType) and named.type.broadcast
    return EdgeStep(
        number,
        place,
        edge.source,
        edge.target,
        frozenset(clock for clock in _resets(edge, known) if set(roots(clock)) <= fresh),
        frozenset(clock for clock in _waits(network, number, edge, known) if set(roots(clock)) <= fresh),
        channels,
        channel_place,
        sends,
        broadcast,
        _changes(network, edge, known, first=edge.synchronisation is None or sends),
    )


def _is_fixed(place: Expression) -> bool:
    """True if a place is the same whenever it is evaluated."""
    variables = [node.variable for node in walk(place) if isinstance(node, Reference)]
    return len(variables) == 1


def _resets(edge: Edge, known: Known) -> Iterator[Expression]:
    for update in edge.updates:
        if isinstance(update, Assign) and isinstance(update.target.type, ClockType):
            place = fold_place(update.target, known)
            if _is_fixed(place) and fold(update.value, known) == Constant(0):
                yield place


def _waits(network: Network, process: int, edge: Edge, known: Known) -> Iterator[Expression]:
    """The clocks that the guard, or the invariant of the location that is left, wants to be at least 1."""
    for condition in (edge.guard, network.processes[process].locations[edge.source].invariant):
        if condition is None:
            continue
        try:
            atoms = split_conjunction(condition, known).clocks
        except UnsupportedError:
            continue
        for only_if, atom in atoms:
            if only_if is None and atom.left is None and atom.right is not None:
                place = fold_place(atom.right, known)
                if interval(atom.bound, known)[1] <= -1 and _is_fixed(place):
                    yield place


def _changes(network: Network, edge: Edge, known: Known, first: bool) -> dict[Variable, Changes | None]:
    """The effect of the edge on single integers.

    Args:
        first: nothing has been written in the same transition when its updates begin, so that its guard holds then.
    """
    changes: dict[Variable, Changes | None] = dict.fromkeys(written_variables(list(edge.updates)))
    for variable in changes:
        if not isinstance(variable.type, IntType | BoolType) or network.resets(variable):
            continue
        low, high = bounds(variable.type)
        writing = [update for update in edge.updates if variable in written_variables([update])]
        if len(writing) != 1:
            continue
        if high - low >= LARGEST_RANGE:
            changes[variable] = _direction(writing[0], variable, known)
            continue
        values: Iterable[int] = range(low, high + 1)
        if first and edge.guard is not None:
            values = [value for value in values if _allows(edge.guard, variable, value, known)]
        changes[variable] = _written(writing[0], variable, values, (low, high), known)
    return changes


def _direction(update: Expression, variable: Variable, known: Known) -> Changes | None:
    """The direction of an update: it makes a variable larger (written as a step from 0 to 1) or smaller (1 to 0)."""
    added = _added(update, variable)
    if added is None:
        return None
    low, high = interval(added[1], known)
    if not added[0]:
        low, high = -high, -low
    return frozenset({(0, 1)}) if low > 0 else frozenset({(1, 0)}) if high < 0 else None


def _added(update: Expression, variable: Variable) -> tuple[bool, Expression] | None:
    """The value that an update adds to a variable, or (False) subtracts; None where it does something else."""
    if isinstance(update, Increment) and update.target == Reference(variable):
        return True, Constant(update.delta)
    if not isinstance(update, Assign) or update.target != Reference(variable):
        return None
    operator, value = update.operator, update.value
    if operator is None and isinstance(value, Binary) and value.left == update.target:
        operator, value = value.operator, value.right
    if operator in (BinaryOperator.ADD, BinaryOperator.SUBTRACT):
        return operator is BinaryOperator.ADD, value
    return None


def _allows(guard: Expression, variable: Variable, value: int, known: Known) -> bool:
    """True if the guard may be true where the variable has a value."""
    there = Known({**known.values, variable: (value,)}, known.bound)
    parts = [part for part in conjuncts(guard) if not reads_clock(part)]
    return not any(isinstance(folded := fold(part, there), Constant) and folded.value == 0 for part in parts)


def _written(
    update: Expression, variable: Variable, values: Iterable[int], allowed: tuple[int, int], known: Known
) -> Changes | None:
    added = _added(update, variable)
    if added is not None:
        value, sign = added[1], 1 if added[0] else -1
    elif isinstance(update, Assign) and update.target == Reference(variable) and update.operator is None:
        value, sign = update.value, 0
    else:
        return None
    pairs = []
    for before in values:
        there = Known({**known.values, variable: (before,)}, known.bound)
        after = fold(value, there)
        if not isinstance(after, Constant):
            return None
        pairs.append((before, before + sign * after.value if sign else after.value))
    if isinstance(variable.type, BoolType):
        pairs = [(before, int(after != 0)) for before, after in pairs]
    # A value outside the range is a run-time error: nothing follows.
    return frozenset(pair for pair in pairs if allowed[0] <= pair[1] <= allowed[1])
