"""The action of `tachk bridge`."""

from __future__ import annotations

from contextlib import ExitStack, suppress
from pathlib import Path

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass
from tachk.cli.arguments import parse_definitions
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.cli.places import place
from tachk.cli.simulated_model import simulated_model
from tachk.engine.simulation.policy import Policy
from tachk.xrce.bridge.bridging import Bridge
from tachk.xrce.bridge.clock import WallClock
from tachk.xrce.bridge.part import BridgedPart
from tachk.xrce.bridge.sockets import BridgeSocket
from tachk.xrce.proxy.recording import CaptureWriter

_NANOSECONDS = 10**9


_FOR_EVER = 2**62


@dataclass(frozen=True, slots=True)
class BridgeArguments:
    """Arguments of `tachk bridge`."""

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
    """Raises UsageError for a part that is no end of a session, OSError for a port that is taken."""
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
