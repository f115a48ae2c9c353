"""Simplification and negation normal form keep the meaning: truth, robustness and what is undetermined, everywhere.

The judge is the exact evaluator, on finished traces and on traces that go on, also after their end.
"""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest

from tachk.diagnostics.span import NOWHERE, Source
from tachk.logic.negation import negate, negation_normal_form
from tachk.logic.simplify import simplify
from tachk.syntax import formula as f
from tachk.syntax.formula_parser import parse_formula
from tachk.syntax.formula_printer import print_formula
from tachk.testing.exact_monitor import satisfaction
from tachk.testing.exact_trace import Ending, ExactTrace
from tachk.testing.formulas import FormulaShape, random_formula, random_trace

LEAVES = ("p", "p", "q", "x < 1", "x == 1", "true", "false", "rise(p)", "fall(q)", "change(x)", "change(2)", "1 < 3")
BOUNDS = (
    "",
    "[0, 0]",
    "[0, 1]",
    "[0, 1)",
    "(0, 1]",
    "[1, 2]",
    "(1, 2)",
    "[1, 1]",
    "[1, 1)",
    "(0, 0]",
    "[2, inf)",
    "(0, inf)",
)


def parsed(text: str) -> f.Formula:
    formula, diagnostics = parse_formula(Source("f", text))
    assert formula is not None, diagnostics
    return formula


def random_text(random: Random, depth: int) -> str:
    """A formula with many constants, empty windows and repeated parts."""
    if depth == 0 or random.random() < 0.1:
        return random.choice(LEAVES)
    inner = [random_text(random, depth - 1) for _ in range(2)]
    if random.random() < 0.2:
        inner[1] = inner[0]
    kind = random.choice("FGOHFGOH!&|>USWr")
    match kind:
        case "!":
            return f"!({inner[0]})"
        case "r":
            return f"{random.choice(['rise', 'fall'])}({inner[0]})"
        case "&" | "|":
            return f"({inner[0]}) {kind * 2} ({inner[1]})"
        case ">":
            return f"({inner[0]}) -> ({inner[1]})"
        case "W":
            return f"({inner[0]}) W ({inner[1]})"
        case "U" | "S":
            return f"({inner[0]}) {kind}{random.choice(BOUNDS)} ({inner[1]})"
        case _:
            return f"{kind}{random.choice(BOUNDS)} ({inner[0]})"


def same_meaning(one: f.Formula, other: f.Formula, trace: ExactTrace) -> None:
    for ending in Ending:
        seen = ExactTrace(trace.times, trace.columns, trace.end, ending)
        first, second = satisfaction(one, seen), satisfaction(other, seen)
        points = {*first.points, *second.points}
        for instant in {*points, *(point + Fraction(1, 7) for point in points)}:
            assert first.value(instant) == second.value(instant), (
                f"{print_formula(one)} and {print_formula(other)} at {instant} of {seen}"
            )


@pytest.mark.parametrize("seed", range(5))
def test_constants_and_odd_windows(seed: int) -> None:
    random = Random(seed)
    shape = FormulaShape(rows=3)
    for _ in range(20):
        formula = parsed(random_text(random, 3))
        simpler = simplify(formula)
        assert simplify(simpler) == simpler
        trace = random_trace(random, shape)
        same_meaning(formula, simpler, trace)
        same_meaning(formula, negation_normal_form(formula), trace)
        same_meaning(f.Not(NOWHERE, formula), negate(formula), trace)


@pytest.mark.parametrize("seed", range(2))
def test_formulas_as_they_occur(seed: int) -> None:
    random = Random(seed)
    shape = FormulaShape(rows=5)
    for _ in range(15):
        formula, trace = random_formula(random, shape, 3), random_trace(random, shape)
        same_meaning(formula, simplify(formula), trace)
        same_meaning(f.Not(NOWHERE, formula), negate(formula), trace)
