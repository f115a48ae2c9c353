"""The clauses of an edge, which every writer takes from one place."""

from __future__ import annotations

from dataclasses import fields

from tachk.base.span import NOWHERE
from tachk.base.words import Direction
from tachk.syntax import ast
from tachk.syntax.building.build_template import CLAUSE_ORDER
from tachk.syntax.edge_clauses import ClauseKind, edge_clauses
from tachk.syntax.printing.expression_printer import print_clause

NAME = ast.Identifier(NOWHERE, "x")
VALUE = ast.NameExpression(NOWHERE, "x")
INT = ast.TypeExpression(NOWHERE, (), ast.NamedType(NOWHERE, "int"))
GIVEN = {
    "selects": ((ast.SelectBinding(NOWHERE, NAME, INT),), "x : int"),
    "guard": (VALUE, "x"),
    "synchronisation": (ast.SynchronisationLabel(NOWHERE, VALUE, Direction.SEND, None), "x!"),
    "updates": ((VALUE, VALUE), "x, x"),
    "probability": (VALUE, "x"),
}


def edge(**given: object) -> ast.EdgeDeclaration:
    return ast.EdgeDeclaration(NOWHERE, None, NAME, **given)  # type: ignore[arg-type]


def test_every_part_of_an_edge_is_a_clause() -> None:
    parts = {field.name for field in fields(ast.EdgeDeclaration)}
    assert parts - {"span", "source", "target", "controllable", "doc"} == set(GIVEN)
    clauses = edge_clauses(edge(**{name: value for name, (value, _) in GIVEN.items()}))
    assert [clause.value for clause in clauses] == [value for value, _ in GIVEN.values()]
    assert [print_clause(clause) for clause in clauses] == [text for _, text in GIVEN.values()]


def test_clauses_come_in_the_order_that_the_language_asks_for() -> None:
    clauses = edge_clauses(edge(**{name: value for name, (value, _) in reversed(GIVEN.items())}))
    assert tuple(clause.kind.value for clause in clauses) == CLAUSE_ORDER


def test_what_an_edge_does_not_have_is_no_clause() -> None:
    assert edge_clauses(edge()) == ()
    assert [clause.kind for clause in edge_clauses(edge(updates=(VALUE,)))] == [ClauseKind.UPDATES]
