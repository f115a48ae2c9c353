"""Lines between rows and robustness in time, as the core has them, against exact definitions."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from random import Random

import pytest

from tachk.recordings.traces.linear_monitor import Measure, robustness
from tachk.syntax.formulas.printer import print_formula
from tests.support.exact_monitor import verdict
from tests.support.exact_trace import ExactTrace, Scalar
from tests.support.formulas import FormulaShape, MonitoringCase, random_monitoring_case
from tests.support.lines_agreement import line_problems, time_problems
from tests.support.monitor_input import always, monitor_input
from tests.support.seeds import enough, seeds
from tests.support.smaller_cases import describe

pytestmark = pytest.mark.drawn

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
    for seed in seeds(range(PACK * pack, PACK * (pack + 1))):
        case = drawn(SHAPES[name], seed)
        assert line_problems(case, (1, 1, 2, 5)[seed % 4], seed) == (), text(case)


@pytest.mark.parametrize("pack", range(4))
@pytest.mark.parametrize("name", SHAPES)
def test_robustness_in_time_agrees_with_the_definitions(name: str, pack: int) -> None:
    for seed in seeds(range(PACK * pack, PACK * (pack + 1))):
        case = drawn(replace(SHAPES[name], linear=False), seed)
        assert time_problems(case, (1, 1, 2, 5)[seed % 4], seed) == (), text(case)


def shifted(trace: ExactTrace, amounts: dict[str, Fraction]) -> ExactTrace:
    """Every column later by its amount; what comes before its first value is that value."""

    def value(name: str, instant: Fraction) -> Scalar:
        before = [row for row, time in enumerate(trace.times) if time <= instant - amounts[name]]
        return trace.columns[name][before[-1] if before else 0]

    moments = {Fraction(0)} | {time + amount for time in trace.times for amount in amounts.values()}
    times = tuple(sorted(moment for moment in moments if 0 <= moment <= trace.end))
    columns = {name: tuple(value(name, time) for time in times) for name in trace.columns}
    return ExactTrace(times, columns, trace.end)


@pytest.mark.parametrize("pack", range(10))
def test_signals_may_be_shifted_by_less_than_the_robustness_in_time(pack: int) -> None:
    """Each signal on its own, all earlier (ahead) or all later (behind), also where an atom compares two of them."""
    promised = 0
    for seed in seeds(range(30 * pack, 30 * (pack + 1))):
        random = Random(seed)
        case = random_monitoring_case(random, FormulaShape(depth=2, numeric=seed % 2 == 1))
        given = monitor_input(case)
        for measure, sign in ((Measure.AHEAD, -1), (Measure.BEHIND, 1)):
            found = robustness(given.program, given.trace, measure)
            room = min(max(found.low, -found.high), 8 * given.trace.ticks_per_unit)
            if room <= 0:
                continue
            promised += 1
            room = Fraction(room) / given.trace.ticks_per_unit
            shares = [Fraction(random.choice((99, random.randint(0, 99))), 100) for _ in case.trace.columns]
            amounts = {name: sign * room * share for name, share in zip(case.trace.columns, shares, strict=True)}
            truth = verdict(case.formula, shifted(case.trace, amounts)).truth
            assert truth is (found.low > 0), f"{text(case)}, shifted by {amounts}"
    assert enough(promised > 5)


def test_lines_of_an_absolute_value_end_without_a_trace_of_rounding() -> None:
    case = random_monitoring_case(Random(1070), SHAPES["thirds"])
    assert line_problems(case, 2, 1070) == (), text(case)
