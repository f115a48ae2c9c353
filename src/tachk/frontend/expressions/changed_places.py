"""Assignments as places: ``(i = 3) += 2``, ``(++i)++``, ``(r = q).x = 2``, ``f(++i)`` for a reference.

UPPAAL takes an assignment, and a `++` or `--` in front, for the variable that it has changed. So what stands inside is
done first, and the place is used then.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tachk.base.records import replace
from tachk.base.span import Span
from tachk.frontend.context import Context
from tachk.model.expressions import Comma, Expression, Field, Index
from tachk.model.traversal import may_change, walk
from tachk.syntax import ast


def changed_first(place: ast.Expression) -> tuple[ast.Expression | None, ast.Expression]:
    """The side effect of a place, None if it has none, and the place without it."""
    match place:
        case ast.AssignmentExpression(target=target) | ast.IncrementExpression(prefix=True, target=target):
            return place, changed_first(target)[1]
        case ast.IndexExpression(base=base) | ast.MemberExpression(base=base):
            first, inner = changed_first(base)
            return (None, place) if first is None else (first, replace(place, base=inner))
        case _:
            return None, place


def in_turn(
    first: Expression, place: Expression, then: Expression, others: Sequence[Expression], span: Span, context: Context
) -> Expression | None:
    """``first`` and then ``then``, which uses the place; None after a report.

    Args:
        others: what is evaluated in ``then`` beside the place; it must not notice that ``first`` is done already.
    """
    written = context.effects_of([first]).writes
    indices = tuple(_indices(place))
    effects = context.effects_of((*indices, *others))
    changing = any(may_change(node) for index in indices for node in walk(index))
    if changing or not written.isdisjoint(effects.reads | effects.writes):
        what = "using an assignment as a place is not supported here, where its order matters"
        context.error("E0750", span, what, "make the assignment before, in a statement or an update of its own")
        return None
    return Comma((first, then), then.type, span)


def _indices(place: Expression) -> Iterator[Expression]:
    match place:
        case Index(base, index):
            yield from _indices(base)
            yield index
        case Field(base):
            yield from _indices(base)
        case _:
            pass
