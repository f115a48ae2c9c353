"""The action of `tachk sweep`."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from tachk.api import model as api
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import DIGITS
from tachk.base.job import current_job, limited
from tachk.base.records import dataclass
from tachk.base.seeds import DEFAULT_SEED
from tachk.base.whole_files import write_whole
from tachk.cli.arguments import parse_size
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.cli.reporting import Reporting
from tachk.cli.terminal import can_rewrite_lines
from tachk.engine.options import Limits
from tachk.model.grid import grid_of
from tachk.report.campaign.table import Sweep
from tachk.simulation.statistics.estimate import Settings
from tachk.simulation.statistics.rare import Splitting
from tachk.simulation.statistics.sampling import RunSource
from tachk.verify.campaign.job import ESTIMATED
from tachk.verify.campaign.run import Progress
from tachk.verify.verdict import Answer

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
        formulas, until: as for `tachk simulate`: by what runs are judged in each cell, and how long they are.
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
    splitting = Splitting(arguments.relative, arguments.effort) if arguments.splitting else None
    return Settings(
        RunSource(arguments.seed), arguments.confidence, arguments.half_width, arguments.runs, splitting=splitting
    )


def _part(text: str) -> tuple[int, int]:
    match = re.fullmatch(rf"({DIGITS})/({DIGITS})", text)
    if match is None:
        raise UsageError(f"--part {text} is no part", "write 3/10 for the third of ten parts")
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
