"""Random formulas and random traces, for tests of monitors against each other and against the oracle.

`random_monitoring_case` draws from a `random.Random`, so a seed names a case; `monitoring_cases` is the same generator
as a hypothesis strategy. Values are dyadic, so that doubles compute with them exactly.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from random import Random
from typing import TYPE_CHECKING

from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.base.span import NOWHERE
from tachk.syntax import ast
from tachk.syntax import formula as syntax
from tests.support.exact_trace import ExactTrace, Scalar

if TYPE_CHECKING:
    from hypothesis.strategies import SearchStrategy

FLAGS, NUMBERS = ("p", "q", "r"), ("x", "y")
"""The columns of random traces: truth values and numbers."""


@dataclass(frozen=True, slots=True)
class FormulaShape:
    """What random formulas and traces look like.

    Attributes:
        depth: the largest number of operators inside each other.
        bound: the largest bound of an interval.
        grid: bounds and times are multiples of its reciprocal.
        open_bounds, unbounded, until, past, edges, numeric, arithmetic: what occurs.
        rows: the largest number.
        gap: the largest time from one row to the next.
        equal_times: whether several rows may be for one instant.
    linear: only what has a meaning where numbers move in straight lines between rows.
        constants: the share of true and false among the innermost operands.
    """

    depth: int = 3
    bound: int = 4
    grid: int = 2
    open_bounds: bool = True
    unbounded: bool = True
    until: bool = True
    past: bool = True
    edges: bool = True
    numeric: bool = True
    arithmetic: bool = True
    rows: int = 8
    gap: int = 3
    equal_times: bool = True
    constants: float = 0.04
    linear: bool = False


@dataclass(frozen=True, slots=True)
class MonitoringCase:
    formula: syntax.Formula
    trace: ExactTrace


def random_monitoring_case(random: Random, shape: FormulaShape = FormulaShape()) -> MonitoringCase:
    """A formula over the columns of a finished trace, whose length is of the order of the formula's windows."""
    return MonitoringCase(random_formula(random, shape, shape.depth), random_trace(random, shape))


def monitoring_cases(shape: FormulaShape = FormulaShape()) -> SearchStrategy[MonitoringCase]:
    """`random_monitoring_case` as a hypothesis strategy."""
    from hypothesis import strategies

    return strategies.randoms(use_true_random=False).map(lambda random: random_monitoring_case(random, shape))


def random_formula(random: Random, shape: FormulaShape, depth: int) -> syntax.Formula:
    if depth == 0 or random.random() < 0.08:
        return _leaf(random, shape)
    kinds: list[tuple[int, Callable[[], syntax.Formula]]] = [
        (2, lambda: syntax.Not(NOWHERE, inner())),
        (2, lambda: syntax.And(NOWHERE, tuple(inner() for _ in range(random.choice((2, 2, 3)))))),
        (2, lambda: syntax.Or(NOWHERE, tuple(inner() for _ in range(random.choice((2, 2, 3)))))),
        (2, lambda: syntax.Implies(NOWHERE, inner(), inner())),
        (5, lambda: syntax.Eventually(NOWHERE, random_interval(random, shape), inner())),
        (5, lambda: syntax.Always(NOWHERE, random_interval(random, shape), inner())),
    ]
    if shape.edges:
        kinds += [(1, lambda: syntax.Rise(NOWHERE, inner())), (1, lambda: syntax.Fall(NOWHERE, inner()))]
    if shape.until:
        kinds += [(4, lambda: syntax.Until(NOWHERE, random_interval(random, shape), inner(), inner()))]
        if shape.unbounded:
            kinds += [(1, lambda: syntax.WeakUntil(NOWHERE, inner(), inner()))]
    if shape.past:
        kinds += [
            (2, lambda: syntax.Once(NOWHERE, random_interval(random, shape), inner())),
            (2, lambda: syntax.Historically(NOWHERE, random_interval(random, shape), inner())),
        ]
        if shape.until:
            kinds += [(2, lambda: syntax.Since(NOWHERE, random_interval(random, shape), inner(), inner()))]

    def inner() -> syntax.Formula:
        return random_formula(random, shape, depth - 1)

    weights = [weight for weight, _ in kinds]
    return random.choices([make for _, make in kinds], weights)[0]()


def random_interval(random: Random, shape: FormulaShape) -> syntax.Interval:
    """Lower bounds of 0 and bounds that coincide are frequent, empty intervals rare."""
    lower = Fraction(0) if random.random() < 0.5 else Fraction(random.randint(0, shape.bound * shape.grid), shape.grid)
    lower_closed = not shape.open_bounds or random.random() < 0.7
    begin = syntax.Duration(NOWHERE, lower)
    if shape.unbounded and random.random() < 0.2:
        return syntax.Interval(NOWHERE, begin, None, lower_closed)
    length = Fraction(random.randint(0, shape.bound * shape.grid), shape.grid)
    upper_closed = not shape.open_bounds or random.random() < 0.7
    return syntax.Interval(NOWHERE, begin, syntax.Duration(NOWHERE, lower + length), lower_closed, upper_closed)


def random_trace(random: Random, shape: FormulaShape) -> ExactTrace:
    """Irregular rows; about half of the traces end with their last row."""
    times = [Fraction(0)]
    for _ in range(random.randint(0, shape.rows - 1)):
        shortest = 0 if shape.equal_times and random.random() < 0.4 else 1
        times.append(times[-1] + Fraction(random.randint(shortest, shape.gap * shape.grid), shape.grid))
    columns: dict[str, tuple[Scalar, ...]] = {}
    for name in FLAGS:
        share = random.choice((0.2, 0.5, 0.8))
        columns[name] = tuple(random.random() < share for _ in times)
    if shape.numeric:
        for name in NUMBERS:
            columns[name] = tuple(Fraction(random.randint(-8, 8), 4) for _ in times)
    rest = Fraction(random.choice((0, random.randint(0, shape.gap * shape.grid))), shape.grid)
    return ExactTrace(tuple(times), columns, times[-1] + rest)


def _leaf(random: Random, shape: FormulaShape) -> syntax.Formula:
    if random.random() < shape.constants:
        return syntax.TruthConstant(NOWHERE, random.random() < 0.5)
    kind = random.random()
    if shape.edges and kind < 0.08:
        return syntax.Change(NOWHERE, _changing(random, shape))
    if not shape.numeric or kind < 0.44:
        return syntax.Atom(NOWHERE, _name(random.choice(FLAGS)))
    if kind < 0.48:
        operator, second = random.choice((BinaryOperator.EQUAL, BinaryOperator.NOT_EQUAL)), _name(random.choice(FLAGS))
        return syntax.Atom(NOWHERE, ast.BinaryExpression(NOWHERE, operator, _name(random.choice(FLAGS)), second))
    return syntax.Atom(NOWHERE, _comparison(random, shape))


def _changing(random: Random, shape: FormulaShape) -> ast.Expression:
    if not shape.numeric or shape.linear or random.random() < 0.4:
        return _name(random.choice(FLAGS))
    return _comparison(random, shape) if random.random() < 0.3 else _term(random, shape)


def _comparison(random: Random, shape: FormulaShape) -> ast.Expression:
    operator = random.choice(
        (
            BinaryOperator.LESS,
            BinaryOperator.LESS_EQUAL,
            BinaryOperator.GREATER,
            BinaryOperator.GREATER_EQUAL,
            BinaryOperator.LESS,
            BinaryOperator.LESS_EQUAL,
            BinaryOperator.GREATER,
            BinaryOperator.GREATER_EQUAL,
            BinaryOperator.EQUAL,
            BinaryOperator.NOT_EQUAL,
        )
    )
    return ast.BinaryExpression(NOWHERE, operator, _name(random.choice(NUMBERS)), _term(random, shape))


def _term(random: Random, shape: FormulaShape) -> ast.Expression:
    """Divisors and moduli are powers of two, so that the result is dyadic."""
    literal = ast.FloatLiteral(NOWHERE, str(random.randint(0, 4) / 2))
    number: ast.Expression = (
        ast.UnaryExpression(NOWHERE, PrefixOperator.MINUS, literal) if random.random() < 0.4 else literal
    )
    column = _name(random.choice(NUMBERS))
    kind = random.random()
    if kind < 0.6:
        return number
    if kind < 0.8 or not shape.arithmetic:
        return ast.BinaryExpression(
            NOWHERE,
            random.choice((BinaryOperator.ADD, BinaryOperator.SUBTRACT, BinaryOperator.MULTIPLY)),
            column,
            number,
        )
    if kind < 0.87:
        power = ast.IntegerLiteral(NOWHERE, random.choice((1, 2, 4)))
        return ast.BinaryExpression(
            NOWHERE,
            BinaryOperator.DIVIDE if shape.linear else random.choice((BinaryOperator.DIVIDE, BinaryOperator.MODULO)),
            column,
            power,
        )
    if kind < 0.93:
        return ast.CallExpression(NOWHERE, _name("abs"), (column,))
    return ast.CallExpression(NOWHERE, _name(random.choice(("min", "max"))), (column, number))


def _name(name: str) -> ast.Expression:
    return ast.NameExpression(NOWHERE, name)
