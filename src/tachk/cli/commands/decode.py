"""`tachk decode`: print the DDS-XRCE messages in a capture, a line for each submessage."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options


@click.command(name="decode")
@click.argument("file", metavar="FILE", type=options.type_of_file)
@options.agent_ports(
    "A UDP or TCP port of an Agent, or of a relay that clients take for one. Can be given several times. "
    "Without it 8888, and with --signals each port to which a session is created."
)
@click.option(
    "--serial",
    is_flag=True,
    help="FILE holds the bytes of a serial line, with eProsima's framing: alone, or as the packets of a capture.",
)
@click.option(
    "form", "--format", type=click.Choice(["text", "jsonl"]), default="text", show_default=True, help="Form of a line."
)
@click.option(
    "signals",
    "--signals",
    metavar="FILE",
    type=options.type_of_file,
    help="Write what each stream has sent, acknowledged and lost over time to a .csv or .parquet file; print no lines.",
)
@click.option("output", "-o", "--output", metavar="FILE", type=options.type_of_file, help="Write the lines to a file.")
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Print the DDS-XRCE messages in a capture, a line for each submessage.

    FILE is a pcap or pcapng capture; - reads one from standard input as it comes, for instance from tcpdump -w -.
    What goes to or from the port and is no message of DDS-XRCE gets a line that says malformed, and why.

    The exit status is 0 if FILE is a capture, whatever is in it, and 2 if it is none.
    """
    from tachk.cli.actions.decode import Decoding, run_decode

    arguments = options.distributed(given, Decoding)
    options.finish(lambda: run_decode(*arguments), seconds)
