"""The results of a campaign as a table that can be written in every form."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from io import StringIO
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.table import Table

from tachk.base.frames import data_frame
from tachk.base.notebook import html_table, preformatted
from tachk.base.optional_packages import optional_packages
from tachk.base.whole_files import whole_file
from tachk.model.quantity import grouped
from tachk.report.json_report import Json
from tachk.report.plain_console import plain_console
from tachk.report.statistics.text import interval_text
from tachk.verify.campaign.job import COLUMNS, ESTIMATED, Row
from tachk.verify.campaign.run import Campaign
from tachk.verify.verdict import Answer

if TYPE_CHECKING:
    from tachk.report.figure_files import DrawnFigure

_MOST_ROWS = 200
_MOST_SHOWN = 60
"""Rows of a table in a notebook."""


def campaign_text(model: str, campaign: Campaign) -> str:
    """The output of `tachk sweep`."""
    out = StringIO()
    console = plain_console(out)
    console.print(f"{model}: {_heading(campaign)}\n", markup=False)
    names, properties, cells = _cells(campaign)
    if 0 < len(cells) <= _MOST_ROWS:
        console.print(_table(names, properties, cells))
        console.print()
    elif cells:
        console.print(f"({len(cells)} rows: --format csv has them)\n", markup=False)
    for line in _summary(campaign):
        console.print(line, markup=False)
    return "".join(f"{line.rstrip()}\n" for line in out.getvalue().splitlines())


def _cells(campaign: Campaign) -> tuple[list[str], Sequence[str], list[list[Row]]]:
    """The constants and the properties that a table shows, and the rows of each cell."""
    names = [axis.name for axis in campaign.grid.varied] or list(campaign.grid.names)
    cells = groupby(campaign.rows, lambda row: [row[name] for name in campaign.grid.names])
    return names, campaign.job.property_names, [list(rows) for _, rows in cells]


def _cell_row(names: Sequence[str], rows: Sequence[Row]) -> list[str]:
    """The values of constants, the answers, the most states and seconds of a cell."""
    stored = [int(row["states_stored"] or 0) for row in rows]
    seconds = [float(row["seconds"] or 0) for row in rows]
    answers = [_answer(row) for row in rows]
    return [*(str(rows[0][name]) for name in names), *answers, grouped(max(stored)), f"{max(seconds):.2f}"]


def _heading(campaign: Campaign) -> str:
    size = campaign.cells
    computed = size - campaign.earlier - campaign.unfinished
    parts = [f"{size} cell{'s' * (size != 1)}, {computed} computed in {campaign.seconds:.1f} s"]
    if campaign.earlier:
        parts.append(f"{campaign.earlier} known from before")
    if campaign.unfinished:
        parts.append(f"{campaign.unfinished} not finished")
    return ", ".join(parts)


def _table(names: Sequence[str], properties: Sequence[str], cells: Sequence[Sequence[Row]]) -> Table:
    table = Table(box=None, padding=(0, 2, 0, 0), pad_edge=False)
    for name in names:
        table.add_column(name, justify="right")
    for name in properties:
        table.add_column(name)
    table.add_column("states", justify="right")
    table.add_column("seconds", justify="right")
    for rows in cells:
        table.add_row(*_cell_row(names, rows))
    return table


def _answer(row: Row) -> str:
    low, high = row["low"], row["high"]
    if row["answer"] != ESTIMATED or low is None or high is None:
        return str(row["answer"])
    return interval_text(float(low), float(high))


def _summary(campaign: Campaign) -> Iterator[str]:
    for name in campaign.job.property_names:
        rows = [row for row in campaign.rows if row["property"] == name]
        found = Counter(str(row["answer"]) for row in rows)
        said = [f"{answer} in {found[answer]}" for answer in (*Answer, ESTIMATED) if found[answer]]
        if said:
            yield f"{name}: {', '.join(said)}"
        reasons = Counter(str(row["reason"]) for row in rows if row["reason"])
        for reason, times in reasons.most_common():
            yield f"  unknown in {times}: {reason}"
        notes = Counter(str(row["notes"]) for row in rows if row["notes"])
        for note, times in notes.most_common():
            yield f"  note in {times}: {note}"


@dataclass(frozen=True, slots=True)
class Sweep:
    """One row for each combination of values and each property.

    Attributes:
        model: the path as given.
    """

    model: str
    campaign: Campaign = field(repr=False)

    @property
    def rows(self) -> tuple[Row, ...]:
        """Each a flat dictionary: ``pandas.DataFrame(sweep.rows)``."""
        return self.campaign.rows

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the values of a row: the constants first."""
        return (*self.campaign.grid.names, *COLUMNS)

    def to_rows(self) -> list[Row]:
        """`rows` as a list."""
        return list(self.rows)

    def to_frame(self) -> Any:
        """`to_rows` as a `pandas.DataFrame`. Raises UsageError where pandas is not installed."""
        return data_frame(self.rows)

    def to_dict(self) -> dict[str, Json]:
        """The document of docs/schema/sweep.schema.json."""
        campaign = self.campaign
        return {
            "model": self.model,
            "constants": [{"name": axis.name, "values": list(axis.values)} for axis in campaign.grid.axes],
            "cells": campaign.cells,
            "unfinished": campaign.unfinished,
            "interrupted": campaign.interrupted,
            "rows": [dict(row) for row in self.rows],
        }

    def to_csv(self) -> str:
        """The rows as comma-separated values, with a line of names."""
        out = StringIO()
        writer = csv.DictWriter(out, self.columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(self.rows)
        return out.getvalue()

    def to_parquet(self, path: str | Path) -> None:
        """Writes a file. Raises MissingPackageError where pyarrow is not installed."""
        with optional_packages():
            import pyarrow
            from pyarrow import parquet
        kinds = {"TEXT": pyarrow.string(), "INTEGER": pyarrow.int64(), "REAL": pyarrow.float64()}
        columns: dict[str, Any] = {name: [row[name] for row in self.rows] for name in self.columns}
        for axis in self.campaign.grid.axes:
            if not all(isinstance(value, int) for value in axis.values):
                columns[axis.name] = list(map(str, columns[axis.name]))
        arrays = {
            name: pyarrow.array(values, kinds[COLUMNS[name]]) if name in COLUMNS else pyarrow.array(values)
            for name, values in columns.items()
        }
        with whole_file(Path(path)) as part:
            parquet.write_table(pyarrow.table(arrays), part)

    def to_text(self) -> str:
        """The output of `tachk sweep`."""
        return campaign_text(self.model, self.campaign)

    def plot(self, path: str | Path | None = None, show: str = "answer") -> DrawnFigure:
        """Draws a heat map for each property. A notebook shows the result.

        Args:
            path: a file to write; its ending says the format.
            show: the column that is drawn, such as ``states_stored``.

        Raises UsageError for an unknown format or column, or more maps than a picture can show.
        """
        with optional_packages():
            from tachk.report.campaign.heat_map import STYLE, draw_maps
            from tachk.report.figure_files import DrawnFigure

        campaign = self.campaign
        figure = DrawnFigure(lambda: draw_maps(self.model, campaign.grid, campaign.rows, show), STYLE)
        if path is not None:
            figure.write(path)
        return figure

    def __str__(self) -> str:
        return self.to_text()

    def __repr__(self) -> str:
        return f"<Sweep of {self.model}: {self._in_words}>"

    def _repr_html_(self) -> str:
        campaign = self.campaign
        names, properties, cells = _cells(campaign)
        rows = [_cell_row(names, each) for each in cells[:_MOST_SHOWN]]
        table = html_table([*names, *properties, "states", "seconds"], rows, f"{self.model}: {_heading(campaign)}")
        left_out = len(cells) - _MOST_SHOWN
        more = [f"{left_out} more rows: to_frame() has them"] if left_out > 0 else []
        return f"{table}\n{preformatted(chr(10).join((*more, *_summary(campaign))))}"

    @property
    def _in_words(self) -> str:
        found = "; ".join(line for line in _summary(self.campaign) if not line.startswith(" "))
        return f"{self.campaign.cells} cells{f', {found}' if found else ''}"
