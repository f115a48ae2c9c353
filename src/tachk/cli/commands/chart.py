"""`tachk chart`: draw a sequence chart of a capture or of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from tachk.cli import options


@click.command(name="chart")
@click.argument("file", metavar="FILE", type=options.type_of_file)
@click.option(
    "output",
    "-o",
    "--output",
    metavar="FILE",
    type=options.type_of_file,
    default=Path("chart.svg"),
    show_default=True,
    help="An .svg or .png file.",
)
@click.option(
    "begin", "--from", metavar="TIME", help="Draw from this time, such as 2.5 s or 300 ms; a number counts seconds."
)
@click.option("end", "--to", metavar="TIME", help="Draw up to this time.")
@click.option(
    "axis",
    "--time",
    type=click.Choice(["compressed", "scale"]),
    default="compressed",
    show_default=True,
    help="compressed: a line for each message; scale: equal times are equal lengths. Long silences are left out.",
)
@click.option(
    "name",
    "--property",
    metavar="NAME",
    help="Of a report of tachk verify: the run about this property; without this option the first run.",
)
@options.agent_ports(
    "Of a capture: a port of an Agent, or of a relay that clients take for one; without this option 8888 and "
    "every port at which a session is created. Can be given several times."
)
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Draw a sequence chart: who sent which message to whom, and which were lost.

    FILE is a pcap or pcapng capture of DDS-XRCE, or a report with runs: tachk verify MODEL --trace some --format json.
    """
    from tachk.cli.actions.chart import ChartArguments, run_chart

    arguments = options.distributed(given, ChartArguments)
    options.finish(lambda: run_chart(*arguments), seconds)
