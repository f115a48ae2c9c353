"""Names in formulas that mean values in columns: locations of processes, constants of messages, enumerations."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from tachk.base.operators import BinaryOperator
from tachk.recordings.monitors.compiler import columns_read
from tachk.recordings.monitors.formulas import NamedFormula, literal
from tachk.recordings.traces.trace import TraceSource
from tachk.syntax import ast
from tachk.syntax.formula import Formula
from tachk.syntax.printing.expression_printer import print_expression
from tachk.syntax.rewrite import rewrite


def located(named: NamedFormula, columns: Collection[str]) -> NamedFormula:
    """The formula, and those that it may name, with `P == "loc"` in place of `P.loc` where the trace has no column
    `P.loc`, but one `P`."""
    formula = _located(named.formula, columns)
    siblings = {name: _located(each, columns) for name, each in (named.siblings or {}).items()}
    if formula is named.formula and siblings == (named.siblings or {}):
        return named
    return replace(named, formula=formula, siblings=siblings or None, written=named.text)


def with_named_values(formulas: Sequence[NamedFormula], recording: TraceSource) -> list[NamedFormula]:
    """Formulas with values in place of the names that the recording has for them; columns and constants come first."""
    names = {name for named in formulas for name in named.columns - named.constant_names}.difference(recording.columns)
    if not names:
        return list(formulas)
    from tachk.recordings.traces.logs.named_values import named_values

    values = {name: value for name, value in named_values(recording).items() if name in names}
    if not values:
        return list(formulas)

    def change(node: Any) -> Any:
        if isinstance(node, (ast.NameExpression, ast.MemberExpression)):
            value = values.get(node.name if isinstance(node, ast.NameExpression) else print_expression(node))
            if isinstance(value, str):
                return ast.StringLiteral(node.span, value)
            if value is not None:
                return literal(node.span, Fraction(value))
        return node

    return [replace(named, formula=rewrite(named.formula, change), written=named.text) for named in formulas]


def _located(formula: Formula, columns: Collection[str]) -> Formula:
    places = {name for name in columns_read(formula) if name not in columns and name.rpartition(".")[0] in columns}
    if not places:
        return formula

    def change(node: Any) -> Any:
        match node:
            case ast.MemberExpression(base=base, name=location, span=span) if print_expression(node) in places:
                column = ast.NameExpression(base.span, print_expression(base))
                text = ast.StringLiteral(location.span, location.name)
                return ast.BinaryExpression(span, BinaryOperator.EQUAL, column, text)
            case _:
                return node

    return rewrite(formula, change)
