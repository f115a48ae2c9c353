"""A model with many proposed edges at once, elaborated in one go.

All of them share the variables of one network, so a network with any of them, or with none, is made of it by leaving
edges out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.job import check_job
from tachk.base.records import dataclass, replace
from tachk.frontend.context import Budget, Context
from tachk.frontend.elaborate import Elaborated, elaborate
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.loaded import INSTANCES, LoadedModel, with_constants
from tachk.model.network import Edge, Network
from tachk.model.recording import RecordingMap
from tachk.recordings.conformance.location_columns import with_location_variables
from tachk.syntax import ast
from tachk.verify.repair.proposals import ProposedEdge, listed


@dataclass(frozen=True, slots=True)
class ExtendedModel:
    """Attributes:
    network: with all the edges.
    proposed: the edges; those that the elaborated model does not allow are left out.
    numbers: of the proposals, by the place of their text.
    """

    network: Network
    mapping: RecordingMap
    proposed: tuple[ProposedEdge, ...]
    numbers: dict[int, int]

    def number_of(self, edge: Edge) -> int | None:
        """The number of the proposal of which an edge was elaborated; None for an edge of the model."""
        span = edge.spans[0]
        own = self.proposed and span.source is self.proposed[0].edge.span.source
        return self.numbers[span.start] if own else None

    def with_edges(self, network: Network, wanted: Callable[[int | None], bool]) -> Network:
        """The network with those edges alone whose numbers are wanted; None is that of all edges of the model."""
        processes = tuple(
            replace(process, edges=tuple(edge for edge in process.edges if wanted(self.number_of(edge))))
            for process in network.processes
        )
        return replace(network, processes=processes)

    @property
    def without_any(self) -> Network:
        return self.with_edges(self.network, lambda number: number is None)

    def with_one(self, number: int) -> Network:
        return self.with_edges(self.network, lambda each: each is None or each == number)


def extended_model(loaded: LoadedModel, proposed: Iterable[ProposedEdge]) -> ExtendedModel:
    """The model with all the edges that it allows. Raises InputError for a model that is wrong without any."""
    placed = listed(proposed)
    result, errors = _elaborated(loaded, placed)
    if errors and placed:
        source = placed[0].edge.span.source
        wrong = {found.span.start for found in errors if found.span.source is source}
        placed = [each for each in placed if each.edge.span.start not in wrong]
        result, errors = _elaborated(loaded, placed)
    if errors:
        raise InputError(errors)
    assert result.recording is not None
    network, mapping = with_location_variables(result.network, result.recording)
    numbers = {each.edge.span.start: number for number, each in enumerate(placed)}
    return ExtendedModel(network, mapping, tuple(placed), numbers)


def _elaborated(loaded: LoadedModel, proposed: Sequence[ProposedEdge]) -> tuple[Elaborated, tuple[Diagnostic, ...]]:
    check_job()
    findings = DiagnosticCollector()
    context = Context(findings, budget=Budget(INSTANCES))
    items = with_proposals(loaded.items, proposed)
    others = [item for item in items if not isinstance(item, ast.PropertyDeclaration)]
    result = elaborate(others, loaded.document.span, loaded.overrides, context)
    return result, findings.sorted() if findings.has_errors else ()


def with_proposals(items: Sequence[ast.Item], proposed: Sequence[ProposedEdge]) -> list[ast.Item]:
    """The items of a model with edges more, behind all others of their template."""
    return [_extended(item, proposed) if isinstance(item, ast.Template) else item for item in items]


def _extended(template: ast.Template, proposed: Sequence[ProposedEdge]) -> ast.Template:
    own = [each for each in proposed if each.template == template.name.name]
    if not own:
        return template
    span = template.name.span
    edges = tuple(replace(each.edge, source=ast.Identifier(span, each.source)) for each in own)
    if template.classic:
        return replace(template, edges=(*template.edges, *edges))
    by_source: dict[str, list[ast.EdgeDeclaration]] = {}
    for each in own:
        by_source.setdefault(each.source, []).append(each.edge)
    locations = tuple(
        replace(place, edges=(*place.edges, *by_source.get(place.name.name, ()))) for place in template.locations
    )
    return replace(template, locations=locations)


def with_edge(loaded: LoadedModel, proposal: ProposedEdge) -> LoadedModel:
    """The model with an edge more, its properties without their expectations. Raises InputError."""
    items = tuple(with_proposals(loaded.items, listed([proposal])))
    return with_constants(replace(loaded, items=items), {}, [query.name for query in loaded.queries])
