"""The verdicts on the runs of one file: how many runs each formula is true on, and the first one that it is not."""

from __future__ import annotations

from collections.abc import Mapping

from rich.console import Console
from rich.text import Text

from tachk.recordings.monitors.record import MonitorRecord
from tachk.recordings.traces.node_signal import Truth
from tachk.report.json_report import Json
from tachk.report.monitor.json import monitor_to_json
from tachk.report.monitor.text import print_monitor

_ORDER = (Truth.TRUE, Truth.FALSE, Truth.UNDETERMINED)


def print_runs(name: str, records: Mapping[str, MonitorRecord], console: Console, all_violations: bool) -> None:
    """Prints counts for each formula, then the whole report on the first run on which some formula is not true.

    Args:
        name: of the file.
        records: by the numbers of the runs.
    """
    console.print(Text(f"{name}: {len(records)} runs"))
    console.print()
    for formula in _names(records):
        runs = {truth: _runs(records, formula, truth) for truth in _ORDER}
        line_shown = ", ".join(f"{truth.word} on {len(runs[truth])}" for truth in _ORDER)
        first = f"; the first violation is in run {runs[Truth.FALSE][0]}" if runs[Truth.FALSE] else ""
        console.print(Text(f"  {formula}: {line_shown}{first}"))
    for truth in (Truth.FALSE, Truth.UNDETERMINED):
        shown = next((each for each in records.values() if any(v.truth is truth for v in each.verdicts)), None)
        if shown is not None:
            console.print()
            print_monitor(shown, console, all_violations)
            return


def runs_to_json(name: str, records: Mapping[str, MonitorRecord], all_violations: bool) -> dict[str, Json]:
    """The machine form: docs/schema/monitor_runs.schema.json."""
    return {
        "trace": name,
        "formulas": [
            {
                "name": formula,
                **{truth.word: len(_runs(records, formula, truth)) for truth in _ORDER},
                "violating": list(_runs(records, formula, Truth.FALSE)),
            }
            for formula in _names(records)
        ],
        "runs": [{"run": run, **monitor_to_json(record, all_violations)} for run, record in records.items()],
    }


def _names(records: Mapping[str, MonitorRecord]) -> list[str]:
    return [verdict.name for verdict in next(iter(records.values())).verdicts]


def _runs(records: Mapping[str, MonitorRecord], formula: str, truth: Truth) -> list[str]:
    return [
        run
        for run, record in records.items()
        if any(verdict.name == formula and verdict.truth is truth for verdict in record.verdicts)
    ]
