"""The answers as an HTML table, for notebooks."""

from __future__ import annotations

from jinja2 import Environment, FunctionLoader, StrictUndefined

from tachk.report.quantity import count, seconds
from tachk.report.record import RunRecord
from tachk.resources import template_text

_COLOURS = {"holds": "green", "fails": "firebrick", "unknown": "darkorange"}


def run_to_html(record: RunRecord) -> str:
    """A table with one row for each answer; everything that comes from the model is escaped."""
    environment = Environment(loader=FunctionLoader(template_text), autoescape=True, undefined=StrictUndefined)
    template = environment.get_template("report/verdicts.html.j2")
    return template.render(record=record, colours=_COLOURS, count=count, seconds=seconds)
