"""Simplified formulas, and those in negation normal form, have the same values as before, at every instant."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from random import Random

import pytest

from tachk.logic.negation import negate, negation_normal_form
from tachk.logic.simplify import simplify
from tachk.syntax.formula import Formula, Not
from tachk.syntax.formula_printer import print_formula
from tachk.testing.exact_monitor import satisfaction
from tachk.testing.exact_trace import Ending
from tachk.testing.formulas import FormulaShape, random_monitoring_case

SHAPES = (FormulaShape(), FormulaShape(depth=2, constants=0.4), FormulaShape(depth=3, constants=0.3, bound=1))


@pytest.mark.parametrize(
    ("rewrite", "same_as"),
    [
        (simplify, lambda formula: formula),
        (negation_normal_form, lambda formula: formula),
        (negate, lambda formula: Not(formula.span, formula)),
    ],
    ids=["simplify", "negation normal form", "negation"],
)
@pytest.mark.parametrize("seed", range(60))
def test_values_are_kept(
    seed: int, rewrite: Callable[[Formula], Formula], same_as: Callable[[Formula], Formula]
) -> None:
    case = random_monitoring_case(Random(seed), SHAPES[seed % len(SHAPES)])
    other = rewrite(case.formula)
    for ending in Ending:
        trace = replace(case.trace, ending=ending)
        before, after = satisfaction(same_as(case.formula), trace), satisfaction(other, trace)
        text = f"{print_formula(case.formula)} becomes {print_formula(other)} on {trace}"
        assert before == after, text
