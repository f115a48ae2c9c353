"""A campaign for people: a row for each cell, a column for each property."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from io import StringIO
from itertools import groupby

from rich.table import Table

from tachk.model.quantity import grouped
from tachk.report.plain_console import plain_console
from tachk.report.statistics.text import interval_text
from tachk.verify.campaign.job import ESTIMATED, Row
from tachk.verify.campaign.run import Campaign
from tachk.verify.verdict import Answer

_MOST_ROWS = 200


def campaign_text(model: str, campaign: Campaign) -> str:
    """What `tachk sweep` prints."""
    out = StringIO()
    console = plain_console(out)
    console.print(f"{model}: {_heading(campaign)}\n", markup=False)
    shown = [axis.name for axis in campaign.grid.varied] or list(campaign.grid.names)
    cells = [list(rows) for _, rows in groupby(campaign.rows, lambda row: [row[name] for name in campaign.grid.names])]
    if 0 < len(cells) <= _MOST_ROWS:
        console.print(_table(shown, campaign.job.asked, cells))
        console.print()
    elif cells:
        console.print(f"({len(cells)} rows: --format csv has them)\n", markup=False)
    for line in _summary(campaign):
        console.print(line, markup=False)
    return "".join(f"{line.rstrip()}\n" for line in out.getvalue().splitlines())


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
        stored = [int(row["states_stored"] or 0) for row in rows]
        seconds = [float(row["seconds"] or 0) for row in rows]
        answers = [_answer(row) for row in rows]
        constants = [str(rows[0][name]) for name in names]
        table.add_row(*constants, *answers, grouped(max(stored)), f"{max(seconds):.2f}")
    return table


def _answer(row: Row) -> str:
    low, high = row["low"], row["high"]
    if row["answer"] != ESTIMATED or low is None or high is None:
        return str(row["answer"])
    return interval_text(float(low), float(high))


def _summary(campaign: Campaign) -> Iterator[str]:
    for name in campaign.job.asked:
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
