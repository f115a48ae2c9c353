"""The answers about a model as a part of a page, from what `tachk verify --format json` writes."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.report.drawing.sequence.layout import lay_out
from tachk.report.drawing.sequence.sequence_svg import draw_chart
from tachk.report.drawing.svg import Picture
from tachk.report.json_report import run_to_json
from tachk.report.page.content import Answers, Section
from tachk.report.page.playback import edge_names, playback, told_lines
from tachk.report.pictures import draw_items, file_items
from tachk.report.record import RunRecord
from tachk.report.sequence.of_run import chart_of_run
from tachk.report.sequence.run_steps import steps_of_result
from tachk.report.text_report import evidence_text
from tachk.syntax import ast

MOST_EVENTS = 400
"""A chart of more is not on the page; the run can be stepped through all the same."""


def answers_of(record: RunRecord, number: int = 0) -> Answers:
    """What was just verified as a part of a page. ``number`` as for `answers_part`."""
    told = {v.query.name: evidence_text(record.network, v).partition("\n")[2] for v in record.verdicts}
    return answers_part(run_to_json(record), number, told)


def answers_part(run: Mapping[str, Any], number: int, told: Mapping[str, str]) -> Answers:
    """A run of `tachk verify` as a part of a page.

    Args:
        run: as docs/schema/verify.schema.json has it. The pictures are of the model file that it names.
        number: of the part, from 0, so that names on the page are different.
        told: runs in words by the names of properties; what is missing is told in fewer words.
    """
    edges, pictures, remark = _automata(run)
    templates = {process: f"{run['model']}/{template}" for process, template in run["templates"].items()}
    sections = [_section(run, result, number, told, templates, edges) for result in run["results"]]
    return Answers(run, sections, pictures, remark)


def _automata(run: Mapping[str, Any]) -> tuple[dict[str, str], Sequence[Picture], str]:
    """The names of edges by their places, and the pictures in which they have these names; or why there are none."""
    path = run["model"]
    if not os.path.exists(path):
        return {}, (), f"The automata are not drawn, as there is no file {path} here."
    try:
        items, layout = file_items(path)
        templates = [item for item in items if isinstance(item, ast.Template)]
        edges = edge_names(templates)
        if not _told_places(run) <= edges.keys():
            return {}, (), f"The automata are not drawn, as {path} has changed since."
        pictures = draw_items(templates, layout, path) if templates else ()
    except (InputError, UsageError):
        return {}, (), f"The automata are not drawn, as {path} cannot be read any more."
    return edges, [replace(picture, name=f"{path}/{picture.name}") for picture in pictures], ""


def _told_places(run: Mapping[str, Any]) -> set[str]:
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
    told: Mapping[str, str],
    templates: Mapping[str, str],
    edges: Mapping[str, str],
) -> Section:
    name = result["name"]
    place = f"{number}-{name}"
    values = [line for found in result["values"] for line in _value_lines(found)]
    if result["trace"] is None:
        return Section(place, result, values, told.get(name, _fault(result)))
    chart = chart_of_run(steps_of_result(run, result)).used()
    drawn = draw_chart(lay_out(chart)).svg if chart.messages and len(chart.events) <= MOST_EVENTS else ""
    played = playback(result["trace"], run["time_unit"], result["loop_start"], templates, edges)
    return Section(place, result, values, told.get(name, told_lines(played)), drawn, played)


def _fault(result: Mapping[str, Any]) -> str:
    fault = result["fault"]
    if fault is None:
        return ""
    detail = f": {fault['detail']}" if fault["detail"] else ""
    return f"{fault['position']}: {fault['message']}\n{fault['text']}{detail}\n{fault['help']}"


def _value_lines(found: Mapping[str, Any]) -> list[str]:
    lines = []
    for end, word, strict, loose in (("lower", "least", ">", "≥"), ("upper", "largest", "<", "≤")):
        extreme = found[end]
        if extreme is None:
            continue
        if extreme["value"] is None:
            lines.append(f"{found['expression']} has no {word} value")
        else:
            lines.append(f"{found['expression']} {strict if extreme['strict'] else loose} {extreme['value']}")
    return lines
