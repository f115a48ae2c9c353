"""Queries and properties as text."""

from __future__ import annotations

from tachk.base.words import QueryKind
from tachk.syntax import ast
from tachk.syntax.formulas.printer import print_formula
from tachk.syntax.printing.expression_printer import print_expression, print_expressions


def print_expected(expected: ast.Expected) -> str:
    """The text behind ``expect``."""
    if isinstance(expected, str):
        return expected
    return f"{expected.outcome} if {print_expression(expected.condition)} else {print_expected(expected.otherwise)}"


def print_query(query: ast.PropertyFormula) -> str:
    """The text of the question of a property or a query; a sentence as it was written."""
    match query:
        case ast.UncheckedFormula(text=text):
            return text
        case ast.TemporalFormula(formula=formula, sentence=sentence):
            return sentence if formula is None else print_formula(formula)
        case ast.QueryFormula(
            kind=QueryKind.SUPREMUM | QueryKind.INFIMUM | QueryKind.BOUNDS as kind,
            predicate=predicate,
            operands=operands,
        ):
            restriction = "" if predicate is None else f"{{ {print_expression(predicate)} }}"
            return f"{kind}{restriction}: {print_expressions(operands)}"
        case ast.QueryFormula(kind=kind, predicate=predicate, operands=operands, deadline=deadline):
            assert predicate is not None, "only sup, inf and bounds go without a predicate"
            soon = (
                "" if deadline is None else f"[{'<' if deadline.strict else '<='} {print_expression(deadline.bound)}]"
            )
            if kind is QueryKind.LEADS_TO:
                return f"{print_expression(predicate)} -->{soon} {print_expressions(operands)}"
            return f"{kind}{soon} {print_expression(predicate)}"
