"""Processes: templates with arguments, partial instantiation, free parameters, the system line."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from itertools import islice

from tachk.base.diagnostics.diagnostic import Label
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.records import dataclass, field, replace
from tachk.base.span import NOWHERE, Span
from tachk.frontend.context import Context
from tachk.frontend.declarations.channels import ChannelTable
from tachk.frontend.declarations.declarations import (
    Declared,
    argument_value,
    constant_symbol,
    keeps_names,
    widened,
)
from tachk.frontend.declarations.parameters import as_variables, changed_parameters, own_clock
from tachk.frontend.expressions.places import assignable, converted, is_place
from tachk.frontend.expressions.typed_expressions import expression, type_reader
from tachk.frontend.expressions.typing import can_assign, describe, is_bounded, is_data, same_shape
from tachk.frontend.findings import DiagnosticCollector, count, wrong_arguments
from tachk.frontend.scope import (
    BrokenSymbol,
    FamilySymbol,
    ProcessSymbol,
    Scope,
    Symbol,
    TemplateSymbol,
    ValueSymbol,
)
from tachk.frontend.templates.templates import elaborate_process
from tachk.model.expressions import Constant, Expression, Field, Index, Reference, Variable, VariableKind
from tachk.model.floating import HYBRID_DOUBLE, variable_type
from tachk.model.network import Process
from tachk.model.traversal import holds_hybrid_clock
from tachk.model.types import BoolType, ClockType, IntType, ScalarType, Type, VoidType, bounds, element_type
from tachk.model.variable_layout import default_values
from tachk.syntax import ast

MAXIMUM_INSTANCES = 2**16
"""Processes of one network; more is taken for a mistake."""

VALUE_CODES = frozenset({"E0601", "E0602", "E0603", "E0604", "E0606", "E0334", "W0401", "W0402", "W0403"})
"""Findings that depend on the values of parameters, which a template without instances does not have."""


@dataclass(slots=True)
class Instances:
    """The processes of a network as they are made.

    Attributes:
        globals: the global names, among them templates and instantiations.
        symbols: the names of processes and process families, for queries.
        used: the templates that some process is an instance of.
    """

    globals: Scope
    channels: ChannelTable
    context: Context
    processes: list[Process] = field(default_factory=list)
    symbols: dict[str, Symbol] = field(default_factory=dict)
    used: set[str] = field(default_factory=set)
    _changed: dict[str, tuple[ast.Parameter, ...]] = field(default_factory=dict, repr=False)

    # ---- the system line --------------------------------------------------------------------------------------------

    def run_system(self, line: ast.SystemLine) -> None:
        """Makes the processes that a system line names, in its order."""
        seen: dict[str, ast.Identifier] = {}
        for priority, group in enumerate(line.groups):
            for name in group:
                if name.name in seen:
                    self.context.findings.add(
                        "E0414",
                        name.span,
                        f"`{name.name}` is in the system line twice",
                        f"make a second process of it: `{self._free_name(name.name)} = {name.name}(...);`",
                        (Label(seen[name.name].span, "first here"),),
                    )
                    continue
                seen[name.name] = name
                self._run(name, priority)

    def _run(self, name: ast.Identifier, priority: int) -> None:
        symbol = self.globals.lookup(name.name)
        if isinstance(symbol, BrokenSymbol):
            return
        if not isinstance(symbol, TemplateSymbol):
            what = "unknown process or template" if symbol is None else f"not a process but a {symbol.description}:"
            self.context.error("E0206", name.span, f"{what} `{name.name}`", self._suggest(name.name))
            return
        node = symbol.template
        if not node.parameters:
            self._make(node, name.name, Scope(self.globals), Declared(name.name), (), name, priority)
            return
        instances: dict[tuple[int, ...], ProcessSymbol] = {}
        self.symbols[name.name] = FamilySymbol(instances, len(node.parameters), name.span)
        room = MAXIMUM_INSTANCES - len(self.processes)
        free = list(islice(self._free_values(node, (), Scope(self.globals), name.span), room + 1))
        if len(free) > room:
            self.context.error(
                "E0418",
                name.span,
                f"with the instances of `{name.name}` this model has more than {MAXIMUM_INSTANCES} processes",
                "give the free parameters smaller ranges",
            )
            return
        for values, bound in free:
            full = f"{name.name}({','.join(map(str, values))})"
            process = self._make(node, full, bound, Declared(full), values, name, priority)
            if process is not None:
                instances[values] = process
        if not instances:
            self.symbols[name.name] = BrokenSymbol(name.span)

    def _free_name(self, name: str) -> str:
        """A name for a process of a template that nothing has yet."""
        return next(made for n in itertools.count(1) if self.globals.lookup(made := f"{name}{n}") is None)

    def _suggest(self, name: str) -> str | None:
        known = [n for n, s in self.globals.symbols.items() if isinstance(s, TemplateSymbol)]
        return did_you_mean(name, known)

    def _free_values(
        self, node: ast.Template | ast.Instantiation, values: tuple[int, ...], bound: Scope, used_at: Span
    ) -> Iterator[tuple[tuple[int, ...], Scope]]:
        """The combinations of values of the parameters from number ``len(values)`` on, with their bindings."""
        if len(values) == len(node.parameters):
            yield values, bound
            return
        parameter = node.parameters[len(values)]
        reader = type_reader(bound, self.context)
        base = reader.type(parameter.type)
        type_ = None if base is None else reader.dimensions(base, parameter.dimensions)
        if type_ is None:
            return
        if parameter.reference or not is_bounded(type_) or isinstance(type_, BoolType):
            fresh = self._free_name(node.name.name)
            kind = "a reference" if parameter.reference else f"of type {describe(type_)}"
            self.context.findings.add(
                "E0413",
                used_at,
                f"parameter `{parameter.name.name}` of `{node.name.name}` needs an argument: it is {kind}",
                f"write `{fresh} = {node.name.name}(...);` and put `{fresh}` into the system line; "
                "only parameters with a bounded integer or scalar type may stay free",
                (Label(parameter.span, "the parameter"),),
            )
            return
        low, high = bounds(type_)
        if high - low >= MAXIMUM_INSTANCES:
            self.context.error(
                "E0418",
                used_at,
                f"`{node.name.name}` would have {high - low + 1} instances, more than {MAXIMUM_INSTANCES}",
                f"give `{parameter.name.name}` a smaller range",
            )
            return
        for value in range(low, high + 1):
            inner = Scope(self.globals, "", dict(bound.symbols))
            inner.declare(
                parameter.name,
                ValueSymbol(Constant(value, type_), False, "parameter", parameter.name.span),
                self.context.findings,
            )
            yield from self._free_values(node, (*values, value), inner, used_at)

    def _make(
        self,
        node: ast.Template | ast.Instantiation,
        name: str,
        bound: Scope,
        declared: Declared,
        values: tuple[int, ...],
        at: ast.Identifier,
        priority: int,
    ) -> ProcessSymbol | None:
        resolved = self._resolve(node, bound, declared)
        if resolved is None:
            if not values:
                self.symbols[name] = BrokenSymbol(at.span)
            return None
        template, parameters = resolved
        self.used.add(template.name.name)
        process, members = self._elaborate(template, name, parameters, declared)
        symbol = ProcessSymbol(len(self.processes), members, at.span)
        self.processes.append(replace(process, priority=priority))
        if not values:
            self.symbols[name] = symbol
        return symbol

    def _elaborate(
        self, template: ast.Template, name: str, parameters: Scope, declared: Declared
    ) -> tuple[Process, Scope]:
        changed = self._changed.get(template.name.name)
        if changed is None:
            changed = self._changed[template.name.name] = changed_parameters(template)
        parameters = as_variables(changed, parameters, declared, self.context)
        return elaborate_process(template, name, parameters, declared, self.channels, self.context)

    # ---- arguments --------------------------------------------------------------------------------------------------

    def _resolve(
        self, node: ast.Template | ast.Instantiation, bound: Scope, declared: Declared
    ) -> tuple[ast.Template, Scope] | None:
        """Follows a chain of instantiations to its template; the scope holds the template's parameters."""
        while isinstance(node, ast.Instantiation):
            self.used.add(node.name.name)
            target = self._template(node)
            if target is None:
                return None
            if len(target.parameters) != len(node.arguments):
                names = [parameter.span.text for parameter in target.parameters]
                self.context.findings.add(
                    "E0412",
                    node.span,
                    f"`{target.name.name}` takes {count(len(target.parameters), 'argument')}, "
                    f"not {len(node.arguments)}",
                    wrong_arguments(names, len(node.arguments)),
                    (Label(target.name.span, "declared here"),),
                )
                return None
            inner = Scope(self.globals)
            for parameter, argument in zip(target.parameters, node.arguments, strict=True):
                symbol = self._bind(parameter, argument, bound, inner, declared)
                inner.declare(parameter.name, symbol or BrokenSymbol(parameter.name.span), self.context.findings)
            node, bound = target, inner
        return node, bound

    def _template(self, node: ast.Instantiation) -> ast.Template | ast.Instantiation | None:
        symbol = self.globals.lookup(node.template.name)
        if isinstance(symbol, TemplateSymbol):
            return symbol.template
        if not isinstance(symbol, BrokenSymbol):
            self.context.error(
                "E0206",
                node.template.span,
                f"unknown template `{node.template.name}`",
                self._suggest(node.template.name),
            )
        return None

    def _bind(
        self, parameter: ast.Parameter, argument: ast.Expression, outer: Scope, inner: Scope, declared: Declared
    ) -> Symbol | None:
        """The meaning of a parameter inside the template."""
        written = type_reader(inner, self.context).parameter(parameter)
        value = expression(argument, outer, self.context)
        if written is None or value is None:
            return None
        type_ = variable_type(written)
        name = parameter.name.name
        constant = "const" in parameter.type.prefixes
        if parameter.reference and (is_place(value) or not constant):
            return self._bind_reference(parameter, argument, type_, value, outer)
        if _is_clock(written) and not (constant or isinstance(value.type, ClockType) or holds_hybrid_clock(value)):
            return own_clock(parameter, written, value, declared, self.context)
        if not is_data(type_) or element_type(written) == HYBRID_DOUBLE:
            self.context.error(
                "E0315", parameter.span, f"a {describe(type_)} cannot be passed by value", "put `&` before its name"
            )
            return None
        if not can_assign(type_, value.type):
            self.context.error(
                "E0309", argument.span, f"parameter `{name}` needs {describe(type_)}, not {describe(value.type)}"
            )
            return None
        wide = widened(type_)
        if keeps_names(value, wide, self.context):
            return ValueSymbol(converted(value, wide), False, "parameter", parameter.name.span)
        slots = argument_value(value, wide, f"the argument for `{name}`", self.context)
        if slots is None:
            return None
        return constant_symbol(name, wide, slots, "parameter", parameter.name, declared, self.context)

    def _bind_reference(
        self, parameter: ast.Parameter, argument: ast.Expression, type_: Type, value: Expression, outer: Scope
    ) -> Symbol | None:
        name = parameter.name.name
        constant = "const" in parameter.type.prefixes
        if not is_place(value) or isinstance(type_, VoidType):
            if isinstance(value, Constant) or not is_place(value):
                self.context.error(
                    "E0317", argument.span, f"parameter `{name}` is passed by reference and needs a variable"
                )
            return None
        if not constant and not assignable(argument, outer, self.context):
            return None
        if not same_shape(type_, value.type):
            self.context.error(
                "E0309", argument.span, f"parameter `{name}` needs {describe(type_)}, not {describe(value.type)}"
            )
            return None
        fixed = self._fixed(value)
        return None if fixed is None else ValueSymbol(fixed, not constant, "parameter", parameter.name.span)

    def _fixed(self, place: Expression) -> Expression | None:
        """The place with its indices computed."""
        match place:
            case Index(base, number):
                inner = self._fixed(base)
                slots = self.context.constant_slots(number, "an index in an argument")
                if inner is None or slots is None:
                    return None
                return replace(place, base=inner, index=Constant(slots[0], number.type, number.span))
            case Field(base):
                inner = self._fixed(base)
                return None if inner is None else replace(place, base=inner)
            case Reference():
                return place
            case _:
                self.context.error("E0317", place.span, "an argument passed by reference must be a variable")
                return None

    # ---- templates without instance ---------------------------------------------------------------------------------

    def check_unused(self) -> None:
        """Checks the templates and instantiations that no process uses, with made-up arguments.

        Findings that depend on the arguments are left out, and unsupported constructs are only reported, as they are
        not part of the network.
        """
        own = DiagnosticCollector()
        context = replace(self.context, constants=set(self.context.constants), findings=own)
        checker = Instances(self.globals, ChannelTable(set()), context)
        for name, symbol in self.globals.symbols.items():
            if isinstance(symbol, TemplateSymbol) and symbol.template.name.name not in self.used:
                with context.findings.without(VALUE_CODES if symbol.template.parameters else frozenset()):
                    declared = Declared(name)
                    bound = Scope(self.globals)
                    for parameter in symbol.template.parameters:
                        bound.declare(parameter.name, checker._made_up(parameter, bound, declared), context.findings)
                    resolved = checker._resolve(symbol.template, bound, declared)
                    if resolved is not None and isinstance(symbol.template, ast.Template):
                        template, parameters = resolved
                        checker._elaborate(template, name, parameters, declared)
        for found in own.sorted():
            if found.is_unsupported:
                self.context.error("W0405", found.span, f"{found.message}, but no process uses it", found.help)
            else:
                self.context.findings.extend([found])

    def _made_up(self, parameter: ast.Parameter, bound: Scope, declared: Declared) -> Symbol:
        written = type_reader(bound, self.context).parameter(parameter)
        span = parameter.name.span
        if written is None or isinstance(written, VoidType):
            return BrokenSymbol(span)
        type_ = variable_type(written)
        if isinstance(type_, IntType | BoolType | ScalarType) and not parameter.reference:
            return ValueSymbol(Constant(default_values(type_)[0], type_), False, "parameter", span)
        hybrid = element_type(written) == HYBRID_DOUBLE
        variable = Variable(
            parameter.name.name, type_, VariableKind.LOCAL, default_values(type_), span=NOWHERE, is_hybrid=hybrid
        )
        constant = "const" in parameter.type.prefixes or not (parameter.reference or _is_clock(written))
        if constant and is_data(type_):
            self.context.constants.add(variable)
        declared.variables.append(variable)
        return ValueSymbol(Reference(variable), not constant, "parameter", span)


def _is_clock(written: Type) -> bool:
    return isinstance(written, ClockType) or written == HYBRID_DOUBLE
