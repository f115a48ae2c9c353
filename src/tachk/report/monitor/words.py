"""In words: why a formula is violated on a trace, or why its verdict is still open."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.model.quantity import grouped
from tachk.recordings.monitors.record import MonitorRecord, MonitorVerdict, cell_text, clock_text, value_text
from tachk.recordings.traces.monitor_program import NodeKind
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.verdict_explanation import Finding, TruthReason
from tachk.recordings.traces.violations import Violations

_COLUMNS_SHOWN = 8


def explain_verdict(record: MonitorRecord, verdict: MonitorVerdict) -> tuple[str, ...]:
    """The story of a verdict that is not true, a sentence a line."""
    finding = verdict.finding
    return () if finding is None else explain_finding(record, verdict, finding)


def explain_finding(record: MonitorRecord, verdict: MonitorVerdict, finding: Finding) -> tuple[str, ...]:
    """The story of one violation, or of what is pending."""
    trace = record.trace
    lines = [*_trigger(trace, finding), *_reason(trace, finding.response)]
    if verdict.measured is Truth.FALSE:
        lines += seen_values(trace, verdict, finding)
        lines += _certain(trace, finding)
    else:
        lines.append(f"the trace ends at {clock_text(trace, trace.end)}, too early to decide")
        if verdict.presumably is not None:
            lines.append(f"if nothing changes any more it will be {verdict.presumably.word}")
    return tuple(lines)


def count_violations(violations: Violations) -> str:
    """The number of violations, as a line; empty if there is one only, and no trigger."""
    triggers, number = violations.triggers, len(violations)
    stretches = f"{grouped(number)} {'violation' if number == 1 else 'violations'}"
    if triggers is None:
        return f"{stretches} in all" if number > 1 else ""
    total = f"{grouped(triggers.total)} {'trigger' if triggers.total == 1 else 'triggers'}"
    shown = [(triggers.violated, "violated"), (triggers.pending, "pending")]
    (first, state), *others = [each for each in shown if each[0]] or shown
    line = f"{grouped(first)} of {total} {'is' if first == 1 else 'are'} {state}"
    line += "".join(f", {grouped(more)} {state}" for more, state in others if more)
    return line + (f"; {stretches} in all" if number != triggers.violated else "")


def _trigger(trace: Trace, finding: Finding) -> Iterator[str]:
    if finding.trigger is None or finding.triggered is None:
        return
    first, last = finding.triggered
    trigger = finding.trigger
    at = cell_text(trace, first)
    if trigger.kind is NodeKind.RISE:
        yield f"trigger: `{trigger.operands[0]}` becomes true at {at}"
    elif trigger.kind is NodeKind.FALL:
        yield f"trigger: `{trigger.operands[0]}` becomes false at {at}"
    elif first == last:
        yield f"trigger: `{trigger.text}` at {at}"
    elif finding.cell == first:
        begins = "becomes true at" if first > 0 else "is true from the beginning, at"
        yield f"trigger: `{trigger.text}` {begins} {at}"
    else:
        yield f"trigger: `{trigger.text}` is true since {at}, also at {cell_text(trace, finding.cell)}"


def _reason(trace: Trace, reason: TruthReason) -> Iterator[str]:
    """The reasons why a subformula is false or undetermined, from the outside inwards."""
    at = cell_text(trace, reason.cell)
    if reason.window is not None:
        yield from _window_reason(trace, reason)
        return
    match reason.kind, reason.value:
        case NodeKind.AND | NodeKind.OR | NodeKind.NOT, _ if reason.parts:
            if len(reason.parts) > 1:
                yield f"`{reason.text}` is {reason.value.word} at {at}:"
            for part in reason.parts:
                yield from _reason(trace, part)
        case NodeKind.RISE, Truth.FALSE:
            yield f"`{reason.operands[0]}` does not become true at {at}"
        case NodeKind.FALL, Truth.FALSE:
            yield f"`{reason.operands[0]}` does not become false at {at}"
        case _:
            yield f"`{reason.text}` is {reason.value.word} at {at}"


def _window_reason(trace: Trace, reason: TruthReason) -> Iterator[str]:
    assert reason.window is not None
    first, last = reason.window
    inner = f"`{reason.operands[-1]}`"
    until = "the end of the trace" if last is None else cell_text(trace, last)
    window = f"from {cell_text(trace, first)} to {until}"
    deadline = ", the deadline" if last is not None and reason.kind in (NodeKind.EVENTUALLY, NodeKind.UNTIL) else ""
    match reason.kind, reason.value:
        case NodeKind.EVENTUALLY, Truth.FALSE:
            yield f"{inner} is never true {window}{deadline}"
        case NodeKind.EVENTUALLY, Truth.UNDETERMINED:
            yield f"{inner} has not been true {_so_far(trace, first)}; it is awaited {window}{deadline}"
        case NodeKind.ALWAYS, Truth.FALSE:
            yield f"{inner} should be true at every instant {window}"
        case NodeKind.ALWAYS, Truth.UNDETERMINED:
            yield f"{inner} has to be true at every instant {window}"
        case NodeKind.ONCE, _:
            yield f"{inner} is never true {window}"
        case NodeKind.HISTORICALLY, _:
            yield f"{inner} should have been true at every instant {window}"
        case NodeKind.UNTIL, Truth.FALSE if reason.parts:
            left, right = reason.operands
            yield f"`{left}` should stay true until `{right}` is true, {window}"
        case ((NodeKind.UNTIL | NodeKind.SINCE), Truth.FALSE):
            yield f"{inner} is never true {window}{deadline}"
        case NodeKind.UNTIL, Truth.UNDETERMINED:
            yield f"{inner} has not been true {_so_far(trace, first)}; it is awaited {window}{deadline}"
        case _:
            yield f"`{reason.text}` is {reason.value.word} at {cell_text(trace, reason.cell)}, looking {window}"
    for part in reason.parts:
        yield from _reason(trace, part)


def _so_far(trace: Trace, first: int) -> str:
    """``yet``, or that the window has not begun: the operand may well have been true before it."""
    return "yet" if first <= 2 * trace.end else "in time yet"


def seen_values(trace: Trace, verdict: MonitorVerdict, finding: Finding) -> Iterator[str]:
    """The values of columns that are to blame, a line for each instant."""
    for reason in finding.blamed:
        columns = verdict.explainer.columns(reason)[:_COLUMNS_SHOWN]
        cell = reason.cell if reason.window is None or reason.window[1] is None else reason.window[1]
        if columns and cell <= 2 * trace.end:
            values = ", ".join(f"{column} = {value_text(trace, column, cell)}" for column in columns)
            yield f"seen at {cell_text(trace, cell)}: {values}"


def _certain(trace: Trace, finding: Finding) -> Iterator[str]:
    decided = finding.decided
    if decided is not None and decided != finding.cell:
        yield f"the violation is certain at {cell_text(trace, decided)}"
    if finding.last > finding.cell:
        yield f"violated from {cell_text(trace, finding.cell)} until {clock_text(trace, (finding.last + 1) // 2)}"
