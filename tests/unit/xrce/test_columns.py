"""What is held as columns of numbers is what it was made of."""

from __future__ import annotations

from pathlib import Path
from random import Random
from statistics import median

import pytest

from tachk.xrce.conformance.packet_events import read_capture
from tachk.xrce.legs import Leg
from tachk.xrce.matching import _equal_ones, matched
from tachk.xrce.measuring.quantity import (
    Confidence,
    Observation,
    PackedSamples,
    PacketPlace,
    Quantity,
    QuantityUnit,
    gathered,
    seen,
    values_of,
)
from tachk.xrce.messages import Endpoint
from tachk.xrce.transmissions import open_transmissions, read_transmissions
from tachk.xrce.wire import SubmessageKind

CAPTURES = Path(__file__).parents[2] / "data/captures"
NAMES = [
    "losses_and_delays",
    "later/fragments_losses",
    "later/batches_losses",
    "later/restarted",
    "later/best_effort_mixed",
]


@pytest.mark.parametrize("name", NAMES)
def test_transmissions_are_those_of_the_capture(name: str) -> None:
    path = CAPTURES / f"{name}.pcap"
    read, packed = list(open_transmissions(path)), read_transmissions(path).transmissions
    assert len(read) == len(packed) > 0
    for one, other in zip(read, packed, strict=True):
        for what in ("link", "to_agent", "sent", "packet", "arrivals", "events", "is_lost", "is_observed", "arrived"):
            assert getattr(one, what) == getattr(other, what)
        assert (one.kinds, one.is_reliable) == (other.kinds, other.is_reliable)
    for link in range(3):
        for to_agent in (True, False):
            wanted = [one.packet for one in read if (one.link, one.to_agent) == (link, to_agent)]
            assert [one.packet for one in packed.where(link, to_agent)] == wanted
    kinds = frozenset({SubmessageKind.ACKNACK, SubmessageKind.CREATE})
    assert [one.packet for one in packed.where(kinds=kinds)] == [one.packet for one in read if kinds & one.kinds]


def test_parts_of_a_recording_are_its_events() -> None:
    events = read_capture(CAPTURES / "losses_and_delays.pcap").events
    listed = list(events)
    assert [events[n] for n in range(len(events))] == listed
    assert events[5:40:3] == tuple(listed[5:40:3])
    assert events[-1] == listed[-1]
    assert events == tuple(listed)


def observations(count: int) -> list[Observation]:
    random = Random(count)
    return [
        Observation(
            random.choice((random.random(), random.randrange(9))),
            tuple(PacketPlace(random.choice("ab"), random.randrange(99)) for _ in range(random.randrange(4))),
        )
        for _ in range(count)
    ]


@pytest.mark.parametrize("count", [0, 10, 999, 1000, 3000])
def test_samples_are_what_was_observed(count: int) -> None:
    found = observations(count)
    samples = gathered(iter(found))
    assert isinstance(samples, PackedSamples) == (count >= 1000)
    assert list(samples) == found
    assert [type(each.value) for each in samples] == [type(each.value) for each in found]
    assert list(values_of(samples)) == [each.value for each in found]
    assert tuple(samples[3:9]) == tuple(found[3:9])
    quantity = seen("n", "title", iter(found), "")
    plain = Quantity("n", "title", QuantityUnit.COUNT, tuple(found), None, Confidence.MEASURED, "")
    assert quantity.value == (median(each.value for each in found) if found else None)
    assert (quantity.minimum, quantity.maximum) == (plain.minimum, plain.maximum)
    assert quantity.first_places(6) == (plain.places[:6], len(plain.places))


@pytest.mark.parametrize("seed", range(20))
def test_messages_are_matched_content_by_content(seed: int) -> None:
    random = Random(seed)
    here, there = Leg(Endpoint("c", 1), Endpoint("a", 1)), Leg(Endpoint("c", 2), Endpoint("a", 2))
    contents: list[tuple[Leg, bytes]] = []
    for packet in range(60):
        leg, octets = random.choice((here, there)), bytes([random.randrange(12)])
        leg.add(packet, packet, 10 * packet, True, False, octets)
        contents.append((leg, octets))
    before, behind = here.columns(), there.columns()
    found = matched(before, behind)
    pairs = {(int(before.packets[one]), int(behind.packets[other])) for one, other in found.arrivals.tolist()}
    expected: set[tuple[int, int]] = set()
    unsent: list[int] = []
    for octets in {each for _, each in contents}:
        entered = [n for n, (leg, own) in enumerate(contents) if leg is here and own == octets]
        left = [n for n, (leg, own) in enumerate(contents) if leg is there and own == octets]
        expected |= {(entered[one], left[other]) for one, other in _equal_ones(entered, left)} if entered else set()
        unsent += [] if entered else left
    assert pairs == expected
    assert behind.packets[found.unsent].tolist() == sorted(unsent)
