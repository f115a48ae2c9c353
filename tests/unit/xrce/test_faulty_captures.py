"""What is measured in columns of numbers is what is measured message by message, whatever faults a capture has."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from random import Random

import numpy as np
import pytest

from tachk.xrce.measuring import heartbeats, input_windows, sleeps, traffic
from tachk.xrce.measuring.conversation import Conversation, conversations
from tachk.xrce.measuring.measure import _twice
from tachk.xrce.measuring.quantity import Observation
from tachk.xrce.packets import CaptureError
from tachk.xrce.transmissions import Capture, open_transmissions, read_transmissions
from tests.support.seeds import seeds
from tests.unit.xrce import plain_measuring as plain
from tests.unit.xrce.faulty_captures import faulty_capture

FILE = "run.pcap"


def rows(found: Sequence[Observation]) -> list[plain.Sample]:
    return [(each.value, *(place.packet for place in each.places)) for each in found]


@pytest.mark.parametrize("seed", seeds(range(40)))
def test_columns_say_what_messages_say(tmp_path: Path, seed: int) -> None:
    path = faulty_capture(tmp_path / FILE, Random(seed))
    try:
        messages, recording = list(open_transmissions(path)), read_transmissions(path)
    except CaptureError:
        return
    for link in range(len(recording.links)):
        ours = [one for one in messages if one.link == link]
        agree_on_client(ours, recording, link)
    for conversation in conversations(FILE, recording):
        ours = [one for one in messages if one.link == conversation.link]
        agree_on_stream(plain.moments(ours, conversation.from_client, conversation.stream), conversation)
    streams = {(one.link, one.to_agent, event.stream) for one in messages for event in one.events if event.is_reliable}
    assert {(c.link, c.from_client, c.stream) for c in conversations(FILE, recording)} == streams
    (overtakings,) = traffic.overtakings(FILE, recording)
    assert rows(overtakings) == list(plain.overtakings(messages))
    (delays,) = traffic.delays(FILE, recording)
    assert rows(delays) == [
        ((arrival.time - one.sent) / plain.MILLISECOND, one.packet, arrival.packet)
        for one in messages
        for arrival in one.arrivals or ()
    ]
    (copies,) = traffic.copies(FILE, recording)
    several = [one.arrivals for one in messages if one.arrivals is not None and len(one.arrivals) > 1]
    assert rows(copies) == [(len(each), *(arrival.packet for arrival in each)) for each in several]
    for to_agent in (True, False):
        losses = [rows(each) for each in traffic.losses(FILE, recording, to_agent)]
        for link in range(len(recording.links)):
            known = [one for one in messages if (one.link, one.to_agent) == (link, to_agent) and one.is_observed]
            lost = [one.packet for one in known if one.is_lost]
            if known:
                assert losses.pop(0) == [(100 * len(lost) / len(known), *lost)]
        assert not losses


def agree_on_stream(found: list[plain.Moment], conversation: Conversation) -> None:
    c = conversation
    assert [["sent", "heartbeat", "came"][kind] for kind in c.kinds] == [moment.what for moment in found]
    assert c.times.tolist() == [moment.time for moment in found]
    assert c.packets(np.arange(len(found))).tolist() == [moment.one.packet for moment in found]
    assert c.unacknowledged.tolist() == [moment.waiting for moment in found]
    assert c.again.tolist() == [moment.again for moment in found]
    assert c.answers.tolist() == [moment.answers for moment in found]
    numbered = [n for n, moment in enumerate(found) if moment.number is not None]
    assert c.numbers[numbered].tolist() == [found[n].number for n in numbered]
    assert [(w.activity, w.beat, w.previous, *(place.packet for place in w.places)) for w in heartbeats.waits(c)] == [
        (*wait[:3], *dict.fromkeys(wait[3:])) for wait in plain.waits(found)
    ]
    for period in (1, 100):
        assert [
            (s.length, s.gap, s.traffic, *(place.packet for place in s.places)) for s in heartbeats.starvings(c, period)
        ] == list(plain.starvings(found, period))
    assert tuple(map(rows, heartbeats.agent_rounds(c))) == plain.agent_rounds(found)
    assert rows(heartbeats.overdue(c)) == [
        plain.between(before, after)
        for before, after in pairwise(found)
        if after.what == "heartbeat" and after.waiting and plain.overdue(before, after)
    ]
    assert traffic.longest_unacknowledged(c) == plain.longest(found)
    assert rows(traffic.round_trips(c)) == list(plain.round_trips(found))
    assert rows(traffic.repairs(c)) == list(plain.repairs(found))
    assert rows(traffic.paces(c)) == plain.paces(found)
    most = max((moment.waiting for moment in found if moment.what == "sent"), default=0)
    window = traffic.window("", "", [c])
    assert (window.value or 0) == most
    room = plain.made_room(found, most)
    if len(room) > 1 and most >= 4 and most & (most - 1) == 0:
        assert rows(window.samples) == [(most, *packets) for packets in room]
    else:
        at_most = [(most, m.one.packet) for m in found if m.what == "sent" and m.waiting == most > 0]
        assert rows(window.samples) == at_most[:1]


def agree_on_client(ours: Sequence[plain.ReadTransmission], recording: Capture, link: int) -> None:
    reactions = list(traffic.reactions(FILE, recording))[link]
    assert rows(reactions) == list(plain.reactions(ours))
    sent = recording.transmissions
    assert _twice(sent, sent.rows(link)) == plain.twice(ours)
    silent = [each for each in sleeps.sleeps(recording) if each.link == link]
    expected = list(plain.asleep(ours, recording.end))
    assert [(s.begin, s.end, s.before, s.first, s.waking) for s in silent] == expected
    covered = sleeps.asleep(recording, silent)[sent.rows(link)].tolist()
    assert covered == [not one.to_agent and any(s[0] <= one.sent <= s[1] for s in expected) for one in ours]
    stream = plain.read_by_client(ours)
    client = input_windows._at_client(recording, link)
    assert client.times.tolist() == [each[0] for each in stream]
    assert client.unanswered() == plain.unanswered(stream)
    assert input_windows._differences(client) == {size: plain.differences(stream, size) for size in (2, 4, 8, 16, 32)}
