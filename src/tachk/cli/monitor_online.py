"""`tachk monitor` row by row: from standard input, with --online, or on a file that grows with --follow."""

from __future__ import annotations

import json
import sys
import time
from codecs import BOM_UTF8
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TextIO

from tachk.base.awaited_pipe import AwaitedStream, GrowingFile
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import StoppedError
from tachk.base.records import replace
from tachk.cli.destination import growing_destination
from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import Reporting, ViolationReporting
from tachk.cli.row_by_row import RowByRow
from tachk.cli.trace_arguments import TraceArguments, exit_status, print_warnings
from tachk.recordings.monitors.formulas import NamedFormula, beside_columns, hidden_formulas
from tachk.recordings.monitors.locations import located
from tachk.recordings.monitors.online import Monitor
from tachk.recordings.monitors.online_record import OnlineVerdict, OnlineViolation
from tachk.recordings.monitors.row_names import TIME
from tachk.recordings.traces.compressed import is_compressed, open_bytes, plain_suffix
from tachk.recordings.traces.conventions import EvaluationOptions
from tachk.recordings.traces.csv_beginning import ByteStream
from tachk.recordings.traces.logs.trace_jsonl import JsonStream
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace_csv import CsvRecording, PushedBack, open_csv, open_csv_stream
from tachk.recordings.traces.trace_files import JSON_LINES, is_csv
from tachk.report.monitor.event_lines import end_event, verdict_event, violation_event
from tachk.report.monitor.online_report import decided_to_text, online_to_json, online_to_text, violation_to_text
from tachk.xrce.traces.arriving import Pipe
from tachk.xrce.traces.live import LivePackets, needs_hindsight


def open_live(trace: str, ports: tuple[int, ...]) -> LivePackets:
    """A capture on standard input, or a file that grows. Raises UsageError."""
    if trace == "-":
        return LivePackets(trace, Pipe(sys.stdin.fileno()), ports, time.monotonic_ns)
    path = Path(trace)
    if not path.is_file():
        raise UsageError(f"there is no file {path}")
    return LivePackets(trace, GrowingFile(path), ports, time.monotonic_ns)


def without_hindsight(formulas: tuple[NamedFormula, ...], are_chosen: bool) -> tuple[NamedFormula, ...]:
    """The formulas that can be decided while a capture is made; prints the names of the others.

    Args:
        are_chosen: the user has chosen these formulas by their names; then all stay.
    """
    if are_chosen:
        return formulas
    late = [one.name for one in formulas if needs_hindsight(one.columns)]
    if late and len(late) < len(formulas):
        print(f"left out, for they are known only when the capture is over: {', '.join(late)}", file=sys.stderr)
        return tuple(one for one in formulas if one.name not in late)
    return formulas


class OnlineReport:
    """A report while a trace is monitored. This one prints nothing."""

    def __init__(self, monitor: Monitor, name: str) -> None:
        self._monitor = monitor
        self._name = name

    def changed(self, violations: Iterable[OnlineViolation]) -> None:
        """Reports violations that have begun or ended."""

    def decided(self, verdict: OnlineVerdict) -> None:
        """Reports that a verdict is decided."""

    def end(self) -> None:
        """Ends the report: no row follows, or none matters."""


class JsonOnlineReport(OnlineReport):
    """Prints one JSON object at the end."""

    def __init__(self, monitor: Monitor, name: str, out: TextIO) -> None:
        super().__init__(monitor, name)
        self._out = out
        self._ended: list[OnlineViolation] | None = [] if monitor.watches_violations else None

    def changed(self, violations: Iterable[OnlineViolation]) -> None:
        if self._ended is not None:
            self._ended += [violation for violation in violations if violation.until is not None]

    def end(self) -> None:
        json.dump(online_to_json(self._monitor.record(self._name, self._ended)), self._out, indent=2)
        self._out.write("\n")


class LineOnlineReport(OnlineReport):
    """Prints a line of JSON at each event."""

    def __init__(self, monitor: Monitor, name: str, out: TextIO) -> None:
        super().__init__(monitor, name)
        self._out = out
        self._reported: set[str] = set()

    def changed(self, violations: Iterable[OnlineViolation]) -> None:
        self._write(*map(violation_event, violations))

    def decided(self, verdict: OnlineVerdict) -> None:
        self._reported.add(verdict.name)
        self._write(verdict_event(verdict))

    def end(self) -> None:
        record = self._monitor.record(self._name)
        self._write(*(verdict_event(verdict) for verdict in record.verdicts if verdict.name not in self._reported))
        self._write(end_event(record))

    def _write(self, *events: Mapping[str, Any]) -> None:
        if events:
            self._out.write("".join(json.dumps(event) + "\n" for event in events))
            self._out.flush()


class TextOnlineReport(OnlineReport):
    """Prints some lines at each event, and a summary at the end."""

    def __init__(self, monitor: Monitor, name: str, out: TextIO) -> None:
        super().__init__(monitor, name)
        self._out = out
        self._counts: dict[str, int] = {}

    def changed(self, violations: Iterable[OnlineViolation]) -> None:
        for violation in violations:
            if violation.until is None:
                self._counts[violation.name] = self._counts.get(violation.name, 0) + 1
            self._out.write(violation_to_text(violation, self._monitor.unit, self._monitor.dated) + "\n")
        self._out.flush()

    def decided(self, verdict: OnlineVerdict) -> None:
        self._out.write(decided_to_text(verdict, self._monitor.unit, self._monitor.dated) + "\n")
        self._out.flush()

    def end(self) -> None:
        record = self._monitor.record(self._name)
        self._out.write(online_to_text(record))
        if self._monitor.watches_violations:
            for verdict in record.verdicts:
                if verdict.measured is not Truth.TRUE:
                    count = self._counts.get(verdict.name, 0)
                    self._out.write(f"{verdict.name}: {count} {'violation' if count == 1 else 'violations'}\n")


_ONLINE_REPORTS = {"text": TextOnlineReport, "json": JsonOnlineReport, "jsonl": LineOnlineReport}
"""By the formats of reports that can be written while a trace is recorded."""


def run_online(
    arguments: TraceArguments,
    formulas: tuple[NamedFormula, ...],
    evaluation: EvaluationOptions,
    rows: RowByRow,
    violations: ViolationReporting,
    reporting: Reporting,
    stream: ByteStream | None = None,
) -> ExitStatus:
    """Judges rows as they come, and says each verdict when it is decided. Ctrl-C ends the trace.

    Args:
        stream: the rows, where they come from standard input.
    """
    if reporting.form not in _ONLINE_REPORTS:
        raise UsageError(
            f"{reporting.form} reports are written about whole traces", "leave out --online, or take --format json"
        )
    recording = _open(arguments, rows, stream)
    if arguments.run is not None:
        raise UsageError("row by row a file is one run", "leave out --run, or --online and --follow")
    if isinstance(recording, LivePackets):
        formulas = without_hindsight(formulas, bool(arguments.names))
    if not isinstance(recording, LivePackets):
        print_warnings(hidden_formulas(formulas, recording.columns))
        if isinstance(recording, CsvRecording):
            formulas = beside_columns(formulas, recording.columns)
        else:  # later lines may have other columns
            formulas = tuple(named.beside(recording.columns) for named in formulas)
        formulas = tuple(located(named, recording.columns) for named in formulas)
    monitor = Monitor(
        formulas,
        unit=recording.unit,
        decimals=arguments.decimals,
        end=evaluation.ending,
        robustness=evaluation.robustness,
        all_violations=violations.all_violations,
        packets=recording.packets if isinstance(recording, LivePackets) else None,
    )
    monitor.dated = not isinstance(recording, LivePackets) and recording.dates
    if isinstance(recording, CsvRecording):
        recording = replace(recording, texts=monitor.text_columns, decimals=arguments.decimals)
    elif isinstance(recording, JsonStream):
        recording = replace(recording, decimals=arguments.decimals)
    with growing_destination(reporting.output, reporting.quiet) as out:
        report = OnlineReport(monitor, arguments.trace)
        if out is not None:
            report = _ONLINE_REPORTS[reporting.form](monitor, arguments.trace, out)
        # A file that is there to its end is read to its end where bounds or violations go on after the decision.
        whole = violations.all_violations or (evaluation.robustness and arguments.trace != "-" and not rows.follow)
        ended = _fed(monitor, recording, report, whole and not rows.fail_fast, rows.fail_fast)
        verdicts = monitor.finish() if ended else monitor.verdicts
        if violations.all_violations:
            report.changed(monitor.take_violations())
        report.end()
    return exit_status({verdict.truth for verdict in verdicts})


def _open(
    arguments: TraceArguments, rows: RowByRow, stream: ByteStream | None
) -> CsvRecording | JsonStream | LivePackets:
    if arguments.others:
        raise UsageError("row by row only one file can be read", "leave out --online, --follow and --fail-fast")
    if rows.live:
        return open_live(arguments.trace, arguments.ports)
    if stream is not None:
        begin = line = stream.readline()
        while line and not line.removeprefix(BOM_UTF8).strip():
            line = stream.readline()
            begin += line
        first = line.removeprefix(BOM_UTF8)
        if first.lstrip().startswith(b"{"):
            return JsonStream("-", stream, arguments.time, arguments.unit, first)
        return open_csv_stream(PushedBack(stream, begin), "-", arguments.time, arguments.unit)
    path = Path(arguments.trace)
    lines = plain_suffix(path) in JSON_LINES.suffixes
    if not is_csv(path) and not lines:
        raise UsageError(f"{path}: row by row only CSV and JSON lines can be read", "leave out --online")
    if not rows.follow and not lines:
        return open_csv(path, arguments.time, arguments.unit)
    if not path.is_file():
        raise UsageError(f"there is no file {path}")
    if rows.follow and is_compressed(path):
        raise UsageError(f"{path}: a compressed file cannot be followed", "leave out --follow")
    if not lines:
        return open_csv_stream(_followed(path), str(path), arguments.time, arguments.unit)
    growing: ByteStream = _followed(path) if rows.follow else open_bytes(path)
    return JsonStream(str(path), growing, arguments.time, arguments.unit, growing.readline())


def _followed(path: Path) -> AwaitedStream:
    file = GrowingFile(path)
    return AwaitedStream(file.read1, file.close)


def _fed(
    monitor: Monitor,
    recording: CsvRecording | JsonStream | LivePackets,
    report: OnlineReport,
    whole: bool,
    fail_fast: bool,
) -> bool:
    """Feeds the monitor until the rows end or, unless the whole is wanted, everything is decided; prints each verdict
    when it is. False: it has stopped before the trace has ended, at a violation or a limit."""
    reported: set[str] = set()
    try:
        known = () if isinstance(recording, LivePackets) else recording.columns
        columns = [name for name in monitor.columns if name != TIME or name in known]
        for rows in recording.blocks(columns, monitor.decimals):
            if len(rows.times):
                monitor.push(rows.times, rows.columns, rows.decimals)
            monitor.notes = rows.notes + rows.warnings
            print_warnings(rows.warnings)
            if monitor.watches_violations:
                report.changed(monitor.take_violations())
            for verdict in monitor.verdicts:
                if verdict.measured is not Truth.UNDETERMINED and verdict.name not in reported:
                    reported.add(verdict.name)
                    report.decided(verdict)
            if fail_fast and monitor.truth is Truth.FALSE:
                return False
            if monitor.decided and not whole:
                break
    except KeyboardInterrupt:
        pass
    except StoppedError as error:
        print(f"the {error.reason} was over before the trace ended", file=sys.stderr)
        return False
    return True
