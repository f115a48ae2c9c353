"""`tachk monitor`: check properties on a recorded trace."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.awaited_pipe import AwaitedStream, awaited_pipe
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import replace
from tachk.base.whole_files import whole_text
from tachk.cli import options, trace_options
from tachk.cli.destination import destination
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import Reporting, ViolationReporting
from tachk.cli.row_by_row import RowByRow
from tachk.cli.terminal import console
from tachk.recordings.traces.conventions import EvaluationOptions, Interpolation, TraceEnding
from tachk.report.monitor.formats import MONITOR_FORMATS, write_monitor

if TYPE_CHECKING:
    from tachk.cli.trace_arguments import TraceArguments
    from tachk.recordings.monitors.formulas import NamedFormula
    from tachk.recordings.traces.logs.set_of_runs import SeveralRuns


@contextmanager
def dump_in_a_file(stream: AwaitedStream) -> Iterator[str]:
    """Reads standard input to its end; gives the path of a file that has it, as long as it is used."""
    import tempfile

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


@click.command(name="monitor")
@trace_options.formula
@trace_options.trace("; - reads CSV or JSON lines from standard input as they come, or VCD")
@trace_options.columns
@click.option(
    "ending",
    "--end",
    type=options.Choice(TraceEnding),
    default=TraceEnding.UNDETERMINED.value,
    show_default=True,
    help="What an obligation that is open at the end counts as: undetermined, satisfied (weak) or violated (strong).",
)
@click.option(
    "--robustness/--no-robustness",
    default=True,
    show_default=True,
    help="Also compute how far values are from changing a verdict.",
)
@click.option(
    "--time-robustness",
    is_flag=True,
    help="Also compute how far each column can at least be shifted in time without changing a verdict.",
)
@click.option("--all-violations", is_flag=True, help="Report all violations, not only the first of each formula.")
@click.option(
    "--signals",
    metavar="FILE",
    type=options.written_file,
    help="Write the truth and the robustness of each formula over time, as comma-separated values.",
)
@click.option(
    "over",
    "--find",
    metavar="NAME=LOW..HIGH",
    multiple=True,
    help="Find the tightest value of this name in the formula, from this range, with which each TRACE, taken alone, "
    "satisfies it.",
)
@click.option("step", "--step", metavar="NUMBER", help="With --find: try multiples of this number only.")
@click.option("--online", is_flag=True, help="Read the trace row by row, with bounded memory.")
@click.option("--follow", is_flag=True, help="At the end of the file, wait for further rows.")
@click.option("--live", is_flag=True, help="TRACE is a capture of packets that is being made: - or a file.")
@click.option("--fail-fast", is_flag=True, help="Read row by row, and stop at the first verdict that is false.")
@options.max_seconds()
@options.report(*MONITOR_FORMATS)
def command(seconds: float | None, **given: Any) -> None:
    """Check formulas, sentences or the properties of a model on a recorded trace.

    Exit status: 0 all are true, 10 some are false, 20 some are undetermined or time ran out and none is false,
    2 bad input. With --find: 0 there is such a value, 10 there is none.
    """
    from tachk.cli.found_parameter import FindOptions, run_find
    from tachk.cli.trace_arguments import TraceArguments

    search, *arguments = distributed(
        given, FindOptions, TraceArguments, EvaluationOptions, RowByRow, ViolationReporting, Reporting
    )
    if search.over:
        options.finish(lambda: run_find(search, *arguments), seconds)
    if search.step is not None:
        raise click.UsageError("--step goes with --find.")
    options.finish(lambda: run_monitor(*arguments), seconds)


def run_monitor(
    arguments: TraceArguments,
    evaluation: EvaluationOptions = EvaluationOptions(),
    rows: RowByRow = RowByRow(),
    violations: ViolationReporting = ViolationReporting(),
    reporting: Reporting = Reporting(),
) -> ExitStatus:
    """Judges a trace, whole or row by row."""
    from tachk.cli.trace_arguments import exit_status, print_warnings
    from tachk.recordings.monitors.formulas import names_file
    from tachk.recordings.monitors.offline import evaluate_formulas
    from tachk.recordings.traces.logs.set_of_runs import SeveralRuns

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
    record = evaluate_formulas(formulas, recording, evaluation, source)
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
    from tachk.cli.trace_arguments import exit_status
    from tachk.recordings.monitors.offline import evaluate_formulas

    if reporting.form not in ("text", "json") or violations.signals is not None:
        raise UsageError(
            f"{recording.name} holds several runs: they are reported as text or JSON, without --signals",
            f"choose one run: --run {next(iter(recording.runs))}",
        )
    from tachk.report.monitor.several_runs import print_runs, runs_to_json

    records = {number: evaluate_formulas(formulas, run, evaluation) for number, run in recording.runs.items()}
    with destination(reporting.output, reporting.quiet) as out:
        if out is not None and reporting.form == "text":
            print_runs(recording.name, records, console(out), violations.all_violations)
        elif out is not None:
            json.dump(runs_to_json(recording.name, records, violations.all_violations), out, indent=2)
            out.write("\n")
    return exit_status({verdict.truth for record in records.values() for verdict in record.verdicts})
