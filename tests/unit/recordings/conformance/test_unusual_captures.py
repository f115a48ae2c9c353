"""Captures of the real programs that the tools or the automata once judged wrongly; see the README beside them."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from tachk.cli.main import app
from tachk.xrce.conformance.packet_events import read_capture
from tachk.xrce.events import decode
from tachk.xrce.wire import SubmessageKind

pytestmark = pytest.mark.drawn

ROOT = Path(__file__).parents[4]
MODEL = str(ROOT / "models/micro_xrce_dds/client_3_0.ta")
QUERIES = ROOT / "queries/micro_xrce_dds.ta"
CAPTURES = ROOT / "tests/data/captures/unusual"


def capture(name: str) -> str:
    return str(CAPTURES / f"{name}.pcap")


def run(*words: str) -> tuple[int, str]:
    found = CliRunner().invoke(app, list(words))
    return found.exit_code, found.output


def verdicts(name: str, *more: str) -> tuple[int, list[str]]:
    status, text = run("monitor", str(QUERIES), capture(name), *more)
    return status, text.splitlines()


def settings(name: str) -> list[str]:
    status, text = run("xrce", "measure", capture(name), "--for", MODEL, "--format", "settings")
    assert status == 0, text
    return text.split()


def test_tcp_at_another_port_is_the_same_with_and_without_it() -> None:
    """The first segment of a client is the length of its CREATE_CLIENT alone."""
    status, lines = verdicts("tcp_other_port")
    assert status == 0 and lines[-1] == "14 true"
    assert lines == verdicts("tcp_other_port", "--port", "24800")[1]


def test_samples_behind_a_cancel_reach_their_reader_outside_of_any_stream() -> None:
    status, lines = verdicts("cancel_while_flowing")
    assert status == 0 and lines[-1] == "14 true"


def test_a_client_goes_on_from_another_address_behind_a_relay() -> None:
    """It was away for 0.9 s, in which messages came to it; so NIWS is false, and everything that speaks of delivery is
    true."""
    assert "CLIENTS=2" in settings("address_changes")
    text = "\n".join(verdicts("address_changes")[1])
    assert "presumably" not in text
    assert "12 true, 2 false" in text and "NIWS is false" in text and "NIWS_rise is false" in text
    assert run("conform", MODEL, capture("address_changes"), *settings("address_changes"), "--late", "5ms")[0] == 0


@pytest.mark.parametrize(
    ("name", "constant"),
    [
        ("read_for_one_second", "READ_SECONDS"),
        ("read_20_bytes_per_second", "READ_BYTES"),
        ("cancel_while_flowing", "CANCELS"),
        ("cancel_while_idle", "CANCELS"),
    ],
)
def test_limits_in_time_and_cancels_are_measured(name: str, constant: str) -> None:
    assert run("conform", MODEL, capture(name), *settings(name), "--late", "5ms")[0] == 0
    status, text = run("conform", MODEL, capture(name))
    assert status == 2 and f"set -D {constant}=" in text


@pytest.mark.parametrize(("name", "late"), [("two_topics", "5ms"), ("two_readers", "50ms")])
def test_several_topics_and_readers_are_measured(name: str, late: str) -> None:
    own = settings(name)
    assert {"TOPICS=2", "READERS=2"} <= set(own)
    assert run("conform", MODEL, capture(name), *own, "--late", late)[0] == 0
    status, text = run("conform", MODEL, capture(name), "-D", "CLIENTS=4")
    assert status == 2 and "set -D TOPICS=2" in text


def test_the_agent_announces_what_its_sender_has_not_sent() -> None:
    """Without that edge the capture is refused at the HEARTBEAT, and the refusal is explained."""
    own = [*settings("heartbeat_before_data"), "--late", "5ms"]
    assert run("conform", MODEL, capture("heartbeat_before_data"), *own)[0] == 0
    status, text = run("conform", MODEL, capture("heartbeat_before_data"), *own, "-D", "EARLY_ANNOUNCEMENT=0")
    assert status == 10
    assert "it leaves the model at packet 206" in text and "kind=HEARTBEAT, number=14, detail=15" in text
    assert "the model allows sent(link=3, kind=DATA, number=14" in text


def test_a_ping_outside_a_session_does_not_wake_the_agent() -> None:
    assert (
        run("conform", MODEL, capture("ping_without_session"), *settings("ping_without_session"), "--late", "5ms")[0]
        == 0
    )
    sent = [e for e in read_capture(CAPTURES / "ping_without_session.pcap").events if e.cells.get("kind") == "PING"]
    assert [(e.name, e.place) for e in sent] == [("sent", "packet 393"), ("arrived", "packet 394")]


def test_a_client_hangs_that_has_fewer_slots_than_a_sample_has_pieces() -> None:
    """It never answers the fourth piece of five. One that stops looking for the last would, and so would one with more
    slots."""
    text = "\n".join(verdicts("too_many_pieces")[1])
    assert "FARS is false" in text and "ECRA is undetermined" in text
    fixed = ["-D", "MESSAGES=4", "-D", "CLIENT_JITTER=5", "-D", "AGENT_JITTER=5", "-D", "AGENT_DELAY=16"]
    for changed, packet in (([], None), (["-D", "ENDLESS_SEARCH=0"], 90), (["-D", "INPUT_HISTORY=8"], 90)):
        four = [] if "INPUT_HISTORY=8" in changed else ["-D", "INPUT_HISTORY=4"]
        status, told = run("conform", MODEL, capture("too_many_pieces"), *fixed, *four, *changed)
        assert status == (0 if packet is None else 10), changed
        assert packet is None or f"leaves the model at packet {packet}," in told


def test_a_client_forgets_what_it_has_confirmed_when_its_session_is_there() -> None:
    """STATUS_AGENT comes behind the samples 0 to 4. The Agent has from 5 on, the client lacks 0 to the end."""
    with Path(capture("forgets_confirmed")).open("rb") as packets:
        seen = list(decode(packets, [27801]))
    begun = [place for place, event in enumerate(seen) if event.kind is SubmessageKind.CREATE_CLIENT]
    assert len(begun) == 3
    second = seen[begun[1] : begun[2]]
    there = next(place for place, event in enumerate(second) if event.kind is SubmessageKind.STATUS_AGENT)
    confirmed = [event.fields["first"] for event in second if event.kind is SubmessageKind.ACKNACK and event.to_agent]
    assert max(confirmed) == 5 and set(confirmed[-9:]) == {0}
    held = {event.fields["first"] for event in second[there:] if event.kind is SubmessageKind.HEARTBEAT}
    assert held == {5}
    assert any("FARS " in line and "presumably false" in line for line in verdicts("forgets_confirmed")[1])
