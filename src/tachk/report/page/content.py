"""What is on the page about a verified model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from tachk.drawing.sequence.layout import lay_out
from tachk.drawing.sequence.sequence_svg import draw_chart
from tachk.drawing.svg import Picture
from tachk.formats.layout_json import read_layout_beside
from tachk.frontend.loaded import LoadedModel
from tachk.properties.verdict import Verdict
from tachk.report.json_report import Json
from tachk.report.page.playback import edge_names, playback
from tachk.report.pictures import draw_items
from tachk.report.record import RunRecord
from tachk.report.run.trace_view import view_trace
from tachk.report.sequence.of_run import chart_of_run
from tachk.report.sequence.run_steps import steps_of_view
from tachk.report.text_report import evidence_text
from tachk.syntax import ast

MOST_EVENTS = 400
"""A chart of more is not on the page; the run can be stepped through all the same."""


@dataclass(frozen=True, slots=True)
class Section:
    """One answer.

    Attributes:
        told: the run in words; empty where there is none.
        chart: the sequence chart of the run; empty where there is none.
        playback: the run for the script; None where there is none.
    """

    verdict: Verdict
    told: str = ""
    chart: str = ""
    playback: Json = field(default=None, repr=False)


@dataclass(frozen=True, slots=True)
class Page:
    """Attributes:
    facts: what is needed to repeat it: names and values.
    pictures: of the templates.
    added: pictures that the user adds: what they are called, and their SVG.
    """

    title: str
    record: RunRecord
    facts: Sequence[tuple[str, str]]
    sections: Sequence[Section]
    pictures: Sequence[Picture] = ()
    added: Sequence[tuple[str, str]] = ()


def page_of(
    model: LoadedModel,
    record: RunRecord,
    title: str,
    facts: Sequence[tuple[str, str]],
    added: Sequence[tuple[str, str]] = (),
) -> Page:
    """The page about the answers that were found about a model.

    Args:
        facts: see `Page`; the constants and the unit of time come to them.
        added: pictures of the user: names and SVG.
    """
    templates = [item for item in model.items if isinstance(item, ast.Template)]
    layout = model.layout or read_layout_beside(record.model)
    pictures = draw_items(templates, layout, record.model) if templates else ()
    constants = ", ".join(f"{name} = {value}" for name, value in record.network.constants)
    known = [("model", record.model), ("constants", constants), ("unit of time", record.network.time_unit)]
    sections = [_section(record, verdict, templates) for verdict in record.verdicts]
    return Page(title, record, [*((n, v) for n, v in known if v), *facts], sections, pictures, added)


def _section(record: RunRecord, verdict: Verdict, templates: Sequence[ast.Template]) -> Section:
    """An answer with everything that explains it."""
    network = record.network
    _, _, told = evidence_text(network, verdict).partition("\n")
    if verdict.trace is None:
        return Section(verdict, told)
    view = view_trace(network, verdict.trace)
    query = verdict.query
    remark = f"{query.name} {verdict.answer.value}"
    steps = steps_of_view(view, query.title or query.text, network.time_unit or "", dict(network.constants), remark)
    chart = chart_of_run(steps).used()
    drawn = draw_chart(lay_out(chart)).svg if chart.messages and len(chart.events) <= MOST_EVENTS else ""
    return Section(verdict, told, drawn, playback(network, view, edge_names(templates)))
