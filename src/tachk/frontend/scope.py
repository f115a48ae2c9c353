"""Scopes: names and their meanings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from tachk.base.diagnostics.diagnostic import Diagnostic, Label
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.records import dataclass, field, replace
from tachk.base.span import NOWHERE, Span
from tachk.frontend.findings import DiagnosticCollector
from tachk.model.expressions import Constant, Expression, Function, Reference
from tachk.model.types import Type
from tachk.syntax import ast


@dataclass(frozen=True, slots=True)
class ValueSymbol:
    """A variable, constant, parameter, signal or bound variable.

    Attributes:
        expression: what the name stands for: a reference, a constant, or the argument of a template parameter.
        assignable: False for constants, ``const`` parameters and bound variables.
        description: for messages: "variable", "constant", "parameter", ...
    """

    expression: Expression
    assignable: bool
    description: str
    span: Span = NOWHERE

    def use(self, span: Span) -> Expression:
        """The expression with the place where the name is used."""
        match self.expression:
            case Reference(variable):
                return Reference(variable, span)
            case Constant(value, type_):
                return Constant(value, type_, span)
            case other:
                return replace(other, span=span)


@dataclass(frozen=True, slots=True)
class TypeSymbol:
    type: Type
    span: Span = NOWHERE
    description: str = "type"


@dataclass(frozen=True, slots=True)
class FunctionSymbol:
    """``function`` is None while its own body is being elaborated."""

    function: Function | None
    span: Span = NOWHERE
    description: str = "function"


@dataclass(frozen=True, slots=True)
class LocationSymbol:
    number: int
    span: Span = NOWHERE
    description: str = "location"


@dataclass(frozen=True, slots=True)
class TemplateSymbol:
    template: ast.Template | ast.Instantiation
    span: Span = NOWHERE
    description: str = "template"


@dataclass(frozen=True, slots=True)
class ProcessSymbol:
    """A process in queries, signals and properties; ``members`` holds its parameters, variables, functions and
    locations."""

    number: int
    members: Scope
    span: Span = NOWHERE
    description: str = "process"


@dataclass(frozen=True, slots=True)
class FamilySymbol:
    """The instances ``T(0)``, ``T(1)``, ... made by free parameters, by the values of the parameters."""

    instances: Mapping[tuple[int, ...], ProcessSymbol]
    parameters: int
    span: Span = NOWHERE
    description: str = "template"


@dataclass(frozen=True, slots=True)
class BrokenSymbol:
    """A name whose declaration has an error: using it is not a further error."""

    span: Span = NOWHERE
    description: str = "broken declaration"


@dataclass(frozen=True, slots=True)
class DroppedSymbol:
    """A variable or function that is left out of the network; see `tachk.frontend.dropped`.

    Attributes:
        reason: of a function, what in it is refused.
        text: of a text constant.
        shape: of a variable, its type, where every scalar in it counts as a floating point number.
    """

    span: Span
    description: str
    reason: Diagnostic | None = None
    text: str | None = None
    shape: Type | None = None


@dataclass(frozen=True, slots=True)
class EmptyTypeSymbol:
    """A type without values, which is an error only where it is used: ``diagnostics`` say what is wrong with it."""

    diagnostics: tuple[Diagnostic, ...]
    span: Span = NOWHERE
    description: str = "type without values"


Symbol = (
    ValueSymbol
    | TypeSymbol
    | FunctionSymbol
    | LocationSymbol
    | TemplateSymbol
    | ProcessSymbol
    | FamilySymbol
    | BrokenSymbol
    | DroppedSymbol
    | EmptyTypeSymbol
)


@dataclass(slots=True)
class Scope:
    """Names declared at one level; what is not found here is looked up in the enclosing level.

    Attributes:
        label: what the names of this level belong to, for messages: "the globals", "template `Train`".
        below: every name that some declaration of this level introduces, even one that was not reached yet.
    """

    parent: Scope | None = None
    label: str = ""
    symbols: dict[str, Symbol] = field(default_factory=dict)
    below: frozenset[str] = frozenset()

    def lookup(self, name: str) -> Symbol | None:
        scope: Scope | None = self
        while scope is not None:
            symbol = scope.symbols.get(name)
            if symbol is not None:
                return symbol
            scope = scope.parent
        return None

    def declare(self, name: ast.Identifier, symbol: Symbol, findings: DiagnosticCollector) -> None:
        """Adds a name; a second declaration at the same level is a finding, and the first one stays."""
        first = self.symbols.get(name.name)
        if first is None:
            self.symbols[name.name] = symbol
            return
        if isinstance(first, BrokenSymbol) and first.span == name.span:
            self.symbols[name.name] = symbol
            return
        findings.add(
            "E0202",
            name.span,
            f"`{name.name}` is declared twice",
            "rename one of them",
            (Label(first.span, f"first declared here as a {first.description}"),),
        )

    def names(self) -> Iterator[str]:
        """Every visible name, innermost level first."""
        scope: Scope | None = self
        while scope is not None:
            yield from scope.symbols
            scope = scope.parent

    def suggestion(self, name: str) -> str | None:
        """A help text for a name that is not known."""
        return self.declared_below(name) or did_you_mean(name, self.names())

    def declared_below(self, name: str) -> str | None:
        """A help text for a name whose declaration comes too late."""
        scope: Scope | None = self
        while scope is not None:
            if name in scope.below:
                return "it is declared further down: move the declaration above its first use"
            scope = scope.parent
        return None
