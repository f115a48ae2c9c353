"""`tachk monitor` row by row: from standard input, with --online, or on a file that grows with --follow."""

from __future__ import annotations

import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import TextIO

from tachk.base.awaited_pipe import PATIENCE
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import StoppedError, check_job
from tachk.cli.destination import growing_destination
from tachk.cli.exit_status import ExitStatus
from tachk.cli.judged import Judged, exit_status, print_warnings
from tachk.cli.listeners import JsonListener, LineListener, Listener, TextListener
from tachk.cli.live_capture import open_live, without_hindsight
from tachk.cli.reporting import ReportForm, Reporting, ViolationReporting
from tachk.cli.row_by_row import RowByRow
from tachk.recordings.monitors.formulas import NamedFormula, beside_columns, hidden_formulas
from tachk.recordings.monitors.locations import located
from tachk.recordings.monitors.offline import Judging
from tachk.recordings.monitors.online import Monitor
from tachk.recordings.monitors.row_names import TIME
from tachk.recordings.traces.compressed import is_compressed, open_bytes, plain_suffix
from tachk.recordings.traces.csv_beginning import ByteStream
from tachk.recordings.traces.logs.trace_jsonl import JsonStream
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace_csv import CsvRecording, PushedBack, open_csv, open_csv_stream
from tachk.recordings.traces.trace_files import JSON_LINES, is_csv
from tachk.xrce.traces.live import LivePackets


class _AwaitedFile:
    """A file read beyond its end: whoever reads waits for more, until the time is over."""

    def __init__(self, path: Path) -> None:
        self._stream = path.open("rb")
        self._line = b""

    def readline(self, size: int = -1, /) -> bytes:
        while True:
            self._line += self._stream.readline(size)
            if self._line.endswith(b"\n"):
                line, self._line = self._line, b""
                return line
            check_job()
            time.sleep(PATIENCE)

    def read1(self, size: int = -1, /) -> bytes:
        while True:
            piece = self._stream.read1(size)
            if piece:
                return piece
            check_job()
            time.sleep(PATIENCE)

    def close(self) -> None:
        self._stream.close()


def run_online(
    judged: Judged,
    formulas: tuple[NamedFormula, ...],
    judging: Judging,
    rows: RowByRow,
    told: ViolationReporting,
    reporting: Reporting,
    stream: ByteStream | None = None,
) -> ExitStatus:
    """Judges rows as they come, and says each verdict when it is decided. Ctrl-C ends the trace.

    Args:
        stream: the rows, where they come from standard input.
    """
    if reporting.form is ReportForm.JUNIT:
        raise UsageError("junit reports are written about whole traces", "leave out --online, or take --format json")
    recording = _open(judged, rows, stream)
    if judged.run is not None:
        raise UsageError("row by row a file is one run", "leave out --run, or --online and --follow")
    if isinstance(recording, LivePackets):
        formulas = without_hindsight(formulas, bool(judged.names))
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
        decimals=judged.decimals,
        end=judging.ending,
        robustness=judging.robustness,
        all_violations=told.all_violations,
        packets=recording.packets if isinstance(recording, LivePackets) else None,
    )
    monitor.dated = not isinstance(recording, LivePackets) and recording.dates
    if isinstance(recording, CsvRecording):
        recording = replace(recording, texts=monitor.text_columns, decimals=judged.decimals)
    elif isinstance(recording, JsonStream):
        recording = replace(recording, decimals=judged.decimals)
    with growing_destination(reporting.output, reporting.quiet) as out:
        listener = _listener(monitor, reporting.form, out, judged.trace)
        # A file that is there to its end is read to its end where bounds or violations go on after the decision.
        whole = told.all_violations or (judging.robustness and judged.trace != "-" and not rows.follow)
        ended = _fed(monitor, recording, listener, whole and not rows.fail_fast, rows.fail_fast)
        verdicts = monitor.finish() if ended else monitor.verdicts
        if told.all_violations:
            listener.hear(monitor.take_violations())
        listener.end()
    return exit_status({verdict.truth for verdict in verdicts})


def _listener(monitor: Monitor, form: ReportForm, out: TextIO | None, name: str) -> Listener:
    match form:
        case _ if out is None:
            return Listener(monitor, name)
        case ReportForm.JSON:
            return JsonListener(monitor, name, out)
        case ReportForm.JSONL:
            return LineListener(monitor, name, out)
        case _:
            return TextListener(monitor, name, out)


def _open(judged: Judged, rows: RowByRow, stream: ByteStream | None) -> CsvRecording | JsonStream | LivePackets:
    if judged.others:
        raise UsageError("row by row only one file can be read", "leave out --online, --follow and --fail-fast")
    if rows.live:
        return open_live(judged.trace, judged.ports)
    if stream is not None:
        line = stream.readline()
        if line.lstrip().startswith(b"{"):
            return JsonStream("-", stream, judged.time, judged.unit, line)
        return open_csv_stream(PushedBack(stream, line), "-", judged.time, judged.unit)
    path = Path(judged.trace)
    lines = plain_suffix(path) in JSON_LINES.suffixes
    if not is_csv(path) and not lines:
        raise UsageError(f"{path}: row by row only CSV and JSON lines can be read", "leave out --online")
    if not rows.follow and not lines:
        return open_csv(path, judged.time, judged.unit)
    if not path.is_file():
        raise UsageError(f"there is no file {path}")
    if rows.follow and is_compressed(path):
        raise UsageError(f"{path}: a compressed file cannot be followed", "leave out --follow")
    if not lines:
        return open_csv_stream(_AwaitedFile(path), str(path), judged.time, judged.unit)
    growing: ByteStream = _AwaitedFile(path) if rows.follow else open_bytes(path)
    return JsonStream(str(path), growing, judged.time, judged.unit, growing.readline())


def _fed(
    monitor: Monitor,
    recording: CsvRecording | JsonStream | LivePackets,
    listener: Listener,
    whole: bool,
    fail_fast: bool,
) -> bool:
    """Feeds the monitor until the rows end or, unless the whole is wanted, everything is decided; tells each verdict
    when it is. False: it has stopped before the trace has ended, at a violation or a limit."""
    told: set[str] = set()
    try:
        known = () if isinstance(recording, LivePackets) else recording.columns
        columns = [name for name in monitor.columns if name != TIME or name in known]
        for rows in recording.blocks(columns, monitor.decimals):
            if len(rows.times):
                monitor.push(rows.times, rows.columns, rows.decimals)
            monitor.notes = rows.notes + rows.warnings
            print_warnings(rows.warnings)
            if monitor.watches_violations:
                listener.hear(monitor.take_violations())
            for verdict in monitor.verdicts:
                if verdict.measured is not Truth.UNDETERMINED and verdict.name not in told:
                    told.add(verdict.name)
                    listener.decided(verdict)
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
