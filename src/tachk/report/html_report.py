"""The answers as an HTML table, for notebooks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jinja2 import Environment, FunctionLoader, StrictUndefined

from tachk.base.notebook import ANSWER_COLOURS, CAPTION, PRE
from tachk.base.resources import template_text
from tachk.model.quantity import grouped, seconds
from tachk.report.extreme_text import answer_text
from tachk.report.record import RunRecord
from tachk.report.text_report import evidence_text

if TYPE_CHECKING:
    from tachk.simulation.statistics.answers import StatisticalAnswer


def run_to_html(record: RunRecord) -> str:
    """A table with one row for each answer, and the runs, those behind unexpected answers unfolded.

    Everything that comes from the model is escaped.
    """
    environment = Environment(loader=FunctionLoader(template_text), autoescape=True, undefined=StrictUndefined)
    template = environment.get_template("report/verdicts.html.j2")
    runs = [
        (verdict, title, text)
        for verdict in record.verdicts
        for title, _, text in (evidence_text(record.network, verdict).partition("\n"),)
        if title
    ]
    answers = {verdict.query.name: answer_text(verdict, record.network.time_unit) for verdict in record.verdicts}
    return template.render(
        record=record,
        answers=answers,
        estimates=_estimates(record),
        runs=runs,
        colours=ANSWER_COLOURS,
        caption=CAPTION,
        pre=PRE,
        count=grouped,
        seconds=seconds,
    )


def _estimates(record: RunRecord) -> list[tuple[StatisticalAnswer, str]]:
    """The answers to statistical queries, each with what it says in a few words."""
    if not record.estimates:
        return []
    from tachk.report.statistics.answered import short_answer
    from tachk.report.statistics.json import answered_document

    return [(answer, short_answer(answered_document(answer)["found"])) for answer in record.estimates]
