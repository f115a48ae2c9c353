"""Verdicts about networks whose clocks stop, and are copied, beside random runs by the reference semantics.

No zone, schedule or proof is shared: `tachk.meaning.step` lets time pass and fires transitions with exact clock values.
What is said to be unreachable is met by no random run, values stay within their bounds, and each run that is shown is
one step by step.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from fractions import Fraction
from random import Random

import pytest

from tachk.base.operators import BinaryOperator
from tachk.base.words import QueryKind
from tachk.engine.options import Limits
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.step import StepError, delay, fire, initial_state, satisfies, successors
from tachk.model.connectives import negation
from tachk.model.expressions import BOOL, Binary, Constant, Expression, Reference
from tachk.model.query import Query
from tachk.model.run import TimedState, TimedTrace
from tachk.model.traversal import asks_deadlock
from tachk.model.types import ClockType
from tachk.verify.verdict import Answer, Extreme, Verdict
from tachk.verify.verify import verify
from tests.support import RandomCase, Shape, random_case
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn

SMALL = {"processes": 2, "locations": 3, "clocks": 3, "constant": 3, "stopwatches": True}
SHAPES = {
    "stopwatches": Shape(**SMALL),
    "copies": Shape(**SMALL, copies=0.6),
    "copies and diagonals": Shape(**SMALL, copies=0.6, advances=False, diagonals=True, deadlocks=False),
    "copies in functions": Shape(**SMALL, copies=0.5, language=True),
}


def questions(case: RandomCase) -> list[Query]:
    asked = [Query(f"met{n}", QueryKind.POSSIBLY, p) for n, p in enumerate(case.predicates)]
    for number, predicate in enumerate(case.predicates):
        if not asks_deadlock(predicate):
            asked.append(Query(f"later{number}", QueryKind.EVENTUALLY, predicate))
            asked.append(Query(f"never{number}", QueryKind.POTENTIALLY_ALWAYS, negation(predicate)))
    clocks = [v for v in case.network.all_variables() if isinstance(v.type, ClockType)]
    return [*asked, Query("values", QueryKind.BOUNDS, None, tuple(map(Reference, clocks[:2])))]


def random_states(model: PreparedNetwork, random: Random) -> Iterator[TimedState]:
    for _ in range(8):
        state = initial_state(model)
        yield state
        for _ in range(10):
            with suppress(StepError):
                state = delay(model, state, Fraction(random.randint(0, 12), random.choice((1, 2, 3, 4, 6))))
                yield state
            following = successors(model, state)
            if following:
                state = random.choice(following)[1]
                yield state


def is_run(model: PreparedNetwork, trace: TimedTrace) -> bool:
    state = initial_state(model)
    for step in trace.steps:
        state = delay(model, state, step.delay)
        if step.transition is not None:
            state = fire(model, state, step.transition)
        if state != step.state:
            return False
    return trace.initial == initial_state(model)


def objections(model: PreparedNetwork, query: Query, verdict: Verdict, met: list[TimedState]) -> Iterator[str]:
    """What is wrong with a verdict that is not unknown."""
    if query.kind is QueryKind.BOUNDS:
        for operand, extremes in zip(query.operands, verdict.extremes, strict=True):
            yield from of_extreme(model, operand, extremes.least, BinaryOperator.LESS, met)
            yield from of_extreme(model, operand, extremes.largest, BinaryOperator.GREATER, met)
        return
    predicate = query.predicate
    assert predicate is not None
    if (verdict.answer is Answer.HOLDS) is (query.kind is not QueryKind.EVENTUALLY):
        if verdict.trace is None or not is_run(model, verdict.trace):
            yield "there is no run that shows it"
        elif query.kind is QueryKind.POSSIBLY and not satisfies(model, verdict.trace.states[-1], predicate):
            yield "the run ends elsewhere"
        elif query.kind is QueryKind.POTENTIALLY_ALWAYS and not all_of(model, verdict.trace.states, predicate):
            yield "the run leaves what it never leaves"
        elif query.kind is QueryKind.EVENTUALLY and not all_of(model, verdict.trace.states, negation(predicate)):
            yield "the run does not avoid it"
    elif query.kind is QueryKind.POSSIBLY and not all_of(model, met, negation(predicate)):
        yield "a random run gets there"


def of_extreme(
    model: PreparedNetwork,
    operand: Expression,
    extreme: Extreme | None,
    beyond: BinaryOperator,
    met: list[TimedState],
) -> Iterator[str]:
    if extreme is None:
        yield "a value is missing"
        return
    if extreme.run is not None and not is_run(model, extreme.run):
        yield "the run that takes a value is none"
    if extreme.value is None:
        return
    value = Constant(extreme.value)
    inside = negation(Binary(beyond, operand, value, BOOL))
    if extreme.strict:
        inside = Binary(BinaryOperator.AND, inside, Binary(BinaryOperator.NOT_EQUAL, operand, value, BOOL), BOOL)
    if not all_of(model, met, inside):
        yield f"a random run goes beyond {extreme.value}"


def all_of(model: PreparedNetwork, states: Iterable[TimedState], predicate: Expression) -> bool:
    return all(satisfies(model, state, predicate) for state in states)


@pytest.mark.parametrize("shape", SHAPES)
def test_no_verdict_is_contradicted_by_a_random_run(shape: str) -> None:
    decided: set[Answer] = set()
    for seed in seeds(range(10)):
        case = random_case(Random(seed), SHAPES[shape])
        model, asked = prepare(case.network), questions(case)
        met = list(random_states(model, Random(seed)))
        for query, verdict in zip(asked, verify(case.network, asked, limits=Limits(states=2000)), strict=True):
            if verdict.answer is not Answer.UNKNOWN:
                assert not [*objections(model, query, verdict, met)], f"seed {seed}, {query.name}"
                decided.add(verdict.answer)
    assert enough(len(decided) == 2)
