"""Members of processes that variables name in queries, as in ``P(who).idle``: one case for each instance."""

from __future__ import annotations

from collections.abc import Callable

from tachk.base.operators import BinaryOperator
from tachk.base.span import Span
from tachk.frontend.context import Context
from tachk.frontend.expressions import folded_expressions as fold
from tachk.frontend.expressions.operator_types import choose
from tachk.frontend.expressions.process_names import select_member
from tachk.frontend.expressions.typing import describe, is_integral, value_range
from tachk.frontend.findings import count
from tachk.frontend.scope import FamilySymbol, FunctionSymbol, LocationSymbol, ProcessSymbol, ValueSymbol
from tachk.model.expressions import (
    BOOL,
    Block,
    Call,
    Constant,
    Expression,
    Function,
    LocationTest,
    Reference,
    Return,
    Variable,
    VariableKind,
)
from tachk.model.types import IntType, ScalarType
from tachk.syntax import ast


def is_constant(value: Expression, context: Context) -> bool:
    """True if a value is known before the model runs."""
    return not context.effects_of([value]).reads - context.constants


Case = Callable[[ProcessSymbol], Expression | None]
"""The member of a chosen process; None after a report."""


def chosen_member(
    node: ast.MemberExpression, symbol: FamilySymbol, arguments: tuple[Expression, ...], context: Context
) -> Expression | None:
    """The member of the instance with these arguments; None after a report."""
    return chosen(node.base, node.span, symbol, arguments, lambda process: _member(process, node, context), context)


def chosen(
    process: ast.Expression,
    span: Span,
    symbol: FamilySymbol,
    arguments: tuple[Expression, ...],
    case: Case,
    context: Context,
) -> Expression | None:
    """The case of the instance with these arguments; None after a report.

    Arguments that no instance has are a run-time error, as an index outside of an array is.
    """
    if len(arguments) != symbol.parameters:
        expected = count(symbol.parameters, "free parameter")
        context.error("E0308", process.span, f"`{process.span.text}` has {expected}, not {len(arguments)}")
        return None
    for argument in arguments:
        if not is_integral(argument.type) and not isinstance(argument.type, ScalarType):
            message = f"an argument that names a process must be an integer, not {describe(argument.type)}"
            context.error("E0301", argument.span, message)
            return None
    if not context.allow_instances(len(symbol.instances), span):
        return None
    members = [case(instance) for instance in symbol.instances.values()]
    known = [member for member in members if member is not None]
    if len(known) < len(members):
        return None
    selectors = [
        _existing(argument, column, process, context)
        for argument, column in zip(arguments, zip(*symbol.instances, strict=True), strict=True)
    ]
    tests = [_test(selectors, values, span) for values in symbol.instances]
    if isinstance(known[0], LocationTest):
        cases = [
            fold.binary(BinaryOperator.AND, test, member, BOOL, span) for test, member in zip(tests, known, strict=True)
        ]
        return fold.joined(BinaryOperator.OR, cases, BOOL, span)
    # The last case needs no test, unless it is what finds that there is no such instance.
    last = known.pop()
    certain = all(selector is argument for selector, argument in zip(selectors, arguments, strict=True))
    value: Expression | None = last if certain else choose(tests[-1], last, last, span, context)
    for test, member in reversed(list(zip(tests, known, strict=False))):
        if value is not None:
            value = choose(test, member, value, span, context)
    return value


def _member(process: ProcessSymbol, node: ast.MemberExpression, context: Context) -> Expression | None:
    member = select_member(process, node.name, context)
    match member:
        case LocationSymbol(number):
            return LocationTest(process.number, number, span=node.span)
        case ValueSymbol():
            return member.use(node.span)
        case FunctionSymbol():
            context.error("E0203", node.span, f"`{node.name.name}` is a function", "write parentheses to call it")
            return None
        case None:
            return None
        case _:
            message = f"a {member.description} of a process that a variable names is not supported"
            context.error("E0750", node.span, message, "name the process by constants")
            return None


def _test(selectors: list[Expression], values: tuple[int, ...], span: Span) -> Expression:
    """The condition that the arguments have these values."""
    tests = [
        fold.binary(BinaryOperator.EQUAL, selector, Constant(value, selector.type), BOOL, span)
        for selector, value in zip(selectors, values, strict=True)
    ]
    return fold.joined(BinaryOperator.AND, tests, BOOL, span)


def _existing(argument: Expression, column: tuple[int, ...], process: ast.Expression, context: Context) -> Expression:
    """The argument; where it may be none that an instance has, through a function that takes no others."""
    if not is_integral(argument.type):
        return argument
    range_ = IntType(min(column), max(column))
    low, high = value_range(argument)
    if range_.low <= low and high <= range_.high:
        return argument
    parameter = Variable("argument", range_, VariableKind.FRAME)
    body = Block((Return(Reference(parameter)),))
    function = Function(process.span.text, (parameter,), range_, body, process.span)
    context.record_function(function)
    return Call(function, (argument,), range_, argument.span)
