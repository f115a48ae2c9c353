"""The machine form of an evaluated trace: plain dictionaries that follow docs/schema/monitor.schema.json."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TextIO

from tachk.base.plain_data import Fields, PlainData
from tachk.model.quantity import decimal
from tachk.recordings.monitors.record import MonitorRecord, MonitorVerdict, cell_time, value_text
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.verdict_explanation import Finding, TruthReason
from tachk.report.json_report import Json
from tachk.report.monitor.words import explain_verdict

if TYPE_CHECKING:
    from rich.console import Console


def write_json(record: MonitorRecord, out: TextIO, console: Callable[[TextIO], Console], all_violations: bool) -> None:
    """A row of `tachk.report.monitor.formats`."""
    json.dump(monitor_to_json(record, all_violations), out, indent=2)
    out.write("\n")


def monitor_to_json(record: MonitorRecord, all_violations: bool = False) -> dict[str, Json]:
    """The record as a dictionary for `json.dumps`. Instants are exact strings such as ``"12.5"`` or ``"7/3"``.

    Args:
        all_violations: list them; else they are counted only.
    """
    trace = record.trace
    shown: dict[str, Json] = {
        "trace": trace.name,
        "rows": trace.rows,
        "begin": exact(trace, 0),
        "end": exact(trace, 2 * trace.end),
        "unit": trace.unit or None,
        "interpolation": trace.interpolation.value,
        "pending_counts_as": record.ending.value,
        "results": [verdict_to_json(record, verdict, all_violations) for verdict in record.verdicts],
    }
    return with_notes(shown, (*trace.notes, *trace.warnings))


def with_notes(shown: dict[str, Json], notes: Sequence[str]) -> dict[str, Json]:
    """With the notes of the reader of a trace, if there are any."""
    return {**shown, "notes": list(notes)} if notes else shown


def verdict_to_json(record: MonitorRecord, verdict: MonitorVerdict, all_violations: bool = False) -> dict[str, Json]:
    """One verdict."""
    fields = Fields(
        VERDICT_NAMES,
        sentence=lambda verdict: verdict.sentence or None,
        finding=lambda verdict: finding_to_json(record, verdict),
        violations=lambda verdict: _violations(record.trace, verdict, all_violations),
    )
    return PlainData({**FORMS, MonitorVerdict: fields}).of(verdict)


def _violations(trace: Trace, verdict: MonitorVerdict, listed: bool) -> dict[str, Json]:
    if verdict.measured is Truth.TRUE and not listed:
        return {"count": 0, "triggers": None, "listed": None}
    violations = verdict.violations
    return {
        "count": len(violations),
        "triggers": PlainData()(violations.triggers),
        "listed": [violation_to_json(trace, verdict, finding) for finding in violations] if listed else None,
    }


def violation_to_json(trace: Trace, verdict: MonitorVerdict, finding: Finding) -> dict[str, Json]:
    """One violation, among many."""
    return {
        "formula": finding.formula,
        "from": exact(trace, finding.cell),
        "until": exact(trace, 2 * ((finding.last + 1) // 2)),
        "packet": trace.packet(finding.cell // 2),
        "triggered_from": None if finding.triggered is None else exact(trace, finding.triggered[0]),
        "deadline": None if finding.deadline is None else exact(trace, finding.deadline),
        "blamed": [_blamed(trace, verdict, reason) for reason in finding.blamed],
    }


def finding_to_json(record: MonitorRecord, verdict: MonitorVerdict) -> dict[str, Json] | None:
    """First violation, or the position at which the verdict stays open; None where it is true."""
    finding, trace = verdict.finding, record.trace
    if finding is None:
        return None
    return {
        "kind": "violation" if verdict.measured is Truth.FALSE else "pending",
        "from": exact(trace, finding.cell),
        "until": exact(trace, 2 * ((finding.last + 1) // 2)),
        "packet": trace.packet(finding.cell // 2),
        "trigger": None if finding.trigger is None else finding.trigger.text,
        "triggered_from": None if finding.triggered is None else exact(trace, finding.triggered[0]),
        "deadline": None if finding.deadline is None else exact(trace, finding.deadline),
        "decided": None if finding.decided is None else exact(trace, finding.decided),
        "blamed": [_blamed(trace, verdict, reason) for reason in finding.blamed],
        "explanation": list(explain_verdict(record, verdict)),
    }


def first_finding(record: MonitorRecord | None) -> dict[str, Json] | None:
    """The finding of the first verdict of a record, if there is one."""
    return None if record is None else finding_to_json(record, record.verdicts[0])


def _blamed(trace: Trace, verdict: MonitorVerdict, reason: TruthReason) -> dict[str, Json]:
    columns = verdict.explainer.columns(reason)
    return {
        "formula": reason.text,
        "value": reason.value.word,
        "at": exact(trace, reason.cell),
        "seen": {column: value_text(trace, column, reason.cell) for column in columns},
    }


def exact(trace: Trace, cell: int) -> str:
    """The instant of a cell as the clock of the recording shows it; between two ticks the middle."""
    return decimal(trace.clock(cell_time(cell)), 18)


def number(value: float) -> Json:
    """Infinities as strings, for JSON has none."""
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    return value


FORMS: dict[type, Callable[[Any], object]] = {
    Truth: lambda truth: truth.word,
    float: number,
    Fraction: lambda instant: decimal(instant, 18),
}
VERDICT_NAMES = (
    "name title formula sentence verdict=truth measured presumably robustness time_robustness vacuous finding "
    "violations"
)
