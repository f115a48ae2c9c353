"""Other expressions in the place of variables."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from operator import is_
from typing import Any, TypeVar

from tachk.base.records import replace
from tachk.model.expressions import Expression, Reference, Variable
from tachk.model.traversal import PARTS

Node = TypeVar("Node", bound=Expression)


def substituted(expression: Expression, instead: Mapping[Variable, Expression]) -> Expression:
    """The expression with others in the place of variables, wherever they stand; functions that it calls stay as they
    are."""
    if isinstance(expression, Reference):
        return instead.get(expression.variable, expression)
    return with_parts(expression, lambda part: substituted(part, instead))


def with_parts(expression: Node, of: Callable[[Expression], Expression]) -> Node:
    """The expression with what ``of`` makes of each direct subexpression in its place."""
    parts: dict[str, Any] = {}
    for name in PARTS[type(expression)]:
        part = getattr(expression, name)
        parts[name] = tuple(map(of, part)) if isinstance(part, tuple) else of(part)
    return changed(expression, **parts)


def changed(expression: Node, **parts: Any) -> Node:
    """The expression with these parts; the same object where it has them already, as what is known of parts of
    networks is remembered by object."""
    for name, part in parts.items():
        old = getattr(expression, name)
        if part is not old and not (isinstance(part, tuple) and all(map(is_, part, old))):
            return replace(expression, **parts)
    return expression
