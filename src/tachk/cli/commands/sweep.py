"""`tachk sweep`: check a model for many values of its constants."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import DIGITS
from tachk.base.job import current_job, limited
from tachk.base.optional_packages import require
from tachk.base.records import dataclass
from tachk.base.seeds import DEFAULT_SEED
from tachk.base.whole_files import write_whole
from tachk.cli import options
from tachk.cli import simulation_options as drawing
from tachk.cli.destination import destination
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.cli.reporting import Reporting
from tachk.cli.terminal import can_rewrite_lines
from tachk.engine.options import Limits
from tachk.model.grid import grid_of

if TYPE_CHECKING:
    from tachk.report.campaign.table import Sweep
    from tachk.simulation.statistics.estimate import Settings
    from tachk.verify.campaign.run import Progress


@click.command(name="sweep")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@click.argument("queries", metavar="[QUERY]...", nargs=-1, required=False, help="Queries.")
@click.option(
    "over",
    "-D",
    "--define",
    "--over",
    metavar="NAME=VALUES,...",
    multiple=True,
    help="Set a global constant of the model to each of these values: 3, 1..5, 10,50,100 or 0..60:5.",
)
@click.option(
    "properties",
    "--property",
    metavar="NAME",
    multiple=True,
    help="A property of the model; `all` for every one, which is the default.",
)
@click.option(
    "store",
    "--store",
    metavar="FILE",
    type=options.type_of_file,
    help="Keep finished cells in this SQLite file. A sweep that was stopped goes on where it was.",
)
@click.option(
    "processes",
    "-j",
    "--processes",
    metavar="N",
    type=options.Count(min=1),
    help="Compute so many cells at a time; without it as many as the machine has cores.",
)
@click.option("dask", "--dask", metavar="ADDRESS", help="Compute on the Dask cluster with this scheduler.")
@options.report("text", "csv", "json")
@click.option(
    "picture",
    "--heat-map",
    metavar="FILE",
    type=options.written_file,
    help="Draw a map of the values into this .svg, .png or .pdf file.",
)
@click.option(
    "show",
    "--show",
    metavar="COLUMN",
    default="answer",
    show_default=True,
    help="What the map shows: answer, or a column of numbers such as states_stored, run_end, estimate.",
)
@click.option(
    "seconds_each",
    "--cell-seconds",
    metavar="SECONDS",
    type=options.Seconds(min=0),
    help="Stop the check of a cell after this time; its answers are unknown then.",
)
@click.option(
    "formulas",
    "--monitor",
    metavar="FORMULA",
    help="Check this formula, or those of a file, on random runs of each cell: the probability that a run "
    "satisfies them. Properties are checked then only where they are named.",
)
@click.option(
    "until",
    "--until",
    metavar="TIME",
    default="100",
    show_default=True,
    help="With --monitor: the length of the runs, such as 100 or 2 h.",
)
@click.option(
    "part",
    "--part",
    metavar="K/N",
    default="1/1",
    help="Compute every N-th cell, from the K-th one on: one of N jobs, each with a --store of its own.",
)
@click.option(
    "merged",
    "--merge",
    metavar="FILE",
    multiple=True,
    type=options.type_of_file,
    help="Take over the cells of this file of the same sweep, such as a part has made.",
)
@drawing.confidence(0.8, "Confidence level of the intervals of statistical queries.")
@drawing.half_width("Statistical queries draw runs until the interval of a probability is at most 2 E wide.")
@drawing.runs("Statistical queries draw N runs, --monitor judges N (else 100).")
@drawing.seed("Seed of the runs of statistical queries.")
@drawing.splitting
@options.max_states("; its answers are unknown then")
@options.max_memory
@click.option("non_zeno", "--non-zeno", is_flag=True, help="Count only runs in which time diverges.")
@options.max_seconds("Stop after this time. Cells that are not finished then are missing; --store lets them follow.")
def command(**given: Any) -> None:
    """Check a model for every combination of values of its constants.

    \b
    tachk sweep fischer.ta -D N=2..4 -D WRITE=1..5 --property mutual_exclusion
    tachk sweep model.ta -D LOSSES=0..5 -D SLICE=10,50,100 --store sweep.sqlite -o table.parquet

    With -o and a name that ends in .csv or .parquet, tachk writes the table there and prints the report.
    Exit status: 0 every answer is known, 20 some are unknown or cells are not finished, 2 bad input.
    """

    seconds = given.pop("seconds")
    arguments, reporting = distributed(given, SweepArguments, Reporting)
    options.finish(lambda: run_sweep(arguments, reporting, seconds))


_EVERY = "all"
_RUNS = 100
"""The default number of runs that --monitor judges in each cell."""


@dataclass(frozen=True, slots=True)
class SweepArguments:
    """Arguments of `tachk sweep`.

    Attributes:
        over: constants with their values.
        processes: None for as many as there are cores.
        dask: the address of a scheduler, in place of processes here.
        picture: the file of the heat map.
        show: the column that it shows.
        seconds_each: the limit of each cell.
        states: the limit of each search.
        max_memory: such as ``2G``.
        formulas, until: as for `tachk simulate`: the formulas for the runs of each cell, and their length.
        part: such as ``3/10``.
        merged: files of the same sweep.
    """

    model: str
    queries: tuple[str, ...] = ()
    over: tuple[str, ...] = ()
    properties: tuple[str, ...] = ()
    store: Path | None = None
    processes: int | None = None
    dask: str | None = None
    picture: Path | None = None
    show: str = "answer"
    seconds_each: float | None = None
    states: int | None = None
    max_memory: str | None = None
    non_zeno: bool = False
    confidence: float = 0.95
    half_width: float = 0.05
    runs: int | None = None
    seed: int = DEFAULT_SEED
    splitting: bool = False
    relative: float = 0.1
    effort: int = 1000
    formulas: str | None = None
    until: str = "100"
    part: str = "1/1"
    merged: tuple[Path, ...] = ()


def run_sweep(arguments: SweepArguments, reporting: Reporting, seconds: float | None) -> ExitStatus:
    """Computes the table, and reports."""
    from tachk.api import model as api
    from tachk.cli.arguments import parse_size, refuse_setting
    from tachk.verify.campaign.job import ESTIMATED
    from tachk.verify.verdict import Answer

    for query in arguments.queries:
        refuse_setting(query, "--over")
    if arguments.picture is not None:
        require("matplotlib")
    grid = grid_of(arguments.over)
    memory = None if arguments.max_memory is None else parse_size(arguments.max_memory)
    first = {axis.name: axis.values[0] for axis in grid.axes}
    with limited(seconds):
        with limited(memory=memory):
            model = api.load(arguments.model, **first)
        print_diagnostics((*model.refusals, *model.warnings))
        named = tuple(
            name for name in arguments.properties if name != _EVERY or _EVERY in {q.name for q in model.properties}
        )
        with _progress(reporting.quiet) as progress:
            found = model.sweep(
                *arguments.queries,
                over=grid,
                property=named,
                non_zeno=arguments.non_zeno,
                store=arguments.store,
                processes=arguments.processes,
                dask=arguments.dask,
                limits=Limits(states=arguments.states, seconds=arguments.seconds_each, memory_bytes=memory),
                seconds=current_job().seconds_left,
                progress=progress,
                settings=_settings(arguments),
                monitor=arguments.formulas,
                until=arguments.until,
                runs=arguments.runs or _RUNS,
                seed=arguments.seed,
                part=_part(arguments.part),
                merge=arguments.merged,
            )
    if arguments.picture is not None:
        estimated = arguments.show == "answer" and all(row["answer"] == ESTIMATED for row in found.rows)
        found.plot(arguments.picture, "estimate" if estimated else arguments.show)
    _write(found, reporting)
    if found.campaign.interrupted:
        return ExitStatus.INTERRUPTED
    unknown = any(row["answer"] == Answer.UNKNOWN.value for row in found.rows)
    return ExitStatus.UNKNOWN if unknown or found.campaign.unfinished else ExitStatus.AS_EXPECTED


def _settings(arguments: SweepArguments) -> Settings:
    """The settings with which statistical queries are answered in each cell."""
    from tachk.simulation.statistics.estimate import Settings
    from tachk.simulation.statistics.rare import Splitting
    from tachk.simulation.statistics.sampling import RunSource

    splitting = Splitting(arguments.relative, arguments.effort) if arguments.splitting else None
    return Settings(
        RunSource(arguments.seed), arguments.confidence, arguments.half_width, arguments.runs, splitting=splitting
    )


def _part(text: str) -> tuple[int, int]:
    match = re.fullmatch(rf"({DIGITS})/({DIGITS})", text)
    if match is None:
        raise UsageError(f"--part {text} is not a part", "write 3/10 for the third of ten parts")
    return int(match[1]), int(match[2])


def _write(found: Sweep, reporting: Reporting) -> None:
    table = _write_table(found, reporting)
    with destination(None if table else reporting.output, reporting.quiet) as out:
        if out is None:
            return
        match reporting.form:
            case "csv":
                out.write(found.to_csv())
            case "json":
                json.dump(found.to_dict(), out, indent=2)
                out.write("\n")
            case _:
                out.write(found.to_text())


def _write_table(found: Sweep, reporting: Reporting) -> bool:
    """Writes the table where the name of the file says that it holds one and no report; whether it does."""
    if reporting.output is None:
        return False
    match reporting.output.suffix.lower(), reporting.form:
        case ".parquet", _:
            found.to_parquet(reporting.output)
        case ".csv", "text":
            write_whole(reporting.output, found.to_csv(), newline="")
        case _:
            return False
    return True


@contextmanager
def _progress(quiet: bool) -> Iterator[Callable[[Progress], None] | None]:
    """A bar on a terminal; elsewhere a line for each tenth of the cells, so that logs show that it is alive."""
    if quiet:
        yield None
        return
    if not can_rewrite_lines(sys.stderr):
        yield _Tenths()
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = TextColumn("cells"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn()
    with Bar(*columns, console=Console(file=sys.stderr), transient=True) as bar:
        task = bar.add_task("cells", total=None)
        yield lambda now: bar.update(task, total=now.cells, completed=now.finished)


class _Tenths:
    def __init__(self) -> None:
        self._shown = -1

    def __call__(self, now: Progress) -> None:
        tenth = 10 * now.finished // now.cells
        if self._shown == -1 or tenth > self._shown:
            self._shown = tenth
            print(f"{now.finished} of {now.cells} cells", file=sys.stderr, flush=True)
