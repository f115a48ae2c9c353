"""Results that tachk has written as JSON, as parts of a page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.optional_packages import optional_packages
from tachk.formats.written_reports import check_report, read_json
from tachk.model.grid import Grid, ParameterAxis
from tachk.report.page.content import Chapter, Table
from tachk.report.statistics.answered import mean_text
from tachk.report.statistics.text import interval_text, times_text
from tachk.verify.campaign.job import ESTIMATED

_MOST_ROWS = 200
"""A table of more is not on the page."""

_KNOWN = "tachk verify, sweep, simulate, estimate and monitor write such files with --format json"


def read_result(path: Path) -> Mapping[str, Any]:
    """The object in a file. Raises UsageError."""
    return read_json(path, _KNOWN)


def runs_of_verify(document: Mapping[str, Any], path: Path) -> Sequence[Mapping[str, Any]]:
    """The runs of `tachk verify` in a result; none if it is another one. Raises UsageError."""
    runs = document.get("runs")
    if not isinstance(runs, list):
        return ()
    check_report(document, "verify", path, _KNOWN)
    return runs


def chapter_of(document: Mapping[str, Any], path: Path) -> Chapter:
    """Any other result as a part of a page. Raises UsageError for what is none."""
    for needed, report, chapter in _READERS:
        if needed <= document.keys():
            check_report(document, report, path, _KNOWN)
            return chapter(document)
    raise UsageError(f"{path} is not a result that can be shown", _KNOWN)


# ---- sweeps ---------------------------------------------------------------------------------------------------------


def _sweep(document: Mapping[str, Any]) -> Chapter:
    grid = Grid(tuple(ParameterAxis(axis["name"], tuple(axis["values"])) for axis in document["constants"]))
    rows: list[dict[str, Any]] = document["rows"]
    for number, row in enumerate(rows):
        for axis in grid.axes:
            if row.get(axis.name) not in axis.values:
                raise UsageError(f"$.rows[{number}] of the sweep has none of the values of {axis.name}", _KNOWN)
    properties = list(dict.fromkeys(row["property"] for row in rows))
    varied = ", ".join(axis.name for axis in grid.varied) or "constants"
    lines = [f"{document['cells']} combinations of values of {varied}."]
    if document["unfinished"]:
        lines.append(f"{document['unfinished']} of them are not finished.")
    for name in properties:
        own = [row for row in rows if row["property"] == name]
        found = Counter(row["answer"] for row in own)
        lines.append(f"{name}: {', '.join(f'{answer} in {times}' for answer, times in found.items())}.")
        reasons = Counter(row["reason"] for row in own if row["reason"])
        lines += [f"Unknown in {times}: {reason}." for reason, times in reasons.most_common()]
    pictures = []
    for shown in ("answer", "estimate"):
        drawn = [row for row in rows if (row["answer"] == ESTIMATED) is (shown == "estimate")]
        try:
            pictures += [(shown, _heat_map(document["model"], grid, drawn, shown))] if drawn else []
        except UsageError as error:
            lines.append(f"No picture: {error}.")
    return Chapter(f"{document['model']}: many values", lines, _cells(grid, properties, rows), pictures)


def _heat_map(model: str, grid: Grid, rows: Sequence[Mapping[str, Any]], shown: str) -> str:
    """Raises UsageError for more maps than a picture can show, and without matplotlib."""
    with optional_packages():
        from tachk.report.campaign.heat_map import STYLE, draw_maps  # matplotlib takes more memory than most pages
        from tachk.report.figure_files import svg_of
    return svg_of(partial(draw_maps, model, grid, rows, shown), STYLE)


def _cells(grid: Grid, properties: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> Sequence[Table]:
    names = [axis.name for axis in grid.varied] or list(grid.names)
    cells = [list(own) for _, own in groupby(rows, lambda row: [row[name] for name in grid.names])]
    if not 0 < len(cells) <= _MOST_ROWS:
        return ()
    lines = [[*(str(own[0][name]) for name in names), *map(_answer, own)] for own in cells]
    return (Table((*names, *properties), lines, frozenset(range(len(names)))),)


def _answer(row: Mapping[str, Any]) -> str:
    estimated = row["answer"] == ESTIMATED and None not in (row["low"], row["high"])
    return interval_text(row["low"], row["high"]) if estimated else row["answer"]


# ---- simulation -----------------------------------------------------------------------------------------------------


def _simulation(document: Mapping[str, Any]) -> Chapter:
    drawn = f"{document['runs']:,} runs until {document['until']}, {document['transitions']:,} transitions"
    lines = [f"{drawn}, seed {document['seed']}, policy {document['policy']}."]
    for order in document["faults"]:
        impossible = f"; {times_text(order['missed'])} the model does not allow it" if order["missed"] else ""
        lines.append(f"Ordered {order['order']}: {times_text(order['done'])}{impossible}.")
    endings = Table(("ending", "runs"), [(end, f"{n:,}") for end, n in document["endings"].items()], frozenset({1}))
    rows = []
    for formula in document["formulas"]:
        low, high = formula["probability_of_violation"]
        counts = [f"{formula[word]:,}" for word in ("true", "false", "undetermined")]
        first = str(formula["violating"][0]) if formula["violating"] else ""
        named = (formula["name"], formula.get("formula", ""))
        rows.append((*named, *counts, interval_text(low, high), f"{formula['confidence']:.6g}", first))
    columns = (
        "name",
        "formula",
        "true",
        "false",
        "undetermined",
        "probability of a violation",
        "confidence",
        "first in run",
    )
    formulas = [Table(columns, rows, frozenset(range(2, 8)))] if rows else []
    return Chapter(f"{document['model']}: simulation", lines, [endings, *formulas])


# ---- statistics -----------------------------------------------------------------------------------------------------


def _estimates(document: Mapping[str, Any]) -> Chapter:
    confidence = f"{document['confidence']:.6g}"
    rows, drawn = [], []
    for answer in document["answers"]:
        runs = f"{sum(sample['runs'] for sample in answer.get('samples', ())):,}"
        match answer["kind"]:
            case "probability":
                rows.append((answer["query"], interval_text(answer["low"], answer["high"]), confidence, runs))
            case "test":
                rows.append((answer["query"], answer["answer"], "", runs))
            case "splitting":
                interval = f"{answer['mean']:.3g}; {interval_text(answer['low'], answer['high'])} by splitting"
                rows.append((answer["query"], interval, confidence, f"{len(answer['replications'])} replications"))
            case "mean":
                rows.append((answer["query"], mean_text(answer), confidence, runs))
            case _:
                drawn.append(f"{answer['query']}: {len(answer['runs'])} runs were drawn.")
    table = Table(("query", "answer", "confidence", "runs"), rows, frozenset({2, 3}))
    lines = [f"By random runs with seed {document['seed']}.", *drawn]
    return Chapter(f"{document['model']}: statistics", lines, [table] if rows else [])


# ---- monitoring -----------------------------------------------------------------------------------------------------


def _monitor(document: Mapping[str, Any]) -> Chapter:
    unit = document["unit"] or ""
    lines = [f"{document['rows']:,} rows, from {document['begin']} to {document['end']} {unit}".rstrip() + "."]
    rows = [
        (result["name"], result["verdict"], _count(result["violations"]), result["title"] or result["formula"])
        for result in document["results"]
    ]
    details = [
        (f"{result['name']}: why it is {result['verdict']}", "\n".join(result["finding"]["explanation"]))
        for result in document["results"]
        if result["finding"] is not None
    ]
    table = Table(("formula", "verdict", "violations", "meaning"), rows, frozenset({2}))
    return Chapter(f"{document['trace']}: monitored", lines, [table], details=details)


def _count(violations: Mapping[str, Any] | None) -> str:
    return "not counted" if violations is None else str(violations["count"])


_READERS: Sequence[tuple[frozenset[str], str, Callable[[Mapping[str, Any]], Chapter]]] = (
    (frozenset({"cells", "constants", "rows"}), "sweep", _sweep),
    (frozenset({"runs", "endings", "formulas"}), "simulate", _simulation),
    (frozenset({"answers", "seed", "confidence"}), "estimate", _estimates),
    (frozenset({"trace", "results", "pending_counts_as"}), "monitor", _monitor),
)
"""The required fields of a result, the schema that describes it, and the function that makes a part of it."""
