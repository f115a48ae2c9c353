"""Parameters passed by value that are no constants in the template: every process has a variable of its own instead."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from tachk.frontend.context import Context
from tachk.frontend.declarations.declarations import Declared, argument_value, checked_slots
from tachk.frontend.expressions.initialisers import clock_value
from tachk.frontend.expressions.typing import WIDE
from tachk.frontend.scope import Scope, ValueSymbol
from tachk.model.expressions import Constant, Expression, Reference, Variable, VariableKind
from tachk.model.floating import HYBRID_DOUBLE, variable_type
from tachk.model.types import IntType, Type
from tachk.syntax import ast
from tachk.syntax.walk import nodes_of_kind


def changed_parameters(template: ast.Template) -> tuple[ast.Parameter, ...]:
    """The parameters passed by value that the template assigns to."""
    changed = set(_assigned(template))
    return tuple(
        parameter
        for parameter in template.parameters
        if parameter.name.name in changed and not parameter.reference and "const" not in parameter.type.prefixes
    )


def as_variables(changed: Iterable[ast.Parameter], parameters: Scope, declared: Declared, context: Context) -> Scope:
    """The parameters of a process with variables in place of the values that the template changes.

    UPPAAL treats them so; they start at the value of the argument.

    Args:
        changed: the `changed_parameters` of the template.
        parameters: what the parameters mean; stays as it is.
        declared: gets the variables.
    """
    symbols = dict(parameters.symbols)
    for parameter in changed:
        name = parameter.name.name
        symbol = symbols.get(name)
        if not isinstance(symbol, ValueSymbol):
            continue
        value = symbol.expression
        if not isinstance(value, Constant) and not context.open_constants.among(context.effects_of([value]).reads):
            continue
        type_ = IntType() if value.type == WIDE else value.type
        slots = argument_value(value, type_, f"the argument for `{name}`", context)
        if slots is not None:
            variable = Variable(declared.full_name(name), type_, VariableKind.LOCAL, slots, span=parameter.name.span)
            declared.variables.append(variable)
            symbols[name] = ValueSymbol(Reference(variable), True, "parameter", symbol.span)
    return Scope(parameters.parent, parameters.label, symbols, parameters.below)


def own_clock(
    parameter: ast.Parameter, type_: Type, value: Expression, declared: Declared, context: Context
) -> ValueSymbol | None:
    """The clock for a parameter passed by value: a clock of the process that begins with the argument.

    Args:
        type_: as `TypeReader.parameter` gives it.
        declared: gets the clock.
    """
    name, of_variable = parameter.name.name, variable_type(type_)
    initial = clock_value(value, of_variable, value.span, context)
    slots = None if initial is None else checked_slots(initial, of_variable, f"the argument for `{name}`", context)
    if slots is None:
        return None
    hybrid = type_ == HYBRID_DOUBLE
    variable = Variable(
        declared.full_name(name), of_variable, VariableKind.LOCAL, slots, span=parameter.name.span, is_hybrid=hybrid
    )
    declared.variables.append(variable)
    return ValueSymbol(Reference(variable), True, "parameter", parameter.name.span)


def _assigned(template: ast.Template) -> Iterator[str]:
    """The names that a template assigns to, those aside that mean something else in the same function or edge."""
    for function in template.declarations:
        if isinstance(function, ast.FunctionDeclaration):
            yield from _targets(function.body) - set(_local_names(function))
    for edge in nodes_of_kind((template.locations, template.branchpoints, template.edges), ast.EdgeDeclaration):
        yield from _targets(edge) - {binding.name.name for binding in edge.selects}


def _targets(tree: ast.Node) -> set[str]:
    found: set[str] = set()
    for node in nodes_of_kind(tree, ast.AssignmentExpression, ast.IncrementExpression):
        if isinstance(node.target, ast.NameExpression):
            found.add(node.target.name)
    return found


def _local_names(function: ast.FunctionDeclaration) -> Iterator[str]:
    for parameter in function.parameters:
        yield parameter.name.name
    for declarator in nodes_of_kind(function.body, ast.Declarator):
        yield declarator.name.name
