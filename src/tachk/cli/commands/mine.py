"""`tachk mine`: find the tightest parameter that traces satisfy."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from typing import Any

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli import options, trace_options
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import Reporting
from tachk.recordings.traces.conventions import TraceEnding


@click.command(name="mine")
@trace_options.formula
@click.argument("traces", metavar="TRACE...", type=click.Path(), nargs=-1, required=True, help="Recorded traces.")
@click.option(
    "over",
    "--over",
    metavar="NAME=LOW..HIGH",
    required=True,
    multiple=True,
    help="The name in the formula whose value is looked for, and the values that it may have.",
)
@click.option("step", "--step", metavar="NUMBER", help="Try multiples of this number only.")
@options.definitions
@click.option("name", "--property", metavar="NAME", help="The formula of the file.")
@click.option("--unit", metavar="UNIT", help="The unit of the times, if a trace does not say it: ms, s, ...")
@click.option("--time", metavar="NAME", help="The time column, if its name is not time, t or timestamp.")
@click.option(
    "ending",
    "--end",
    type=options.Choice(TraceEnding),
    default=TraceEnding.UNDETERMINED.value,
    show_default=True,
    help="With strong, an obligation open at the end of a trace counts as violated, else as satisfied.",
)
@options.max_seconds()
@options.report("text", "json")
def command(seconds: float | None, **given: Any) -> None:
    """Find the tightest value of a name in a formula with which recorded traces satisfy it.

    Exit status: 0 there is one, 10 no value of the range satisfies it, 2 bad input.
    """

    arguments, reporting = options.distributed(given, MineArguments, Reporting)
    options.finish(lambda: run_mine(arguments, reporting), seconds)


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
    from tachk.api.mining import mine
    from tachk.cli.arguments import parse_definitions
    from tachk.recordings.monitors.formulas import check_order
    from tachk.recordings.monitors.mined_ranges import named_ranges

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
