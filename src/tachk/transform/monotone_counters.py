"""Monotone counters: counters that only go up, of which smaller values let more happen and force nothing.

A *monotone counter* is an integer variable that every update raises, and that is read in guards only, where it is
smaller than something: ``losses < LOSSES``. A process that raises a counter takes something away from the others and
gives them nothing, so it may be left out where only what is reachable counts (`tachk.transform.blocking_processes`).

That is a simulation. Let one state differ from another only in that counters have smaller values. It can do all
that the other can, and reaches such a state again:

- Time passes. Counters occur in no invariant and no rate. An edge that a counter enables could still stop time over an
  urgent channel. So no edge whose guard is about a counter sends on an urgent channel or is a partner over one. A
  receiver of a broadcast may be one, as the sender alone decides whether a broadcast is possible.
- The same edges are enabled: a counter stands below ``and`` and ``or`` only, so that the guard stays true. The guard
  cannot be a run-time error, which ``losses < LOSSES || a[n] > 0`` is only once the counter is at its bound.
- No further process is forced to take part: a process that can receive a broadcast must. An edge that a counter enables
  may force it, unless another receiving edge of the same location and channel, whose guard is about no counter, is
  enabled whenever this one is. That is decided with the conditions of which guards consist as unknown truth values.
- The updates have the same effect. Nothing that is assigned depends on a counter but the counter itself, whose new
  value is the old one and a constant; a smaller one stays in range where a larger one does, and does not wrap round.

Priorities and ``deadlock`` are about what is impossible: nothing is left out there at all. What a target is about is no
monotone counter. Weights of branches and rates of delays do not decide what is reachable.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from math import prod

from tachk.analysis.failures import can_fail
from tachk.analysis.fold import Known, fold, known_values
from tachk.analysis.impossible_edges import opened
from tachk.base.operators import COMPARISONS, CONSTANT_HIGH, BinaryOperator, UnaryOperator
from tachk.base.records import replace
from tachk.base.words import Direction
from tachk.model.expressions import (
    Assign,
    Binary,
    Constant,
    Expression,
    Increment,
    Reference,
    Unary,
    Variable,
    VariableKind,
)
from tachk.model.network import Edge, Network, Process
from tachk.model.traversal import process_expressions
from tachk.model.types import ChannelType, IntType, bounds
from tachk.transform.cone_of_influence import is_broadcast, mentioned

MOST_CONDITIONS = 10
"""Different conditions in the guards of a location of which all combinations of truth values are tried."""
MOST_SELECTIONS = 64
"""Combinations of values of the select variables of an edge that are looked at one by one."""

_SMALLER = (BinaryOperator.LESS, BinaryOperator.LESS_EQUAL)
_POSITIVE = (BinaryOperator.AND, BinaryOperator.OR)


def monotone_counters(network: Network, targets: Sequence[Expression]) -> frozenset[Variable]:
    """The monotone counters of a network for the reachability of targets."""
    known = known_values(network, targets)
    raised = {
        target.variable
        for process in network.processes
        for edge in process.edges
        for target in map(_raised, edge.updates)
        if target is not None
    }
    found = {variable for variable in raised if _is_counter(variable)} - mentioned(targets)[1]
    for process in network.processes:
        found -= _read_otherwise(process, found, known)
    for process in network.processes:
        for edge in process.edges:
            if edge.guard is not None and (mentioned_counters := mentioned([edge.guard])[1] & found):
                if can_fail(edge.guard, known) or not _forces_nothing(process, edge, found, known):
                    found -= mentioned_counters
    return frozenset(found)


def _is_counter(variable: Variable) -> bool:
    return (
        isinstance(variable.type, IntType)
        and variable.kind in (VariableKind.GLOBAL, VariableKind.LOCAL)
        and not variable.declared_meta
    )


def _raised(update: Expression) -> Reference | None:
    """The variable that an update does nothing but raise by a constant."""
    match update:
        case Increment(Reference() as target, 1):
            return _in_range(target, 1)
        case Assign(Reference() as target, Constant(step), operator=BinaryOperator.ADD):
            return _in_range(target, step)
        case Assign(
            Reference() as target, Binary(BinaryOperator.ADD, Reference(variable), Constant(step)), operator=None
        ):
            return _in_range(target, step) if variable is target.variable else None
        case _:
            return None


def _in_range(target: Reference, step: int) -> Reference | None:
    type_ = target.variable.type
    return target if isinstance(type_, IntType) and 0 <= step <= CONSTANT_HIGH - type_.high else None


def _read_otherwise(process: Process, candidates: set[Variable], known: Known) -> set[Variable]:
    """The variables that occur elsewhere than in updates that raise them and in guards that bound them from above."""
    found: set[Variable] = set()
    guards = [edge.guard for edge in process.edges if edge.guard is not None]
    for guard in guards:
        found |= {v for v in mentioned([guard])[1] & candidates if not _needs_less(opened(guard, known), v)}
    rest = replace(process, edges=tuple(replace(edge, guard=None) for edge in process.edges))
    for expression in process_expressions(rest):
        if _raised(expression) is None:
            found |= mentioned([expression])[1] & candidates
    return found


def _needs_less(condition: Expression, variable: Variable) -> bool:
    """True if a condition that is true stays true when the variable becomes smaller."""
    if variable not in mentioned([condition])[1]:
        return True
    match condition:
        case Binary(operator, left, right) if operator in _POSITIVE:
            return _needs_less(left, variable) and _needs_less(right, variable)
        case Binary(operator, Reference(compared), Constant()) if operator in _SMALLER:
            return compared is variable
        case Binary(operator, Constant(), Reference(compared)) if operator in COMPARISONS:
            return compared is variable and operator.mirrored in _SMALLER
        case _:
            return False


def _forces_nothing(process: Process, edge: Edge, candidates: set[Variable], known: Known) -> bool:
    """True if an edge that is enabled only thanks to a counter keeps nothing from happening."""
    if edge.synchronisation is None:
        return True
    channel = edge.synchronisation.channel
    if not is_broadcast(channel) or edge.synchronisation.direction is Direction.SEND:
        return isinstance(channel.type, ChannelType) and not channel.type.urgent
    others = [
        other
        for other in process.edges
        if other.source == edge.source
        and other.synchronisation is not None
        and other.synchronisation.direction is Direction.RECEIVE
        and (other.guard is None or mentioned([other.guard])[1].isdisjoint(candidates))
    ]
    selections = _selections(edge, known)
    return selections is not None and all(_covered(edge, there, others, candidates) for there in selections)


def _selections(edge: Edge, known: Known) -> list[Known] | None:
    """The facts for each combination of values of the select variables; None for too many."""
    ranges = [range(low, high + 1) for low, high in (bounds(v.type) for v in edge.selects)]  # type: ignore[arg-type]
    if prod(map(len, ranges)) > MOST_SELECTIONS:
        return None
    return [
        replace(known, bound={**known.bound, **dict(zip(edge.selects, values, strict=True))})
        for values in product(*ranges)
    ]


def _covered(edge: Edge, there: Known, others: Sequence[Edge], candidates: set[Variable]) -> bool:
    """True if one of the others can receive from the same channel whenever the edge can."""
    assert edge.synchronisation is not None
    channel = fold(edge.synchronisation.channel, there)
    guards = [
        Constant(1) if other.guard is None else opened(other.guard, here)
        for other in others
        for here in _selections(other, there) or ()
        if other.synchronisation is not None and fold(other.synchronisation.channel, here) == channel
    ]
    assert edge.guard is not None
    guard = opened(edge.guard, there)
    conditions = list(dict.fromkeys(c for g in (guard, *guards) for c in _conditions(g)))
    relevant = [c for c in conditions if not mentioned([c])[1].isdisjoint(candidates)]
    unknown = [c for c in conditions if c not in relevant]
    if len(unknown) > MOST_CONDITIONS:
        return False
    for values in product((False, True), repeat=len(unknown)):
        truth = dict(zip(unknown, values, strict=True)) | dict.fromkeys(relevant, True)
        if _is_true(guard, truth) and not any(_is_true(other, truth) for other in guards):
            return False
    return True


def _conditions(formula: Expression) -> Iterator[Expression]:
    """The conditions of which a formula consists."""
    match formula:
        case Constant():
            return
        case Binary(operator, left, right) if operator in _POSITIVE:
            yield from _conditions(left)
            yield from _conditions(right)
        case Unary(UnaryOperator.NOT, operand):
            yield from _conditions(operand)
        case _:
            yield formula


def _is_true(formula: Expression, truth: Mapping[Expression, bool]) -> bool:
    match formula:
        case Constant(value):
            return value != 0
        case Binary(BinaryOperator.AND, left, right):
            return _is_true(left, truth) and _is_true(right, truth)
        case Binary(BinaryOperator.OR, left, right):
            return _is_true(left, truth) or _is_true(right, truth)
        case Unary(UnaryOperator.NOT, operand):
            return not _is_true(operand, truth)
        case _:
            return truth[formula]
