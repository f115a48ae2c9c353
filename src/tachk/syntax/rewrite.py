"""Changing syntax trees."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from typing import Any, TypeVar

from tachk.base.records import fields, is_dataclass, replace
from tachk.base.span import Span
from tachk.syntax import ast

N = TypeVar("N")

_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_$#]*")
_NAMED = ast.Identifier | ast.NameExpression | ast.NamedType


def rewrite(node: N, change: Callable[[Any], Any]) -> N:
    """The tree with ``change`` applied to every node, innermost first. What nothing changes keeps its identity."""
    return _rewritten(node, change)  # type: ignore[no-any-return]


def _rewritten(node: Any, change: Callable[[Any], Any]) -> Any:
    if isinstance(node, tuple):
        items = tuple(_rewritten(item, change) for item in node)
        return items if any(new is not old for new, old in zip(items, node, strict=True)) else node
    if not isinstance(node, ast.Node):
        return node
    changed = {}
    for field in fields(node):
        old = getattr(node, field.name)
        if isinstance(old, tuple | ast.Node):
            new = _rewritten(old, change)
            if new is not old:
                changed[field.name] = new
    return change(replace(node, **changed) if changed else node)


def names_in(nodes: object) -> dict[str, Span]:
    """Every word that is used as a name, with the place of its first use."""
    found: dict[str, Span] = {}
    pending: list[object] = [nodes]
    while pending:
        node = pending.pop()
        if isinstance(node, tuple | list):
            pending += reversed(node)
        elif isinstance(node, ast.UncheckedFormula) or (isinstance(node, ast.TemporalFormula) and node.sentence):
            text = node.text if isinstance(node, ast.UncheckedFormula) else node.sentence
            for word in _WORD.finditer(text):
                found.setdefault(word.group(), node.span)
        elif isinstance(node, ast.Node) and is_dataclass(node):
            if isinstance(node, _NAMED):
                found.setdefault(node.name, node.span)
            pending += [getattr(node, field.name) for field in reversed(fields(node)) if field.name != "span"]
    return found


def renamed(node: N, names: Mapping[str, str]) -> N:
    """The tree with every use of some names replaced, in texts that are kept unread as well."""

    def change(inner: Any) -> Any:
        if isinstance(inner, _NAMED) and inner.name in names:
            return replace(inner, name=names[inner.name])
        if isinstance(inner, ast.UncheckedFormula | ast.GanttDeclaration):
            text = _WORD.sub(lambda word: names.get(word.group(), word.group()), inner.text)
            return inner if text == inner.text else replace(inner, text=text)
        if isinstance(inner, ast.TemporalFormula) and inner.sentence:
            text = _WORD.sub(lambda word: names.get(word.group(), word.group()), inner.sentence)
            return inner if text == inner.sentence else replace(inner, sentence=text)
        return inner

    return rewrite(node, change)


def fresh_name(wanted: str, taken: Collection[str]) -> str:
    """The wanted name, or with a number behind it the first that is not taken."""
    if wanted not in taken:
        return wanted
    number = 1
    while f"{wanted}_{number}" in taken:
        number += 1
    return f"{wanted}_{number}"


def substitute(expression: ast.Expression, values: Mapping[str, ast.Expression]) -> ast.Expression:
    """The expression with free names replaced by expressions, without capture by the variables of quantifiers."""
    match expression:
        case ast.NameExpression(name=name):
            return values.get(name, expression)
        case ast.QuantifierExpression(variable=variable, body=body):
            inner = {name: value for name, value in values.items() if name != variable.name}
            used = {name for name in inner if name in names_in(body)}
            captured = {word for name in used for word in names_in(inner[name])}
            if variable.name in captured:
                name = fresh_name(variable.name, captured | set(names_in(body)))
                inner[variable.name] = ast.NameExpression(variable.span, name)
                variable = replace(variable, name=name)
            return replace(expression, variable=variable, body=substitute(body, inner))
        case ast.MemberExpression(base=base):
            return replace(expression, base=substitute(base, values))
        case _:
            return _in_parts(expression, values)


def _in_parts(expression: ast.Expression, values: Mapping[str, ast.Expression]) -> ast.Expression:
    changed: dict[str, Any] = {}
    for field in fields(expression):
        part = getattr(expression, field.name)
        if isinstance(part, tuple):
            changed[field.name] = tuple(_item(item, values) for item in part)
        elif isinstance(part, ast.Node) and not isinstance(part, ast.Identifier | ast.TypeExpression):
            changed[field.name] = substitute(part, values)  # type: ignore[arg-type]
    return replace(expression, **changed)


def _item(item: Any, values: Mapping[str, ast.Expression]) -> Any:
    if isinstance(item, tuple):  # a designator and its value
        return item[0], substitute(item[1], values)
    return substitute(item, values)
