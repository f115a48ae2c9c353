"""`tachk monitor`."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import TextIO

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.whole_files import whole_text
from tachk.cli.actions.judged import Judged, exit_status, print_warnings
from tachk.cli.actions.monitoring.standard_input import StandardInput, dump_in_a_file
from tachk.cli.actions.row_by_row import RowByRow
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import ReportForm, Reporting, ViolationReporting
from tachk.cli.terminal import console
from tachk.recordings.monitors.formulas import NamedFormula, names_file
from tachk.recordings.monitors.offline import Judging, judge
from tachk.recordings.monitors.record import MonitorRecord
from tachk.recordings.traces.conventions import Interpolation
from tachk.recordings.traces.logs.set_of_runs import SeveralRuns
from tachk.report.monitor.text import print_monitor


def run_monitor(
    judged: Judged,
    judging: Judging = Judging(),
    rows: RowByRow = RowByRow(),
    told: ViolationReporting = ViolationReporting(),
    reporting: Reporting = Reporting(),
) -> ExitStatus:
    """Judges a trace, whole or row by row."""
    formulas = judged.formulas()
    stream = StandardInput() if judged.trace == "-" and not judged.others and not rows.live else None
    if stream is not None and stream.begins_dump():
        with dump_in_a_file(stream) as path:
            return run_monitor(replace(judged, trace=path, called=judged.trace), judging, rows, told, reporting)
    if rows.online or rows.follow or rows.live or rows.fail_fast or judged.trace == "-":
        if judging.interpolation is not Interpolation.CONSTANT:
            raise UsageError(
                "--interpolation linear needs the whole trace: row by row the next row is not known",
                "leave out --online and --follow, and give a file",
            )
        if judging.time_robustness:
            raise UsageError("--time-robustness needs the whole trace", "leave out --online and --follow")
        if told.signals is not None:
            raise UsageError("--signals needs the whole trace", "leave out --online, --follow and --fail-fast")
        from tachk.cli.actions.monitor_online import run_online

        return run_online(judged, formulas, judging, rows, told, reporting, stream)
    source = judged.formula if names_file(judged.formula) else ""
    recording = judged.recording()
    if isinstance(recording, SeveralRuns):
        return _run_several(recording, formulas, judging, told, reporting)
    record = judge(formulas, recording, judging, source)
    print_warnings(record.trace.warnings)
    if judged.called is not None:
        record = replace(record, trace=replace(record.trace, name=judged.called))
    with destination(reporting.output, reporting.quiet) as out:
        if out is not None:
            _write(record, reporting.form, out, told.all_violations)
    if told.signals is not None:
        from tachk.report.monitor.formula_signals import write_signals

        with whole_text(told.signals) as file:
            write_signals(record, file)
    return exit_status({verdict.truth for verdict in record.verdicts})


def _run_several(
    recording: SeveralRuns,
    formulas: tuple[NamedFormula, ...],
    judging: Judging,
    told: ViolationReporting,
    reporting: Reporting,
) -> ExitStatus:
    """Judges each run of a file."""
    if reporting.form not in (ReportForm.TEXT, ReportForm.JSON) or told.signals is not None:
        raise UsageError(
            f"{recording.name} holds several runs: they are reported as text or JSON, without --signals",
            f"choose one run: --run {next(iter(recording.runs))}",
        )
    from tachk.report.monitor.several_runs import print_runs, runs_to_json

    records = {number: judge(formulas, run, judging) for number, run in recording.runs.items()}
    with destination(reporting.output, reporting.quiet) as out:
        if out is not None and reporting.form is ReportForm.TEXT:
            print_runs(recording.name, records, console(out), told.all_violations)
        elif out is not None:
            json.dump(runs_to_json(recording.name, records, told.all_violations), out, indent=2)
            out.write("\n")
    return exit_status({verdict.truth for record in records.values() for verdict in record.verdicts})


def _write(record: MonitorRecord, form: ReportForm, out: TextIO, all_violations: bool) -> None:
    match form:
        case ReportForm.TEXT:
            print_monitor(record, console(out), all_violations)
        case ReportForm.JSON:
            from tachk.report.monitor.json import monitor_to_json

            json.dump(monitor_to_json(record, all_violations), out, indent=2)
            out.write("\n")
        case ReportForm.JSONL:
            from tachk.report.monitor.event_lines import record_events

            for event in record_events(record, all_violations):
                out.write(json.dumps(event) + "\n")
        case ReportForm.JUNIT:
            from tachk.report.monitor.junit import monitor_to_junit

            out.write(monitor_to_junit(record, all_violations))
        case _:
            raise UsageError(f"unknown format {form}")
