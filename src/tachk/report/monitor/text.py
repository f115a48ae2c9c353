"""The report of a monitor for people: the table of verdicts, then the reasons where one is not true."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TextIO

from rich.console import Console
from rich.table import Table
from rich.text import Text

from tachk.model.quantity import grouped
from tachk.recordings.monitors.record import MonitorRecord, MonitorVerdict, cell_text, clock_text
from tachk.recordings.traces.conventions import Interpolation, TraceEnding
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.violations import Violations
from tachk.report.monitor.words import count_violations, explain_verdict, seen_values

STYLES = {Truth.TRUE: "green", Truth.FALSE: "red", Truth.UNDETERMINED: "yellow"}


def write_text(record: MonitorRecord, out: TextIO, console: Callable[[TextIO], Console], all_violations: bool) -> None:
    """A row of `tachk.report.monitor.formats`."""
    print_monitor(record, console(out), all_violations)


def print_monitor(record: MonitorRecord, console: Console, all_violations: bool = False) -> None:
    """Prints the verdicts on one trace.

    Args:
        all_violations: also a table of them, for each formula.
    """
    trace = record.trace
    rows = f"{grouped(trace.rows)} {'row' if trace.rows == 1 else 'rows'}"
    console.print(Text(f"{trace.name}: {rows}, from {clock_text(trace, 0)} to {clock_text(trace, trace.end)}"))
    moving = [name for name in trace.columns if trace.moves(name)]
    if trace.interpolation is Interpolation.LINEAR:
        console.print(Text(f"straight lines between rows: {', '.join(moving) or 'no column holds numbers'}"))
    for note in trace.notes:
        console.print(Text(note))
    console.print()
    console.print(_table(record))
    for verdict in record.verdicts:
        lines = explain_verdict(record, verdict)
        if lines:
            console.print()
            console.print(Text(f"{verdict.name} is {verdict.measured.word}", style=f"bold {STYLES[verdict.measured]}"))
            if verdict.sentence:
                console.print(Text(f"  {verdict.sentence}", style="dim"))
            for line in lines:
                console.print(Text(f"  {line}"))
            _print_violations(record, verdict, console, all_violations)
    console.print()
    console.print(_summary(record))


def _print_violations(record: MonitorRecord, verdict: MonitorVerdict, console: Console, listed: bool) -> None:
    violations = verdict.violations
    line = count_violations(violations)
    if line:
        console.print(Text(f"  {line}"))
    if listed and len(violations):
        console.print()
        console.print(_violations_table(record, verdict, violations))


def _violations_table(record: MonitorRecord, verdict: MonitorVerdict, violations: Violations) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), show_header=True, header_style="dim")
    several = len(violations.parts) > 1
    triggered = violations.triggers is not None
    table.add_column("  violated at", no_wrap=True)
    table.add_column("until", no_wrap=True)
    if triggered:
        table.add_column("trigger since", no_wrap=True)
        table.add_column("deadline", no_wrap=True)
    if several:
        table.add_column("of", overflow="fold")
    table.add_column("seen", overflow="fold")
    trace = record.trace
    for finding in violations:
        last = (finding.last + 1) // 2
        row = [f"  {cell_text(trace, finding.cell)}", clock_text(trace, last)]
        if triggered:
            row.append("" if finding.triggered is None else cell_text(trace, finding.triggered[0]))
            row.append("" if finding.deadline is None else cell_text(trace, finding.deadline))
        if several:
            row.append(finding.formula)
        row.append("; ".join(line.removeprefix("seen at ") for line in seen_values(trace, verdict, finding)))
        table.add_row(*map(Text, row))
    return table


def answer_text(verdict: MonitorVerdict) -> str:
    """The verdict in a few words: ``true``, ``undetermined, presumably false``, ``true (nothing triggered)``."""
    if verdict.measured is not verdict.truth:
        return f"{verdict.truth.word} (undetermined at the end)"
    if verdict.truth is Truth.UNDETERMINED and verdict.presumably is not None:
        return f"undetermined, presumably {verdict.presumably.word}"
    return f"{verdict.truth.word} (nothing triggered)" if verdict.vacuous else verdict.truth.word


def is_quantitative(record: MonitorRecord) -> bool:
    """Whether the robustness of some verdict says more than its truth."""
    return any(finite_robustness_text(verdict.robustness) for verdict in record.verdicts)


def finite_robustness_text(robustness: tuple[float, float] | None) -> str:
    """As `robustness_text`; empty for the two infinities, which a formula without numbers has."""
    return "" if robustness is None or all(map(math.isinf, robustness)) else robustness_text(robustness)


def robustness_text(robustness: tuple[float, float] | None) -> str:
    """A number where the interval is one, else the interval: ``2.5``, ``-inf .. 0.5``."""
    if robustness is None:
        return ""
    low, high = robustness
    return _number(low) if low == high else f"{_number(low)} .. {_number(high)}"


def _number(value: float) -> str:
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    return f"{value:.6g}"


_MILLISECONDS = 1000
"""In the unit of captures, a second: what happens between packets is a matter of milliseconds."""


def _table(record: MonitorRecord) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), show_header=True, header_style="dim")
    quantitative = is_quantitative(record)
    table.add_column("  formula", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    if quantitative:
        table.add_column("robustness", no_wrap=True)
    timed = any(verdict.time_robustness is not None for verdict in record.verdicts)
    if timed:
        captured = record.trace.packets is not None
        unit = " [ms]" if captured else f" [{record.trace.unit}]" if record.trace.unit else ""
        factor = _MILLISECONDS if captured else 1
        table.add_column(Text(f"ahead{unit}"), no_wrap=True)
        table.add_column(Text(f"behind{unit}"), no_wrap=True)
    table.add_column("meaning", overflow="fold")
    for verdict in record.verdicts:
        row = [Text(f"  {verdict.name}"), Text(answer_text(verdict), style=STYLES[verdict.truth])]
        if quantitative:
            row.append(Text(robustness_text(verdict.robustness)))
        if timed:
            bounds = verdict.time_robustness
            sides = () if bounds is None else (bounds.ahead, bounds.behind)
            texts = [robustness_text((low * factor, high * factor)) for low, high in sides] or ["", ""]
            row.extend(map(Text, texts))
        table.add_row(*row, Text(verdict.formula))
    return table


def _summary(record: MonitorRecord) -> Text:
    parts = []
    for truth in (Truth.TRUE, Truth.FALSE, Truth.UNDETERMINED):
        number = sum(verdict.truth is truth for verdict in record.verdicts)
        if number:
            parts.append(f"{number} {truth.word}")
    rule = {
        TraceEnding.UNDETERMINED: "",
        TraceEnding.WEAK: "; what is pending at the end counts as satisfied",
        TraceEnding.STRONG: "; what is pending at the end counts as violated",
    }[record.ending]
    return Text(", ".join(parts) + rule)
