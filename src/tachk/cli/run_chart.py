"""`tachk verify --chart`: the sequence chart of a run that was just found."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from tachk.cli.commands.chart import write_chart
from tachk.report.drawing.sequence.layout import TimeAxis
from tachk.report.json_report import run_to_json
from tachk.report.record import RunRecord
from tachk.report.sequence.of_run import chart_of_run
from tachk.report.sequence.run_steps import steps_of_result


def write_run_chart(output: Path, record: RunRecord) -> None:
    """Draws the run of the first unexpected answer that has one, or else of the first answer; says so if none has."""
    found = [verdict for verdict in record.verdicts if verdict.trace is not None]
    chosen = next((verdict for verdict in found if verdict.met is False), found[0] if found else None)
    if chosen is None or chosen.trace is None:
        print("no answer has a run, so there is no chart", file=sys.stderr)
        return
    run: dict[str, Any] = run_to_json(record)
    result = next(each for each in run["results"] if each["name"] == chosen.query.name)
    write_chart(chart_of_run(steps_of_result(run, result)).used(), output, TimeAxis.COMPRESSED)
    print(f"written: {output}", file=sys.stderr)
