"""`tachk time`: measure the time between two events, over all runs."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import OutOfTimeError, StoppedError, current_job, limited, unhurried
from tachk.base.records import dataclass
from tachk.cli import options
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import print_diagnostics
from tachk.engine.options import Limits
from tachk.model.grid import grid_of

if TYPE_CHECKING:
    from tachk.api import model as api
    from tachk.report.time_report import TimedRow
    from tachk.verify.times import Times


@click.command(name="time")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@click.option(
    "start",
    "--from",
    metavar="EVENT",
    help="The first event: a condition that becomes true, a channel (c!, c?) or a signal. Without it: the start of "
    "the run.",
)
@click.option("end", "--to", metavar="EVENT", required=True, help="The second event: the next one after the first.")
@click.option(
    "last",
    "--last/--first",
    help="If the first event comes again before the second, measure from the last one; else from the first.",
)
@click.option("best", "--best", is_flag=True, help="Only the least time.")
@click.option(
    "worst", "--worst", is_flag=True, help="Only the largest time, and whether the second event may not come."
)
@click.option(
    "settled",
    "--settled",
    is_flag=True,
    help="Look at conditions only where no process is in a committed location, as temporal properties do.",
)
@click.option(
    "over",
    "--over",
    metavar="NAME=A..B",
    multiple=True,
    help="A table over the values of constants: LOSSES=0..3,HBA=5 (several are separated by commas).",
)
@click.option("traces", "--traces", is_flag=True, help="Also show a run for each time.")
@options.definitions
@click.option(
    "form",
    "--format",
    type=click.Choice(("text", "csv", "json")),
    default="text",
    show_default=True,
    help="Form of the report.",
)
@click.option("output", "-o", "--output", metavar="FILE", type=options.written_file, help="Write the report to a file.")
@options.max_states()
@options.max_seconds()
def command(
    model: str,
    start: str | None,
    end: str,
    last: bool,
    best: bool,
    worst: bool,
    settled: bool,
    over: tuple[str, ...],
    traces: bool,
    definitions: tuple[str, ...],
    form: str,
    output: Path | None,
    states: int | None,
    seconds: float | None,
) -> None:
    """Measure the least and the largest time between two events, over all runs of a model."""

    arguments = TimeArguments(model, start, end, last, best, worst, settled, over, definitions)
    options.finish(lambda: run_time(arguments, Limits(states=states, seconds=seconds), form, output, traces), seconds)


_MOST_ROWS = 10_000


@dataclass(frozen=True, slots=True)
class TimeArguments:
    """Arguments of `tachk time`."""

    model: str
    start: str | None
    end: str
    last: bool = False
    best: bool = False
    worst: bool = False
    settled: bool = False
    over: tuple[str, ...] = ()
    definitions: tuple[str, ...] = ()


def run_time(
    arguments: TimeArguments,
    limits: Limits = Limits(),
    form: str = "text",
    output: Path | None = None,
    traces: bool = False,
) -> ExitStatus:
    """Measures for each combination of the values of constants, and reports in one table."""
    from tachk.api import model as api
    from tachk.cli.arguments import split_definitions
    from tachk.engine.outcome import INTERRUPTED
    from tachk.report.time_report import TimedInterval, TimedRow, times_to_csv, times_to_json, times_to_text

    constants, several = split_definitions(arguments.definitions)
    grid = grid_of((*arguments.over, *several), "--over")
    if len(grid) > _MOST_ROWS:
        raise UsageError(f"these are {len(grid)} rows, and {_MOST_ROWS} are the most")
    twice = [name for name in grid.names if name in constants]
    if twice:
        raise UsageError(f"{twice[0]} is set by -D and by --over")
    rows: list[TimedRow] = []
    with destination(output) as out:
        assert out is not None
        with limited(limits.seconds):
            for values in grid.cells():
                given = dict(zip(grid.names, values, strict=True))
                chosen = {name: value for name, value in given.items() if isinstance(value, int)}
                if rows and chosen == given and current_job().seconds_left == 0:
                    rows.append(TimedRow(chosen, rows[0].network, _unknown(OutOfTimeError.reason)))
                    continue
                with unhurried():  # a table as far as it goes
                    model = api.load(arguments.model, **constants, **given)
                if not rows:
                    print_diagnostics((*model.refusals, *model.warnings))
                chosen = {name: model.constants[name] for name in grid.names}
                rows.append(TimedRow(chosen, model.network, _times(model, arguments, limits, traces)))
                if rows[-1].times.reason == INTERRUPTED:
                    break
        between = TimedInterval(arguments.model, arguments.start, arguments.end, arguments.last)
        match form:
            case "text":
                out.write(times_to_text(between, rows, traces))
            case "csv":
                out.write(times_to_csv(rows))
            case _:
                print(json.dumps(times_to_json(between, rows), indent=2), file=out)
    if form != "text":
        for reason in dict.fromkeys(row.times.reason for row in rows if row.times.reason):
            print(f"some times are unknown: {reason}", file=sys.stderr)
    return worst(_statuses(rows))


def _times(model: api.Model, arguments: TimeArguments, limits: Limits, traces: bool) -> Times:
    """The times of a model; unknown if a limit ended the search."""
    from tachk.api.times import OPTIONS, measured_times
    from tachk.engine.options import Options
    from tachk.report.time_report import TimedInterval

    try:
        return measured_times(
            model.loaded,
            TimedInterval(arguments.model, arguments.start, arguments.end, arguments.last),
            OPTIONS,
            best=arguments.best or not arguments.worst,
            worst=arguments.worst or not arguments.best,
            settled=arguments.settled,
            options=Options(),
            limits=limits,
            trace=traces,
        )
    except StoppedError as error:
        return _unknown(error.reason)


def _unknown(reason: str) -> Times:
    from tachk.verify.times import Times

    return Times(None, None, None, reason)


def _statuses(rows: Iterable[TimedRow]) -> Iterator[ExitStatus]:
    from tachk.engine.outcome import INTERRUPTED

    for row in rows:
        if row.times.reason == INTERRUPTED:
            yield ExitStatus.INTERRUPTED
        elif row.times.reason:
            yield ExitStatus.UNKNOWN
