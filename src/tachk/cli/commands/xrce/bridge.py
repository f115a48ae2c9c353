"""`tachk xrce bridge`: let a model stand in for a client or an Agent of DDS-XRCE, by UDP."""

from __future__ import annotations

from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass
from tachk.cli import options
from tachk.cli import simulation_options as drawing
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.engine.simulation.policy import Policy
from tachk.xrce.bridge.clock import WallClock


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
    type=options.NumberInRange(0.001, 1000),
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
@click.option("record", "--record", metavar="FILE", type=options.written_file, help="Write the packets to a capture.")
def command(**given: Any) -> None:
    """Run processes of a model as a client or an Agent in a real session of DDS-XRCE, over UDP.

    \b
    tachk xrce bridge publication.ta --process application --process publisher --to 127.0.0.1:8888
    tachk xrce bridge publication.ta --process writer --listen 8888

    What the processes send over send[link][kind] becomes packets; packets become deliver[link][kind].
    Ends with --until or Ctrl-C. Exit status: 0 there was a session, 10 there was none, 2 bad input, 3 something that is
    not simulated.
    """

    (arguments,) = distributed(given, BridgeArguments)
    options.finish(lambda: run_bridge(arguments))


_NANOSECONDS = 10**9
_FOR_EVER = 2**62


@dataclass(frozen=True, slots=True)
class BridgeArguments:
    """Arguments of `tachk xrce bridge`."""

    model: str
    processes: tuple[str, ...]
    to: str | None
    listen: str | None
    definitions: tuple[str, ...]
    seconds_in_all: float | None
    speed: float
    seed: int
    policy: str
    topic: str
    record: Path | None


def run_bridge(arguments: BridgeArguments) -> ExitStatus:
    """Raises UsageError for a part that is not an end of a session, OSError for a port that is taken."""
    from tachk.cli.arguments import parse_definitions
    from tachk.cli.places import place
    from tachk.cli.simulated_model import simulated_model
    from tachk.xrce.bridge.bridging import Bridge
    from tachk.xrce.bridge.part import BridgedPart
    from tachk.xrce.bridge.sockets import BridgeSocket
    from tachk.xrce.proxy.recording import CaptureWriter

    model = simulated_model(arguments.model, **parse_definitions(arguments.definitions))
    print_diagnostics((*model.refusals, *model.warnings))
    clock = WallClock(arguments.speed)
    bridge = Bridge(
        BridgedPart(model.network, arguments.processes, arguments.seed, Policy(arguments.policy)),
        clock,
        topic=arguments.topic,
    )
    if bridge.to_agent and arguments.to is None:
        raise UsageError("these processes are a client: --to is missing", "--to HOST:PORT says where the Agent listens")
    if not bridge.to_agent and arguments.listen is None:
        raise UsageError("these processes are an Agent: --listen is missing", "such as --listen 8888")
    to = None if arguments.to is None else place(arguments.to, "--to", needs_host=True)
    listen = None if arguments.listen is None else place(arguments.listen, "--listen")
    until = (
        _FOR_EVER
        if arguments.seconds_in_all is None
        else int(arguments.seconds_in_all * _NANOSECONDS * arguments.speed)
    )
    with ExitStack() as stack:
        file = None if arguments.record is None else stack.enter_context(arguments.record.open("wb"))
        socket = BridgeSocket(bridge, listen, to, None if file is None else CaptureWriter(file))
        stack.callback(socket.close)
        side = "client" if bridge.to_agent else "Agent"
        print(f"{arguments.model}: {side} at {socket.address}{'' if to is None else f', to {to}'}", flush=True)
        with suppress(KeyboardInterrupt):
            socket.run(clock, until)
        sent, received = socket.packets
        print(f"{sent} packets sent, {received} received, {bridge.ignored} of them mean nothing to the model")
    return ExitStatus.AS_EXPECTED if bridge.is_open else ExitStatus.NOT_AS_EXPECTED
