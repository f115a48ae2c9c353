"""The options of `tachk chart`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from tachk.cli import options


@click.command(name="chart", short_help="Draw a sequence chart of a capture or of a run.")
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
@click.option(
    "ports",
    "--port",
    metavar="PORT",
    type=options.Count(1, 65535),
    multiple=True,
    help="Of a capture: a port of an Agent, or of a relay that clients take for one; without this option 8888 and "
    "every port at which a session is created. Can be given several times.",
)
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Draw who sent what to whom, and what was lost.

    FILE is a pcap or pcapng capture of DDS-XRCE, or a report with runs: tachk verify MODEL --trace some --format json.
    """
    from tachk.cli.actions.packets.chart import Charting, run_chart

    arguments = options.distributed(given, Charting)
    options.finish(lambda: run_chart(*arguments), seconds)
