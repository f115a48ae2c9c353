"""Verdicts on a trace as an HTML table, for notebooks."""

from __future__ import annotations

from jinja2 import Environment, FunctionLoader, StrictUndefined

from tachk.base.notebook import ANSWER_COLOURS, CAPTION
from tachk.base.resources import template_text
from tachk.model.quantity import grouped
from tachk.recordings.monitors.record import MonitorRecord, clock_text
from tachk.recordings.traces.node_signal import Truth
from tachk.report.monitor.text import answer_text, finite_robustness_text, is_quantitative
from tachk.report.monitor.words import explain_verdict

_COLOURS = {truth: ANSWER_COLOURS[truth.word] for truth in Truth}


def monitor_to_html(record: MonitorRecord) -> str:
    """A table with one row for each formula; everything that comes from files is escaped."""
    environment = Environment(loader=FunctionLoader(template_text), autoescape=True, undefined=StrictUndefined)
    template = environment.get_template("report/monitor.html.j2")
    trace = record.trace
    return template.render(
        record=record,
        colours=_COLOURS,
        caption=CAPTION,
        columns=["name", "formula", "verdict", *(["robustness"] if is_quantitative(record) else ()), "what happened"],
        rows=grouped(trace.rows),
        begin=clock_text(trace, 0),
        end=clock_text(trace, trace.end),
        answer=answer_text,
        robustness=finite_robustness_text,
        explain=lambda verdict: explain_verdict(record, verdict),
    )
