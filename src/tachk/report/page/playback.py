"""A run as the script of the page takes it: what changes, and what to light up in the pictures of templates."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from typing import Any

from tachk.model.quantity import decimal, duration
from tachk.report.json_report import Json
from tachk.syntax import ast
from tachk.syntax.picture_layout import keyed_edges


def edge_names(templates: Iterable[ast.Template]) -> dict[str, str]:
    """What the pictures of templates call each edge, by its place as reports tell it."""
    return {str(edge.span): key.text for template in templates for key, edge in keyed_edges(template)}


def playback(
    trace: list[Mapping[str, Any]], unit: str, loop: int | None, templates: Mapping[str, str], edges: Mapping[str, str]
) -> dict[str, Any]:
    """The run by columns, since most values stay as they are in most steps: ``locations``, ``variables`` and ``clocks``
    hold for each name its values, each with the number of the state from which on it has it.

    ``times``, ``told`` (the step in words) and ``moved`` (the edges that are taken) have an entry for each state,
    ``templates`` one for each process.

    Args:
        trace: as docs/schema/verify.schema.json has it.
        unit: of time; may be empty.
        loop: the number of the state at which the loop begins.
        templates: by process.
        edges: the names of edges in pictures, see `edge_names`.
    """
    shown = {process: templates[process] for process in trace[0]["locations"] if process in templates}
    columns: dict[str, dict[str, list[list[Json]]]] = {"locations": {}, "variables": {}, "clocks": {}}
    clocks: dict[str, Fraction] = {}
    places: dict[tuple[str, str, str], list[str]] = {}
    times: list[str] = []
    told: list[str] = []
    moved: list[list[list[str]]] = []
    for number, state in enumerate(trace):
        delay = Fraction(state.get("delay") or 0)
        clocks = {name: value + delay for name, value in clocks.items()} | _clocks(state)
        transition = state["transition"] if number else None
        times.append("" if state["time"] is None else duration(Fraction(state["time"]), unit))
        told.append(_told(delay, transition, unit) if number else "the start")
        moved.append([*_moved(transition, places, edges)])
        _add(columns["locations"], number, state.get("locations") or {})
        _add(columns["variables"], number, {n: str(v).lower() for n, v in (state.get("variables") or {}).items()})
        _add(columns["clocks"], number, {name: decimal(value) for name, value in clocks.items()})
    return {"templates": shown, "loop": loop, "times": times, "told": told, "moved": moved, **columns}


def told_lines(run: Mapping[str, Any]) -> str:
    """The steps of a `playback` in words, a line for each."""
    return "\n".join(f"{time:>12}  {told}" for time, told in zip(run["times"], run["told"], strict=True))


def _add(columns: dict[str, list[list[Json]]], number: int, values: Mapping[str, str]) -> None:
    for name, value in values.items():
        column = columns.setdefault(name, [])
        if not column or column[-1][1] != value:
            column.append([number, value])


def _moved(
    transition: Mapping[str, Any] | None, places: dict[tuple[str, str, str], list[str]], edges: Mapping[str, str]
) -> Iterator[list[str]]:
    """The edges of a step, each with its process. ``places``: of edges, to which those of this step are added."""
    for part in () if transition is None else transition["participants"]:
        edge = part["process"], part["source"], part["target"]
        places[edge] = part.get("positions", places.get(edge, []))
        yield from ([part["process"], edges[place]] for place in places[edge] if place in edges)


def _clocks(state: Mapping[str, Any]) -> dict[str, Fraction]:
    return {name: Fraction(value) for name, value in (state.get("clocks") or {}).items()}


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
