"""A run as the script of the page takes it: every state by names, and what to light up in the pictures of templates."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from typing import Any

from tachk.report.json_report import Json
from tachk.report.quantity import decimal, duration
from tachk.syntax import ast
from tachk.syntax.picture_layout import keyed_edges


def edge_names(templates: Iterable[ast.Template]) -> dict[str, str]:
    """What the pictures of templates call each edge, by its place as reports tell it."""
    return {str(edge.span): key.text for template in templates for key, edge in keyed_edges(template)}


def playback(
    trace: list[Mapping[str, Any]], unit: str, loop: int | None, templates: Mapping[str, str], edges: Mapping[str, str]
) -> dict[str, Any]:
    """The run: ``templates`` by process, and ``states``, each with the step that leads to it.

    Args:
        trace: as docs/schema/verify.schema.json has it.
        unit: of time; may be empty.
        loop: the number of the state at which the loop begins.
        templates: by process.
        edges: the names of edges in pictures, see `edge_names`.
    """
    shown = {process: templates[process] for process in trace[0]["locations"] if process in templates}
    return {"templates": shown, "loop": loop, "states": [*_states(trace, unit, edges)]}


def told_lines(states: Iterable[Mapping[str, Any]]) -> str:
    """The steps of a `playback` in words, a line for each."""
    return "\n".join(f"{state['time']:>12}  {state['told']}" for state in states)


def _states(trace: list[Mapping[str, Any]], unit: str, edges: Mapping[str, str]) -> Iterator[dict[str, Json]]:
    now: dict[str, dict[str, Any]] = {kind: dict(trace[0][kind] or {}) for kind in ("locations", "variables")}
    clocks = _clocks(trace[0])
    places: dict[tuple[str, str, str], list[str]] = {}
    yield {"told": "the start", "moved": [], **_state(trace[0]["time"], unit, now, clocks)}
    for state in trace[1:]:
        for kind, values in now.items():
            values.update(state.get(kind, {}))
        delay = Fraction(state["delay"] or 0)
        clocks = {name: value + delay for name, value in clocks.items()} | _clocks(state)
        transition = state["transition"]
        moved: list[Json] = []
        for part in () if transition is None else transition["participants"]:
            edge = part["process"], part["source"], part["target"]
            places[edge] = part.get("positions", places.get(edge, []))
            moved += [[part["process"], edges[place]] for place in places[edge] if place in edges]
        told = _told(delay, transition, unit)
        yield {"told": told, "moved": moved, **_state(state["time"], unit, now, clocks)}


def _clocks(state: Mapping[str, Any]) -> dict[str, Fraction]:
    return {name: Fraction(value) for name, value in (state.get("clocks") or {}).items()}


def _state(
    time: str | None, unit: str, now: Mapping[str, Mapping[str, Any]], clocks: Mapping[str, Fraction]
) -> dict[str, Json]:
    return {
        "time": "" if time is None else duration(Fraction(time), unit),
        "locations": dict(now["locations"]),
        "variables": {name: str(value).lower() for name, value in now["variables"].items()},
        "clocks": {name: decimal(value) for name, value in clocks.items()},
    }


def _told(delay: Fraction, transition: Mapping[str, Any] | None, unit: str) -> str:
    waited = f"after {duration(delay, unit)}: " if delay else ""
    if transition is None:
        return f"{waited}time passes" if waited else "the end"
    first, *others = transition["participants"]
    if not transition["channel"]:
        return f"{waited}{first['process']} goes from {first['source']} to {first['target']}"
    parts = [first, *others]
    receivers = ", ".join(part["process"] for part in parts if part["role"] == "receives")
    sender = first["process"] if first["role"] == "sends" else ""
    ends = f"{sender} → {receivers}" if receivers else sender
    return f"{waited}{transition['channel']}: {ends}"
