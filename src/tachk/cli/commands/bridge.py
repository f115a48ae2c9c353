"""`tachk bridge`: let a model stand in for a client or an Agent of DDS-XRCE, by UDP."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options
from tachk.cli import simulation_options as drawing


@click.command(name="bridge")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@click.option(
    "processes",
    "--process",
    metavar="NAME",
    multiple=True,
    required=True,
    help="A process of the client, or of the Agent, or a template. Can be given several times.",
)
@click.option("to", "--to", metavar="HOST:PORT", help="A model of a client: where the Agent listens.")
@click.option(
    "listen", "--listen", metavar="[HOST:]PORT", help="A model of an Agent: where it listens. HOST is 127.0.0.1."
)
@options.definitions
@click.option("seconds_in_all", "--until", metavar="SECONDS", type=options.Seconds(min=0), help="Stop after this time.")
@click.option(
    "speed",
    "--speed",
    metavar="FACTOR",
    type=click.FloatRange(0.001, 1000),
    default=1.0,
    show_default=True,
    help="How many times as fast as real the time of the model passes.",
)
@drawing.seed("The same seed draws the same delays, as long as the same packets come.")
@drawing.policy
@click.option(
    "topic",
    "--topic",
    metavar="NAME",
    default="HelloWorldTopic",
    show_default=True,
    help="Of a client: NAME__t, NAME__dw and NAME__dr are the Agent's references for topic, writer and reader.",
)
@click.option("record", "--record", metavar="FILE", type=options.type_of_file, help="Write the packets to a capture.")
def command(**given: Any) -> None:
    """Run processes of a model as a client or an Agent in a real session of DDS-XRCE, over UDP.

    \b
    tachk bridge publication.ta --process application --process publisher --to 127.0.0.1:8888
    tachk bridge publication.ta --process writer --listen 8888

    What the processes send over send[link][kind] becomes packets; packets become deliver[link][kind].
    Ends with --until or Ctrl-C. Exit status: 0 there was a session, 10 there was none, 2 bad input, 3 something that is
    not simulated.
    """
    from tachk.cli.actions.bridge import BridgeArguments, run_bridge

    (arguments,) = options.distributed(given, BridgeArguments)
    options.finish(lambda: run_bridge(arguments))
