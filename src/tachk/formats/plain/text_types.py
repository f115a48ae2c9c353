"""Declared types of names in a text, without elaboration: enough to distinguish clocks from numbers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from tachk.syntax import ast
from tachk.syntax.walk import nodes_of_kind


@dataclass(frozen=True, slots=True)
class DeclaredName:
    """Attributes:
    type: as it is written.
    dimensions: of the array behind the name, those of named types not counted.
    """

    type: ast.TypeExpression
    dimensions: int = 0


@dataclass(frozen=True, slots=True)
class TextTypes:
    """Attributes:
    names: of variables and parameters.
    types: the named ones.
    results: of functions.
    processes: the names in each process or template, for queries.
    """

    names: Mapping[str, DeclaredName]
    types: Mapping[str, DeclaredName]
    results: Mapping[str, ast.TypeExpression]
    processes: Mapping[str, TextTypes]

    def within(self, declarations: Iterable[Any], parameters: Iterable[ast.Parameter] = ()) -> TextTypes:
        """With the names that a block declares, which hide equal names outside."""
        names, types, results = dict(self.names), dict(self.types), dict(self.results)
        for parameter in parameters:
            names[parameter.name.name] = DeclaredName(parameter.type, len(parameter.dimensions))
        for item in declarations:
            match item:
                case ast.VariableDeclaration(type=ast.TypeExpression() as type_):
                    names.update((d.name.name, DeclaredName(type_, len(d.dimensions))) for d in item.declarators)
                case ast.TypedefDeclaration(type=type_):
                    types.update((d.name.name, DeclaredName(type_, len(d.dimensions))) for d in item.declarators)
                case ast.FunctionDeclaration(result=result, name=name):
                    results[name.name] = result
                case _:
                    pass
        return replace(self, names=names, types=types, results=results)

    def binding(self, name: str, type_: ast.TypeExpression) -> TextTypes:
        """With one more name: of a quantifier or a select."""
        return replace(self, names={**self.names, name: DeclaredName(type_)})

    def place(self, expression: ast.Expression) -> DeclaredName | None:
        """The type of a variable, an element of an array or a field of a record; None for everything else."""
        match expression:
            case ast.NameExpression(name=name):
                return self._whole(self.names.get(name))
            case ast.IndexExpression(base=base):
                array = self.place(base)
                if array is None or not array.dimensions:
                    return None
                return self._whole(replace(array, dimensions=array.dimensions - 1))
            case ast.MemberExpression(base=base, name=name):
                return self._field(self.place(base), name.name) or self._of_process(base, name.name)
            case ast.ConditionalExpression(then=then, otherwise=otherwise):
                return self.place(then) or self.place(otherwise)
            case _:
                return None

    def base(self, expression: ast.Expression) -> str:
        """The built-in type of a place: ``clock``, ``int``, ``bool``, ``double``, ...; a range is an ``int``. Empty
        where it is no such place."""
        found = self.place(expression)
        return "" if found is None else self.base_of(found)

    def base_of(self, found: DeclaredName) -> str:
        match found:
            case DeclaredName(ast.TypeExpression(base=ast.BuiltinType(name=name)), 0):
                return name
            case DeclaredName(ast.TypeExpression(base=ast.RangeType()), 0):
                return "int"
            case _:
                return ""

    def reads_clock(self, expression: ast.Expression) -> bool:
        """True if the value of a clock is part of an expression; the arguments of calls and indices aside."""
        match expression:
            case ast.CallExpression() | ast.RateExpression():
                return False
            case ast.QuantifierExpression(variable=variable, type=type_, body=body):
                return self.binding(variable.name, type_).reads_clock(body)
            case ast.NameExpression() | ast.IndexExpression() | ast.MemberExpression():
                return self.base(expression) == "clock"
            case ast.UnaryExpression(operand=operand):
                return self.reads_clock(operand)
            case ast.BinaryExpression(left=left, right=right):
                return self.reads_clock(left) or self.reads_clock(right)
            case ast.ConditionalExpression(condition=condition, then=then, otherwise=otherwise):
                return any(map(self.reads_clock, (condition, then, otherwise)))
            case _:
                return False

    def mentions_clock(self, tree: object) -> bool:
        """True if some part of a tree is a clock."""
        places = nodes_of_kind(tree, ast.NameExpression, ast.IndexExpression, ast.MemberExpression)
        return any(self.base(place) == "clock" for place in places)

    def _whole(self, found: DeclaredName | None) -> DeclaredName | None:
        """The type with each named type replaced by its definition."""
        while found is not None and isinstance(found.type.base, ast.NamedType):
            named = self.types.get(found.type.base.name)
            if named is None:
                return found
            found = DeclaredName(named.type, found.dimensions + named.dimensions)
        return found

    def _field(self, record: DeclaredName | None, name: str) -> DeclaredName | None:
        if record is None or record.dimensions or not isinstance(record.type.base, ast.StructType):
            return None
        for field in record.type.base.fields:
            for declarator in field.declarators:
                if declarator.name.name == name and field.type is not None:
                    return self._whole(DeclaredName(field.type, len(declarator.dimensions)))
        return None

    def _of_process(self, base: ast.Expression, name: str) -> DeclaredName | None:
        called = base.function if isinstance(base, ast.CallExpression) else base
        inner = self.processes.get(called.name) if isinstance(called, ast.NameExpression) else None
        return None if inner is None else inner.place(ast.NameExpression(base.span, name))


def text_types(items: Iterable[ast.Item]) -> TextTypes:
    """The global names of a text, and for queries those in its processes."""
    listed = tuple(items)
    outside = TextTypes({}, {}, {}, {}).within(listed)
    processes: dict[str, TextTypes] = {}
    for item in listed:
        if isinstance(item, ast.Template):
            processes[item.name.name] = outside.within(item.declarations, item.parameters)
    for item in nodes_of_kind(listed, ast.Instantiation):
        if item.template.name in processes:
            processes[item.name.name] = processes[item.template.name]
    return replace(outside, processes=processes)
