"""A run as the script of the page takes it: every state by names, and what to light up in the pictures of templates."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction

from tachk.diagnostics.span import Span
from tachk.model.network import Network
from tachk.report.json_report import Json
from tachk.report.quantity import decimal, duration
from tachk.report.run.trace_view import Event, Snapshot, TraceView
from tachk.syntax import ast
from tachk.syntax.picture_layout import keyed_edges
from tachk.words import Direction


def edge_names(templates: Iterable[ast.Template]) -> dict[Span, str]:
    """What the pictures of templates call each edge, by the place where it is written."""
    return {edge.span: key.text for template in templates for key, edge in keyed_edges(template)}


def playback(network: Network, view: TraceView, edges: Mapping[Span, str]) -> dict[str, Json]:
    """The run: ``templates`` by process, and ``states``, each with the step that leads to it.

    Args:
        edges: the names of edges in pictures.
    """
    shown = view.without_hidden()
    return {
        "templates": {p.name: p.template for p in network.processes if p.name not in view.hidden_processes},
        "loop": view.loop_start,
        "states": [*_states(shown, network.time_unit or "", edges)],
    }


def _states(view: TraceView, unit: str, edges: Mapping[Span, str]) -> Iterator[Json]:
    yield {"told": "the start", "moved": [], **_state(view.initial, unit)}
    for step in view.steps:
        told = _told(step.delay, step.event, unit)
        moved: list[Json] = []
        if step.event is not None:
            for move in step.event.moves:
                moved += [[move.process, edges[span]] for span in move.spans if span in edges]
        yield {"told": told, "moved": moved, **_state(step.state, unit)}


def _state(state: Snapshot, unit: str) -> dict[str, Json]:
    return {
        "time": "" if state.time is None else duration(state.time, unit),
        "locations": dict(state.locations),
        "variables": {name: str(value).lower() for name, value in state.variables},
        "clocks": {name: decimal(value) for name, value in state.clocks or ()},
    }


def _told(delay: Fraction | None, event: Event | None, unit: str) -> str:
    waited = f"after {duration(delay, unit)}: " if delay else ""
    if event is None:
        return f"{waited}time passes" if waited else "the end"
    first = event.moves[0]
    if not event.channel:
        return f"{waited}{first.process} goes from {first.source} to {first.target}"
    receivers = ", ".join(move.process for move in event.moves if move.direction is Direction.RECEIVE)
    sender = first.process if first.direction is Direction.SEND else ""
    ends = f"{sender} → {receivers}" if receivers else sender
    return f"{waited}{event.channel}: {ends}"
