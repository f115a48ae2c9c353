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
        case ast.ScenarioFormula(clauses=clauses):
            return " ".join(["scenario {", *(f"{print_scenario_clause(clause)};" for clause in clauses), "}"])
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


def print_scenario_clause(clause: ast.ScenarioStep | ast.ObservesClause) -> str:
    """A step of a scenario, or what it observes, without the semicolon."""
    match clause:
        case ast.ObservesClause(channels=channels):
            return f"observes {print_expressions(channels)}"
        case ast.ScenarioStep(channel=None, earliest=time):
            assert time is not None, "silence has a length"
            return f"nothing {_time(time)}"
        case ast.ScenarioStep(channel=channel, condition=condition):
            assert channel is not None
            behind = "" if condition is None else f" with {print_expression(condition)}"
            return f"{_bounds(clause)}{print_expression(channel)}{behind}"


def _bounds(step: ast.ScenarioStep) -> str:
    match step.earliest, step.latest:
        case None, None:
            return ""
        case None, latest:
            return f"within {_time(latest)} "
        case earliest, None:
            return f"after {_time(earliest)} "
        case earliest, latest:
            return f"from {_time(earliest)} to {_time(latest)} "


def _time(time: ast.ScenarioTime | None) -> str:
    assert time is not None
    amount = str(time.amount) if isinstance(time.amount, int) else time.amount.name
    return f"{amount} {time.unit}".rstrip()
