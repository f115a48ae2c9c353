"""Observers against the exact monitor along single runs, and observed networks against the networks alone."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from random import Random
from typing import Any

import pytest

from tachk.base.span import Source
from tachk.frontend.loaded import LoadedModel
from tachk.logic.observer.construction import NoObserver, build_observer
from tachk.logic.observer.violation import condition_of
from tachk.logic.simplify import simplify
from tachk.meaning.clock_constants import clock_constants
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.step import StepError, delay, initial_state, successors
from tachk.model.query import Query
from tachk.model.run import DiscreteState, TimedState, Transition
from tachk.syntax import ast
from tachk.syntax.formula import Formula, TruthConstant
from tachk.syntax.formulas.parser import parse_formula
from tachk.syntax.formulas.printer import print_formula
from tachk.syntax.rewrite import rewrite
from tachk.transform.observed import observed
from tachk.verify.verdict import Answer
from tachk.verify.verify import verify
from tests.support import RandomCase, Shape, random_case
from tests.support.agreement import VARIANTS, Effort, compare
from tests.support.exact_monitor import verdict
from tests.support.exact_trace import ExactTrace
from tests.support.observer_agreement import (
    ObserverCase,
    bounded_observer_case,
    edges_observer_case,
    endless_observer_case,
    nested_observer_case,
    past_observer_case,
    query_of,
    random_observer_case,
    random_watched,
    replaying,
    violated,
)
from tests.support.oracles.digitised import _capped, _next_region, _spread
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn

SMALL = Shape(processes=2, locations=3, clocks=2, constant=3, deadlocks=False)
MAXIMAL_STATES = 400


def _truth(case: ObserverCase) -> bool | None:
    """As the monitor says it, but what no run can satisfy is violated before the trace shows it."""
    truth = verdict(case.formula, case.trace).truth
    return verdict(simplify(rewrite(case.formula, _constant)), case.trace).truth if truth is None else truth


def _constant(node: Any) -> Any:
    condition = condition_of(node) if isinstance(node, Formula) else None
    return TruthConstant(node.span, condition.value) if isinstance(condition, ast.BooleanLiteral) else node


@pytest.mark.parametrize("block", range(3))
def test_an_observer_can_reach_its_bad_location_where_the_monitor_says_false(block: int) -> None:
    answers = []
    for seed in seeds(range(40 * block, 40 * block + 40)):
        case = random_observer_case(Random(seed))
        try:
            build_observer(case.formula, "Observer")
        except NoObserver:
            continue
        model = replaying(case.trace)
        query = query_of(case.formula, model)
        assert query is not None
        truth = _truth(case)
        _compare(model, query, truth, f"seed {seed}: {print_formula(case.formula)} is {truth}")
        answers.append(truth)
    assert enough(answers.count(False) > 5)
    assert enough(len(answers) - answers.count(False) > 5)


@pytest.mark.parametrize("block", range(3))
def test_an_observer_says_what_the_monitor_says_where_events_fall_on_bounds(block: int) -> None:
    answers = []
    for seed in seeds(range(80 * block, 80 * block + 80)):
        case = bounded_observer_case(Random(seed))
        model = replaying(case.trace)
        query = query_of(case.formula, model)
        if query is None:
            continue
        truth = _truth(case)
        assert violated(model, query) == (truth is False), f"seed {seed}: {print_formula(case.formula)} is {truth}"
        answers.append(truth)
    assert enough(answers.count(False) > 15)
    assert enough(len(answers) - answers.count(False) > 15)


@pytest.mark.parametrize("block", range(2))
def test_an_observer_says_what_the_monitor_says_of_what_is_temporal_inside(block: int) -> None:
    answers = _compared(nested_observer_case, range(40 * block, 40 * block + 40))
    assert enough(answers.count(False) > 4)
    assert enough(len(answers) - answers.count(False) > 4)


@pytest.mark.parametrize("block", range(3))
def test_an_observer_says_what_the_monitor_says_of_edges_that_coincide(block: int) -> None:
    answers = _compared(edges_observer_case, range(30 * block, 30 * block + 30))
    assert enough(answers.count(False) > 5)
    assert enough(len(answers) - answers.count(False) > 5)


@pytest.mark.parametrize(
    ("requirement", "rows", "end"),
    [
        # Both rise at the beginning, where one of them must not count as having been there before.
        ("F[0, 8] (rise(q) && rise(r))", {0: "q r", 8: "p q r"}, 20),
        # p rises at the last instant of the window, and stays: violated there, and nowhere before.
        ("F(0, 4] ((q || !rise(p)) && (fall(p) || p))", {0: "", 4: "p", 9: ""}, 12),
        # The same for the last instant of something that has to last from the last instant on.
        ("F[0, 4] (p && F[0, 4] (!rise(q) && q))", {0: "p", 8: "p q"}, 20),
        ("F[0, 4] (rise(p) && F[0, 4] ((r || !rise(q)) && (fall(q) || q)))", {0: "", 4: "p", 8: "p q"}, 20),
    ],
)
def test_edges_at_the_first_and_at_the_last_instant_of_a_window(
    requirement: str, rows: dict[int, str], end: int
) -> None:
    columns = {name: tuple(name in row.split() for row in rows.values()) for name in ("p", "q", "r")}
    trace = ExactTrace(tuple(map(Fraction, rows)), columns, Fraction(end))
    formula, _ = parse_formula(Source("requirement", requirement))
    assert formula is not None
    model = replaying(trace)
    query = query_of(formula, model)
    assert query is not None
    assert violated(model, query) == (verdict(formula, trace).truth is False)


@pytest.mark.parametrize("block", range(3))
def test_an_observer_says_what_the_monitor_says_of_windows_that_ended_before_now(block: int) -> None:
    answers = _compared(past_observer_case, range(60 * block, 60 * block + 60))
    assert enough(answers.count(False) > 15)
    assert enough(len(answers) - answers.count(False) > 10)


@pytest.mark.parametrize("block", range(3))
def test_what_sets_no_deadline_is_evaluated_as_a_run_whose_values_stay_for_ever(block: int) -> None:
    answers = []
    for seed in seeds(range(60 * block, 60 * block + 60)):
        case = endless_observer_case(Random(seed))
        model = replaying(case.trace, stops=False)
        query = query_of(case.formula, model)
        if query is None:
            continue
        (found,) = verify(model.network, [query])
        long = replace(case.trace, end=case.trace.end + 1000)
        truth = verdict(case.formula, long).truth
        assert (found.answer is Answer.FAILS) == (truth is False), f"seed {seed}: {print_formula(case.formula)}"
        assert (found.answer is Answer.HOLDS) == (truth is True), f"seed {seed}: {print_formula(case.formula)}"
        answers.append(truth)
    assert enough(answers.count(False) > 5)
    assert enough(answers.count(True) > 5)


def _compared(draw: Callable[[Random], ObserverCase], numbers: range) -> list[bool | None]:
    """What the monitor says of the cases drawn for which there is an observer, which says the same."""
    answers = []
    for seed in seeds(numbers):
        case = draw(Random(seed))
        model = replaying(case.trace)
        query = query_of(case.formula, model)
        if query is None:
            continue
        truth = _truth(case)
        _compare(model, query, truth, f"seed {seed}: {print_formula(case.formula)} is {truth}")
        answers.append(truth)
    return answers


def _compare(model: LoadedModel, query: Query, truth: bool | None, case: str) -> None:
    """Of a formula that a run without end can violate, the monitor judges the trace as if nothing came behind it."""
    assert query.observer is not None
    if query.observer.endings:
        assert truth is False or not violated(model, query), case
    else:
        assert violated(model, query) == (truth is False), case


@pytest.mark.parametrize("block", range(3))
def test_an_observer_never_keeps_the_network_from_acting_and_never_delays_it(block: int) -> None:
    watched = compared = 0
    for seed in seeds(range(8 * block, 8 * block + 8)):
        random = Random(seed)
        network = random_case(random, SMALL).network
        query = random_watched(random, network)
        if query is None:
            continue
        watched += 1
        alone, with_observer = prepare(network), prepare(observed(network, query.observer).network)
        states, complete = _reachable(with_observer)
        for state in states:
            own = _projected(alone, state)
            settled = [later for later in _observer_moves(with_observer, state) if not _hurries(with_observer, later)]
            assert settled, f"seed {seed}: the observer cannot leave a committed location"
            for later in settled:
                assert _actions(alone, own) == _actions(with_observer, later, len(network.processes)), f"seed {seed}"
            assert _may_wait(alone, own) <= any(
                _may_wait(with_observer, later) for later in _observer_moves(with_observer, state)
            ), f"seed {seed}: time stands still"
        expected, all_expected = _reachable(alone)
        if complete and all_expected:
            compared += 1
            constants = clock_constants(network, []).maximum[1:]
            assert {_normal(_projected(alone, state), constants) for state in states} == {
                _normal(state, constants) for state in expected
            }, f"seed {seed}"
    assert enough(watched > 3)
    assert enough(compared > 0), "no network is small enough to compare all its states"


@pytest.mark.parametrize("block", range(3))
def test_no_option_changes_the_verdict_of_an_observer(block: int) -> None:
    for seed in seeds(range(100 + 6 * block, 106 + 6 * block)):
        random = Random(seed)
        network = random_case(random, SMALL).network
        query = random_watched(random, network)
        if query is not None and query.target is not None:
            case = RandomCase(observed(network, query.observer).network, (query.target,))
            assert compare(case, VARIANTS, Effort(200, 300)).problems == (), f"seed {seed}"


# ---- regions --------------------------------------------------------------------------------------------------------


def _reachable(model: PreparedNetwork) -> tuple[set[TimedState], bool]:
    """A point of every reachable region, and whether these are all."""
    constants = clock_constants(model.network, []).maximum[1:]
    start = _normal(initial_state(model), constants)
    found, waiting = {start}, deque([start])
    while waiting:
        if len(found) > MAXIMAL_STATES:
            return found, False
        state = waiting.popleft()
        after = [later for _, later in successors(model, state)]
        duration = _next_region(tuple(v for v, m in zip(state.clocks, constants, strict=True) if v <= m))
        after += _waited(model, state, duration)
        for later in after:
            normal = _normal(later, constants)
            if normal not in found:
                found.add(normal)
                waiting.append(normal)
    return found, True


def _normal(state: TimedState, constants: tuple[int, ...]) -> TimedState:
    return TimedState(state.discrete, _spread(_capped(state.clocks, constants)), Fraction(0))


def _waited(model: PreparedNetwork, state: TimedState, duration: Fraction | None) -> list[TimedState]:
    try:
        return [] if duration is None else [delay(model, state, duration)]
    except StepError:
        return []


def _projected(alone: PreparedNetwork, state: TimedState) -> TimedState:
    """The state of the network alone: its processes, variables and clocks come first."""
    processes, slots = len(alone.network.processes), len(alone.layout.initial)
    discrete = DiscreteState(state.discrete.locations[:processes], state.discrete.values[:slots])
    return TimedState(discrete, state.clocks[: alone.dimension - 1], state.time)


def _actions(model: PreparedNetwork, state: TimedState, observer: int = -1) -> set[Transition]:
    return {t for t, _ in successors(model, state) if all(p.process != observer for p in t.participants)}


def _observer_moves(model: PreparedNetwork, state: TimedState) -> Iterator[TimedState]:
    """The state and those that the observer alone can lead to while no time passes."""
    observer = len(model.network.processes) - 1
    found, waiting = {state}, deque([state])
    while waiting:
        current = waiting.popleft()
        yield current
        for transition, after in successors(model, current):
            if transition.participants[0].process == observer and after not in found:
                found.add(after)
                waiting.append(after)


def _hurries(model: PreparedNetwork, state: TimedState) -> bool:
    """Whether the observer is in a committed location, which it leaves before the network goes on."""
    return model.network.processes[-1].locations[state.discrete.locations[-1]].committed


def _may_wait(model: PreparedNetwork, state: TimedState) -> bool:
    return bool(_waited(model, state, Fraction(1, 64)))
