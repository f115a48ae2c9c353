"""The canonical text of temporal formulas.

Operators are letters, connectives are ``!``, ``&&``, ``||`` and ``->``, and an interval is left out where it is all the
time. Reading the text again gives an equal tree, if in the tree no ``And`` is directly inside an ``And``, no ``Or``
inside an ``Or`` (the text is flat), no `Atom` has a connective outermost, and every bound is a finite decimal.
"""

from __future__ import annotations

import re
from fractions import Fraction
from functools import cache
from typing import Any

from tachk.base.operators import CONNECTIVES
from tachk.base.records import replace
from tachk.syntax import ast
from tachk.syntax.formula import (
    Always,
    And,
    Atom,
    Change,
    Duration,
    Eventually,
    Fall,
    Formula,
    Historically,
    Implies,
    Interval,
    Not,
    Once,
    Or,
    Rise,
    Since,
    TruthConstant,
    Until,
    WeakUntil,
)
from tachk.syntax.formulas.tokens import EDGES, INFINITE, INFIX, PREFIX
from tachk.syntax.parsing.tables import lexer
from tachk.syntax.parsing.tokens import LARGEST_LITERAL
from tachk.syntax.printing.expression_printer import print_expression
from tachk.syntax.rewrite import rewrite

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_$#]*")

_IMPLICATION, _DISJUNCTION, _CONJUNCTION, _UNTIL, _PREFIXED = range(5)
_LETTER = {Eventually: "F", Always: "G", Once: "O", Historically: "H", Until: "U", Since: "S"}
_SIMPLE = (
    *(ast.NameExpression, ast.MemberExpression, ast.IndexExpression, ast.CallExpression, ast.RateExpression),
    *(ast.BooleanLiteral, ast.IntegerLiteral, ast.FloatLiteral),
)


def print_formula(formula: Formula) -> str:
    """The text of a formula on one line."""
    return _print(formula, _IMPLICATION)


def print_interval(interval: Interval) -> str:
    """``[0, 5 s)``, or nothing for all the time."""
    if interval.upper is None and interval.lower_closed and interval.lower.value == 0 and not interval.lower.unit:
        return ""
    if interval.upper is None:
        upper = "inf)"
    else:
        upper = print_duration(interval.upper) + ("]" if interval.upper_closed else ")")
    opening = "[" if interval.lower_closed else "("
    return f"{opening}{print_duration(interval.lower)}, {upper}"


def print_duration(duration: Duration) -> str:
    """A bound with its unit; a fraction that is not a finite decimal as a quotient."""
    unit = f" {duration.unit}" if duration.unit else ""
    if isinstance(duration.value, Fraction):
        return print_number(duration.value) + unit
    return print_expression(quoted(duration.value)) + unit


def print_number(number: Fraction | int) -> str:
    """A number in decimal where it is a finite one; an integer beyond 32 bits with ``.0``, as the language wants it."""
    value = Fraction(number)
    if value.denominator == 1:
        return str(value.numerator) if abs(value.numerator) <= LARGEST_LITERAL else f"{value.numerator}.0"
    rest, digits = value.denominator, 0
    while rest % 10 == 0:
        rest, digits = rest // 10, digits + 1
    for factor in (2, 5):
        while rest % factor == 0:
            rest, digits = rest // factor, digits + 1
    if rest != 1:
        return f"{value.numerator}/{value.denominator}"
    shifted = abs(value.numerator) * 10**digits // value.denominator
    text = str(shifted).rjust(digits + 1, "0")
    whole, decimals = text[:-digits], text[-digits:].rstrip("0")
    return f"{'-' * (value < 0)}{whole}.{decimals}"


def print_atom(expression: ast.Expression) -> str:
    """An expression over one state; names that are words of formulas in backticks."""
    return print_expression(quoted(expression))


def quoted(expression: ast.Expression) -> ast.Expression:
    """The expression with names that formulas could not read otherwise in backticks."""
    return rewrite(expression, _quoted)


def _quoted(node: Any) -> Any:
    if isinstance(node, ast.NameExpression | ast.Identifier) and not _is_plain(node.name):
        return replace(node, name=f"`{node.name}`")
    return node


def _is_plain(name: str) -> bool:
    return name not in _reserved() and _NAME.fullmatch(name) is not None


@cache
def _reserved() -> frozenset[str]:
    """Words that a formula may not take for a name, wherever they stand."""
    return frozenset({*lexer().keywords, *PREFIX, *INFIX, *EDGES, *INFINITE, "deadlock", "sum"})


def _level(formula: Formula) -> int:
    match formula:
        case Implies():
            return _IMPLICATION
        case Or():
            return _DISJUNCTION
        case And():
            return _CONJUNCTION
        case Until() | Since() | WeakUntil():
            return _UNTIL
        case Atom(expression=ast.BinaryExpression(operator=operator)) if operator in CONNECTIVES:
            return _IMPLICATION
        case Atom(expression=expression):
            return _PREFIXED if isinstance(expression, _SIMPLE) else _UNTIL
        case _:
            return _PREFIXED


def _print(formula: Formula, least: int) -> str:
    text = _text(formula)
    return text if _level(formula) >= least else f"({text})"


def _text(formula: Formula) -> str:
    match formula:
        case TruthConstant(value=value):
            return "true" if value else "false"
        case Atom(expression=expression):
            return print_atom(expression)
        case Not(operand=operand):
            return f"!{_print(operand, _PREFIXED)}"
        case And(operands=operands):
            return " && ".join(_print(operand, _CONJUNCTION) for operand in operands)
        case Or(operands=operands):
            return " || ".join(_print(operand, _DISJUNCTION) for operand in operands)
        case Implies(left=left, right=right):
            return f"{_print(left, _DISJUNCTION)} -> {_print(right, _DISJUNCTION)}"
        case Rise(operand=operand):
            return f"rise({_print(operand, _IMPLICATION)})"
        case Fall(operand=operand):
            return f"fall({_print(operand, _IMPLICATION)})"
        case Change(expression=expression):
            return f"change({print_atom(expression)})"
        case WeakUntil(left=left, right=right):
            return f"{_print(left, _PREFIXED)} W {_print(right, _PREFIXED)}"
        case Until(interval=interval, left=left, right=right) | Since(interval=interval, left=left, right=right):
            infix = f" {_LETTER[type(formula)]}{print_interval(interval)} "
            return _print(left, _PREFIXED) + infix + _print(right, _PREFIXED)
        case _:
            return f"{_LETTER[type(formula)]}{print_interval(formula.interval)} {_print(formula.operand, _PREFIXED)}"
