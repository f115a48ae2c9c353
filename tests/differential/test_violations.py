"""All violations and the counts of triggers against the definitions, on random formulas and traces."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given, settings

from tachk.base.span import NOWHERE
from tachk.syntax import formula as syntax
from tachk.syntax.formulas.printer import print_formula
from tests.support.formulas import FormulaShape, MonitoringCase, monitoring_cases, random_monitoring_case
from tests.support.monitor_input import always
from tests.support.seeds import seeds
from tests.support.smaller_cases import describe
from tests.support.violation_agreement import online_violation_problems, violation_problems

pytestmark = pytest.mark.drawn

SHAPES = (FormulaShape(depth=2), FormulaShape(depth=2, unbounded=False, rows=14, gap=2), FormulaShape(depth=1, grid=3))


def check(case: MonitoringCase, refinement: int) -> None:
    text = f"{print_formula(case.formula)} on {describe(case.trace)}"
    assert not violation_problems(case, refinement), text
    for seed in (0, 1):
        assert not online_violation_problems(case, refinement, seed), text


@pytest.mark.parametrize("pack", range(4))
def test_violations_agree_with_the_definition(pack: int) -> None:
    for seed in seeds(range(30 * pack, 30 * (pack + 1))):
        random = Random(seed)
        case = random_monitoring_case(random, SHAPES[seed % len(SHAPES)])
        other = random_monitoring_case(random, SHAPES[seed % len(SHAPES)]).formula
        match seed % 4:
            case 0:
                formula: syntax.Formula = always(case.formula)
            case 1:
                formula = always(syntax.Implies(NOWHERE, case.formula, other))
            case 2:
                formula = syntax.And(NOWHERE, (always(case.formula), always(syntax.Implies(NOWHERE, other, other))))
            case _:
                formula = case.formula
        check(MonitoringCase(formula, case.trace), (1, 2)[seed % 2])


@settings(max_examples=25, deadline=None)
@given(monitoring_cases())
def test_violations_agree_and_what_fails_is_small(case: MonitoringCase) -> None:
    check(MonitoringCase(always(case.formula), case.trace), 1)
