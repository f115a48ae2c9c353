"""Predicates as terms; the parts of a conjunction or disjunction have no order where it makes no difference."""

from __future__ import annotations

from collections.abc import Iterable

from tachk.analysis.failures import can_fail
from tachk.analysis.fold import fold
from tachk.base.operators import UnaryOperator
from tachk.base.records import dataclass
from tachk.engine.symmetry.terms import TermReader, Token
from tachk.model.connectives import is_conjunction, sides
from tachk.model.expressions import Binary, Expression, Unary


@dataclass(frozen=True, slots=True)
class UnorderedJunction:
    """A conjunction or disjunction, whose parts have no order."""

    conjunctive: bool
    parts: tuple[Term, ...]


Term = tuple[Token, ...] | UnorderedJunction


def predicate_term(reader: TermReader, predicate: Expression) -> Term:
    """A predicate; where nothing in it can be a run-time error the order of its parts does not matter."""
    folded = fold(predicate, reader.known)
    reader.begin()
    if can_fail(folded, reader.known):
        tokens: list[Token] = []
        reader.condition(folded, tokens)
        return tuple(tokens)
    return _term(reader, folded, True)


def _term(reader: TermReader, expression: Expression, positive: bool) -> Term:
    conjunctive = is_conjunction(expression, positive)
    if conjunctive is None:
        if isinstance(expression, Unary) and expression.operator is UnaryOperator.NOT:
            return _term(reader, expression.operand, not positive)
        tokens: list[Token] = [("positive", positive)]
        reader.condition(expression, tokens)
        return tuple(tokens)
    parts: list[Term] = []
    pending = [(expression, positive)]
    while pending:
        part, holds = pending.pop()
        if isinstance(part, Unary) and part.operator is UnaryOperator.NOT:
            pending.append((part.operand, not holds))
        elif isinstance(part, Binary) and is_conjunction(part, holds) is conjunctive:
            pending += reversed(sides(part, holds))
        else:
            parts.append(_term(reader, part, holds))
    return UnorderedJunction(conjunctive, tuple(parts))


def flat(terms: Iterable[Term]) -> Iterable[Token]:
    """All tokens of some terms."""
    for term in terms:
        if isinstance(term, UnorderedJunction):
            yield from flat(term.parts)
        else:
            yield from term
