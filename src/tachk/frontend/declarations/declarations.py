"""Declarations of variables, clocks, channels and constants, global and local."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from tachk.base.operators import CONSTANT_HIGH
from tachk.base.records import dataclass, field, replace
from tachk.frontend.context import Context
from tachk.frontend.dropped import (
    FLOATING_CONSTANT,
    FLOATING_VARIABLE,
    HYBRID_CLOCK,
    declare_dropped,
    declare_foreign_functions,
    dropped_kind,
    dropped_variable,
)
from tachk.frontend.expressions.initialisers import initialiser
from tachk.frontend.expressions.places import converted
from tachk.frontend.expressions.typed_expressions import expression, type_reader
from tachk.frontend.expressions.typing import WIDE, describe, is_data, is_integral
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.open_constants import OpenConstants
from tachk.frontend.priority_interpretations import FIRST, says_default
from tachk.frontend.scope import BrokenSymbol, Scope, Symbol, ValueSymbol
from tachk.model.expressions import Constant, Expression, Index, Reference, Variable, VariableKind
from tachk.model.floating import DOUBLE, HYBRID_DOUBLE, contains_double, is_floating, number_of, variable_type
from tachk.model.floating_calls import NAMED_OPERATIONS, RANDOM_TRI, floating_constant
from tachk.model.traversal import called_functions
from tachk.model.types import (
    ArrayType,
    BoolType,
    ChannelType,
    ClockType,
    IntType,
    RecordType,
    ScalarType,
    Type,
    VoidType,
    element_type,
    leaves,
    slot_count,
)
from tachk.model.variable_layout import default_values, slot_bounds
from tachk.syntax import ast
from tachk.syntax.walk import nodes_of_kind


@dataclass(slots=True)
class Declared:
    """The declarations of a level.

    Attributes:
        owner: the name of the process, or "" for the globals.
        overrides: values of global constants given from outside, by name.
        variables: what becomes part of the network, in order.
        constants: the integer constants with their values.
    """

    owner: str = ""
    overrides: Mapping[str, ast.Expression] = field(default_factory=dict)
    variables: list[Variable] = field(default_factory=list)
    constants: list[tuple[str, int]] = field(default_factory=list)

    @property
    def kind(self) -> VariableKind:
        return VariableKind.LOCAL if self.owner else VariableKind.GLOBAL

    def full_name(self, name: str) -> str:
        return f"{self.owner}.{name}" if self.owner else name


def declare(
    items: Iterable[ast.Declaration], scope: Scope, declared: Declared, context: Context
) -> list[ast.ChannelPriorityDeclaration]:
    """Elaborates declarations in order; returns the channel priorities for later."""
    priorities = []
    for item in items:
        match item:
            case ast.VariableDeclaration():
                _declare_variables(item, scope, declared, context)
            case ast.TypedefDeclaration():
                from tachk.frontend.declarations.functions import declare_types

                declare_types(item, scope, context)
            case ast.FunctionDeclaration():
                from tachk.frontend.declarations.functions import declare_function

                declare_function(item, scope, context)
            case ast.ChannelPriorityDeclaration(span):
                if declared.owner:
                    context.error("E0405", span, "channel priorities are global", "move this line out of the template")
                else:
                    priorities.append(item)
            case ast.UpdateHook(span, kind):
                context.error("E0750", span, f"`{kind}` is not supported", "add the updates to the edges")
            case ast.ForeignImport():
                declare_foreign_functions(item, scope, context)
            case ast.SignalDeclaration(name=name):
                # Global signals are elaborated after the processes, which they may mention.
                context.error("E0502", name.span, "a signal is global", "move this line out of the template")
            case ast.DynamicTemplate():
                pass  # refused when the file was loaded
    return priorities


def _declare_variables(node: ast.VariableDeclaration, scope: Scope, declared: Declared, context: Context) -> None:
    left_out = None if node.type is None else dropped_kind(node.type)
    if left_out is not None and not (left_out in (FLOATING_VARIABLE, HYBRID_CLOCK) and context.keeps_doubles):
        if left_out != FLOATING_CONSTANT or not _declare_floating_constant(node, scope, declared, context):
            declare_dropped(node, left_out, _shapes(node, scope, context), scope, context)
        return
    _declare_each(node, scope, declared, context)


def _shapes(node: ast.VariableDeclaration, scope: Scope, context: Context) -> list[Type | None]:
    """The types of the parts of dropped variables; None where they are unknown."""
    reader = type_reader(scope, replace(context, findings=DiagnosticCollector()))
    return [reader.dimensions(DOUBLE, declarator.dimensions) for declarator in node.declarators]


def _declare_floating_constant(
    node: ast.VariableDeclaration, scope: Scope, declared: Declared, context: Context
) -> bool:
    """Declares constants, unless something that is refused is all that is wrong with them."""
    found, own = context.findings, DiagnosticCollector()
    context.findings = own
    try:
        _declare_each(node, scope, declared, context)
    finally:
        context.findings = found
    if not own.has_mistakes and any(diagnostic.is_unsupported for diagnostic in own.sorted()):
        return False
    found.extend(own.sorted())
    return True


def _declare_each(node: ast.VariableDeclaration, scope: Scope, declared: Declared, context: Context) -> None:
    reader = type_reader(scope, context)
    constant = node.type is None or "const" in node.type.prefixes
    base: Type | None = IntType() if node.type is None else reader.declared(node.type)
    for declarator in node.declarators:
        written: Type | None = HYBRID_DOUBLE if reader.is_used_as_hybrid(base, declarator.name.name) else base
        hybrid = written is not None and element_type(written) == HYBRID_DOUBLE
        type_ = None if written is None else reader.dimensions(variable_type(written), declarator.dimensions)
        symbol: Symbol | None = None
        if type_ is not None:
            if constant:
                symbol = _constant(declarator, type_, scope, declared, context)
            else:
                meta = node.type is not None and "meta" in node.type.prefixes
                symbol = _variable(declarator, type_, meta, hybrid, scope, declared, context)
        scope.declare(declarator.name, symbol or BrokenSymbol(declarator.name.span), context.findings)


def _variable(
    node: ast.Declarator, type_: Type, meta: bool, hybrid: bool, scope: Scope, declared: Declared, context: Context
) -> Symbol | None:
    name = node.name.name
    if isinstance(type_, VoidType):
        context.error("E0315", node.span, "a variable cannot be void")
        return None
    if meta and not is_data(type_):
        context.error("E0315", node.span, f"a {describe(type_)} cannot be meta")
        meta = False
    if is_floating(type_) and not context.keeps_doubles:
        return dropped_variable(node.name, FLOATING_VARIABLE, type_, context)
    if contains_double(type_) and not context.keeps_doubles:
        context.error(
            "E0750",
            node.span,
            f"a variable of type {describe(type_)} that lasts is not supported",
            "compute with `double` inside functions, and keep integers, scaled if need be",
        )
        return None
    if not context.allow_variable(type_, node.span):
        return None
    initial = _Initial(default_values(type_))
    if node.initialiser is not None:
        if _has_channel(type_):
            context.error("E0318", node.initialiser.span, "a channel has no value")
            return None
        found = _initial(node.initialiser, type_, meta, f"the initial value of `{name}`", scope, context)
        if found is None:
            return None
        initial = found
    variable = Variable(
        declared.full_name(name),
        type_,
        declared.kind,
        initial.slots,
        declared_meta=meta,
        span=node.name.span,
        is_hybrid=hybrid,
        drawn=initial.drawn,
    )
    declared.variables.append(variable)
    if isinstance(type_, ClockType):
        description = "clock"
    else:
        description = "channel" if _has_channel(type_) else "variable"
    return ValueSymbol(Reference(variable), True, description, node.name.span)


def _has_channel(type_: Type) -> bool:
    return isinstance(element_type(type_), ChannelType)


@dataclass(frozen=True, slots=True)
class _Initial:
    """An initial value: known, or drawn for each run."""

    slots: tuple[int, ...]
    drawn: Expression | None = None


def _initial(
    node: ast.Expression, type_: Type, meta: bool, what: str, scope: Scope, context: Context
) -> _Initial | None:
    if not context.keeps_doubles and _draws(node, scope):
        help_ = "`tachk simulate` and `tachk estimate` draw them anew for each run"
        context.error("E0750", node.span, "random initial values are for simulations only", help_)
        return None
    value = initialiser(node, type_, scope, context)
    if value is None:
        return None
    if any(function.operation and function.operation.draws for function in called_functions([value])):
        if meta:
            context.error("E0750", node.span, f"{what} is random, which no meta variable can be")
            return None
        return _Initial(default_values(type_), value)
    slots = checked_slots(value, type_, what, context)
    return None if slots is None else _Initial(slots)


def _draws(node: ast.Expression, scope: Scope) -> bool:
    """True if an expression calls a function of UPPAAL's that draws random numbers."""
    called = (call.function for call in nodes_of_kind(node, ast.CallExpression))
    names = {function.name for function in called if isinstance(function, ast.NameExpression)}
    drawing = {name for name, operation in NAMED_OPERATIONS.items() if operation.draws} | {RANDOM_TRI.name}
    return any(scope.lookup(name) is None for name in names & drawing)


def checked_slots(value: Expression, type_: Type, what: str, context: Context) -> tuple[int, ...] | None:
    """The slots of a constant of the given type, checked against its ranges."""
    slots = context.constant_slots(value, what)
    if slots is None:
        return slots
    for (path, leaf), slot in zip(leaves(type_), slots, strict=True):
        low, high = (0, CONSTANT_HIGH) if isinstance(leaf, ClockType) else slot_bounds(leaf)
        if not low <= slot <= high:
            at = f" at {path}" if path else ""
            context.error(
                "E0603",
                value.span,
                f"{what}{at} is {slot}, outside the range [{low}, {high}]",
                "change the value or the declared range",
            )
            return None
    return slots


def widened(type_: Type) -> Type:
    """The type with plain ``int`` replaced by the full 32 bits, which constants may use."""
    match type_:
        case IntType():
            return WIDE if type_ == IntType() else type_
        case ArrayType(element, index):
            return ArrayType(widened(element), index)
        case RecordType(_, fields):
            return replace(type_, fields=tuple((f, widened(t)) for f, t in fields))
        case BoolType() | ScalarType() | ClockType() | ChannelType() | VoidType():
            return type_


def _constant(node: ast.Declarator, type_: Type, scope: Scope, declared: Declared, context: Context) -> Symbol | None:
    name = node.name.name
    if not is_data(type_):
        context.error("E0315", node.span, f"a {describe(type_)} cannot be const")
        return None
    override = None if declared.owner else declared.overrides.get(name)
    if override is not None:
        if not is_integral(type_):
            context.error(
                "E0608",
                override.span,
                f"`{name}` is a {describe(type_)}; only boolean and integer constants can be set from outside",
            )
            return None
    given = node.initialiser if override is None else override
    if given is None:
        context.error("E0607", node.name.span, f"constant `{name}` needs a value")
        return None
    wide = widened(type_)
    value = initialiser(given, wide, scope, context)
    if value is None:
        return None
    opened = not declared.owner and name in context.open_constants.names
    is_named = opened or keeps_names(value, wide, context)
    slots = checked_slots(value, wide, f"the value of `{name}`", _noting_nothing(context) if is_named else context)
    if slots is None:
        return None
    if is_integral(type_) and not declared.owner:
        declared.constants.append((name, slots[0]))
    if opened:
        return _open_constant(node.name, wide, slots, declared, context)
    if is_named:
        return ValueSymbol(value, False, "constant", node.name.span)
    return constant_symbol(name, wide, slots, "constant", node.name, declared, context)


def _open_constant(
    name: ast.Identifier, type_: Type, slots: tuple[int, ...], declared: Declared, context: Context
) -> ValueSymbol:
    values = context.open_constants.ranges.get(name.name)
    of_values = type_ if values is None or not isinstance(type_, IntType) else IntType(*values)
    variable = Variable(name.name, of_values, declared.kind, slots, span=name.span)
    declared.variables.append(variable)
    context.constants.add(variable)
    context.open_constants.variables[name.name] = variable
    return ValueSymbol(Reference(variable), False, "constant", name.span)


def keeps_names(value: Expression, type_: Type, context: Context) -> bool:
    """True if a constant with this value stands for an expression of open constants.

    One with a range does not, for its range has to be checked.
    """
    if type_ != WIDE and not isinstance(type_, BoolType):
        return False
    return bool(context.open_constants.among(context.effects_of([value]).reads))


def _noting_nothing(context: Context) -> Context:
    return replace(context, open_constants=OpenConstants())


def constant_symbol(
    name: str,
    type_: Type,
    slots: tuple[int, ...],
    description: str,
    identifier: ast.Identifier,
    declared: Declared,
    context: Context,
) -> ValueSymbol:
    """The meaning of a constant: its value, or for arrays and structs a variable that nothing changes."""
    if is_integral(type_) or isinstance(type_, ScalarType):
        return ValueSymbol(Constant(slots[0], type_), False, description, identifier.span)
    if type_ == DOUBLE:
        return ValueSymbol(floating_constant(number_of(slots)), False, description, identifier.span)
    variable = Variable(declared.full_name(name), type_, declared.kind, slots, span=identifier.span)
    declared.variables.append(variable)
    context.constants.add(variable)
    return ValueSymbol(Reference(variable), False, description, identifier.span)


# ---- channel priorities ---------------------------------------------------------------------------------------------


def set_channel_priorities(
    nodes: list[ast.ChannelPriorityDeclaration], scope: Scope, declared: Declared, context: Context
) -> int:
    """Gives the global channels their priorities, in place; returns the default priority."""
    if not nodes:
        return 0
    for extra in nodes[1:]:
        context.error("E0405", extra.span, "channel priorities are declared twice", "join the two declarations")
    node = nodes[0]
    default = 0
    slots: dict[Variable, dict[int, int]] = {}
    for level, group in enumerate(node.groups, start=0 if says_default(node) else 1):
        for channel in group:
            if isinstance(channel, ast.NameExpression) and channel.name == "default":
                default = level
                continue
            value = expression(channel, scope, context)
            if value is None:
                continue
            found = _channel_slots(value, context)
            if found is None:
                context.error("E0405", channel.span, "a priority needs a global channel", None)
                continue
            variable, positions = found
            for position in positions:
                if position in slots.setdefault(variable, {}):
                    context.error("E0405", channel.span, f"`{channel.span.text}` already has a priority")
                slots[variable][position] = level
    if not says_default(node):
        context.findings.add(
            "W0409",
            node.span,
            "`default` is missing: UPPAAL's manual does not say what priority internal edges then have",
            f"tachk tries every place; if answers differ, `default` is {FIRST}; write `default` to choose a place",
        )
    for position, variable in enumerate(declared.variables):
        if variable in slots:
            count = len(variable.initial)
            levels = tuple(slots[variable].get(i, default) for i in range(count))
            declared.variables[position] = _replace_variable(variable, levels, scope)
    return default


def _channel_slots(value: Expression, context: Context) -> tuple[Variable, range] | None:
    """The channel variable and the slots of it that an expression with constant indices denotes."""
    offset = 0
    current = value
    while isinstance(current, Index):
        base = current.base.type
        if not isinstance(base, ArrayType):
            return None
        number = context.constant_slots(current.index, "the index of a channel with a priority")
        if number is None or not 0 <= number[0] - base.low < base.size:
            return None
        offset += (number[0] - base.low) * slot_count(base.element)
        current = current.base
    if not isinstance(current, Reference) or not _has_channel(current.type):
        return None
    return current.variable, range(offset, offset + slot_count(value.type))


def _replace_variable(variable: Variable, priorities: tuple[int, ...], scope: Scope) -> Variable:
    changed = replace(variable, priorities=priorities)
    symbol = scope.symbols[variable.name]
    assert isinstance(symbol, ValueSymbol)
    scope.symbols[variable.name] = replace(symbol, expression=Reference(changed))
    return changed


def argument_value(value: Expression, type_: Type, what: str, context: Context) -> tuple[int, ...] | None:
    """The slots of a compile-time argument."""
    return checked_slots(converted(value, type_), type_, what, context)
