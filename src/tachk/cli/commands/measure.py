"""`tachk measure`: measure the parameters of a DDS-XRCE system in captures of it."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options


@click.command(name="measure")
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=options.type_of_file)
@options.agent_ports(
    "A port of an Agent, or of a relay that clients take for one; without this option 8888 and every port at "
    "which a session is created. Can be given several times."
)
@click.option(
    "model",
    "--for",
    metavar="MODEL",
    type=click.Path(),
    help="Write settings in the unit of time of this model, and only constants that it has; without this option in "
    "milliseconds.",
)
@click.option(
    "form",
    "--format",
    type=click.Choice(["text", "json", "settings"]),
    default="text",
    show_default=True,
    help="Form of the report; settings: a line of -D options for tachk verify, or for tachk conform if the model has a "
    "`recording`.",
)
@click.option("output", "-o", "--output", metavar="FILE", type=options.type_of_file, help="Write the report to a file.")
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Measure the parameters of a DDS-XRCE system in captures of it.

    FILE is a pcap or pcapng capture; several are put together. Heartbeats, round trips, repairs, windows, losses and
    dead time are printed with minimum, median and maximum, the packets they came from and how sure they are, and as
    constants of a model: tachk verify MODEL $(tachk measure FILE --for MODEL --format settings)
    """
    from tachk.cli.actions.measure import MeasureArguments, run_measure

    arguments = options.distributed(given, MeasureArguments)
    options.finish(lambda: run_measure(*arguments), seconds)
