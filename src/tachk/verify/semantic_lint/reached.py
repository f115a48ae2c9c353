"""Locations that no run reaches and edges that no run takes, reported once for each template."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator

from tachk.analysis.fold import Known, fold
from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.span import Span
from tachk.base.words import Direction
from tachk.model.expressions import Constant, Expression
from tachk.model.network import Edge, Network, Process

Places = Collection[tuple[int, int]]
"""Edges or locations, each as the number of its process and its own."""


def unreached_locations(network: Network, taken: Places) -> Iterator[tuple[int, int]]:
    """The locations that are neither initial nor behind an edge that was taken."""
    reached = {(number, process.initial) for number, process in enumerate(network.processes)}
    reached |= {(process, network.processes[process].edges[edge].target) for process, edge in taken}
    for number, process in enumerate(network.processes):
        yield from ((number, place) for place in range(len(process.locations)) if (number, place) not in reached)


def switched_off(network: Network, known: Known) -> frozenset[tuple[int, int]]:
    """The edges whose guard is false by the constants of the model alone: with other constants they may be taken."""
    return frozenset(
        (number, place)
        for number, process in enumerate(network.processes)
        for place, edge in enumerate(process.edges)
        if edge.guard is not None and _is_false(fold(edge.guard, known))
    )


def _is_false(guard: Expression) -> bool:
    return isinstance(guard, Constant) and guard.value == 0


def untaken_edges(network: Network, taken: Places) -> Iterator[tuple[int, int]]:
    """The other edges, without those that leave a location that no run reaches."""
    missing = set(unreached_locations(network, taken))
    for number, process in enumerate(network.processes):
        for place, edge in enumerate(process.edges):
            if (number, place) not in taken and (number, edge.source) not in missing:
                yield number, place


def unreached_findings(network: Network, taken: Places, known: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """The locations that no process of a template reaches. ``known`` ones are not reported again."""
    known_spans = [finding.span for finding in known]
    findings = []
    for process, place in in_no_process(network, set(unreached_locations(network, taken))):
        location = process.locations[place]
        if not _met(known_spans, (location.span,)):
            findings.append(
                Diagnostic(
                    "W0601",
                    f"no run reaches the location `{location.name}`{_of(network, process)}",
                    location.span,
                    "check the guards and invariants on the way there, or remove it",
                )
            )
    return tuple(findings)


def untaken_findings(
    network: Network, taken: Places, never_true: Places, known: Iterable[Diagnostic]
) -> tuple[Diagnostic, ...]:
    """The edges that no process of a template takes, although some process reaches the location that they leave.

    Args:
        never_true: edges whose guard is false in every state for its integer part alone.
        known: the known findings, which are not reported again.
    """
    known_spans = [finding.span for finding in known]
    untaken = set(untaken_edges(network, taken))
    # An edge is as good as taken where another process of the template does not even reach its source.
    silent = {
        (number, place)
        for number, process in enumerate(network.processes)
        for place in range(len(process.edges))
        if (number, place) not in taken
    }
    findings = []
    for process, place in in_no_process(network, silent):
        edge = process.edges[place]
        numbers = [n for n, other in enumerate(network.processes) if other.template == process.template]
        if any((n, place) in untaken for n in numbers) and not _met(known_spans, edge.spans):
            findings.append(_of_edge(network, process, edge, all((n, place) in never_true for n in numbers)))
    return tuple(findings)


def in_no_process(network: Network, missing: Places) -> Iterator[tuple[Process, int]]:
    """The findings that concern every process of a template, reported of the first of them."""
    instances = Counter(process.template for process in network.processes)
    counts = Counter((network.processes[process].template, place) for process, place in missing)
    first = {process.template: process for process in reversed(network.processes)}
    for (template, place), count in sorted(counts.items()):
        if count == instances[template]:
            yield first[template], place


def in_some_process(network: Network, missing: Places) -> int:
    """The number of places that are not reached in a process, but in another one of its template."""
    everywhere = {(process.template, place) for process, place in in_no_process(network, missing)}
    return sum((network.processes[process].template, place) not in everywhere for process, place in missing)


def _of_edge(network: Network, process: Process, edge: Edge, never_true: bool) -> Diagnostic:
    name = f"`{process.locations[edge.source].name} -> {process.locations[edge.target].name}`"
    of = _of(network, process)
    if never_true and edge.guard is not None:
        message = f"this guard is false in every state that a run reaches, so no run takes the edge {name}{of}"
        return Diagnostic("W0603", message, edge.guard.span, "correct the guard, or remove the edge")
    if edge.synchronisation is None:
        help_ = "compare its guard with the invariants of the locations that it leaves and enters"
    elif edge.synchronisation.direction is Direction.SEND:
        help_ = "compare its guard and the invariants with those of the edges that receive"
    else:
        help_ = "no process sends while this one is there and its guard is true: compare the edges that send"
    return Diagnostic("W0602", f"no run takes the edge {name}{of}", edge.spans[0], help_)


def _of(network: Network, process: Process) -> str:
    several = sum(other.template == process.template for other in network.processes) > 1
    return f", in no process of `{process.template}`" if several else f" of `{process.name}`"


def _met(known_spans: Iterable[Span], spans: Iterable[Span]) -> bool:
    """True if there is a finding about a place inside one of the spans."""
    return any(
        one.source is span.source and one.start < span.end and span.start < one.end
        for one in known_spans
        for span in spans
    )
