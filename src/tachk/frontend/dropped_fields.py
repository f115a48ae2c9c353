"""Floating point fields of structs of which variables last: they are left out, as a plain ``double`` is.

What is assigned to them is left out of the network, and whatever else uses one is refused.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator

from tachk.frontend.expressions.typing import value_range
from tachk.frontend.scope import Scope, ValueSymbol
from tachk.model.types import ArrayType, IntType, RecordType, Type
from tachk.syntax import ast


def lasting_structs(items: Iterable[ast.Item]) -> frozenset[int]:
    """The struct types, by the identity of their nodes, of which some variable of the model or of a template is made,
    and that have something beside floating point numbers."""
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
            inner = [field.type for field in base.fields if field.type is not None]
            pending += inner
            if any(not _is_double(type_) for type_ in inner):
                found.add(id(base))
    return frozenset(found)


def _declared(items: Iterable[ast.Item]) -> Iterator[object]:
    for item in items:
        if isinstance(item, ast.Template):
            yield from item.declarations
        else:
            yield item


def _is_double(type_: ast.TypeExpression) -> bool:
    return isinstance(type_.base, ast.BuiltinType) and type_.base.name == "double"


def names_left_out_field(node: ast.Expression, scope: Scope) -> bool:
    """Whether an expression is a field that is left out, of a place that there is for certain."""
    if not isinstance(node, ast.MemberExpression):
        return False
    record = type_of_place(node.base, scope)
    return isinstance(record, RecordType) and record.leaves_out(node.name.name)


def type_of_place(node: ast.Expression, scope: Scope) -> Type | None:
    """The type of a variable or a part of one; None for everything else, and where an index may lie outside."""
    match node:
        case ast.NameExpression(name=name):
            symbol = scope.lookup(name)
            return symbol.expression.type if isinstance(symbol, ValueSymbol) else None
        case ast.IndexExpression(base=base, index=index):
            array = type_of_place(base, scope)
            if not isinstance(array, ArrayType) or not isinstance(array.index, IntType):
                return None
            low, high = _values(index, scope)
            return array.element if array.index.low <= low and high <= array.index.high else None
        case ast.MemberExpression(base=base, name=name):
            record = type_of_place(base, scope)
            return dict(record.fields).get(name.name) if isinstance(record, RecordType) else None
        case _:
            return None


def _values(index: ast.Expression, scope: Scope) -> tuple[int, int]:
    """Bounds of an index that is a number or a name; of any other, all numbers."""
    if isinstance(index, ast.IntegerLiteral):
        return index.value, index.value
    symbol = scope.lookup(index.name) if isinstance(index, ast.NameExpression) else None
    if isinstance(symbol, ValueSymbol) and isinstance(symbol.expression.type, IntType):
        return value_range(symbol.expression)
    return -(2**31), 2**31 - 1
