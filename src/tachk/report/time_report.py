"""The results of `tachk time`, as text, CSV and JSON."""

from __future__ import annotations

import csv
import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from io import StringIO
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table

from tachk.base.frames import data_frame
from tachk.base.notebook import folded, html_table
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


@dataclasses.dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class TimesReport(Times):
    """The times between two events of one model, in the forms in which people and programs read them.

    Attributes:
        network: of the model, for the runs that take these times.
        between: the events.
    """

    between: TimedInterval = dataclasses.field(repr=False)
    network: Network = dataclasses.field(repr=False)

    @staticmethod
    def of(times: Times, between: TimedInterval, network: Network) -> TimesReport:
        """Times with their events and their model."""
        given = {each.name: getattr(times, each.name) for each in dataclasses.fields(Times)}
        return TimesReport(**given, between=between, network=network)

    def to_dict(self) -> dict[str, Json]:
        """As docs/schema/time.schema.json says."""
        return times_to_json(self.between, [self._row])

    def to_rows(self) -> list[dict[str, str | int | float | bool | None]]:
        """One row. Times are in units of the model; None where there is none, or no limit. A strict time is
        approached and not taken."""
        found: dict[str, str | int | float | bool | None] = {
            "model": self.between.model,
            "from": self.between.start,
            "to": self.between.end,
        }
        for name, extreme in _extremes(self).items():
            found[name] = None if extreme is None else extreme.value
            found[f"{name}_strict"] = None if extreme is None else extreme.strict
        return [{**found, "reason": self.reason, "states": self.states, "seconds": self.seconds}]

    def to_frame(self) -> Any:
        """`to_rows` as a `pandas.DataFrame`. Raises UsageError where pandas is not installed."""
        return data_frame(self.to_rows())

    def to_text(self, traces: bool = False) -> str:
        """The output of `tachk time`.

        Args:
            traces: with the runs that take these times.
        """
        return times_to_text(self.between, [self._row], traces)

    @property
    def _row(self) -> TimedRow:
        return TimedRow({}, self.network, self)

    def __str__(self) -> str:
        times = ", ".join(f"{name}: {time}" for name, time in self.in_words(self.network.time_unit).items())
        return f"{times} ({self.reason})" if self.reason else times

    def _repr_html_(self) -> str:
        words = self.in_words(self.network.time_unit)
        start, end = self.between.start or "the start", self.between.end
        caption = f"{self.between.model}: from {start} to {end}{f' ({self.reason})' if self.reason else ''}"
        table = html_table(list(words), [list(words.values())], caption)
        runs = [folded(title, text) for title, text in _runs(self._row)]
        return "\n".join([table, *runs])


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
    for title, text in _runs(row):
        console.print(f"\n{title}:", markup=False)
        console.print(text, markup=False, soft_wrap=True)


def _runs(row: TimedRow) -> Iterator[tuple[str, str]]:
    """What is said of the run that takes each time, and the run."""
    for name, extreme in _extremes(row.times).items():
        if extreme is None or extreme.run is None or extreme.value is None or name == "waits":
            continue
        values = "".join(f", {constant} = {value}" for constant, value in row.constants.items())
        value = duration(Fraction(extreme.value), row.network.time_unit)
        out = StringIO()
        print_trace(view_trace(row.network, extreme.run), plain_console(out, width=120), row.network.time_unit)
        yield f"the {name} time, {value}{values}", out.getvalue().rstrip("\n")


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
