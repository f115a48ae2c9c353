"""Parts of formulas without a meaning where numbers move in straight lines from one row of a trace to the next.

Sums, multiples, absolute values and extremes of lines consist of lines; products do not. A line has no instants at
which it changes. And where it crosses a constant, ``x > 5`` is false still at the crossing and true after it: there is
no first instant at which it is true, so `rise` would never see it happen, while it sees ``x >= 5``.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.operators import CONNECTIVES, BinaryOperator, PrefixOperator
from tachk.recordings.monitors.compiler import ARITHMETIC, COLUMN_NAMES, EXTREMES, RELATIONS, column_name, is_condition
from tachk.syntax import ast
from tachk.syntax import formula as syntax
from tachk.syntax.printing.expression_printer import print_expression, quoted
from tachk.syntax.walk import nodes_of_kind

_OTHER = {
    BinaryOperator.LESS: BinaryOperator.LESS_EQUAL,
    BinaryOperator.GREATER: BinaryOperator.GREATER_EQUAL,
    BinaryOperator.LESS_EQUAL: BinaryOperator.LESS,
    BinaryOperator.GREATER_EQUAL: BinaryOperator.GREATER,
}


def line_findings(formula: syntax.Formula, moving: Collection[str]) -> tuple[Diagnostic, ...]:
    """Everything that has no meaning, in the order of the text.

    Args:
        formula: one that can be compiled for the trace.
        moving: the columns whose values move between rows.
    """
    checker = _LineChecker(moving)
    found: list[Diagnostic] = []
    for node in nodes_of_kind(formula, syntax.Atom, syntax.Change, syntax.Rise, syntax.Fall):
        match node:
            case syntax.Atom(expression=expression):
                found += checker.not_linear(expression)
            case syntax.Change(expression=expression):
                found += checker.changing(expression)
            case syntax.Rise(operand=operand):
                found += checker.without_first_instant(operand, True, "becomes true")
            case syntax.Fall(operand=operand):
                found += checker.without_first_instant(operand, False, "becomes false")
            case _:
                pass
    return tuple(dict.fromkeys(found))


class _LineChecker:
    def __init__(self, moving: Collection[str]) -> None:
        self._moving = moving

    def moves(self, expression: ast.Expression) -> bool:
        """True if the value of an expression depends on a column that moves."""
        return any(column_name(name) in self._moving for name in nodes_of_kind(expression, *COLUMN_NAMES))

    def not_linear(self, expression: ast.Expression) -> Iterator[Diagnostic]:
        for node in nodes_of_kind(expression, ast.BinaryExpression):
            text = quoted(node)
            match node.operator:
                case BinaryOperator.MULTIPLY if _reads(node.left) and _reads(node.right):
                    yield _not_linear(node, f"{text}, a product of columns, is not linear between rows")
                case BinaryOperator.DIVIDE if _reads(node.right):
                    yield _not_linear(node, f"{text}, a quotient with a column below, is not linear between rows")
                case BinaryOperator.DIVIDE if _constant(node.right) == 0:
                    yield Diagnostic("E0905", f"{text} divides by zero", node.span)
                case BinaryOperator.MODULO:
                    yield _not_linear(node, f"{text}, a remainder, is not linear between rows")
                case _:
                    pass

    def changing(self, expression: ast.Expression) -> Iterator[Diagnostic]:
        if self.moves(expression):
            message = f"{quoted(expression)} moves between rows, so `change` names no instants"
            help = "rise(x >= 5) and fall(x > 5) detect when a line crosses a value; change() is for truth values"
            yield Diagnostic("E0906", message, expression.span, help)
        else:
            yield from self.not_linear(expression)

    def without_first_instant(self, formula: syntax.Formula, wanted: bool, becomes: str) -> Iterator[Diagnostic]:
        """Comparisons that become true (or not true, if not wanted) without a first instant at which they are."""
        match formula:
            case syntax.Atom(expression=expression):
                yield from self._open(expression, wanted, becomes)
            case syntax.Not(operand=operand):
                yield from self.without_first_instant(operand, not wanted, becomes)
            case syntax.Implies(left=left, right=right):
                yield from self.without_first_instant(left, not wanted, becomes)
                yield from self.without_first_instant(right, wanted, becomes)
            case syntax.Rise() | syntax.Fall() | syntax.Change():
                pass  # true at instants only
            case _:
                for operand in syntax.operands(formula):
                    yield from self.without_first_instant(operand, wanted, becomes)

    def _open(self, expression: ast.Expression, wanted: bool, becomes: str) -> Iterator[Diagnostic]:
        if not self.moves(expression):
            return
        match expression:
            case ast.UnaryExpression(operator=PrefixOperator.NOT, operand=operand):
                yield from self._open(operand, not wanted, becomes)
            case ast.BinaryExpression(operator=operator, left=left, right=right) if operator in CONNECTIVES:
                both = operator == BinaryOperator.XOR
                for side, sign in ((left, not wanted if operator == BinaryOperator.IMPLY else wanted), (right, wanted)):
                    yield from self._open(side, sign, becomes)
                    if both:
                        yield from self._open(side, not sign, becomes)
            case ast.BinaryExpression(operator=operator, left=left, right=right) if operator in RELATIONS:
                inner = [side for side in (left, right) if is_condition(side)]
                for side in inner:
                    yield from self._open(side, True, becomes)
                    yield from self._open(side, False, becomes)
                if (
                    not inner
                    and (operator in {BinaryOperator.LESS, BinaryOperator.GREATER, BinaryOperator.NOT_EQUAL}) == wanted
                ):
                    yield _no_first_instant(expression, becomes, _OTHER.get(operator))
            case _:
                if wanted:
                    yield _no_first_instant(expression, becomes, None)


def _not_linear(node: ast.Expression, message: str) -> Diagnostic:
    return Diagnostic("E0905", message, node.span, "with --interpolation constant values are held, and this is allowed")


def _no_first_instant(expression: ast.Expression, becomes: str, other: str | None) -> Diagnostic:
    message = f"where a line crosses, there is no first instant at which {quoted(expression)} {becomes}"
    if other is None or not isinstance(expression, ast.BinaryExpression):
        return Diagnostic("E0907", message, expression.span, "compare with <= or >=")
    better = f"{print_expression(expression.left)} {other} {print_expression(expression.right)}"
    return Diagnostic("E0907", message, expression.span, f"write `{better}`, which does so at the crossing")


def _reads(expression: ast.Expression) -> bool:
    """True if an expression reads a column: any name but those of functions."""
    functions = {id(call.function) for call in nodes_of_kind(expression, ast.CallExpression)}
    return any(id(name) not in functions for name in nodes_of_kind(expression, *COLUMN_NAMES))


def _constant(expression: ast.Expression) -> Fraction | None:
    """The value of an expression without columns; None where it has none."""
    match expression:
        case ast.IntegerLiteral(value=value):
            return Fraction(value)
        case ast.FloatLiteral(text=text):
            return Fraction(text)
        case ast.UnaryExpression(operator=PrefixOperator.MINUS | PrefixOperator.PLUS as sign, operand=operand):
            inner = _constant(operand)
            return inner if inner is None or sign is PrefixOperator.PLUS else -inner
        case ast.BinaryExpression(operator=operator) if operator in ARITHMETIC:
            left, right = _constant(expression.left), _constant(expression.right)
            return None if left is None or right is None else _computed(operator, left, right)
        case ast.CallExpression(function=ast.NameExpression(name=name), arguments=arguments):
            values = [value for value in map(_constant, arguments) if value is not None]
            if len(values) < len(arguments):
                return None
            return (min(values) if name == "min" else max(values)) if name in EXTREMES else abs(values[0])
        case _:
            return None


def _computed(operator: BinaryOperator, left: Fraction, right: Fraction) -> Fraction | None:
    match operator:
        case BinaryOperator.ADD:
            return left + right
        case BinaryOperator.SUBTRACT:
            return left - right
        case BinaryOperator.MULTIPLY:
            return left * right
        case BinaryOperator.DIVIDE:
            return left / right if right != 0 else None
        case BinaryOperator.MINIMUM:
            return min(left, right)
        case BinaryOperator.MAXIMUM:
            return max(left, right)
        case _:
            return None
