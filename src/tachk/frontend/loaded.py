"""A model that has been read: its network, its queries, its text, and the names that further queries may use."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UnsupportedError
from tachk.base.records import dataclass, field, replace
from tachk.base.span import Source
from tachk.frontend.context import Budget, Context
from tachk.frontend.elaborate import elaborate_each_property
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.priority_interpretations import other_interpretations
from tachk.frontend.queries.queries import UncheckedQuery, elaborate_entries
from tachk.frontend.scope import Scope
from tachk.model.expressions import Variable
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.syntax import ast

if TYPE_CHECKING:
    from tachk.model.recording import RecordingMap
    from tachk.syntax.formula import Formula
    from tachk.syntax.picture_layout import Layout

INSTANCES = 2**16
"""Quantifiers are written out at most that many times in one model."""


@dataclass(frozen=True, slots=True)
class LoadedModel:
    """Attributes:
    queries: the properties the model states, in order.
    unchecked: properties that belong to another kind of analysis; of UPPAAL's XML also queries that are wrong.
    document: the syntax tree of the file itself, imports not followed.
    items: of the document, each import replaced by what the file declares.
    scope: the names that queries may use.
    layout: the picture, if the file has one (UPPAAL's XML).
    recording: how recordings of the real system are held against it.
    refusals: the constructs of the model that tachk does not check. Where there are any, what was elaborated is
        incomplete: no analysis may see it, so there is no `network`, while everything that concerns the text is there.
    """

    _elaborated: Network = field(repr=False)
    queries: tuple[Query, ...]
    unchecked: tuple[UncheckedQuery, ...]
    warnings: tuple[Diagnostic, ...]
    document: ast.Document = field(repr=False)
    items: tuple[ast.Item, ...] = field(repr=False)
    scope: Scope = field(repr=False)
    context: Context = field(repr=False)
    layout: Layout | None = field(default=None, repr=False)
    refusals: tuple[Diagnostic, ...] = ()
    overrides: Mapping[str, ast.Expression] = field(default_factory=dict, repr=False)
    recording: RecordingMap | None = field(default=None, repr=False)

    @property
    def network(self) -> Network:
        """The model as analyses see it. Raises UnsupportedError where something in it is refused."""
        if self.refusals:
            raise UnsupportedError(self.refusals[0])
        return self._elaborated

    @property
    def formulas(self) -> tuple[Query | UncheckedQuery, ...]:
        """The queries and the unchecked ones together, in the order in which the model states them."""
        stated = [item.name.name for item in self.items if isinstance(item, ast.PropertyDeclaration)]
        order = {name: number for number, name in enumerate(stated)}

        def place(query: Query | UncheckedQuery) -> int:
            # In XML a query that cannot be read is not an item, but all queries stand in one text.
            return order[query.name] if self.layout is None else query.span.start

        return tuple(sorted((*self.queries, *self.unchecked), key=place))

    @property
    def heading(self) -> Network:
        """The constants and the time unit without any process: what reports say about every model."""
        return Network((), (), 0, self._elaborated.constants, (), self._elaborated.time_unit)

    @property
    def variables(self) -> tuple[Variable, ...]:
        """The global variables that are not refused."""
        return self._elaborated.variables


def other_interpretations_of(loaded: LoadedModel) -> Iterator[tuple[str, LoadedModel]]:
    """The other meanings of a model, each with its place of `default`; see `priority_interpretations`.

    The queries are those of the model, with the names of the interpretation.
    """
    if loaded.refusals:
        return
    for interpretation in other_interpretations(loaded.items):
        context = Context(DiagnosticCollector(), budget=Budget(INSTANCES))
        result = elaborate_each_property(interpretation.items, loaded.document.span, loaded.overrides, context)
        yield (
            interpretation.place,
            replace(
                loaded,
                _elaborated=result.network,
                queries=result.queries,
                unchecked=result.unchecked,
                scope=result.scope,
                context=context,
            ),
        )


def with_constants(
    loaded: LoadedModel,
    values: Mapping[str, int | str],
    properties: Collection[str],
    open_constants: Iterable[str] = (),
    ranges: Mapping[str, tuple[int, int]] = {},
) -> LoadedModel:
    """The model with other values of global constants.

    Args:
        properties: the names of those that are kept, without their expectations.
        open_constants: those that are to keep their names, see `OpenConstants`; the network is for reading then, and
            not for running, unless all of them have ranges.
        ranges: the least and the largest value that each may be given.

    Raises:
        InputError: the model is wrong with these values.
        UsageError: there is no such constant.
    """
    from tachk.frontend.open_constants import OpenConstants
    from tachk.frontend.overrides import constant_overrides

    findings = DiagnosticCollector()
    given = constant_overrides(values, loaded.items, findings)
    items = [
        replace(item, expectation=None) if isinstance(item, ast.PropertyDeclaration) else item
        for item in loaded.items
        if not isinstance(item, ast.PropertyDeclaration) or item.name.name in properties
    ]
    context = Context(
        findings, budget=Budget(INSTANCES), open_constants=OpenConstants(frozenset(open_constants), ranges)
    )
    overrides = {**loaded.overrides, **given}
    result = elaborate_each_property(items, loaded.document.span, overrides, context)
    if findings.has_mistakes:
        raise InputError(findings.sorted())
    unsupported = tuple(found for found in findings.sorted() if found.is_unsupported)
    return replace(
        loaded,
        _elaborated=result.network,
        queries=result.queries,
        unchecked=explained(result.unchecked, unsupported),
        scope=result.scope,
        context=context,
        refusals=unsupported,
        overrides=overrides,
        recording=result.recording,
    )


def with_hybrid_clocks(loaded: LoadedModel, names: Collection[str]) -> LoadedModel:
    """The model as simulations see it, with these clocks and those that are hybrid ones anyway as hybrid ones.

    Raises InputError where the model is wrong then.
    """
    from tachk.frontend.hybrid_clocks import hybrid_clocks

    findings = DiagnosticCollector()
    hybrid = hybrid_clocks(loaded.items, names)
    context = Context(findings, budget=Budget(INSTANCES), keeps_doubles=True, hybrid_clocks=hybrid)
    result = elaborate_each_property(loaded.items, loaded.document.span, loaded.overrides, context)
    if findings.has_mistakes:
        raise InputError(findings.sorted())
    unsupported = tuple(found for found in findings.sorted() if found.is_unsupported)
    return replace(loaded, _elaborated=result.network, scope=result.scope, context=context, refusals=unsupported)


def explained(unchecked: Iterable[UncheckedQuery], unsupported: Sequence[Diagnostic]) -> tuple[UncheckedQuery, ...]:
    """The queries, those that use the name of something refused with the reason."""
    return tuple(
        query if query.family or query.diagnostics else replace(query, diagnostics=tuple(unsupported[:1]))
        for query in unchecked
    )


def temporal_formula_of(loaded: LoadedModel, node: ast.TemporalFormula) -> Formula | None:
    """The formula of a temporal property, bounds in time units of the model; None where it is wrong."""
    from tachk.frontend.queries.observer_processes import temporal_formula

    return temporal_formula(node, loaded.scope, replace(loaded.context, findings=DiagnosticCollector(), in_query=True))


def elaborate_query_file(
    loaded: LoadedModel, source: Source, first: int = 1
) -> tuple[tuple[Query, ...], tuple[UncheckedQuery, ...]]:
    """The queries of a .q file or of the command line, named ``q1``, ``q2``, ... in order; a wrong one is unchecked and
    harms no other.

    Args:
        first: the number of the first query.
    """
    from tachk.syntax.query_files import parse_each_query

    known = loaded.context
    own = replace(known, findings=DiagnosticCollector(), in_query=False, scalar_sets=0, budget=Budget(INSTANCES))
    queries, unchecked = elaborate_entries(parse_each_query(source), loaded.scope, own, first)
    return queries, explained(unchecked, loaded.refusals)
