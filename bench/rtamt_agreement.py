"""Random formulas through the oracle and RTAMT: `python -m bench.rtamt_agreement COUNT SEED [half-open]`.

Needs `pip install rtamt` beside tachk. RTAMT's offline dense-time monitor is asked where its semantics is the same:
closed bounded windows, the until whose left operand holds at the witness too (written ``f U (f && g)`` here), and only
where the trace decides the value, because RTAMT cuts windows at the end of the trace. With ``half-open`` the until of
both is taken as it is. Prints every difference with the seed that reproduces it. Exit status 1 after one.
"""

from __future__ import annotations

import math
import sys
import time
from fractions import Fraction
from random import Random

import rtamt

from tachk.base.span import NOWHERE
from tachk.syntax import ast
from tachk.syntax import formula as syntax
from tachk.syntax.printing.expression_printer import print_expression
from tests.support.exact_monitor import satisfaction
from tests.support.exact_trace import ExactTrace
from tests.support.formulas import FLAGS, NUMBERS, FormulaShape, random_formula, random_trace

SHAPE = FormulaShape(
    open_bounds=False, unbounded=False, edges=False, arithmetic=False, equal_times=False, gap=4, rows=10
)
COLUMNS = (*FLAGS, *NUMBERS, "one")
SAMPLES = tuple(Fraction(n, 8) for n in range(8 * 12))
"""Instants at which values are compared, on the grid of bounds and rows and between them."""


def main(arguments: list[str]) -> int:
    count, seed, half_open = int(arguments[0]), int(arguments[1]), "half-open" in arguments[2:]
    compared, silent, wrong, refused, started = 0, 0, 0, 0, time.monotonic()
    for number in range(seed, seed + count):
        random = Random(number)
        formula = random_formula(random, SHAPE, random.choice((1, 2, 3)))
        trace = _with_numbers(random_trace(random, SHAPE))
        exact = satisfaction(_ours(formula, half_open), trace)
        text = _text(formula)
        try:
            answer = _rtamt(text, trace)
        except Exception as problem:  # RTAMT raises many kinds
            refused += 1
            print(f"seed {number}: {text}: {type(problem).__name__}: {problem}")
            continue
        for instant in SAMPLES:
            value = exact.value(instant)
            if instant > trace.end or value.truth is None or value.low != value.high:
                continue
            theirs = _held(answer, instant)
            if theirs is None:
                silent += 1
                continue
            compared += 1
            if not math.isclose(theirs, float(value.low), abs_tol=1e-9):
                wrong += 1
                print(f"seed {number} at {instant}: {text}: exact {float(value.low)}, RTAMT {theirs}")
                break
    print(
        f"{count} formulas, {compared} values compared, {silent} without an answer of RTAMT, "
        f"{wrong} formulas differ, {refused} refused, {time.monotonic() - started:.0f} s"
    )
    return 1 if wrong else 0


def _with_numbers(trace: ExactTrace) -> ExactTrace:
    """Truth values as 1 and -1."""
    columns = {
        name: tuple(Fraction(1 if value else -1) if isinstance(value, bool) else value for value in values)
        for name, values in trace.columns.items()
    }
    columns["one"] = tuple(Fraction(1) for _ in trace.times)
    return ExactTrace(trace.times, columns, trace.end)


def _ours(formula: syntax.Formula, half_open: bool) -> syntax.Formula:
    """The formula with ``p > 0`` for ``p`` and the closed until and since for RTAMT's."""
    match formula:
        case syntax.TruthConstant(value=value):
            return _compared_with_zero("one", ">" if value else "<")
        case syntax.Atom(expression=ast.NameExpression(name=name)):
            return _compared_with_zero(name, ">")
        case syntax.Not(operand=operand):
            return syntax.Not(NOWHERE, _ours(operand, half_open))
        case syntax.And(operands=operands):
            return syntax.And(NOWHERE, tuple(_ours(operand, half_open) for operand in operands))
        case syntax.Or(operands=operands):
            return syntax.Or(NOWHERE, tuple(_ours(operand, half_open) for operand in operands))
        case syntax.Implies(left=left, right=right):
            return syntax.Implies(NOWHERE, _ours(left, half_open), _ours(right, half_open))
        case syntax.Eventually() | syntax.Always() | syntax.Once() | syntax.Historically():
            return type(formula)(NOWHERE, formula.interval, _ours(formula.operand, half_open))
        case syntax.Until() | syntax.Since():
            left, right = _ours(formula.left, half_open), _ours(formula.right, half_open)
            witness = right if half_open else syntax.And(NOWHERE, (left, right))
            return type(formula)(NOWHERE, formula.interval, left, witness)
        case _:
            return formula


def _compared_with_zero(name: str, operator: str) -> syntax.Formula:
    left, right = ast.NameExpression(NOWHERE, name), ast.IntegerLiteral(NOWHERE, 0)
    return syntax.Atom(NOWHERE, ast.BinaryExpression(NOWHERE, operator, left, right))


def _text(formula: syntax.Formula) -> str:
    """The formula as RTAMT reads it."""
    match formula:
        case syntax.TruthConstant(value=value):
            return "(one > 0)" if value else "(one < 0)"
        case syntax.Atom(expression=ast.NameExpression(name=name)):
            return f"({name} > 0)"
        case syntax.Atom(expression=expression):
            return f"({print_expression(expression).replace('!=', '!==')})"
        case syntax.Not(operand=operand):
            return f"(not {_text(operand)})"
        case syntax.And(operands=operands):
            return f"({' and '.join(_text(operand) for operand in operands)})"
        case syntax.Or(operands=operands):
            return f"({' or '.join(_text(operand) for operand in operands)})"
        case syntax.Implies(left=left, right=right):
            return f"({_text(left)} implies {_text(right)})"
        case syntax.Until(interval=interval, left=left, right=right):
            return f"({_text(left)} until{_window(interval)} {_text(right)})"
        case syntax.Since(interval=interval, left=left, right=right):
            return f"({_text(left)} since{_window(interval)} {_text(right)})"
        case syntax.Eventually(interval=interval, operand=operand):
            return f"(eventually{_window(interval)} {_text(operand)})"
        case syntax.Always(interval=interval, operand=operand):
            return f"(always{_window(interval)} {_text(operand)})"
        case syntax.Once(interval=interval, operand=operand):
            return f"(once{_window(interval)} {_text(operand)})"
        case syntax.Historically(interval=interval, operand=operand):
            return f"(historically{_window(interval)} {_text(operand)})"
        case _:
            raise ValueError(f"not compared with RTAMT: {formula}")


def _window(interval: syntax.Interval) -> str:
    bounds = (interval.lower, interval.upper)
    return "[" + ":".join(str(float(b.value)) for b in bounds if b is not None and isinstance(b.value, Fraction)) + "]"


def _rtamt(text: str, trace: ExactTrace) -> list[tuple[float, float]]:
    """What RTAMT answers: from each instant on the robustness."""
    specification = rtamt.StlDenseTimeSpecification()
    for name in COLUMNS:
        specification.declare_var(name, "float")
    specification.spec = text
    specification.parse()
    signals = []
    for name in COLUMNS:
        samples = [[float(time), float(value)] for time, value in zip(trace.times, trace.columns[name], strict=True)]
        if trace.end > trace.times[-1]:
            samples.append([float(trace.end), samples[-1][1]])
        signals.append([name, samples])
    return [(float(instant), float(value)) for instant, value in specification.evaluate(*signals)]


def _held(answer: list[tuple[float, float]], instant: Fraction) -> float | None:
    earlier = [value for start, value in answer if start <= instant]
    return earlier[-1] if earlier else None


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
