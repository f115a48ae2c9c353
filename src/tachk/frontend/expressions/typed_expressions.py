"""Typing and resolving expressions.

Every function here returns None where it has reported a finding, or where a part of the expression is broken already;
so one mistake gives one message.
"""

from __future__ import annotations

import math
from typing import assert_never

from tachk.base.job import check_job
from tachk.base.operators import CONNECTIVES, CONSTANT_HIGH, CONSTANT_LOW, PrefixOperator, UnaryOperator
from tachk.base.span import Span
from tachk.frontend.context import Context
from tachk.frontend.dropped import is_dropped, refuse_call, refuse_reference, refuse_use
from tachk.frontend.expressions import folded_expressions as fold
from tachk.frontend.expressions.assignments import assignment
from tachk.frontend.expressions.builtin_names import (
    BUILTIN_FUNCTIONS,
    DYNAMIC_FUNCTIONS,
    DYNAMIC_HELP,
    FLOATING_FUNCTIONS,
)
from tachk.frontend.expressions.changed_places import changed_first, in_turn
from tachk.frontend.expressions.chosen_processes import chosen, chosen_member, is_constant
from tachk.frontend.expressions.name_expressions import misuse_help, named
from tachk.frontend.expressions.operator_types import choose, combine
from tachk.frontend.expressions.places import assignable, converted, element, field, is_place
from tachk.frontend.expressions.process_names import mentions_family, select_member, select_process
from tachk.frontend.expressions.text_constants import compared_texts
from tachk.frontend.expressions.type_expressions import TypeReader
from tachk.frontend.expressions.typing import (
    FINT_HELP,
    WIDE,
    can_assign,
    describe,
    is_integral,
    same_shape,
)
from tachk.frontend.findings import count, wrong_arguments
from tachk.frontend.scope import (
    BrokenSymbol,
    DroppedSymbol,
    FamilySymbol,
    FunctionSymbol,
    LocationSymbol,
    ProcessSymbol,
    Scope,
    Symbol,
    ValueSymbol,
)
from tachk.model.expressions import (
    BOOL,
    INT,
    Call,
    Comma,
    Constant,
    Deadlock,
    Expression,
    Function,
    Increment,
    LocationTest,
    Quantifier,
    QuantifierKind,
    Reference,
    Variable,
    VariableKind,
)
from tachk.model.floating import DOUBLE, FloatingOperation, is_floating
from tachk.model.floating_calls import NAMED_OPERATIONS, RANDOM_TRI, floating_constant, operated
from tachk.model.types import BoolType, ClockType, IntType, Type, bounds
from tachk.syntax import ast


def type_reader(scope: Scope, context: Context) -> TypeReader:
    """Resolves types in a scope; sizes and bounds are evaluated there."""
    return TypeReader(scope, context, lambda node, what: constant_integer(node, what, scope, context))


def constant_integer(node: ast.Expression, what: str, scope: Scope, context: Context) -> int | None:
    """The value of an integral expression that must be a constant."""
    value = integral(node, scope, context)
    if value is None:
        return None
    slots = context.constant_slots(value, what)
    return None if slots is None else slots[0]


def condition(node: ast.Expression, scope: Scope, context: Context) -> Expression | None:
    """An expression that is true or false; it may compare clocks."""
    value = expression(node, scope, context)
    if value is None:
        return None
    if isinstance(node, ast.AssignmentExpression) and isinstance(value.type, ClockType):
        context.error("E0313", node.span, "a condition must not change anything", "`=` assigns; write `==` to compare")
        return None
    if not is_integral(value.type):
        context.error(
            "E0305",
            node.span,
            f"a condition must be boolean or integer, not {describe(value.type)}",
            "compare the clock with a bound, as in `x <= 5`" if isinstance(value.type, ClockType) else None,
        )
        return None
    return value


def integral(node: ast.Expression, scope: Scope, context: Context) -> Expression | None:
    """An expression with an integer or boolean value."""
    value = expression(node, scope, context)
    if value is None:
        return None
    if value.type == DOUBLE:
        context.error("E0750", node.span, "a floating point number is not supported here", FINT_HELP)
        return None
    if not is_integral(value.type):
        context.error("E0301", node.span, f"expected an integer, found {describe(value.type)}")
        return None
    return value


def expression(node: ast.Expression, scope: Scope, context: Context) -> Expression | None:
    """The typed expression; comparisons of clocks are in normal form, constants are folded."""
    check_job()
    match node:
        case ast.NameExpression():
            return named(node, scope, context)
        case ast.IntegerLiteral(span, value):
            if not CONSTANT_LOW <= value <= CONSTANT_HIGH:
                limit = f"the largest integer is {CONSTANT_HIGH}, the least one {CONSTANT_LOW}"
                context.error("E0605", span, f"{value} does not fit 32 bits", limit)
                return None
            return Constant(value, INT if value <= INT.high else WIDE, span)
        case ast.BooleanLiteral(span, truth):
            return Constant(int(truth), BOOL, span)
        case ast.FloatLiteral():
            return _floating_number(node, context)
        case ast.StringLiteral(span):
            context.error("E0750", span, "strings are not supported")
            return None
        case ast.UnaryExpression():
            return _unary(node, scope, context)
        case ast.BinaryExpression():
            return _binary(node, scope, context)
        case ast.AssignmentExpression():
            return _assignment(node, scope, context)
        case ast.IncrementExpression():
            return _increment(node, scope, context)
        case ast.ConditionalExpression():
            return _conditional(node, scope, context)
        case ast.CallExpression():
            return _call(node, scope, context)
        case ast.IndexExpression():
            return _index(node, scope, context)
        case ast.MemberExpression():
            return _member(node, scope, context)
        case ast.RateExpression(span):
            context.error(
                "E0334",
                span,
                "a rate can only be set as a conjunct of an invariant",
                "write `x' == 0` (stopped) or `x' == 1` as a part of the location's invariant",
            )
            return None
        case ast.QuantifierExpression():
            return _quantifier(node, scope, context)
        case ast.DeadlockExpression(span):
            if not context.in_query:
                context.error("E0501", span, "`deadlock` can only be used in queries")
                return None
            return Deadlock(span=span)
        case ast.SpawnExpression(span):
            context.error("E0750", span, "`spawn` is not supported", DYNAMIC_HELP)
            return None
        case ast.InitialiserList(span):
            context.error("E0318", span, "a list in braces can only initialise an array or a struct")
            return None
        case _ as never:
            assert_never(never)


def _floating_number(node: ast.FloatLiteral, context: Context) -> Expression | None:
    number = float(node.text)
    if math.isfinite(number):
        return floating_constant(number, node.span)
    context.error("E0605", node.span, f"{node.text} is too large for a floating point number")
    return None


# ---- operators ------------------------------------------------------------------------------------------------------


def _unary(node: ast.UnaryExpression, scope: Scope, context: Context) -> Expression | None:
    if (
        node.operator is PrefixOperator.MINUS
        and isinstance(node.operand, ast.IntegerLiteral)
        and node.operand.value == 2**31
    ):
        return Constant(-(2**31), WIDE, node.span)
    if node.operator is PrefixOperator.NOT:
        operand = condition(node.operand, scope, context)
        return None if operand is None else fold.negation(operand, node.span)
    value = expression(node.operand, scope, context)
    if value is None:
        return None
    if value.type == DOUBLE:
        negative = node.operator is PrefixOperator.MINUS
        return operated(FloatingOperation.NEGATE, (value,), node.span) if negative else value
    if isinstance(value.type, ClockType) or is_integral(value.type):
        if node.operator is PrefixOperator.PLUS:
            return value
        type_ = value.type if isinstance(value.type, ClockType) else INT
        return fold.unary(UnaryOperator.MINUS, value, type_, node.span)
    context.error("E0301", node.operand.span, f"`{node.operator}` needs an integer, not {describe(value.type)}")
    return None


def _binary(node: ast.BinaryExpression, scope: Scope, context: Context) -> Expression | None:
    operator = node.operator
    if operator in CONNECTIVES:
        first, second = condition(node.left, scope, context), condition(node.right, scope, context)
        if first is None or second is None:
            return None
        return fold.binary(operator, first, second, BOOL, node.span)
    truth = compared_texts(operator, node.left, node.right, scope)
    if truth is not None:
        return Constant(int(truth), BOOL, node.span)
    left, right = expression(node.left, scope, context), expression(node.right, scope, context)
    if left is None or right is None:
        return None
    return combine(operator, left, right, node.span, context)


def _conditional(node: ast.ConditionalExpression, scope: Scope, context: Context) -> Expression | None:
    first = node.condition
    if isinstance(first, ast.BinaryExpression) and isinstance(first.left, ast.RateExpression):
        value = Span(node.span.source, first.right.span.start, node.span.end)
        context.error(
            "E0334",
            first.left.span,
            f"`?:` binds weaker than `==`: here the rate is a part of the condition `{first.span.text}`",
            f"put brackets around the value: `{first.left.span.text} == ({value.text})`",
        )
        return None
    test = condition(node.condition, scope, context)
    then, otherwise = expression(node.then, scope, context), expression(node.otherwise, scope, context)
    if test is None or then is None or otherwise is None:
        return None
    return choose(test, then, otherwise, node.span, context)


def _quantifier(node: ast.QuantifierExpression, scope: Scope, context: Context) -> Expression | None:
    if node.kind == "foreach":
        context.error("E0750", node.span, "`foreach` over dynamic processes is not supported", DYNAMIC_HELP)
        return None
    type_ = type_reader(scope, context).bounded(node.type, f"the variable of `{node.kind}`")
    if type_ is None:
        return None
    kind = QuantifierKind(node.kind)
    result_type: Type = INT if kind is QuantifierKind.SUM else BOOL
    checked = integral if kind is QuantifierKind.SUM else condition
    if not (context.in_query and mentions_family(node.body, scope)):
        variable = Variable(node.variable.name, type_, VariableKind.BOUND, span=node.variable.span)
        body = checked(node.body, _bound_scope(node, Reference(variable), scope), context)
        return None if body is None else Quantifier(kind, variable, body, result_type, node.span)
    # Which process is meant depends on the variable, so the instances are written out.
    low, high = bounds(type_)
    if not context.allow_instances(high - low + 1, node.span):
        return None
    parts: list[Expression] = []
    for value in range(low, high + 1):
        part = checked(node.body, _bound_scope(node, Constant(value, type_), scope), context)
        if part is None:
            return None
        parts.append(part)
    return fold.joined(kind.joins, parts, result_type, node.span)


def _bound_scope(node: ast.QuantifierExpression, value: Expression, scope: Scope) -> Scope:
    return Scope(scope, "", {node.variable.name: ValueSymbol(value, False, "bound variable", node.variable.span)})


# ---- places ---------------------------------------------------------------------------------------------------------


def _index(node: ast.IndexExpression, scope: Scope, context: Context) -> Expression | None:
    base, number = expression(node.base, scope, context), expression(node.index, scope, context)
    if base is None or number is None:
        return None
    return element(base, number, node, context)


def _member(node: ast.MemberExpression, scope: Scope, context: Context) -> Expression | None:
    family, arguments = _chosen_process(node.base, scope, context)
    if family is not None:
        return chosen_member(node, family, arguments, context)
    found = select_process(node.base, scope, context, _constant_argument)
    if found is not None:
        member = select_member(found, node.name, context)
        match member:
            case LocationSymbol(number):
                assert isinstance(found, ProcessSymbol)
                return LocationTest(found.number, number, span=node.span)
            case ValueSymbol():
                return member.use(node.span)
            case FunctionSymbol():
                context.error("E0203", node.span, f"`{node.name.name}` is a function", "write parentheses to call it")
            case DroppedSymbol():
                refuse_use(node, member, context)
            case _:
                pass
        return None
    base = expression(node.base, scope, context)
    if base is None:
        return None
    return field(base, node, context)


def _chosen_process(
    node: ast.Expression, scope: Scope, context: Context
) -> tuple[FamilySymbol | None, tuple[Expression, ...]]:
    """The processes among which variables choose in ``P(who)`` in a query, and the values that choose."""
    match node:
        case ast.CallExpression(function=ast.NameExpression(name=name), arguments=given) if context.in_query:
            family = scope.lookup(name)
            if isinstance(family, FamilySymbol):
                arguments = tuple(expression(argument, scope, context) for argument in given)
                known = tuple(argument for argument in arguments if argument is not None)
                if len(known) == len(arguments) and not all(is_constant(argument, context) for argument in known):
                    return family, known
        case _:
            pass
    return None, ()


def _constant_argument(node: ast.Expression, scope: Scope, context: Context) -> int | None:
    value = expression(node, scope, context)
    if value is None:
        return None
    slots = context.constant_slots(value, "an argument that names a process")
    return None if slots is None else slots[0]


def _increment(node: ast.IncrementExpression, scope: Scope, context: Context) -> Expression | None:
    first, target = changed_first(node.target)
    done = None if first is None else expression(first, scope, context)
    place = expression(target, scope, context) if assignable(target, scope, context, None) else None
    if place is None or (first is not None and done is None):
        return None
    if place.type == DOUBLE:
        what = f"`{node.operator}` on floating point numbers is not supported"
        context.error("E0750", node.span, what, f"write `{node.operator[0]}= 1`")
        return None
    if not isinstance(place.type, IntType | BoolType):
        context.error("E0301", target.span, f"`{node.operator}` needs an integer, not {describe(place.type)}")
        return None
    result = Increment(place, 1 if node.operator == "++" else -1, node.prefix, place.type, node.span)
    return result if done is None else in_turn(done, place, result, (), node.span, context)


def _assignment(node: ast.AssignmentExpression, scope: Scope, context: Context) -> Expression | None:
    first, target = changed_first(node.target)
    done = None if first is None else expression(first, scope, context)
    place = expression(target, scope, context) if assignable(target, scope, context) else None
    value = expression(node.value, scope, context)
    if place is None or value is None or (first is not None and done is None):
        return None
    result = assignment(place, value, node, context)
    if result is None or done is None:
        return result
    return in_turn(done, place, result, (), node.span, context)


def comma(nodes: tuple[ast.Expression, ...], span: Span, scope: Scope, context: Context) -> Expression | None:
    """Expressions separated by commas, the last of which is a condition."""
    items = [expression(node, scope, context) for node in nodes[:-1]]
    last = condition(nodes[-1], scope, context)
    if last is None or None in items:
        return None
    if not items:
        return last
    return Comma((*(item for item in items if item is not None), last), last.type, span)


# ---- calls ----------------------------------------------------------------------------------------------------------


def _operation(
    operation: FloatingOperation, node: ast.CallExpression, scope: Scope, context: Context
) -> Expression | None:
    """A call of a function on floating point numbers."""
    arguments = [expression(argument, scope, context) for argument in node.arguments]
    known = [argument for argument in arguments if argument is not None]
    if len(known) != len(arguments):
        return None
    wanted, name = len(operation.parameters), node.function.span.text
    if len(known) != wanted:
        context.error("E0308", node.span, f"`{name}` takes {count(wanted, 'argument')}, not {len(known)}")
        return None
    for argument in known:
        if not can_assign(DOUBLE, argument.type):
            context.error("E0309", argument.span, f"`{name}` needs numbers, not {describe(argument.type)}")
            return None
    return operated(operation, tuple(known), node.span)


def _call(node: ast.CallExpression, scope: Scope, context: Context) -> Expression | None:
    if isinstance(node.function, ast.NameExpression) and scope.lookup(node.function.name) is None:
        operation = NAMED_OPERATIONS.get(node.function.name)
        if operation is not None and (context.keeps_doubles or not operation.only_simulated):
            return _operation(operation, node, scope, context)
    if isinstance(node.function, ast.MemberExpression):
        member = node.function
        family, chooses = _chosen_process(member.base, scope, context)
        if family is not None:
            return chosen(
                member.base,
                node.span,
                family,
                chooses,
                lambda process: _call_of(select_member(process, member.name, context), node, scope, context),
                context,
            )
    return _call_of(_called(node.function, scope, context), node, scope, context)


def _call_of(symbol: Symbol | None, node: ast.CallExpression, scope: Scope, context: Context) -> Expression | None:
    if symbol is None:
        return None
    if not isinstance(symbol, FunctionSymbol):
        if isinstance(symbol, DroppedSymbol):
            refuse_call(node.function, symbol, context)
        elif not isinstance(symbol, BrokenSymbol):
            context.error("E0208", node.function.span, f"a {symbol.description} is not a function", misuse_help(symbol))
        return None
    function = symbol.function
    if function is None:
        context.error("E0310", node.span, "a function cannot call itself", "write a loop instead")
        return None
    if len(node.arguments) != len(function.parameters):
        context.findings.add(
            "E0308",
            node.span,
            f"`{function.name}` takes {count(len(function.parameters), 'argument')}, not {len(node.arguments)}",
            wrong_arguments([parameter.name for parameter in function.parameters], len(node.arguments)),
        )
        return None
    arguments: list[Expression] = []
    changed: list[tuple[Expression | None, int]] = []
    for number, (parameter, given) in enumerate(zip(function.parameters, node.arguments, strict=True)):
        first, argument = changed_first(given) if parameter.reference else (None, given)
        if first is not None:
            changed.append((expression(first, scope, context), number))
        value = _argument(function, parameter, argument, scope, context)
        if value is not None:
            arguments.append(value)
    if len(arguments) != len(node.arguments):
        return None
    result: Expression | None = Call(function, tuple(arguments), function.result, node.span)
    for done, number in reversed(changed):
        if done is None or result is None:
            return None
        others = [*arguments[:number], *arguments[number + 1 :]]
        result = in_turn(done, arguments[number], result, others, node.span, context)
    return result


def _called(node: ast.Expression, scope: Scope, context: Context) -> Symbol | None:
    if isinstance(node, ast.MemberExpression):
        process = select_process(node.base, scope, context, _constant_argument)
        return None if process is None else select_member(process, node.name, context)
    if not isinstance(node, ast.NameExpression):
        context.error("E0208", node.span, "only a function can be called")
        return None
    symbol = scope.lookup(node.name)
    if symbol is None:
        builtin = BUILTIN_FUNCTIONS.get(node.name)
        if node.name == RANDOM_TRI.name and context.keeps_doubles:
            builtin = RANDOM_TRI
        if builtin is not None:
            context.record_function(builtin)
            return FunctionSymbol(builtin, node.span)
        if node.name in DYNAMIC_FUNCTIONS:
            context.error("E0750", node.span, f"`{node.name}` is not supported", DYNAMIC_HELP)
        elif node.name in FLOATING_FUNCTIONS:
            context.error("E0750", node.span, f"the function `{node.name}` on floating point numbers is not supported")
        else:
            context.error("E0201", node.span, f"unknown function `{node.name}`", _meant(node, scope, context))
    return symbol


def _meant(node: ast.NameExpression, scope: Scope, context: Context) -> str | None:
    """A help text for a function that is not known."""
    if node.name == "arrived":
        return "`arrived` is about recorded traces; of a model write `rise(P.location)`, or `change(x)` of a variable"
    from tachk.syntax.formulas.foreign_operators import operator_as_call  # only queries with mistakes need it

    operator = operator_as_call(node.name, node.span) if context.in_query else None
    return operator.help if operator is not None else scope.suggestion(node.name)


def _argument(
    function: Function, parameter: Variable, node: ast.Expression, scope: Scope, context: Context
) -> Expression | None:
    if parameter.reference and is_floating(parameter.type) and is_dropped(node, scope):
        refuse_reference(node, function.name, context)
        return None
    value = expression(node, scope, context)
    if value is None:
        return None
    what = f"parameter `{parameter.name}` of `{function.name}`"
    if parameter.reference:
        if not is_place(value):
            context.error(
                "E0317",
                node.span,
                f"{what} is passed by reference and needs a variable",
                "store the value in a variable first",
            )
            return None
        if parameter in context.effects[function].writes and not assignable(node, scope, context):
            return None
        fits = same_shape(parameter.type, value.type)
    else:
        fits = can_assign(parameter.type, value.type)
    if not fits:
        context.error("E0309", node.span, f"{what} needs {describe(parameter.type)}, not {describe(value.type)}")
        return None
    return value if parameter.reference else converted(value, parameter.type)
