"""Conditions and durations inside sentences: parts of the text that are expressions."""

from __future__ import annotations

from fractions import Fraction

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.exact_numbers import is_huge
from tachk.base.operators import OperandGroup
from tachk.base.span import Span
from tachk.base.time_units import SPELLINGS
from tachk.syntax import ast
from tachk.syntax.formula import (
    And,
    Atom,
    Change,
    Duration,
    Fall,
    Formula,
    Implies,
    Not,
    Or,
    Rise,
    TruthConstant,
    operands,
)
from tachk.syntax.formulas.parser import parse_formula
from tachk.syntax.sentences.text import Piece, cut

_TEMPORAL_HELP = "a condition is about one instant; a property with operators like F and G is written as a formula"


class Unreadable(Exception):
    """A part of a sentence cannot be read."""

    def __init__(self, *diagnostics: Diagnostic) -> None:
        self.diagnostics = diagnostics
        super().__init__("; ".join(found.message for found in diagnostics))


def read_condition(span: Span) -> Formula:
    """The condition in a part of a sentence, with or without quotes around it.

    Raises:
        Refused: it is none.
    """
    pieces, _ = cut(span)
    if len(pieces) == 1 and pieces[0].kind == "quote" and not span.text.startswith("`"):
        span = Span(span.source, pieces[0].span.start + 1, pieces[0].span.end - 1)
    formula, found = parse_formula(span)
    if formula is None or found:
        raise Unreadable(*found)
    temporal = _temporal(formula)
    if temporal is not None:
        raise Unreadable(Diagnostic("E0146", "a temporal operator inside a condition", temporal.span, _TEMPORAL_HELP))
    return formula


def read_value(span: Span) -> ast.Expression:
    """The expression whose changes trigger a sentence.

    Raises:
        Refused: it is none, or a condition.
    """
    formula = read_condition(span)
    if isinstance(formula, Atom):
        return formula.expression
    raise Unreadable(
        Diagnostic(
            "E0144",
            "a condition changes both when it becomes true and when it becomes false",
            span,
            "write 'becomes true' or 'becomes false', or name a variable",
        )
    )


def read_number(span: Span) -> ast.Expression:
    """The expression that a sentence compares with another.

    Raises:
        Refused: it is none, or a condition.
    """
    formula = read_condition(span)
    if isinstance(formula, Atom):
        expression = formula.expression
        if not (
            isinstance(expression, ast.BinaryExpression) and expression.operator.group is not OperandGroup.ARITHMETIC
        ):
            return expression
    raise Unreadable(
        Diagnostic("E0144", "this is a condition, not a number", span, "write 'must be true', or name what is compared")
    )


def read_duration(span: Span) -> Duration:
    """A number, constant or expression in parentheses, and its unit.

    Raises:
        Refused: it is none.
    """
    (amount, *unit), _ = cut(span)
    return Duration(span, _amount(amount), SPELLINGS[unit[0].text.lower()] if len(unit) == 1 else "")


def _amount(piece: Piece) -> Fraction | ast.Expression:
    if piece.kind == "number":
        if is_huge(piece.text):
            raise Unreadable(Diagnostic("E0005", "this number has too many digits", piece.span))
        return Fraction(piece.text)
    formula, found = parse_formula(piece.span)
    if found:
        raise Unreadable(*found)
    if not isinstance(formula, Atom):
        raise Unreadable(Diagnostic("E0144", "this is not a duration", piece.span, "write a number or a constant"))
    match formula.expression:
        case ast.IntegerLiteral(value=value):
            return Fraction(value)
        case ast.FloatLiteral(text=text):
            return Fraction(text)
        case expression:
            return expression


def _temporal(formula: Formula) -> Formula | None:
    """The first part of a formula that is not part of a condition."""
    if not isinstance(formula, TruthConstant | Atom | Change | Not | And | Or | Implies | Rise | Fall):
        return formula
    return next((found for part in operands(formula) if (found := _temporal(part)) is not None), None)
