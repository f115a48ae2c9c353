"""Which expressions are passed to which parameters of templates and functions, by their names in the text."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.syntax import ast
from tachk.syntax.walk import nodes_of_kind


def passed_arguments(items: tuple[ast.Item, ...]) -> Iterator[tuple[ast.Parameter, ast.Expression]]:
    """Each parameter with each of its arguments, in partial instantiations, too.

    Functions of different templates that have the same name count as one.
    """
    made = {item.name.name: item for item in items if isinstance(item, ast.Template | ast.Instantiation)}
    functions: dict[str, list[ast.FunctionDeclaration]] = {}
    for function in nodes_of_kind(items, ast.FunctionDeclaration):
        functions.setdefault(function.name.name, []).append(function)
    for item in made.values():
        if isinstance(item, ast.Instantiation) and item.template.name in made:
            yield from zip(made[item.template.name].parameters, item.arguments, strict=False)
    for call in nodes_of_kind(items, ast.CallExpression):
        if isinstance(call.function, ast.NameExpression):
            for function in functions.get(call.function.name, ()):
                yield from zip(function.parameters, call.arguments, strict=False)
