"""Cases become as small as what makes them fail."""

from __future__ import annotations

from fractions import Fraction
from random import Random

from tachk.syntax.formula import Until
from tachk.syntax.formulas.printer import print_formula
from tachk.syntax.walk import nodes_of_kind
from tests.support.exact_trace import ExactTrace
from tests.support.formulas import MonitoringCase, random_monitoring_case
from tests.support.seeds import seeds
from tests.support.smaller_cases import describe, reduced


def has_until_and_two_rows(case: MonitoringCase) -> bool:
    return any(True for _ in nodes_of_kind(case.formula, Until)) and len(case.trace.times) >= 2


def test_nothing_superfluous_is_left() -> None:
    seed = next(seed for seed in seeds(range(100)) if has_until_and_two_rows(random_monitoring_case(Random(seed))))
    case = reduced(random_monitoring_case(Random(seed)), has_until_and_two_rows)
    assert has_until_and_two_rows(case)
    assert len(case.trace.times) == 2
    assert case.trace.end == case.trace.times[-1]
    assert len(print_formula(case.formula)) < len("false U[0.5, 0.5] false ")


def test_a_trace_on_one_line() -> None:
    trace = ExactTrace(
        (Fraction(0), Fraction(1, 2)), {"p": (True, False), "x": (Fraction(1, 4), Fraction(2))}, Fraction(3)
    )
    assert describe(trace) == "0: p=1, x=0.25; 1/2: p=0, x=2; end 3"
