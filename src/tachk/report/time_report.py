"""The results of `tachk time`, as text, CSV and JSON."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from fractions import Fraction
from io import StringIO
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table

from tachk.base.plain_data import Fields, PlainData
from tachk.base.records import dataclass
from tachk.meaning.run_view import view_trace
from tachk.model.network import Network
from tachk.model.quantity import duration
from tachk.model.run import TimedTrace
from tachk.report.json_report import FORMS, trace_to_json
from tachk.report.plain_console import plain_console
from tachk.report.run.trace_text import print_trace
from tachk.verify.times import FOR_EVER, Times
from tachk.verify.verdict import Extreme

if TYPE_CHECKING:
    from tachk.report.json_report import Json

_COLUMNS = ("best", "worst", "waits")


@dataclass(frozen=True, slots=True)
class TimedInterval:
    """The expressions as they were typed; ``start`` is None for the start of a run."""

    model: str
    start: str | None
    end: str
    last: bool


@dataclass(frozen=True, slots=True)
class TimedRow:
    """``constants``: those over which a table goes, with their values."""

    constants: Mapping[str, int]
    network: Network
    times: Times


def times_to_text(between: TimedInterval, rows: Sequence[TimedRow], traces: bool = False) -> str:
    """A table with a row for each combination of constants, or the times alone where there is one."""
    out = StringIO()
    console = plain_console(out, width=120)
    which = "last " if between.last else ""
    start = "the start" if between.start is None else f"the {which}{between.start}" if which else between.start
    console.print(f"{between.model}: from {start} to {between.end}\n", markup=False, soft_wrap=True)
    table = Table(box=None, padding=(0, 2, 0, 0))
    names = list(rows[0].constants) if rows else []
    for name in (*names, *_COLUMNS):
        table.add_column(f"  {name}" if name == (names or _COLUMNS)[0] else name, justify="right", no_wrap=True)
    for row in rows:
        table.add_row(*map(str, row.constants.values()), *row.times.in_words(row.network.time_unit).values())
    console.print(table)
    for reason in dict.fromkeys(row.times.reason for row in rows if row.times.reason):
        console.print(f"\nsome times are unknown: {reason}", markup=False, soft_wrap=True)
    for row in rows if traces else ():
        _print_runs(row, console)
    return out.getvalue()


def _print_runs(row: TimedRow, console: Console) -> None:
    for name, extreme in _extremes(row.times).items():
        if extreme is None or extreme.run is None or extreme.value is None or name == "waits":
            continue
        values = "".join(f", {constant} = {value}" for constant, value in row.constants.items())
        value = duration(Fraction(extreme.value), row.network.time_unit)
        console.print(f"\nthe {name} time, {value}{values}:", markup=False)
        print_trace(view_trace(row.network, extreme.run), console, row.network.time_unit)


def times_to_csv(rows: Sequence[TimedRow]) -> str:
    """A row for each combination of constants; times in units of the model, ``<9`` for one that is approached."""
    out = StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([*(rows[0].constants if rows else ()), *_COLUMNS, "states"])
    for row in rows:
        cells = (cell.replace(" ", "") if cell != FOR_EVER else cell for cell in row.times.in_words().values())
        writer.writerow([*row.constants.values(), *cells, row.times.states])
    return out.getvalue()


def times_to_json(between: TimedInterval, rows: Sequence[TimedRow]) -> dict[str, Json]:
    """As docs/schema/time.schema.json says."""
    return {
        "model": between.model,
        "from": between.start,
        "to": between.end,
        "occurrence": "last" if between.last else "first",
        "time_unit": rows[0].network.time_unit if rows else "",
        "rows": [_row_to_json(row) for row in rows],
    }


def _row_to_json(row: TimedRow) -> dict[str, Json]:
    fields = Fields(
        "constants best=times.best worst=times.worst waits=times.waiting reason=times.reason states=times.states "
        "seconds=times.seconds"
    )

    def run(trace: TimedTrace) -> object:
        return trace_to_json(view_trace(row.network, trace))

    return PlainData({**FORMS, TimedRow: fields, TimedTrace: run}).of(row)


def _extremes(times: Times) -> dict[str, Extreme | None]:
    return dict(zip(_COLUMNS, (times.best, times.worst, times.waiting), strict=True))
