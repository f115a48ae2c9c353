"""Queries, properties and signals."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, TypeGuard

from tachk.base.diagnostics.diagnostic import Diagnostic, Label
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, replace
from tachk.base.span import NOWHERE, Span
from tachk.base.words import QueryKind
from tachk.frontend.context import Context
from tachk.frontend.expressions.typed_expressions import condition, expression, integral
from tachk.frontend.expressions.typing import describe, is_integral
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.queries.expectations import expectation_clause
from tachk.frontend.scope import BrokenSymbol, Scope, Symbol, ValueSymbol
from tachk.model.expressions import Binary, Constant, Deadlock, Expression, Unary
from tachk.model.network import Signal
from tachk.model.query import Expectation, Query, QueryDeadline
from tachk.model.traversal import asks_deadlock, compares_clocks, walk
from tachk.model.types import ClockType, ScalarType
from tachk.syntax import ast

if TYPE_CHECKING:
    from tachk.syntax.query_files import BrokenQuery


@dataclass(frozen=True, slots=True)
class UncheckedQuery:
    """A query that is not checked: it belongs to another kind of analysis, it needs a construct that is refused, or it
    is wrong and stands where it must not keep others from being checked. It is listed, never silently dropped.

    Attributes:
        family: ``statistical``, ``game``, ``learning`` or ``scenario``; else empty.
        diagnostics: what is refused, or wrong with it.
    """

    name: str
    text: str
    family: str
    title: str = ""
    expectation: Expectation | None = None
    span: Span = NOWHERE
    diagnostics: tuple[Diagnostic, ...] = ()

    @property
    def is_wrong(self) -> bool:
        """True if the query has a mistake, other than naming what is refused."""
        return any(not diagnostic.is_unsupported for diagnostic in self.diagnostics)


def is_statistical(query: object) -> TypeGuard[UncheckedQuery]:
    """True if the query is one that `tachk.frontend.queries.statistical` reads."""
    return isinstance(query, UncheckedQuery) and query.family == "statistical"


def elaborate_query(
    formula: ast.QueryFormula | ast.TemporalFormula | ast.ScenarioFormula,
    name: str,
    scope: Scope,
    context: Context,
    title: str = "",
    expectation: ast.Expected | None = None,
) -> Query | None:
    """A query with its names resolved, in a scope that has the processes; None after a report."""
    expected = expectation_clause(expectation, scope, context)
    if isinstance(formula, ast.TemporalFormula):
        from tachk.frontend.queries.observer_processes import elaborate_temporal

        query = elaborate_temporal(formula, name, scope, context, title, expected.expectation)
        return None if query is None else replace(query, conditional=expected.conditional)
    if isinstance(formula, ast.ScenarioFormula):
        from tachk.frontend.queries.scenarios import elaborate_scenario

        scenario = elaborate_scenario(formula, name, scope, context, title, expected.expectation)
        return None if scenario is None else replace(scenario, conditional=expected.conditional)
    context = replace(context, in_query=True)
    kind = formula.kind
    predicate: Expression | None = None
    broken = False
    if formula.predicate is not None:
        predicate = _predicate(formula.predicate, scope, context)
        broken = predicate is None
    operands = []
    for operand in formula.operands:
        value = (_predicate if kind is QueryKind.LEADS_TO else _measured)(operand, scope, context)
        if value is None:
            broken = True
        else:
            operands.append(value)
    deadline = None if formula.deadline is None else _deadline(formula.deadline, scope, context)
    if broken or (deadline is None and formula.deadline is not None):
        return None
    return Query(
        name,
        kind,
        predicate,
        tuple(operands),
        formula.span.text,
        title,
        expected.expectation,
        formula.span,
        conditional=expected.conditional,
        deadline=deadline,
    )


def _deadline(node: ast.Deadline, scope: Scope, context: Context) -> QueryDeadline | None:
    bound = integral(node.bound, scope, context)
    if bound is None:
        return None
    if context.open_constants.among(context.effects_of([bound]).reads):
        from tachk.frontend.queries.formula_durations import bound_value

        value = bound_value(node.bound, [True], "a deadline", scope, context)
        return None if value is None else QueryDeadline(value, node.strict)
    if not isinstance(bound, Constant):
        context.error("E0501", node.bound.span, "a deadline must be a constant", "name a `const int`")
        return None
    if not 0 <= bound.value < 2**30:
        context.error("E0605", node.bound.span, f"a deadline of {bound.value} is outside [0, 2^30)")
        return None
    return QueryDeadline(bound.value, node.strict)


def _predicate(node: ast.Expression, scope: Scope, context: Context) -> Expression | None:
    value = condition(node, scope, context)
    return value if value is not None and context.require_pure(value, "a query") else None


def _measured(node: ast.Expression, scope: Scope, context: Context) -> Expression | None:
    """An expression whose least or largest value a query is about: an integer, a clock or a difference of clocks."""
    value = expression(node, scope, context)
    if value is None or not context.require_pure(value, "a query"):
        return None
    if isinstance(value.type, ClockType):
        simple = not isinstance(value, Unary | Binary) or (
            isinstance(value, Binary)
            and value.operator is BinaryOperator.SUBTRACT
            and all(
                isinstance(side.type, ClockType) and not isinstance(side, Unary | Binary)
                for side in (value.left, value.right)
            )
        )
        if simple:
            return value
        context.error("E0503", node.span, "only a clock, a difference of two clocks or an integer can be measured")
        return None
    if not is_integral(value.type) or compares_clocks(value) or asks_deadlock(value):
        context.error(
            "E0503",
            node.span,
            "this has no least or largest value",
            "name a clock, a difference of two clocks or an integer expression; conditions go between the braces",
        )
        return None
    return value


def elaborate_signals(nodes: Iterable[ast.SignalDeclaration], scope: Scope, context: Context) -> tuple[Signal, ...]:
    """The signals; each is declared in the scope for those after it and for properties."""
    context = replace(context, in_query=True)
    signals = []
    for node in nodes:
        own = DiagnosticCollector()
        value = expression(node.expression, scope, replace(context, findings=own))
        # A property may wait for its process; a signal that cannot be observed would make the whole model wait.
        context.findings.extend(replace(d, code="E0206") if d.code == "E0733" else d for d in own.sorted())
        symbol: Symbol = BrokenSymbol(node.name.span)
        if value is not None and _is_observable(value, node, context):
            signals.append(Signal(node.name.name, value, node.name.span))
            symbol = ValueSymbol(value, False, "signal", node.name.span)
        above = scope.lookup(node.name.name)
        if above is not None and node.name.name not in scope.symbols:
            context.findings.add(
                "E0202",
                node.name.span,
                f"`{node.name.name}` is declared twice",
                "rename the signal",
                (Label(above.span, f"first declared here as a {above.description}"),),
            )
        scope.declare(node.name, symbol, context.findings)
    return tuple(signals)


def _is_observable(value: Expression, node: ast.SignalDeclaration, context: Context) -> bool:
    if not context.require_pure(value, "a signal"):
        return False
    deadlock = next((inner for inner in walk(value) if isinstance(inner, Deadlock)), None)
    if deadlock is not None:
        context.error("E0501", deadlock.span, "`deadlock` cannot be observed as a signal", "use it in a property")
        return False
    if is_integral(value.type) or isinstance(value.type, ScalarType | ClockType):
        return True
    context.error("E0502", node.expression.span, f"a {describe(value.type)} cannot be observed as a signal")
    return False


def elaborate_properties(
    nodes: Iterable[ast.PropertyDeclaration], scope: Scope, context: Context
) -> tuple[tuple[Query, ...], tuple[UncheckedQuery, ...]]:
    """The properties a model states. One that names a refused construct is unchecked; where the construct was reported
    at its declaration, without diagnostics."""
    queries, unchecked = [], []
    seen: dict[str, Span] = {}
    for node in nodes:
        name = node.name.name
        if name in seen:
            context.findings.add(
                "E0202",
                node.name.span,
                f"property `{name}` is declared twice",
                "rename one of them",
                (Label(seen[name], "first declared here"),),
            )
        seen.setdefault(name, node.name.span)
        if isinstance(node.formula, ast.UncheckedFormula):
            expected = expectation_clause(node.expectation, scope, context)
            unchecked.append(_unchecked(node.formula, name, node.title, expected.expectation))
            continue
        own = DiagnosticCollector()
        title = node.title or node.doc
        query = elaborate_query(node.formula, name, scope, replace(context, findings=own), title, node.expectation)
        if own.has_mistakes:
            context.findings.extend(own.sorted())
        elif query is None or own.has_errors:
            unchecked.append(wrong_query(name, node.formula.span.text, title, node.formula.span, own))
        else:
            context.findings.extend(own.sorted())
            queries.append(query)
    return tuple(queries), tuple(unchecked)


def elaborate_each(
    nodes: Iterable[ast.PropertyDeclaration], scope: Scope, context: Context
) -> tuple[tuple[Query, ...], tuple[UncheckedQuery, ...]]:
    """As `elaborate_properties`, but a property that is wrong is an unchecked query and no finding of the context."""
    queries: list[Query] = []
    unchecked: list[UncheckedQuery] = []
    for node in nodes:
        own = DiagnosticCollector()
        found, others = elaborate_properties([node], scope, replace(context, findings=own))
        if own.has_errors:
            title = node.title or node.doc
            unchecked.append(wrong_query(node.name.name, node.formula.span.text, title, node.formula.span, own))
        else:
            context.findings.extend(own.sorted())
            queries += found
            unchecked += others
    return tuple(queries), tuple(unchecked)


def wrong_query(name: str, text: str, title: str, span: Span, findings: DiagnosticCollector) -> UncheckedQuery:
    return UncheckedQuery(name, text, "", title, None, span, findings.sorted())


def elaborate_entries(
    entries: Iterable[ast.QueryEntry | BrokenQuery], scope: Scope, context: Context, first: int = 1
) -> tuple[tuple[Query, ...], tuple[UncheckedQuery, ...]]:
    """The queries of a .q file or command line, named ``q1``, ``q2``, ... in order, or from ``first`` on. A wrong one
    is an unchecked query and no finding of the context."""
    from tachk.syntax.query_files import BrokenQuery

    queries, unchecked = [], []
    for number, entry in enumerate(entries, first):
        name = f"q{number}"
        own = DiagnosticCollector()
        if isinstance(entry, BrokenQuery):
            own.extend(entry.diagnostics)
            unchecked.append(wrong_query(name, entry.text, entry.comment, entry.span, own))
            continue
        if isinstance(entry.formula, ast.UncheckedFormula):
            expected = expectation_clause(entry.expectation, scope, replace(context, findings=own))
            unchecked.append(_unchecked(entry.formula, name, entry.comment, expected.expectation))
            continue
        inner = replace(context, findings=own)
        query = elaborate_query(entry.formula, name, scope, inner, entry.comment, entry.expectation)
        if query is None or own.has_errors:
            span = entry.formula.span
            unchecked.append(wrong_query(name, span.text, entry.comment, span, own))
        else:
            context.findings.extend(own.sorted())
            queries.append(query)
    return tuple(queries), tuple(unchecked)


def _unchecked(node: ast.UncheckedFormula, name: str, title: str, expectation: Expectation | None) -> UncheckedQuery:
    return UncheckedQuery(name, node.text, node.family, title, expectation, node.span)
