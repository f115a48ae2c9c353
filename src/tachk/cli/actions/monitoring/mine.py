"""`tachk mine`."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass

from tachk.api.mining import mine
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.arguments import parse_definitions
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import ReportForm, Reporting
from tachk.recordings.monitors.formulas import check_order
from tachk.recordings.monitors.mined_ranges import named_ranges
from tachk.recordings.traces.conventions import TraceEnding


@dataclass(frozen=True, slots=True)
class MineArguments:
    """What is looked for; the fields are the arguments of `tachk.mine`."""

    formula: str
    traces: tuple[str, ...]
    over: tuple[str, ...]
    step: str | None = None
    definitions: tuple[str, ...] = ()
    name: str | None = None
    unit: str | None = None
    time: str | None = None
    ending: TraceEnding = TraceEnding.UNDETERMINED


def run_mine(asked: MineArguments, reporting: Reporting = Reporting()) -> ExitStatus:
    """Finds the tightest value of a parameter."""
    ranges = named_ranges(asked.over, "--over")
    if asked.step is not None and re.fullmatch(r"\d*\.?\d+", asked.step) is None:
        raise UsageError(f"--step {asked.step}: expected a positive number")
    check_order(asked.formula, asked.traces[0])
    found = mine(
        asked.formula,
        asked.traces,
        ranges,
        step=asked.step,
        time=asked.time,
        unit=asked.unit,
        end=asked.ending.value,
        constants=parse_definitions(asked.definitions),
        select=() if asked.name is None else (asked.name,),
    )
    with destination(reporting.output, reporting.quiet) as out:
        if out is not None and reporting.form is ReportForm.JSON:
            json.dump(found.to_dict(), out, indent=2)
            out.write("\n")
        elif out is not None:
            out.write(found.to_text())
    return ExitStatus.AS_EXPECTED if found.satisfiable else ExitStatus.NOT_AS_EXPECTED
