"""Events that three or more processes take together, said with broadcast channels.

A broadcast does not wait for its receivers. So its sender, the first process of the vector, has a guard that holds
only where all can take part: the guards of all, and that each process is where its edge begins, which an integer
variable for each of them shows. It also makes the updates of all, in the order of the vector. There is a channel for
each choice of edges, one of each process.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import reduce
from itertools import product

from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, replace
from tachk.base.span import Span
from tachk.syntax import ast


@dataclass(frozen=True, slots=True)
class Meeting:
    """Edges of several processes that are taken together.

    Attributes:
        edges: of each process the number of its edge, the sender first.
        guard: where all can be taken; None: always.
        updates: of all, in order.
    """

    channel: str
    edges: Mapping[str, int]
    guard: ast.Expression | None
    updates: tuple[ast.Expression, ...]

    @property
    def sender(self) -> str:
        return next(iter(self.edges))


@dataclass(frozen=True, slots=True)
class Whereabouts:
    """The variable that says where a process is.

    Attributes:
        numbers: of the locations of the process, by name; only one of several is reported.
    """

    variable: str
    numbers: Mapping[str, int]

    def declaration(self, span: Span, initial: str) -> ast.VariableDeclaration:
        last = ast.IntegerLiteral(span, len(self.numbers) - 1)
        kind = ast.TypeExpression(span, (), ast.RangeType(span, ast.IntegerLiteral(span, 0), last))
        value = ast.IntegerLiteral(span, self.numbers[initial])
        declarator = ast.Declarator(span, ast.Identifier(span, self.variable), (), value)
        return ast.VariableDeclaration(span, kind, (declarator,))

    def is_at(self, location: str, span: Span) -> ast.Expression:
        here = ast.IntegerLiteral(span, self.numbers[location])
        return ast.BinaryExpression(span, BinaryOperator.EQUAL, ast.NameExpression(span, self.variable), here)

    def followed(self, edge: ast.EdgeDeclaration) -> ast.EdgeDeclaration:
        """The edge, which notes where it leads."""
        assert edge.source is not None and edge.target is not None
        if edge.source.name == edge.target.name:
            return edge
        target = ast.NameExpression(edge.span, self.variable)
        there = ast.IntegerLiteral(edge.span, self.numbers[edge.target.name])
        note = ast.AssignmentExpression(edge.span, None, target, there)
        return replace(edge, updates=(*edge.updates, note))


def choices(
    parts: Sequence[tuple[str, str]], edges: Mapping[str, Sequence[tuple[str, ast.EdgeDeclaration]]]
) -> Iterable[dict[str, int]]:
    """For a vector of processes and events: of each process one edge with its event, in all ways."""
    numbered = [[number for number, (event, _) in enumerate(edges[name]) if event == wanted] for name, wanted in parts]
    names = [name for name, _ in parts]
    return (dict(zip(names, chosen, strict=True)) for chosen in product(*numbered))


def guard_of(
    chosen: Mapping[str, int],
    edges: Mapping[str, Sequence[tuple[str, ast.EdgeDeclaration]]],
    places: Mapping[str, Whereabouts],
) -> ast.Expression | None:
    """The condition under which all the chosen edges can be taken, for the first of them."""
    conditions: list[ast.Expression] = []
    for position, (name, number) in enumerate(chosen.items()):
        edge = edges[name][number][1]
        assert edge.source is not None
        if position > 0 and name in places:
            conditions.append(places[name].is_at(edge.source.name, edge.span))
        if edge.guard is not None:
            conditions.append(edge.guard)
    if not conditions:
        return None
    return reduce(
        lambda left, right: ast.BinaryExpression(left.span, BinaryOperator.AND, left, right),
        conditions[1:],
        conditions[0],
    )
