"""A model of a client and a model of an Agent speak by UDP: their packets are messages of DDS-XRCE, and everything that
is written arrives."""

from __future__ import annotations

from contextlib import ExitStack, closing
from io import BytesIO
from pathlib import Path

import pytest

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.model.network import Network
from tachk.xrce.bridge.bridging import Bridge
from tachk.xrce.bridge.clock import SteppedClock
from tachk.xrce.bridge.part import BridgedPart
from tachk.xrce.bridge.sockets import BridgeSocket
from tachk.xrce.events import SubmessageEvent, decode
from tachk.xrce.proxy.recording import CaptureWriter
from tachk.xrce.wire import SubmessageKind

MODELS = Path(__file__).parents[4] / "models" / "micro_xrce_dds"
SECOND = 10**9


def network() -> Network:
    return load_model(MODELS / "publication.ta", {"MESSAGES": 4}).network


def conversation(lost: int | None = None) -> tuple[list[SubmessageEvent], SteppedClock]:
    """What is recorded at the client; one of its packets is lost."""
    clock, out = SteppedClock(), BytesIO()
    agent = BridgeSocket(Bridge(BridgedPart(network(), ["writer"]), clock), None, None)
    client = BridgeSocket(
        Bridge(BridgedPart(network(), ["application", "publisher"]), clock), None, agent.address, CaptureWriter(out)
    )
    sockets = [client, agent]
    try:
        while True:
            for socket in sockets:
                if socket is client and client.packets[0] == lost:
                    lost = None
                    client.bridge.due()  # and nobody sends it
                socket.due()
            while sum(socket.poll() for socket in sockets):
                pass
            wakes = [wake for socket in sockets if (wake := socket.bridge.wake()) is not None]
            if not wakes or clock.now() > 100 * SECOND:
                return list(decode(BytesIO(out.getvalue()), [agent.address.port])), clock
            clock.step_to(max(min(wakes), clock.now() + 1))
    finally:
        for socket in sockets:
            socket.close()


def test_models_of_both_ends_have_a_session_by_udp() -> None:
    found, clock = conversation()
    assert all(not event.problem for event in found)
    kinds = [event.kind for event in found]
    assert kinds[:2] == [SubmessageKind.CREATE_CLIENT, SubmessageKind.STATUS_AGENT]
    written = [event.sequence for event in found if event.kind is SubmessageKind.WRITE_DATA]
    assert written == [1, 2, 3, 4]
    assert [e.fields["first"] for e in found if e.kind is SubmessageKind.ACKNACK and not e.to_agent][-1] == 5
    assert 12 * SECOND <= clock.now() <= 20 * SECOND


def test_what_is_lost_is_repeated() -> None:
    found, _ = conversation(lost=7)
    assert [e.kind for e in found if e.to_agent].count(SubmessageKind.HEARTBEAT) >= 1
    assert [e.fields["first"] for e in found if e.kind is SubmessageKind.ACKNACK and not e.to_agent][-1] == 5


def test_strangers_have_no_part_in_a_session() -> None:
    clock = SteppedClock()
    with ExitStack() as opened:
        agent = opened.enter_context(
            closing(BridgeSocket(Bridge(BridgedPart(network(), ["writer"]), clock), None, None))
        )
        ends = [Bridge(BridgedPart(network(), ["application", "publisher"]), clock) for _ in range(2)]
        client, stranger = (opened.enter_context(closing(BridgeSocket(end, None, agent.address))) for end in ends)
        while not client.bridge.is_open:
            client.due()
            while sum(socket.poll() for socket in (client, agent)):
                pass
        before = list(agent.packets)
        stranger.due()
        assert stranger.packets[0] > 0 and agent.poll() and not stranger.poll()
        assert agent.packets == before


EAGER = """
time_unit = 1 s;
broadcast chan send[2][4];
meta int[0, 9] number = 0;
meta int[0, 9] detail = 0;
process Client() {
    init committed location Ready { to Resting { sync send[0][0]!; assign number = 1, detail = 5; } }
    location Resting;
}
process Slow() {
    clock x;
    init location Waiting { invariant x <= 7; to Waiting { guard x >= 7; assign x = 0; } }
}
process Agent() { int[0, 9] seen = 0; init location Free { to Free { sync send[0][0]?; assign seen = detail; } } }
system Client, Slow, Agent;
"""


def test_what_is_committed_happens_at_once() -> None:
    part = BridgedPart(load_model(Source("<text>", EAGER)).network, ["Client", "Slow"])
    assert part.next_event() == 0
    assert [(sent.time, sent.values["detail"]) for sent in part.advance(0)] == [(0, 5)]
    assert part.next_event() == 7 * SECOND


def test_a_part_without_links_is_no_end_of_a_session() -> None:
    with pytest.raises(UsageError):
        Bridge(BridgedPart(network(), ["loss"]), SteppedClock())


def test_a_stepped_clock_does_not_go_back() -> None:
    clock = SteppedClock(5)
    clock.step_to(7)
    with pytest.raises(ValueError, match="7"):
        clock.step_to(6)
