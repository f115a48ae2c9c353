"""Verdicts and violations as JSON lines, a line for each event: docs/schema/monitor_event.schema.json."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, TextIO

from tachk.base.plain_data import Fields, PlainData
from tachk.model.quantity import decimal
from tachk.recordings.monitors.online_record import OnlineRecord, OnlineVerdict, OnlineViolation
from tachk.recordings.monitors.record import MonitorRecord
from tachk.recordings.traces.node_signal import Truth
from tachk.report.json_report import Json
from tachk.report.monitor.json import FORMS, exact, first_finding, verdict_to_json, with_notes

if TYPE_CHECKING:
    from rich.console import Console


def write_lines(record: MonitorRecord, out: TextIO, console: Callable[[TextIO], Console], all_violations: bool) -> None:
    """A row of `tachk.report.monitor.formats`."""
    for event in record_events(record, all_violations):
        out.write(json.dumps(event) + "\n")


def record_events(record: MonitorRecord, all_violations: bool) -> Iterator[dict[str, Json]]:
    """The events of a trace that has been evaluated as a whole."""
    trace = record.trace
    for verdict in record.verdicts:
        if all_violations and verdict.measured is not Truth.TRUE:
            for each in verdict.violations:
                until = exact(trace, 2 * ((each.last + 1) // 2))
                yield _violation(verdict.name, each.formula, exact(trace, each.cell), until)
        shown = verdict_to_json(record, verdict)
        finding = verdict.finding
        at = None if finding is None or finding.decided is None else exact(trace, finding.decided)
        yield _verdict({key: shown[key] for key in _VERDICT_KEYS}, at)
    end = _end(trace.rows, exact(trace, 0), exact(trace, 2 * trace.end), trace.unit)
    yield with_notes(end, (*trace.notes, *trace.warnings))


def violation_event(violation: OnlineViolation) -> dict[str, Json]:
    """A violation that begins, or has ended."""
    until = None if violation.until is None else decimal(violation.until, 18)
    return _violation(violation.name, violation.violated, decimal(violation.since, 18), until)


def verdict_event(verdict: OnlineVerdict) -> dict[str, Json]:
    """A verdict that has been decided, or that the end of the trace leaves open."""
    shown = PlainData({**FORMS, OnlineVerdict: _DECIDED}).of(verdict)
    return _verdict(shown, None if verdict.decided_at is None else decimal(verdict.decided_at, 18))


def end_event(record: OnlineRecord) -> dict[str, Json]:
    """The last line."""
    return with_notes(_end(record.rows, decimal(record.begin, 18), decimal(record.end, 18), record.unit), record.notes)


_DECIDED = Fields(
    "name title formula verdict=truth measured robustness finding",
    finding=lambda verdict: first_finding(verdict.story),
)
_VERDICT_KEYS = ("name", "title", "formula", "verdict", "measured", "robustness", "finding")


def _verdict(shown: dict[str, Json], decided_at: str | None) -> dict[str, Json]:
    return {"event": "verdict", **shown, "decided_at": decided_at}


def _violation(name: str, violated: str, since: str, until: str | None) -> dict[str, Json]:
    return {"event": "violation", "name": name, "formula": violated, "from": since, "until": until}


def _end(rows: int, begin: str, end: str, unit: str) -> dict[str, Json]:
    return {"event": "end", "rows": rows, "begin": begin, "end": end, "unit": unit or None}
