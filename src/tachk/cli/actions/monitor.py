"""`tachk monitor`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TextIO

from tachk.cli.actions.monitor_request import MonitorRequest, exit_status
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus
from tachk.cli.terminal import console
from tachk.diagnostics.diagnostic import UsageError
from tachk.monitoring.formulas import NamedFormula, check_order, read_formulas
from tachk.monitoring.offline import Measures, judge, selected
from tachk.report.monitor.record import Ending, MonitorRecord
from tachk.report.monitor.text import print_monitor
from tachk.runtime.trace import Interpolation
from tachk.runtime.trace_files import open_trace


def run_monitor(request: MonitorRequest) -> ExitStatus:
    """Judges a trace, whole or row by row."""
    check_order(request.formula, request.trace)
    formulas = selected(read_formulas(request.formula), request.names)
    if request.online or request.follow or request.trace == "-":
        if request.interpolation != "constant":
            raise UsageError(
                "--interpolation linear needs the whole trace: row by row the next row is not known",
                "leave out --online and --follow, and give a file",
            )
        if request.time_robustness:
            raise UsageError("--time-robustness needs the whole trace", "leave out --online and --follow")
        from tachk.cli.actions.monitor_online import run_online

        return run_online(request, formulas)
    return _run_offline(request, formulas)


def _run_offline(request: MonitorRequest, formulas: tuple[NamedFormula, ...]) -> ExitStatus:
    recording = open_trace(request.trace, request.time, request.unit)
    source = request.formula if Path(request.formula).suffix else ""
    measures = Measures(request.robustness, request.time_robustness)
    record = judge(formulas, recording, Ending(request.end), measures, Interpolation(request.interpolation), source)
    with destination(request.output, request.quiet) as out:
        if out is not None:
            _write(record, request.format, out)
    return exit_status({verdict.truth for verdict in record.verdicts})


def _write(record: MonitorRecord, format_: str, out: TextIO) -> None:
    match format_:
        case "text":
            print_monitor(record, console(out))
        case "json":
            from tachk.report.monitor.json import monitor_to_json

            json.dump(monitor_to_json(record), out, indent=2)
            out.write("\n")
        case "junit":
            from tachk.report.monitor.junit import monitor_to_junit

            out.write(monitor_to_junit(record))
        case _:
            raise UsageError(f"unknown format {format_}")
