"""FCRS and FCRS_each on captures of real clients, against what a plain reading of the packets at each client gives."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest

from tachk.api.monitoring import monitor
from tachk.recordings.traces.node_signal import Truth
from tachk.xrce.events import SubmessageEvent
from tachk.xrce.wire import FIRST_RELIABLE_STREAM, SubmessageKind
from tests.unit.xrce.proxy.test_captures import CAPTURES, NAMES, events, truth
from tests.unit.xrce.test_properties_on_packets import QUERIES, Talk, acknack, created, write

Wait = tuple[int, float]
"""When a message of a client was sent, and when an ACKNACK that confirms it came, in nanoseconds; infinite: never."""


def waits(seen: tuple[SubmessageEvent, ...]) -> list[Wait]:
    """Of the messages on reliable streams; numbers of these captures do not go round."""
    sent: dict[tuple[object, int], int] = {}
    found: dict[tuple[object, int], float] = {}
    for event in seen:
        if event.to_agent and event.sequence is not None and (event.stream or 0) >= FIRST_RELIABLE_STREAM:
            sent.setdefault((event.stream, event.sequence), event.time)
        if event.kind is SubmessageKind.ACKNACK and not event.to_agent:
            first = event.fields["first"]
            assert isinstance(first, int)
            for key in sent:
                if key[0] == event.fields["subject"] and key[1] < first:
                    found.setdefault(key, event.time)
    return [(begin, found.get(key, math.inf)) for key, begin in sent.items()]


def longest_stretch(ones: list[Wait]) -> float:
    """For how long something is unconfirmed without interruption."""
    begin, end, longest = 0.0, -1.0, 0.0
    for start, stop in sorted(ones):
        if start > end:
            begin, end = start, stop
        end = max(end, stop)
        longest = max(longest, end - begin)
    return longest


@pytest.mark.parametrize("name", NAMES)
def test_the_longest_waits_are_those_that_the_packets_show(name: str) -> None:
    clients = [end for end in ("publisher", "subscriber") if end in truth(name)["ports"]]
    ones = [wait for end in clients for wait in waits(events(name, end))]
    longest = {"pending": max(stop - start for start, stop in ones), "waiting": longest_stretch(ones)}
    for (trigger, nanoseconds), response in zip(longest.items(), ("acknowledged", "answered"), strict=True):
        bound = Fraction(int(nanoseconds), 10**9) if nanoseconds < math.inf else Fraction(1)
        for limit, holds in ((bound, nanoseconds < math.inf), (bound - Fraction(1, 10**9), False)):
            formula = f"G ({trigger} -> F[0, {float(limit):.9f} s] {response})"
            found = monitor(formula, CAPTURES / f"{name}.pcap", robustness=False, end="weak").truth
            assert (found is not Truth.FALSE) == holds, formula


def test_each_message_in_time_though_there_is_always_one(tmp_path) -> None:
    talk = Talk().up(0, created())
    for number in range(4):
        talk.up(9_000 * number + 10, write(number, number))
        talk.down(9_000 * number + 15_000, acknack(number + 1))
    report = monitor(QUERIES, talk.capture(tmp_path), select=["FCRS", "FCRS_each"])
    assert [verdict.truth for verdict in report] == [Truth.FALSE, Truth.TRUE]


def test_what_is_not_confirmed_when_the_session_ends_stays_so(tmp_path) -> None:
    """A client that closes its session is not told any more. One that begins anew has nothing to be told."""
    ended = bytes.fromhex("81000000030104000002FFFE")
    talk = Talk().up(0, created()).up(10, write(0, 0)).up(100, ended).up(30_000, ended)
    found = monitor(QUERIES, talk.capture(tmp_path), select=["FCRS", "FCRS_each"])
    assert {verdict.truth for verdict in found} == {Truth.FALSE}
    again = Talk().up(0, created()).up(10, write(0, 0)).up(100, ended).up(200, created()).up(30_000, ended)
    found = monitor(QUERIES, again.capture(tmp_path), select=["FCRS", "FCRS_each"])
    assert {verdict.truth for verdict in found} == {Truth.TRUE}
