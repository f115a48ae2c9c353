"""Simplified formulas have the same values as before: truth, robustness and what is undetermined, at every instant,
also after the end of a trace."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest

from tachk.logic.simplify import simplify
from tachk.syntax.formula import Formula
from tachk.syntax.formulas.printer import print_formula
from tests.support.exact_monitor import satisfaction
from tests.support.exact_trace import Ending, ExactTrace
from tests.support.formulas import FormulaShape, random_monitoring_case, random_trace
from tests.support.seeds import seeds
from tests.support.tricky import read_formula

pytestmark = pytest.mark.drawn

SHAPES = (FormulaShape(), FormulaShape(depth=2, constants=0.4), FormulaShape(depth=3, constants=0.3, bound=1))
LEAVES = ("p", "p", "q", "x < 1", "x == 1", "true", "false", "rise(p)", "fall(q)", "change(x)", "change(2)", "1 < 3")
INTERVALS = (
    *("", "[0, 0]", "[0, 1]", "[0, 1)", "(0, 1]", "[1, 2]", "(1, 2)"),
    *("[1, 1]", "[1, 1)", "(0, 0]", "[2, inf)", "(0, inf)"),
)


def odd_formula(random: Random, depth: int) -> str:
    """A formula with many constants, empty windows and repeated parts."""
    if depth == 0 or random.random() < 0.1:
        return random.choice(LEAVES)
    inner = [odd_formula(random, depth - 1) for _ in range(2)]
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
            return f"({inner[0]}) {kind}{random.choice(INTERVALS)} ({inner[1]})"
        case _:
            return f"{kind}{random.choice(INTERVALS)} ({inner[0]})"


def check(formula: Formula, other: Formula, trace: ExactTrace) -> None:
    for ending in Ending:
        seen = replace(trace, ending=ending)
        text = f"{print_formula(formula)} becomes {print_formula(other)} on {seen}"
        assert satisfaction(formula, seen) == satisfaction(other, seen), text


@pytest.mark.parametrize("seed", seeds(range(60)))
def test_values_are_kept(seed: int) -> None:
    case = random_monitoring_case(Random(seed), SHAPES[seed % len(SHAPES)])
    check(case.formula, simplify(case.formula), case.trace)


@pytest.mark.parametrize("seed", seeds(range(5)))
def test_values_are_kept_with_constants_and_odd_windows(seed: int) -> None:
    random = Random(seed)
    changed = 0
    for _ in range(20):
        formula, trace = read_formula(odd_formula(random, 3)), random_trace(random, FormulaShape(rows=3))
        other = simplify(formula)
        changed += other != formula
        check(formula, other, trace)
        assert simplify(other) == other
    assert changed > 2
