"""The action of `tachk mine`."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass

from tachk.api.mining import mine
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.arguments import parse_definitions
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import Reporting
from tachk.recordings.monitors.formulas import check_order
from tachk.recordings.monitors.mined_ranges import named_ranges
from tachk.recordings.traces.conventions import TraceEnding


@dataclass(frozen=True, slots=True)
class MineArguments:
    """Arguments of `tachk mine`; the fields are the arguments of `tachk.mine`."""

    formula: str
    traces: tuple[str, ...]
    over: tuple[str, ...]
    step: str | None = None
    definitions: tuple[str, ...] = ()
    name: str | None = None
    unit: str | None = None
    time: str | None = None
    ending: TraceEnding = TraceEnding.UNDETERMINED


def run_mine(arguments: MineArguments, reporting: Reporting = Reporting()) -> ExitStatus:
    """Finds the tightest value of a parameter."""
    ranges = named_ranges(arguments.over, "--over")
    if arguments.step is not None and re.fullmatch(r"\d*\.?\d+", arguments.step) is None:
        raise UsageError(f"--step {arguments.step}: expected a positive number")
    check_order(arguments.formula, arguments.traces[0])
    found = mine(
        arguments.formula,
        arguments.traces,
        ranges,
        step=arguments.step,
        time=arguments.time,
        unit=arguments.unit,
        end=arguments.ending.value,
        constants=parse_definitions(arguments.definitions),
        select=() if arguments.name is None else (arguments.name,),
    )
    with destination(reporting.output, reporting.quiet) as out:
        if out is not None and reporting.form == "json":
            json.dump(found.to_dict(), out, indent=2)
            out.write("\n")
        elif out is not None:
            out.write(found.to_text())
    return ExitStatus.AS_EXPECTED if found.satisfiable else ExitStatus.NOT_AS_EXPECTED
