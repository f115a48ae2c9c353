"""Reports of traces that are evaluated as they come: some lines when a verdict is decided, a summary at the end."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.base.plain_data import Fields, PlainData
from tachk.model.quantity import decimal, grouped
from tachk.recordings.monitors.online_record import OnlineRecord, OnlineVerdict, OnlineViolation
from tachk.recordings.monitors.record import time_text
from tachk.recordings.traces.node_signal import Truth
from tachk.report.json_report import Json
from tachk.report.monitor.json import FORMS, VERDICT_NAMES, first_finding, with_notes
from tachk.report.monitor.text import robustness_text
from tachk.report.monitor.words import explain_verdict


def decided_to_text(verdict: OnlineVerdict, unit: str, dated: bool) -> str:
    """The line printed as soon as a verdict is decided."""
    at = "" if verdict.decided_at is None else f"{time_text(verdict.decided_at, unit, dated)}: "
    return "\n".join((f"{at}{verdict.name} is {verdict.measured.word}", *_details(verdict, unit, dated))) + "\n"


def violation_to_text(violation: OnlineViolation, unit: str, dated: bool) -> str:
    """The line printed when a violation begins, and when it has ended."""
    since = time_text(violation.since, unit, dated)
    if violation.until is None:
        return f"{violation.name} is violated from {since} on: `{violation.violated}`"
    return f"{violation.name} was violated from {since} until {time_text(violation.until, unit, dated)}"


def online_to_text(record: OnlineRecord) -> str:
    """The summary at the end."""
    rows = f"{grouped(record.rows)} {'row' if record.rows == 1 else 'rows'}"
    begin, end = (time_text(clock, record.unit, record.dated) for clock in (record.begin, record.end))
    lines = [f"{record.trace}: {rows}, from {begin} to {end}", *record.notes, ""]
    width = max(len(verdict.name) for verdict in record.verdicts)
    words = [_words(verdict) for verdict in record.verdicts]
    wide = max(len(word) for word in words)
    for verdict, word in zip(record.verdicts, words, strict=True):
        robustness = f"  robustness {robustness_text(verdict.robustness)}" if verdict.robustness else ""
        lines.append(f"  {verdict.name:{width}}  {word:{wide}}  {verdict.formula}{robustness}")
    totals = [(sum(v.truth is truth for v in record.verdicts), truth.word) for truth in _ORDER]
    lines += ["", ", ".join(f"{total} {word}" for total, word in totals if total)]
    return "\n".join(lines) + "\n"


def online_to_json(record: OnlineRecord) -> dict[str, Json]:
    """The record as docs/schema/monitor.schema.json describes it."""
    shown: dict[str, Json] = {
        "trace": record.trace,
        "rows": record.rows,
        "begin": decimal(record.begin, 18),
        "end": decimal(record.end, 18),
        "unit": record.unit or None,
        "interpolation": "constant",
        "pending_counts_as": record.ending.value,
        "results": [_verdict_to_json(verdict, record) for verdict in record.verdicts],
    }
    return with_notes(shown, record.notes)


def _verdict_to_json(verdict: OnlineVerdict, record: OnlineRecord) -> dict[str, Json]:
    fields = Fields(
        VERDICT_NAMES,
        sentence=lambda verdict: verdict.sentence or None,
        presumably=_none,
        time_robustness=_none,
        vacuous=lambda verdict: False,
        finding=lambda verdict: first_finding(verdict.story),
        violations=lambda verdict: _violations(verdict, record),
    )
    return PlainData({**FORMS, OnlineVerdict: fields, OnlineViolation: _VIOLATION}).of(verdict)


def _none(found: object) -> None:
    """Nothing is known of this while a trace comes."""


_VIOLATION = Fields(
    "formula=violated from=since until packet triggered_from deadline blamed",
    packet=_none,
    triggered_from=_none,
    deadline=_none,
    blamed=lambda violation: [],
)


def _violations(verdict: OnlineVerdict, record: OnlineRecord) -> dict[str, object] | None:
    if record.violations is None:
        return None
    own = sorted((each for each in record.violations if each.name == verdict.name), key=lambda each: each.since)
    return {"count": len(own), "triggers": None, "listed": own}


_ORDER = (Truth.TRUE, Truth.FALSE, Truth.UNDETERMINED)


def _words(verdict: OnlineVerdict) -> str:
    if verdict.measured is verdict.truth:
        return verdict.truth.word
    return f"{verdict.truth.word} (undetermined at the end)"


def _details(verdict: OnlineVerdict, unit: str, dated: bool) -> Iterator[str]:
    if verdict.story is not None:
        for line in explain_verdict(verdict.story, verdict.story.verdicts[0]):
            yield f"  {line}"
    elif verdict.violated is not None:
        begin, end = verdict.violated
        yield f"  violated from {time_text(begin, unit, dated)} until {time_text(end, unit, dated)}"
