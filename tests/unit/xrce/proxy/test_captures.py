"""Captures of real clients and a real Agent behind the relay: what they show, written down before it was looked at.

`tests/data/captures` has captures with the ground truth of the programs: ports, what the clients were told to do, the
rules of the relay with how often they applied, and what the clients printed.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any, Final

import pytest

from tachk.api.monitoring import monitor
from tachk.recordings.traces.node_signal import Truth
from tachk.xrce.events import SubmessageEvent, decode
from tachk.xrce.wire import SubmessageKind

CAPTURES: Final = Path(__file__).resolve().parents[3] / "data/captures"
NAMES: Final = sorted(path.stem for path in CAPTURES.glob("*.pcap"))
PUBLISHER, SUBSCRIBER = "client_AAAABBBB.to_agent", "client_CCCCDDDD.from_agent"


@cache
def truth(name: str) -> Any:
    return json.loads((CAPTURES / f"{name}.json").read_text(encoding="utf-8"))


@cache
def events(name: str, end: str) -> tuple[SubmessageEvent, ...]:
    """What one end saw, or the Agent."""
    with (CAPTURES / f"{name}.pcap").open("rb") as capture:
        return tuple(decode(capture, [truth(name)["ports"][end]]))


def index(event: SubmessageEvent) -> int:
    return int.from_bytes(bytes.fromhex(str(event.fields["sample"])), "little")


def printed(name: str, end: str, what: str) -> list[int]:
    return [line["index"] for line in truth(name).get(end, ()) if line["event"] == what]


@pytest.mark.parametrize("name", NAMES)
def test_everything_decodes_and_agrees_with_what_the_clients_printed(name: str) -> None:
    ends = [end for end in ("publisher", "subscriber", "agent") if end in truth(name)["ports"]]
    assert all(not event.problem for end in ends for event in events(name, end))
    sent = {index(event) for event in events(name, "publisher") if event.kind is SubmessageKind.WRITE_DATA}
    assert sent == {*printed(name, "publisher", "written")}
    if "subscriber" in ends:
        got = {index(event) for event in events(name, "subscriber") if event.kind is SubmessageKind.DATA}
        received = printed(name, "subscriber", "received")
        assert got >= {*received}
        assert received == sorted({*received})


@pytest.mark.parametrize("name", NAMES)
def test_nothing_is_lost_or_copied_but_what_rules_say(name: str) -> None:
    """Each packet of the client's side is on the Agent's side as well, but for those that rules drop or duplicate."""
    between = [end for end in ("publisher", "subscriber") if end in truth(name)["ports"]]
    near = sum(len({event.packet for event in events(name, end)}) for end in between)
    far = len({event.packet for event in events(name, "agent")})
    rules = truth(name)["rules"]
    if any("%" in rule["rule"] for rule in rules):
        pytest.skip("which packets meet in the relay is left to chance")
    expected = 0
    for rule in rules:
        words = rule["rule"].split(" until ")[0].split(" after ")[0].split()
        sign = {"drop": 1, "delay": 0, "duplicate": -1}[words[0]]
        to_client = "agent->client" in words or words[-2:-1] == ["DATA"]
        expected += rule["applied"] * (-sign if to_client else sign)
    assert near - far == expected


REPAIRED: Final = f"G ({PUBLISHER}.outstanding > 0 -> F[0, 1 s] {PUBLISHER}.outstanding == 0)"
DELIVERED: Final = f"G ({SUBSCRIBER}.outstanding > 0 -> F[0, 36 s] {SUBSCRIBER}.outstanding == 0)"
SILENT: Final = f"G ({PUBLISHER}.heartbeats == 0)"


@pytest.mark.parametrize(
    ("name", "end", "formula", "holds"),
    [
        ("starved_heartbeat", "publisher", REPAIRED, False),
        ("spin_pause", "publisher", REPAIRED, True),
        ("stale_acknack", "publisher", REPAIRED, False),
        ("stale_acknack", "publisher", f"G ({PUBLISHER}.repetitions == 0)", True),
        ("created_again", "publisher", REPAIRED, False),
        ("full_window", "publisher", f"G[0, 10 s] {PUBLISHER}.heartbeats == 0", True),
        ("full_window", "publisher", REPAIRED, False),
        ("dead_time", "subscriber", DELIVERED, False),
        ("dead_time_ping", "subscriber", DELIVERED, True),
        ("created_again_sub", "publisher", REPAIRED, True),
        ("needless_nack", "publisher", f"G ({PUBLISHER}.missing == 0)", False),
    ],
)
def test_what_streams_do(name: str, end: str, formula: str, holds: bool) -> None:
    path = CAPTURES / f"{name}.pcap"
    report = monitor(formula, path, ports=[truth(name)["ports"][end]], end="weak")
    assert report.truth is (Truth.TRUE if holds else Truth.FALSE)


@pytest.mark.parametrize(
    ("name", "missing"),
    [
        ("dead_time", {2}),
        ("dead_time_ping", set()),
        ("sleep_50s", {*range(2, 11)}),
        ("second_read", {19}),
        ("created_again_sub", {6, 7, 8, 9, 10}),
        ("pull_sleep", set()),
        ("pull_sleep_losses", set()),
        ("push_sleep", set()),
        ("push_pause", set()),
        ("needless_nack", set()),
        ("losses_and_delays", set()),
    ],
)
def test_which_samples_never_arrive(name: str, missing: set[int]) -> None:
    """The publisher has them confirmed all the same, the Agent has them."""
    written = {*printed(name, "publisher", "written")}
    assert written - {*printed(name, "subscriber", "received")} == missing
    at_agent = {index(event) for event in events(name, "agent") if event.kind is SubmessageKind.WRITE_DATA}
    assert at_agent == written


def test_a_nack_names_a_message_that_the_agent_has() -> None:
    """On the side of the Agent the message comes first, then the HEARTBEAT, and the answer to that names it."""
    came: set[int] = set()
    needless = 0
    for event in events("needless_nack", "agent"):
        if event.kind is SubmessageKind.WRITE_DATA and event.sequence is not None:
            came.add(event.sequence)
        if event.kind is SubmessageKind.ACKNACK and not event.to_agent:
            missing = event.fields["missing"]
            assert isinstance(missing, list)
            needless += bool(missing) and came.issuperset(missing)
    assert needless > 0
    assert truth("needless_nack")["rules"] == []


def test_a_sleeping_client_that_asks_for_samples_is_not_disturbed() -> None:
    for name in ("pull_sleep", "pull_sleep_losses"):
        assert [line["discarded"] for line in truth(name)["subscriber"] if line["event"] == "awake"] == [0, 0]
    discarded = [line["discarded"] for line in truth("push_sleep")["subscriber"] if line["event"] == "awake"]
    assert discarded[0] > 0
