"""The action of `tachk monitor`."""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from tachk.base.awaited_pipe import AwaitedStream, awaited_pipe
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.whole_files import whole_text
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import Reporting, ViolationReporting
from tachk.cli.row_by_row import RowByRow
from tachk.cli.terminal import console
from tachk.cli.trace_arguments import TraceArguments, exit_status, print_warnings
from tachk.recordings.monitors.formulas import NamedFormula, names_file
from tachk.recordings.monitors.offline import EvaluationOptions, judge
from tachk.recordings.traces.conventions import Interpolation
from tachk.recordings.traces.logs.set_of_runs import SeveralRuns
from tachk.report.monitor.formats import write_monitor


@contextmanager
def dump_in_a_file(stream: AwaitedStream) -> Iterator[str]:
    """Reads standard input to its end; gives the path of a file that has it, as long as it is used."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "standard_input.vcd"
        with path.open("wb") as file:
            while piece := stream.read1():
                file.write(piece)
        yield str(path)


def _reader() -> Callable[[int], bytes | None]:
    buffer = sys.stdin.buffer
    try:
        descriptor = buffer.fileno()
    except OSError:  # a stream that lives in memory
        return getattr(buffer, "read1", buffer.read)
    return awaited_pipe(descriptor).read1


def run_monitor(
    arguments: TraceArguments,
    evaluation: EvaluationOptions = EvaluationOptions(),
    rows: RowByRow = RowByRow(),
    violations: ViolationReporting = ViolationReporting(),
    reporting: Reporting = Reporting(),
) -> ExitStatus:
    """Judges a trace, whole or row by row."""
    formulas = arguments.formulas()
    stream = AwaitedStream(_reader()) if arguments.trace == "-" and not arguments.others and not rows.live else None
    if stream is not None and stream.begins_dump():
        with dump_in_a_file(stream) as path:
            return run_monitor(
                replace(arguments, trace=path, called=arguments.trace), evaluation, rows, violations, reporting
            )
    if rows.online or rows.follow or rows.live or rows.fail_fast or arguments.trace == "-":
        if evaluation.interpolation is not Interpolation.CONSTANT:
            raise UsageError(
                "--interpolation linear needs the whole trace: row by row the next row is not known",
                "leave out --online and --follow, and give a file",
            )
        if evaluation.time_robustness:
            raise UsageError("--time-robustness needs the whole trace", "leave out --online and --follow")
        if violations.signals is not None:
            raise UsageError("--signals needs the whole trace", "leave out --online, --follow and --fail-fast")
        from tachk.cli.monitor_online import run_online

        return run_online(arguments, formulas, evaluation, rows, violations, reporting, stream)
    source = arguments.formula if names_file(arguments.formula) else ""
    recording = arguments.recording()
    if isinstance(recording, SeveralRuns):
        return _run_several(recording, formulas, evaluation, violations, reporting)
    record = judge(formulas, recording, evaluation, source)
    print_warnings(record.trace.warnings)
    if arguments.called is not None:
        record = replace(record, trace=replace(record.trace, name=arguments.called))
    with destination(reporting.output, reporting.quiet) as out:
        if out is not None:
            write_monitor(reporting.form, record, out, console, violations.all_violations)
    if violations.signals is not None:
        from tachk.report.monitor.formula_signals import write_signals

        with whole_text(violations.signals) as file:
            write_signals(record, file)
    return exit_status({verdict.truth for verdict in record.verdicts})


def _run_several(
    recording: SeveralRuns,
    formulas: tuple[NamedFormula, ...],
    evaluation: EvaluationOptions,
    violations: ViolationReporting,
    reporting: Reporting,
) -> ExitStatus:
    """Judges each run of a file."""
    if reporting.form not in ("text", "json") or violations.signals is not None:
        raise UsageError(
            f"{recording.name} holds several runs: they are reported as text or JSON, without --signals",
            f"choose one run: --run {next(iter(recording.runs))}",
        )
    from tachk.report.monitor.several_runs import print_runs, runs_to_json

    records = {number: judge(formulas, run, evaluation) for number, run in recording.runs.items()}
    with destination(reporting.output, reporting.quiet) as out:
        if out is not None and reporting.form == "text":
            print_runs(recording.name, records, console(out), violations.all_violations)
        elif out is not None:
            json.dump(runs_to_json(recording.name, records, violations.all_violations), out, indent=2)
            out.write("\n")
    return exit_status({verdict.truth for record in records.values() for verdict in record.verdicts})
