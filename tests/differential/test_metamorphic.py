"""Changes of a network that cannot change what is reachable, checked on random networks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from random import Random

import pytest

from tachk.base.operators import BinaryOperator
from tachk.engine import zone
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Limits
from tachk.engine.outcome import Status
from tachk.model.expressions import (
    Assign,
    Binary,
    Conditional,
    Constant,
    Expression,
    LocationTest,
    Unary,
    Variable,
    VariableKind,
)
from tachk.model.network import Edge, Location, Process
from tachk.model.types import ClockType
from tests.support import RandomCase, Shape, random_case
from tests.support.seeds import seeds

pytestmark = pytest.mark.drawn

FACTOR = 3


def statuses(case: RandomCase) -> list[Status]:
    program, goals = lower(case.network, case.predicates)
    return [goal.status for goal in zone.explore(program, goals, limits=Limits(states=20_000)).goals]


def rewritten(expression: Expression, change: Callable[[Expression], Expression]) -> Expression:
    """The expression with a change applied to every node of the kinds random networks have, from the leaves up."""
    match expression:
        case Binary():
            parts = {"left": rewritten(expression.left, change), "right": rewritten(expression.right, change)}
            return change(replace(expression, **parts))
        case Unary():
            return change(replace(expression, operand=rewritten(expression.operand, change)))
        case Assign():
            return change(replace(expression, value=rewritten(expression.value, change)))
        case Conditional(condition, then, otherwise):
            return change(
                replace(
                    expression,
                    condition=rewritten(condition, change),
                    then=rewritten(then, change),
                    otherwise=rewritten(otherwise, change),
                )
            )
        case _:
            return change(expression)


def everywhere(case: RandomCase, change: Callable[[Expression], Expression]) -> RandomCase:
    def optional(expression: Expression | None) -> Expression | None:
        return None if expression is None else rewritten(expression, change)

    def process(p: Process) -> Process:
        return replace(
            p,
            locations=tuple(replace(location, invariant=optional(location.invariant)) for location in p.locations),
            edges=tuple(
                replace(e, guard=optional(e.guard), updates=tuple(rewritten(u, change) for u in e.updates))
                for e in p.edges
            ),
        )

    network = replace(case.network, processes=tuple(process(p) for p in case.network.processes))
    return RandomCase(network, tuple(rewritten(p, change) for p in case.predicates))


def slower(case: RandomCase) -> RandomCase:
    """All constants of time multiplied."""

    def times(expression: Expression) -> Expression:
        return Binary(BinaryOperator.MULTIPLY, Constant(FACTOR), expression, expression.type)

    def change(expression: Expression) -> Expression:
        match expression:
            case Binary(_, left, right) if isinstance(left.type, ClockType) and not isinstance(right.type, ClockType):
                return replace(expression, right=times(right))
            case Assign(target, value) if isinstance(target.type, ClockType):
                return replace(expression, value=times(value))
            case _:
                return expression

    return everywhere(case, change)


def other_order(case: RandomCase) -> RandomCase:
    """The processes in reverse order."""
    last = len(case.network.processes) - 1

    def change(expression: Expression) -> Expression:
        if isinstance(expression, LocationTest):
            return replace(expression, process=last - expression.process)
        return expression

    changed = everywhere(case, change)
    return replace(changed, network=replace(changed.network, processes=changed.network.processes[::-1]))


def idle_clock(case: RandomCase) -> RandomCase:
    """One more clock, which nothing looks at."""
    clock = Variable("idle", ClockType(), VariableKind.GLOBAL, (0,))
    return replace(case, network=replace(case.network, variables=(clock, *case.network.variables)))


def idle_process(case: RandomCase) -> RandomCase:
    """One more process, with one location."""
    process = Process("Idle", "Idle", (Location("Here"),), ())
    return replace(case, network=replace(case.network, processes=(*case.network.processes, process)))


def split_edges(case: RandomCase) -> RandomCase:
    """Every internal edge in two: the guard, then the updates, with a committed location in between."""

    def process(p: Process) -> Process:
        locations, edges = list(p.locations), []
        for edge in p.edges:
            if edge.synchronisation is None and not edge.selects:
                between = len(locations)
                locations.append(Location(f"between{between}", committed=True))
                edges.append(replace(edge, target=between, updates=()))
                edges.append(Edge(between, edge.target, updates=edge.updates))
            else:
                edges.append(edge)
        return replace(p, locations=tuple(locations), edges=tuple(edges))

    return replace(case, network=replace(case.network, processes=tuple(process(p) for p in case.network.processes)))


@pytest.mark.parametrize(
    ("change", "shape"),
    [
        (slower, Shape(diagonals=True)),
        (slower, Shape(priorities=True)),
        (other_order, Shape(broadcast=False, priorities=True)),
        (idle_clock, Shape(priorities=True, diagonals=True, clocks=2)),
        (idle_process, Shape(priorities=True)),
        # A split edge may get stuck in between, and a committed process may come between its halves.
        (split_edges, Shape(deadlocks=False, committed=False)),
    ],
)
def test_a_change_that_keeps_behaviour_keeps_answers(change: Callable[[RandomCase], RandomCase], shape: Shape) -> None:
    for seed in seeds(range(60)):
        case = random_case(Random(seed), shape)
        assert statuses(change(case)) == statuses(case), f"seed {seed}"
