"""The monitors of the core against exact definitions, on random formulas and traces.

`python -m bench.monitor_agreement 10000 0` asks the same many more times.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tachk.recordings.traces.core_monitor import monitor_truth
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.verdict_explanation import horizon
from tachk.syntax.formulas.printer import print_formula
from tests.support.exact_monitor import satisfaction
from tests.support.formulas import FormulaShape, MonitoringCase, monitoring_cases, random_monitoring_case
from tests.support.monitor_input import always, monitor_input, truth_of
from tests.support.offline_agreement import offline_problems
from tests.support.online_agreement import online_problems
from tests.support.seeds import enough, seeds
from tests.support.smaller_cases import describe

pytestmark = pytest.mark.drawn

SHAPES = {
    "everything": FormulaShape(),
    "deep": FormulaShape(depth=4, bound=2, rows=6),
    "long": FormulaShape(grid=1, rows=12),
    "thirds": FormulaShape(depth=2, grid=3, gap=2),
    "bounded": FormulaShape(depth=2, unbounded=False, rows=16, gap=2),
    "constants": FormulaShape(depth=2, bound=1, rows=10, gap=1, constants=0.1),
}
PACK = 10
"""Cases in one test, so that reports stay short."""


def check(case: MonitoringCase, seed: int) -> None:
    refinement = (1, 1, 2, 5)[seed % 4]
    text = f"{print_formula(case.formula)} on {describe(case.trace)}"
    assert not offline_problems(case, refinement, seed), text
    assert not online_problems(case, refinement, seed), text


@pytest.mark.parametrize("pack", range(4))
@pytest.mark.parametrize("name", SHAPES)
def test_monitors_agree_with_the_definitions(name: str, pack: int) -> None:
    for seed in seeds(range(PACK * pack, PACK * (pack + 1))):
        case = random_monitoring_case(Random(seed), SHAPES[name])
        check(MonitoringCase(always(case.formula), case.trace) if seed % 3 == 0 else case, seed)


def test_values_that_stay_for_ever_decide_what_looks_ahead_of_the_end() -> None:
    """Without unbounded operators, as on a trace that goes on for as long as anything looks ahead."""
    seen = 0
    for seed in seeds(range(150)):
        case = random_monitoring_case(Random(seed), FormulaShape(depth=2, unbounded=False, rows=4, gap=2))
        given_ = monitor_input(case)
        found = monitor_truth(given_.program, given_.trace)
        if found.verdict is Truth.UNDETERMINED:
            seen += 1
            longer = replace(case.trace, end=case.trace.end + horizon(given_.program) + 1)
            expected = truth_of(satisfaction(case.formula, longer).value(Fraction(0)))
            assert expected is not Truth.UNDETERMINED
            assert found.lasting is expected, seed
    assert enough(seen > 20)


@settings(max_examples=60, deadline=None)
@given(monitoring_cases(), st.integers(0, 1000))
def test_monitors_agree_with_the_definitions_and_what_fails_is_small(case: MonitoringCase, seed: int) -> None:
    check(case, seed)
