"""Locations of processes in formulas, where a column of texts gives them."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from tachk.base.operators import BinaryOperator
from tachk.base.records import replace
from tachk.recordings.monitors.compiler import columns_read
from tachk.recordings.monitors.formulas import NamedFormula
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
