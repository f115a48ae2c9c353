"""Conditions that are enough for formulas: against the exact monitor along runs, and with and without them."""

from __future__ import annotations

from random import Random

import pytest

from tachk.base.words import QueryKind
from tachk.engine.options import Limits, Options
from tachk.frontend.context import Context
from tachk.frontend.expressions.typed_expressions import condition
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.made_network import scope_of
from tachk.logic.sufficient_condition import sufficient_condition
from tachk.model.query import Query
from tachk.verify.verdict import Answer
from tachk.verify.verify import verify
from tests.support import Shape, random_case
from tests.support.exact_monitor import verdict
from tests.support.exact_trace import condition as value_of
from tests.support.observer_agreement import random_atom, random_observer_case, random_watched
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn

SMALL = Shape(processes=3, locations=3, clocks=1, constant=3, deadlocks=False)


@pytest.mark.parametrize("block", range(4))
def test_a_formula_is_not_violated_where_its_condition_is_always_true(block: int) -> None:
    always = 0
    for seed in seeds(range(100 * block, 100 * block + 100)):
        case = random_observer_case(Random(seed))
        enough_for = sufficient_condition(case.formula)
        rows = [
            dict(zip(case.trace.columns, values, strict=True))
            for values in zip(*case.trace.columns.values(), strict=True)
        ]
        if enough_for is not None and all(value_of(enough_for, row).truth for row in rows):
            always += 1
            assert verdict(case.formula, case.trace).truth is not False, f"seed {seed}"
    assert enough(always > 0)


@pytest.mark.parametrize("block", range(3))
def test_answers_are_those_of_observers(block: int) -> None:
    shared = 0
    for seed in seeds(range(40 * block, 40 * block + 40)):
        random = Random(seed)
        network = random_case(random, SMALL).network
        drawn = [random_watched(random, network) for _ in range(4)]
        queries = [query for query in drawn if query is not None and query.kind is QueryKind.INVARIANTLY]
        for number in range(2):
            predicate = condition(random_atom(random, network), scope_of(network), Context(DiagnosticCollector()))
            queries.append(Query(f"plain{number}", QueryKind.INVARIANTLY, predicate))
        limits = Limits(states=2000)
        together = verify(network, queries, Options(), limits)
        alone = verify(network, queries, Options().off("sufficient"), limits)
        for one, other in zip(together, alone, strict=True):
            shared += one.query.observer is not None and one.statistics.states_stored != other.statistics.states_stored
            assert one.query == other.query
            if Answer.UNKNOWN in (one.answer, other.answer):
                assert one.reason == other.reason or "limit" in one.reason + other.reason, f"seed {seed}"
            else:
                assert one.answer is other.answer, f"seed {seed}"
                assert (one.trace is None) == (other.trace is None), f"seed {seed}"
            assert one.notes == other.notes, f"seed {seed}"
    assert enough(shared > 0)
