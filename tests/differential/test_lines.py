"""Lines between rows and robustness in time, as the core has them, against exact definitions."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest

from tachk.syntax.formula_printer import print_formula
from tachk.testing.formulas import FormulaShape, MonitoringCase, random_monitoring_case
from tachk.testing.lines_agreement import line_problems, time_problems
from tachk.testing.monitor_input import always
from tachk.testing.reduction import describe

SHAPES = {
    "shallow": FormulaShape(depth=1, linear=True),
    "everything": FormulaShape(depth=2, linear=True, rows=6),
    "deep": FormulaShape(depth=3, linear=True, rows=5, bound=3),
    "thirds": FormulaShape(depth=2, linear=True, grid=3, rows=5, gap=2),
}
PACK = 10
"""Cases in one test, so that reports stay short."""


def drawn(shape: FormulaShape, seed: int) -> MonitoringCase:
    case = random_monitoring_case(Random(seed), shape)
    return MonitoringCase(always(case.formula), case.trace) if seed % 3 == 0 else case


def text(case: MonitoringCase) -> str:
    return f"{print_formula(case.formula)} on {describe(case.trace)}"


@pytest.mark.parametrize("pack", range(4))
@pytest.mark.parametrize("name", SHAPES)
def test_lines_agree_with_the_definitions(name: str, pack: int) -> None:
    for seed in range(PACK * pack, PACK * (pack + 1)):
        case = drawn(SHAPES[name], seed)
        assert line_problems(case, (1, 1, 2, 5)[seed % 4], seed) == (), text(case)


@pytest.mark.parametrize("pack", range(4))
@pytest.mark.parametrize("name", SHAPES)
def test_robustness_in_time_agrees_with_the_definitions(name: str, pack: int) -> None:
    for seed in range(PACK * pack, PACK * (pack + 1)):
        case = drawn(replace(SHAPES[name], linear=False), seed)
        assert time_problems(case, (1, 1, 2, 5)[seed % 4], seed) == (), text(case)


def test_lines_of_an_absolute_value_end_without_a_trace_of_rounding() -> None:
    case = random_monitoring_case(Random(1070), SHAPES["thirds"])
    assert line_problems(case, 2, 1070) == (), text(case)
