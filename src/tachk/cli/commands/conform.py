"""`tachk conform`: check if recordings are runs of a model."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options
from tachk.cli.reporting import Reporting
from tachk.recordings.conformance.question import ExplanationDetail


@click.command(name="conform")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model with a `recording { ... }`.")
@click.argument(
    "recordings",
    metavar="FILE...",
    nargs=-1,
    required=True,
    type=click.Path(),
    help="Recorded events: CSV, JSON lines (.jsonl), both also compressed (.gz, .zst), or a capture (.pcap).",
)
@options.definitions
@click.option(
    "--tolerance",
    metavar="DURATION",
    help="How much earlier or later than recorded something may have happened, such as 5ms; auto finds the least one. "
    "Without it: as the model says.",
)
@click.option(
    "--late",
    metavar="DURATION",
    help="How much later than it happens something may be recorded. By default as the model says.",
)
@click.option("--unit", metavar="UNIT", help="The unit of the recorded times, if the file does not say it: ms, s, ...")
@options.agent_ports(
    "Of a capture of packets: a port of an Agent, or of a relay that clients take for one; without this option "
    "8888 and every port at which a session is created. Can be given several times."
)
@click.option(
    "applications",
    "--application",
    metavar="LOG",
    type=click.Path(),
    multiple=True,
    help="What an application noted, as events (CSV or JSON lines); beside a capture with times since 1970, such as "
    "`time [ns]`. Rows `told` say when it called the run function, rows `written` when it wrote. Can be given several "
    "times.",
)
@click.option(
    "explanation",
    "--explain",
    type=options.Choice(ExplanationDetail),
    default=ExplanationDetail.SHORT.value,
    show_default=True,
    help="How much to explain about a recording that does not conform. none: nothing; short: where it leaves the model,"
    " and an edit that would make it a run if one is found in a few seconds; full: try all edits near that place.",
)
@click.option("--coverage", is_flag=True, help="Also report which edges of the model the runs that were found take.")
@options.max_states()
@options.max_seconds()
@options.report("text", "json")
def command(seconds: float | None, **given: Any) -> None:
    """Check if recordings of the real system are runs of a model.

    Exit status: 0 all are, 10 one is not, 20 one is undecided because a limit was hit, 2 bad input.
    """
    from tachk.cli.actions.conform import ConformArguments, run_conform

    arguments = options.distributed(given, ConformArguments, Reporting)
    options.finish(lambda: run_conform(arguments[0], arguments[1], seconds), seconds)
