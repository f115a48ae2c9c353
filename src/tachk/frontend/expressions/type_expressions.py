"""From written types to `tachk.model.types`."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.records import dataclass
from tachk.base.span import Span
from tachk.frontend.context import Context
from tachk.frontend.expressions.builtin_names import BUILTIN_TYPES, FOREIGN_TYPES
from tachk.frontend.expressions.typing import describe, is_bounded
from tachk.frontend.scope import BrokenSymbol, EmptyTypeSymbol, Scope, TypeSymbol
from tachk.model.floating import DOUBLE, HYBRID_DOUBLE, is_floating, variable_type
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
    nesting,
    slot_count,
)
from tachk.syntax import ast

MAXIMUM_SLOTS = 2**20
"""Slots of one variable; more is taken for a mistake rather than allocated."""

MAXIMUM_NESTING = 50
"""Arrays and structs within one another, so that recursive passes over types need no stack of their own."""

ConstantInteger = Callable[[ast.Expression, str], int | None]
"""Evaluates an expression that must be a constant integer; the text is the beginning of the message."""


@dataclass(frozen=True, slots=True)
class TypeReader:
    """Resolves types in a scope."""

    scope: Scope
    context: Context
    constant: ConstantInteger

    def type(self, node: ast.TypeExpression, name: str = "") -> Type | None:
        """The type of expressions, its ``const`` and ``meta`` prefixes aside; None after a report. ``name`` names a
        struct or scalar set that a typedef declares."""
        declared = self.declared(node, name)
        return None if declared is None else variable_type(declared)

    def declared(self, node: ast.TypeExpression, name: str = "") -> Type | None:
        """The same as it is written, other for hybrid clocks than for floating point numbers."""
        base = self._base(node.base, name)
        if base is None:
            return None
        if "hybrid" in node.prefixes:
            if isinstance(base, ClockType) and self.context.keeps_doubles:
                return HYBRID_DOUBLE
            self._unsupported(node.span, "hybrid clocks", "declare a plain `clock`")
            return None
        channel = {p for p in node.prefixes if p in ("urgent", "broadcast")}
        if channel:
            return self._channel(base, channel, node.span)
        return base

    def parameter(self, node: ast.Parameter) -> Type | None:
        """The type of a parameter, other for hybrid clocks than for floating point numbers; None after a report."""
        base = self.declared(node.type)
        if base is None:
            return None
        if self.is_used_as_hybrid(base, node.name.name):
            base = HYBRID_DOUBLE
        return self.dimensions(base, node.dimensions)

    def _channel(self, base: Type, prefixes: set[str], span: Span) -> Type | None:
        if isinstance(base, ArrayType):
            element = self._channel(base.element, prefixes, span)
            return None if element is None else ArrayType(element, base.index)
        if not isinstance(base, ChannelType):
            self.context.error("E0315", span, f"only channels can be {' and '.join(sorted(prefixes))}")
            return None
        return ChannelType(base.broadcast or "broadcast" in prefixes, base.urgent or "urgent" in prefixes)

    def _unsupported(self, span: Span, what: str, help: str | None = None) -> None:
        self.context.error("E0750", span, f"{what} are not supported", help)

    def _base(
        self,
        node: ast.BuiltinType | ast.RangeType | ast.ScalarSetType | ast.StructType | ast.NamedType,
        name: str,
    ) -> Type | None:
        match node:
            case ast.BuiltinType():
                return self._builtin(node)
            case ast.RangeType():
                low = self.constant(node.low, "the bound of a range")
                high = self.constant(node.high, "the bound of a range")
                if low is None or high is None:
                    return None
                if low > high:
                    self.context.error("E0604", node.span, f"the range [{low}, {high}] is empty")
                    return None
                return IntType(low, high)
            case ast.ScalarSetType():
                size = self.constant(node.size, "the size of a scalar set")
                if size is None:
                    return None
                if size < 1:
                    self.context.error("E0604", node.span, f"a scalar set needs at least one value, not {size}")
                    return None
                self.context.scalar_sets += 1
                return ScalarType(name or f"scalar[{size}]#{self.context.scalar_sets}", size)
            case ast.StructType():
                return self._record(node, name)
            case ast.NamedType():
                return self._named(node)

    def _builtin(self, node: ast.BuiltinType) -> Type | None:
        match node.name:
            case "int":
                return IntType()
            case "bool":
                return BoolType()
            case "clock":
                return ClockType()
            case "chan":
                return ChannelType()
            case "void":
                return VoidType()
            case "double":
                return DOUBLE
            case _:
                self._unsupported(node.span, f"variables of type `{node.name}`")
        return None

    def _named(self, node: ast.NamedType) -> Type | None:
        symbol = self.scope.lookup(node.name)
        match symbol:
            case TypeSymbol(type_):
                return type_
            case BrokenSymbol():
                return None
            case EmptyTypeSymbol(diagnostics):
                self.context.findings.extend(diagnostics)
            case None:
                if node.name in BUILTIN_TYPES:
                    return BUILTIN_TYPES[node.name]
                types = [n for n in self.scope.names() if isinstance(self.scope.lookup(n), TypeSymbol)]
                meant = FOREIGN_TYPES.get(node.name)
                help_ = f"write {meant}" if meant else self.scope.declared_below(node.name)
                help_ = help_ or did_you_mean(node.name, [*types, "int", "bool", "clock", "chan", "system"])
                self.context.error("E0204", node.span, f"unknown type `{node.name}`", help_)
            case _:
                self.context.error("E0203", node.span, f"`{node.name}` is a {symbol.description}, not a type")
        return None

    def _record(self, node: ast.StructType, name: str) -> Type | None:
        fields: list[tuple[ast.Identifier, Type]] = []
        seen: set[str] = set()
        broken = False
        for declaration in node.fields:
            if declaration.type is None:
                continue
            base = self.declared(declaration.type)
            for declarator in declaration.declarators:
                if declarator.name.name in seen:
                    self.context.error("E0202", declarator.name.span, f"field `{declarator.name.name}` twice")
                seen.add(declarator.name.name)
                if declarator.initialiser is not None:
                    self.context.error(
                        "E0315",
                        declarator.initialiser.span,
                        "a field of a struct cannot have an initialiser",
                        "initialise the variables of this type instead",
                    )
                element = HYBRID_DOUBLE if self.is_used_as_hybrid(base, declarator.name.name) else base
                type_ = None if element is None else self.dimensions(element, declarator.dimensions)
                if isinstance(type_, ChannelType | VoidType):
                    self.context.error("E0315", declarator.span, f"a struct cannot have a {describe(type_)} field")
                    type_ = None
                if type_ is None:
                    broken = True
                else:
                    fields.append((declarator.name, type_))
        if broken:
            return None
        if id(node) in self.context.lasting_structs:
            return self._small(self._without_floating_fields(name, fields), node.span, "a struct")
        whole = RecordType(name, tuple((field.name, type_) for field, type_ in fields))
        return self._small(whole, node.span, "a struct")

    def _without_floating_fields(self, name: str, fields: Sequence[tuple[ast.Identifier, Type]]) -> RecordType:
        """A struct without its floating point fields. One that has nothing else keeps them: its variables are left out
        as a whole."""
        if all(is_floating(type_) for _, type_ in fields):
            return RecordType(name, tuple((field.name, type_) for field, type_ in fields))
        supported, left_out = [], []
        for place, (field, type_) in enumerate(fields):
            if not is_floating(type_):
                supported.append((field.name, type_))
                continue
            left_out.append((place, field.name, type_))
            self.context.error(
                "W0406",
                field.span,
                f"tachk does not check the floating point field `{field.name}`",
                "assignments to it are left out; anything that reads it is refused",
            )
        return RecordType(name, tuple(supported), tuple(left_out))

    def is_used_as_hybrid(self, base: Type | None, name: str) -> bool:
        """True if what a type declares with a name is a plain clock that a simulation takes for a hybrid one."""
        context = self.context
        return isinstance(base, ClockType) and context.keeps_doubles and name in context.hybrid_clocks

    def dimensions(self, element: Type, dimensions: tuple[ast.Expression | ast.TypeExpression, ...]) -> Type | None:
        """The type of an array with the given dimensions; the element's type where there are none."""
        type_ = element
        if dimensions and isinstance(element, VoidType):
            self.context.error("E0315", dimensions[0].span, "an array of void")
            return None
        for dimension in reversed(dimensions):
            index = self._index(dimension)
            if index is None:
                return None
            array = self._small(ArrayType(type_, index), dimension.span, "an array")
            if array is None:
                return None
            type_ = array
        return type_

    def _small(self, type_: ArrayType | RecordType, span: Span, what: str) -> Type | None:
        """The type, if what looks at every part of it can do so."""
        if nesting(type_) > MAXIMUM_NESTING:
            self.context.error(
                "E0606", span, f"arrays and structs are nested more than {MAXIMUM_NESTING} levels deep", "flatten them"
            )
            return None
        if slot_count(type_) > MAXIMUM_SLOTS:
            self.context.error(
                "E0606",
                span,
                f"{what} of {slot_count(type_)} values is too large",
                f"a variable has at most {MAXIMUM_SLOTS} values; declare a smaller one",
            )
            return None
        return type_

    def _index(self, dimension: ast.Expression | ast.TypeExpression) -> IntType | ScalarType | None:
        written: ast.TypeExpression | None = None
        if isinstance(dimension, ast.TypeExpression):
            written = dimension
        elif isinstance(dimension, ast.NameExpression) and (
            isinstance(self.scope.lookup(dimension.name), TypeSymbol)
            or (self.scope.lookup(dimension.name) is None and dimension.name in BUILTIN_TYPES)
        ):
            written = ast.TypeExpression(dimension.span, (), ast.NamedType(dimension.span, dimension.name))
        if written is not None:
            index = self.type(written)
            if index is None:
                return None
            if not is_bounded(index):
                self.context.error(
                    "E0315",
                    written.span,
                    f"an array cannot be indexed by {describe(index)}",
                    "use a size, a bounded integer type or a scalar type",
                )
                return None
            return IntType(0, 1) if isinstance(index, BoolType) else index
        size = self.constant(dimension, "the size of an array")  # type: ignore[arg-type]
        if size is None:
            return None
        if size < 1:
            self.context.error("E0604", dimension.span, f"an array needs at least one element, not {size}")
            return None
        return IntType(0, size - 1)

    def bounded(self, node: ast.TypeExpression, what: str) -> IntType | BoolType | ScalarType | None:
        """The type of a select, quantifier or iteration variable; ``what`` names that for messages."""
        type_ = self.type(node)
        if type_ is None:
            return None
        if not is_bounded(type_):
            self.context.error(
                "E0316",
                node.span,
                f"{what} needs a bounded type, not {describe(type_)}",
                "use a range such as `int[0,3]`, a scalar type, or a typedef of one",
            )
            return None
        return type_
