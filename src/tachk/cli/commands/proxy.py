"""`tachk proxy`: relay packets of DDS-XRCE, and lose, delay or duplicate some."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options


@click.command(name="proxy")
@click.option(
    "listen",
    "--listen",
    metavar="[HOST:]PORT",
    multiple=True,
    required=True,
    help="Where a client takes the relay for the Agent. Once for each client. HOST is 127.0.0.1 without it.",
)
@click.option("to", "--to", metavar="HOST:PORT", help="Where the Agent listens.")
@click.option(
    "scripts", "--script", metavar="FILE", type=options.type_of_file, multiple=True, help="Rules, one on each line."
)
@click.option("given", "--rule", metavar="RULE", multiple=True, help="A rule, as in a script.")
@click.option(
    "trace",
    "--from-trace",
    metavar="TRACE.json",
    type=options.type_of_file,
    help="Do what the network does in this run of a model, a report of tachk verify --format json.",
)
@click.option("prop", "--property", metavar="NAME", help="The property whose run it is, if the report has several.")
@click.option("seed", "--seed", type=options.Count(0), default=0, show_default=True, help="For rules with a share.")
@click.option("record", "--record", metavar="FILE", type=options.type_of_file, help="Write both sides to a capture.")
@click.option(
    "idle",
    "--idle",
    metavar="SECONDS",
    type=options.Seconds(min=0, min_open=True),
    help="Stop when nothing has come for so long after the first packet.",
)
@click.option("show", "--show", is_flag=True, help="Print the rules and do nothing else.")
def command(**given: Any) -> None:
    """Relay UDP packets between clients and Agent of DDS-XRCE, and lose, delay or duplicate some of them.

    A rule says drop, delay or duplicate, which packets, and how long: drop the 2nd ACKNACK agent->client;
    delay DATA 5 by 500 ms; delay ACKNACK 8 until ACKNACK 9; duplicate CREATE_CLIENT after 1 s; drop 20 % of packets.
    docs/real_system.md lists all forms.

    Ends with Ctrl-C, SIGTERM or --idle, and then prints how often each rule applied. The exit status is 10 if a rule
    never did, unless it has a share.
    """
    from tachk.cli.actions.proxy import Proxying, run_proxy

    (proxying,) = options.distributed(given, Proxying)
    options.finish(lambda: run_proxy(proxying))
