"""The answers about a model as a part of a page, from what `tachk verify --format json` writes."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.base.records import replace
from tachk.model.quantity import decimal, duration
from tachk.report.drawing.sequence.layout import lay_out
from tachk.report.drawing.sequence.sequence_svg import draw_chart
from tachk.report.drawing.svg import Picture
from tachk.report.json_report import Json, run_to_json
from tachk.report.page.content import Answers, Section
from tachk.report.page.source_text import source_files
from tachk.report.pictures import draw_items, file_items
from tachk.report.record import RunRecord
from tachk.report.sequence.of_run import chart_of_run
from tachk.report.sequence.run_steps import steps_of_result
from tachk.report.text_report import evidence_text
from tachk.syntax import ast
from tachk.syntax.picture_layout import keyed_edges


def edge_names(templates: Iterable[ast.Template]) -> dict[str, str]:
    """The names of edges in the pictures of templates, by their places in reports."""
    return {str(edge.span): key.text for template in templates for key, edge in keyed_edges(template)}


def playback(
    trace: list[Mapping[str, Any]], unit: str, loop: int | None, templates: Mapping[str, str], edges: Mapping[str, str]
) -> dict[str, Any]:
    """The run by columns, since most values stay as they are in most steps: ``locations``, ``variables`` and ``clocks``
    hold for each name its values, each with the number of the state from which on it has it.

    ``times``, ``descriptions`` (the step in words) and ``moved`` (the edges that are taken) have an entry for each
    state, ``templates`` one for each process.

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
    steps: list[str] = []
    moved: list[list[list[str]]] = []
    for number, state in enumerate(trace):
        delay = Fraction(state.get("delay") or 0)
        clocks = {name: value + delay for name, value in clocks.items()} | _clocks(state)
        transition = state["transition"] if number else None
        times.append("" if state["time"] is None else duration(Fraction(state["time"]), unit))
        steps.append(_step_text(delay, transition, unit) if number else "the start")
        moved.append([*_moved(transition, places, edges)])
        _add(columns["locations"], number, state.get("locations") or {})
        _add(columns["variables"], number, {n: str(v).lower() for n, v in (state.get("variables") or {}).items()})
        _add(columns["clocks"], number, {name: decimal(value) for name, value in clocks.items()})
    return {"templates": shown, "loop": loop, "times": times, "descriptions": steps, "moved": moved, **columns}


def lines_of_run(run: Mapping[str, Any]) -> str:
    """The steps of a `playback` in words, a line for each."""
    return "\n".join(f"{time:>12}  {step}" for time, step in zip(run["times"], run["descriptions"], strict=True))


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


def _step_text(delay: Fraction, transition: Mapping[str, Any] | None, unit: str) -> str:
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


MOST_EVENTS = 400
"""A chart of more is not on the page; the run can be stepped through all the same."""


def answers_of(record: RunRecord, number: int = 0) -> Answers:
    """The verification just done as a part of a page. ``number`` as for `answers_part`."""
    run_texts = {v.query.name: evidence_text(record.network, v).partition("\n")[2] for v in record.verdicts}
    return answers_part(run_to_json(record), number, run_texts)


def answers_part(run: Mapping[str, Any], number: int, run_texts: Mapping[str, str]) -> Answers:
    """A run of `tachk verify` as a part of a page.

    Args:
        run: as docs/schema/verify.schema.json has it. The pictures are of the model file that it names.
        number: of the part, from 0, so that names on the page are different.
        run_texts: runs in words by the names of properties; a missing one is described in fewer words.
    """
    edges, pictures, items, remark = _of_file(run)
    templates = {process: f"{run['model']}/{template}" for process, template in run["templates"].items()}
    sections = [_section(run, result, number, run_texts, templates, edges) for result in run["results"]]
    sources = [*source_files(run["model"], items, sections)] if pictures else ()
    return Answers(run, sections, pictures, sources, remark)


def _of_file(run: Mapping[str, Any]) -> tuple[dict[str, str], Sequence[Picture], Sequence[ast.Item], str]:
    """The names of edges by their places, the pictures in which they have these names, and the declarations; or why
    there are none."""
    path = run["model"]
    if not os.path.exists(path):
        return {}, (), (), f"The automata are not drawn, as there is no file {path} here."
    try:
        items, layout = file_items(path)
        templates = [item for item in items if isinstance(item, ast.Template)]
        edges = edge_names(templates)
        if not _listed_places(run) <= edges.keys():
            return {}, (), (), f"The automata are not drawn, as {path} has changed since."
        pictures = draw_items(templates, layout, path) if templates else ()
    except (InputError, UsageError):
        return {}, (), (), f"The automata are not drawn, as {path} cannot be read any more."
    return edges, [replace(picture, name=f"{path}/{picture.name}") for picture in pictures], items, ""


def _listed_places(run: Mapping[str, Any]) -> set[str]:
    """The places of all edges that the runs take."""
    transitions = [
        state["transition"] for result in run["results"] for state in (result["trace"] or ())[1:] if state["transition"]
    ]
    return {
        place
        for transition in transitions
        for part in transition["participants"]
        for place in part.get("positions", ())
    }


def _section(
    run: Mapping[str, Any],
    result: Mapping[str, Any],
    number: int,
    run_texts: Mapping[str, str],
    templates: Mapping[str, str],
    edges: Mapping[str, str],
) -> Section:
    name = result["name"]
    place = f"{number}-{name}"
    values = [line for found in result["values"] for line in _value_lines(found, run["time_unit"])]
    if result["trace"] is None:
        return Section(place, result, values, run_texts.get(name, _fault(result)))
    chart = chart_of_run(steps_of_result(run, result)).used()
    drawn = draw_chart(lay_out(chart)).svg if chart.lifelines and len(chart.events) <= MOST_EVENTS else ""
    played = playback(result["trace"], run["time_unit"], result["loop_start"], templates, edges)
    return Section(place, result, values, run_texts.get(name, lines_of_run(played)), drawn, played)


def _fault(result: Mapping[str, Any]) -> str:
    fault = result["fault"]
    if fault is None:
        return ""
    detail = f": {fault['detail']}" if fault["detail"] else ""
    return f"{fault['position']}: {fault['message']}\n{fault['text']}{detail}\n{fault['help']}"


def _value_lines(found: Mapping[str, Any], time_unit: str) -> Iterator[str]:
    unit = time_unit if found.get("is_time") else ""
    for end, word, strict, loose in (("lower", "least", ">", "≥"), ("upper", "largest", "<", "≤")):
        extreme = found[end]
        if extreme is None:
            continue
        if extreme["value"] is None:
            yield f"{found['expression']} has no {word} value"
        else:
            value = duration(Fraction(extreme["value"]), unit)
            yield f"{found['expression']} {strict if extreme['strict'] else loose} {value}"
