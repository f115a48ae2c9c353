"""Floating point fields of structs of which variables last: they are left out, as a plain ``double`` is.

What is assigned to them is left out of the network, and whatever else uses one is refused.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator

from tachk.frontend.expressions.typing import value_range
from tachk.frontend.scope import DroppedSymbol, Scope, ValueSymbol
from tachk.model.types import ArrayType, IntType, RecordType, Type
from tachk.syntax import ast


def lasting_structs(items: Iterable[ast.Item]) -> frozenset[int]:
    """The struct types, by the identity of their nodes, of which some variable of the model or a template is made."""
    named: dict[str, list[ast.TypeExpression]] = defaultdict(list)
    pending: list[ast.TypeExpression] = []
    for item in _declared(items):
        match item:
            case ast.TypedefDeclaration(type=type_, declarators=declarators):
                for declarator in declarators:
                    named[declarator.name.name].append(type_)
            case ast.VariableDeclaration(type=ast.TypeExpression() as type_) if "const" not in type_.prefixes:
                pending.append(type_)
            case _:
                pass
    found: set[int] = set()
    while pending:
        base = pending.pop().base
        if isinstance(base, ast.NamedType):
            pending += named.pop(base.name, [])
        elif isinstance(base, ast.StructType):
            pending += [field.type for field in base.fields if field.type is not None]
            found.add(id(base))
    return frozenset(found)


def _declared(items: Iterable[ast.Item]) -> Iterator[object]:
    for item in items:
        if isinstance(item, ast.Template):
            yield from item.declarations
        else:
            yield item


def left_out_type(node: ast.Expression, scope: Scope) -> Type | None:
    """The type of what is left out, or of a part of it, that an expression names; None for everything else, and where
    an index may lie outside."""
    match node:
        case ast.NameExpression(name=name):
            symbol = scope.lookup(name)
            return symbol.shape if isinstance(symbol, DroppedSymbol) else None
        case ast.IndexExpression(base=base, index=index):
            return _element(left_out_type(base, scope), index, scope)
        case ast.MemberExpression(base=base, name=name):
            record = type_of_place(base, scope)
            found = record.left_out_type(name.name) if isinstance(record, RecordType) else None
            return found or _field(left_out_type(base, scope), name.name)
        case _:
            return None


def type_of_place(node: ast.Expression, scope: Scope) -> Type | None:
    """The type of a variable or a part of one; None for everything else, and where an index may lie outside."""
    match node:
        case ast.NameExpression(name=name):
            symbol = scope.lookup(name)
            return symbol.expression.type if isinstance(symbol, ValueSymbol) else None
        case ast.IndexExpression(base=base, index=index):
            return _element(type_of_place(base, scope), index, scope)
        case ast.MemberExpression(base=base, name=name):
            return _field(type_of_place(base, scope), name.name)
        case _:
            return None


def _element(array: Type | None, index: ast.Expression, scope: Scope) -> Type | None:
    if not isinstance(array, ArrayType) or not isinstance(array.index, IntType):
        return None
    low, high = _values(index, scope)
    return array.element if array.index.low <= low and high <= array.index.high else None


def _field(record: Type | None, name: str) -> Type | None:
    return dict(record.fields).get(name) if isinstance(record, RecordType) else None


def _values(index: ast.Expression, scope: Scope) -> tuple[int, int]:
    """Bounds of an index that is a number or a name; of any other, all numbers."""
    if isinstance(index, ast.IntegerLiteral):
        return index.value, index.value
    symbol = scope.lookup(index.name) if isinstance(index, ast.NameExpression) else None
    if isinstance(symbol, ValueSymbol) and isinstance(symbol.expression.type, IntType):
        return value_range(symbol.expression)
    return -(2**31), 2**31 - 1
