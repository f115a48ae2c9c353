"""`tachk bridge`: processes of a model in a real session."""

from __future__ import annotations

from contextlib import ExitStack, suppress
from pathlib import Path

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass
from tachk.cli.actions.simulation.models import simulated_model
from tachk.cli.arguments import parse_definitions
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.cli.places import place
from tachk.engine.simulation.policy import Policy
from tachk.xrce.bridge.bridging import Bridge
from tachk.xrce.bridge.clock import WallClock
from tachk.xrce.bridge.part import BridgedPart
from tachk.xrce.bridge.sockets import BridgeSocket
from tachk.xrce.proxy.recording import CaptureWriter

_NANOSECONDS = 10**9
_FOR_EVER = 2**62


@dataclass(frozen=True, slots=True)
class Bridging:
    """What is asked, as it was typed."""

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


def run_bridge(asked: Bridging) -> ExitStatus:
    """Raises UsageError for a part that is no end of a session, OSError for a port that is taken."""
    model = simulated_model(asked.model, **parse_definitions(asked.definitions))
    print_diagnostics((*model.refusals, *model.warnings))
    clock = WallClock(asked.speed)
    bridge = Bridge(
        BridgedPart(model.network, asked.processes, asked.seed, Policy(asked.policy)), clock, topic=asked.topic
    )
    if bridge.to_agent and asked.to is None:
        raise UsageError("these processes are a client: --to is missing", "--to HOST:PORT says where the Agent listens")
    if not bridge.to_agent and asked.listen is None:
        raise UsageError("these processes are an Agent: --listen is missing", "such as --listen 8888")
    to = None if asked.to is None else place(asked.to, "--to", needs_host=True)
    listen = None if asked.listen is None else place(asked.listen, "--listen")
    until = _FOR_EVER if asked.seconds_in_all is None else int(asked.seconds_in_all * _NANOSECONDS * asked.speed)
    with ExitStack() as stack:
        file = None if asked.record is None else stack.enter_context(asked.record.open("wb"))
        socket = BridgeSocket(bridge, listen, to, None if file is None else CaptureWriter(file))
        stack.callback(socket.close)
        side = "client" if bridge.to_agent else "Agent"
        print(f"{asked.model}: {side} at {socket.address}{'' if to is None else f', to {to}'}", flush=True)
        with suppress(KeyboardInterrupt):
            socket.run(clock, until)
        sent, received = socket.packets
        print(f"{sent} packets sent, {received} received, {bridge.ignored} of them mean nothing to the model")
    return ExitStatus.AS_EXPECTED if bridge.is_open else ExitStatus.NOT_AS_EXPECTED
