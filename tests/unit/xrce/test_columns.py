"""What is held as columns of numbers is what it was made of."""

from __future__ import annotations

import struct
from pathlib import Path
from random import Random
from statistics import median

import numpy as np
import pytest

from tachk.xrce.conformance.packet_events import read_capture
from tachk.xrce.legs import MessageColumns, digests
from tachk.xrce.matching import _equal_ones, matched
from tachk.xrce.measuring.quantity import (
    Confidence,
    Observation,
    PackedSamples,
    PacketPlace,
    Quantity,
    QuantityUnit,
    gathered,
    packed_groups,
    seen,
)
from tachk.xrce.packed_transmissions import PackedTransmissions
from tachk.xrce.transmissions import open_transmissions, read_transmissions
from tachk.xrce.wire import SubmessageKind
from tests.unit.xrce.captures import CREATE_CLIENT, WRITE_DATA, pcap, tcp
from tests.unit.xrce.plain_measuring import said

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
    assert_packed_as_read(CAPTURES / f"{name}.pcap")


def test_a_message_that_is_not_complete_when_the_capture_ends_stands_where_it_began(tmp_path: Path) -> None:
    """It is read last, and sent first."""
    whole, begun = struct.pack("<H", len(CREATE_CLIENT)) + CREATE_CLIENT, struct.pack("<H", 100) + WRITE_DATA
    segments = [tcp(whole, 1), tcp(begun, 1 + len(whole)), tcp(whole, 1, source=40001)]
    segments.append(tcp(struct.pack("<H", len(WRITE_DATA)) + WRITE_DATA, 1 + len(whole), source=40001))
    (tmp_path / "run.pcap").write_bytes(pcap(segments))
    packed = assert_packed_as_read(tmp_path / "run.pcap")
    assert [(one.link, one.packet) for one in packed] == [(0, 1), (0, 2), (1, 3), (1, 4)]


def assert_packed_as_read(path: Path) -> PackedTransmissions:
    read, packed = list(open_transmissions(path)), read_transmissions(path).transmissions
    assert len(read) == len(packed) > 0
    for one, other in zip(read, packed, strict=True):
        for what in ("link", "to_agent", "sent", "packet", "arrivals", "events", "is_lost", "is_observed", "arrived"):
            assert getattr(one, what) == getattr(other, what)
        assert (one.kinds, one.is_reliable) == (other.kinds, other.is_reliable)
    for link in {one.link for one in read}:
        for to_agent in (True, False):
            wanted = [one.packet for one in read if (one.link, one.to_agent) == (link, to_agent)]
            assert [one.packet for one in packed.where(link, to_agent)] == wanted
    kinds = frozenset({SubmessageKind.ACKNACK, SubmessageKind.CREATE})
    assert [one.packet for one in packed.where(kinds=kinds)] == [one.packet for one in read if kinds & one.kinds]
    contents = packed.contents(np.arange(len(packed))).tolist()
    equal = {said(one): content for one, content in zip(read, contents, strict=True)}
    assert [equal[said(one)] for one in read] == contents
    assert len(set(equal.values())) == len(equal)
    return packed


def test_parts_of_a_recording_are_its_events() -> None:
    events = read_capture(CAPTURES / "losses_and_delays.pcap").events
    listed = list(events)
    assert [events[n] for n in range(len(events))] == listed
    assert events[5:40:3] == tuple(listed[5:40:3])
    assert events[-1] == listed[-1]
    assert events == tuple(listed)


@pytest.mark.parametrize("count", [0, 10, 999, 1000, 3000])
@pytest.mark.parametrize("whole", [True, False])
def test_samples_are_what_was_observed(count: int, whole: bool) -> None:
    random = Random(count)
    found: list[Observation] = []
    pieces: list[PackedSamples] = []
    while len(found) < count:
        file, size = random.choice("ab"), random.randrange(1, count - len(found) + 1)
        values = [random.randrange(9) if whole else random.random() for _ in range(size)]
        packets = [[random.randrange(99) for _ in range(random.randrange(4))] for _ in range(size)]
        found += [
            Observation(value, tuple(PacketPlace(file, each) for each in own))
            for value, own in zip(values, packets, strict=True)
        ]
        together = np.array([each for own in packets for each in own], np.int64)
        pieces.append(packed_groups(file, np.array(values), together, np.array(list(map(len, packets)))))
    samples = gathered(pieces)
    assert isinstance(samples, PackedSamples) == (max(count, sum(len(each.places) for each in found)) >= 1000)
    assert list(samples) == found
    assert [type(each.value) for each in samples] == [type(each.value) for each in found]
    assert tuple(samples[3:9]) == tuple(found[3:9])
    quantity = seen("n", "title", samples, "")
    plain = Quantity("n", "title", QuantityUnit.COUNT, tuple(found), None, Confidence.MEASURED, "")
    observed = [each.value for each in found]
    assert quantity.value == quantity.median == plain.median == (median(observed) if found else None)
    assert (quantity.minimum, quantity.maximum) == (min(observed, default=None), max(observed, default=None))
    assert (plain.minimum, plain.maximum) == (quantity.minimum, quantity.maximum)
    assert quantity.first_places(6) == (plain.places[:6], len(plain.places))
    some = np.array([random.random() < 0.3 for _ in range(count)], np.bool_)
    chosen = PackedSamples.together(pieces).chosen(some)
    assert list(chosen) == [each for each, wanted in zip(found, some, strict=True) if wanted]


def columns(packets: list[int], contents: list[bytes]) -> MessageColumns:
    numbers, sizes = np.array(packets, np.int64), np.array(list(map(len, contents)), np.int64)
    said = digests(np.frombuffer(b"".join(contents), np.uint8), np.cumsum(sizes) - sizes, sizes)
    return MessageColumns(numbers, numbers, 10 * numbers, said, numbers >= 0, numbers < 0)


@pytest.mark.parametrize("seed", range(40))
def test_messages_are_matched_content_by_content(seed: int) -> None:
    random = Random(seed)
    contents: list[tuple[bool, bytes]] = []
    waiting: list[bytes] = []
    for _ in range(60):
        octets = bytes([random.randrange(12)])
        if waiting and random.random() < 0.5:  # many come out one after the other
            contents.append((False, waiting.pop(0)))
            continue
        here = seed % 2 == 1 or random.random() < 0.7
        contents.append((here, octets))
        waiting += [octets] if here else []
    contents += [(False, octets) for octets in (waiting if seed % 4 == 1 else ())]
    before, behind = (
        columns(
            [packet for packet, (side, _) in enumerate(contents) if side == here], [o for s, o in contents if s == here]
        )
        for here in (True, False)
    )
    found = matched(before, behind)
    pairs = [(int(before.packets[one]), int(behind.packets[other])) for one, other in found.arrivals.tolist()]
    expected: set[tuple[int, int]] = set()
    unsent: list[int] = []
    for octets in {each for _, each in contents}:
        entered = [n for n, (here, own) in enumerate(contents) if here and own == octets]
        left = [n for n, (here, own) in enumerate(contents) if not here and own == octets]
        expected |= {(entered[one], left[other]) for one, other in _equal_ones(entered, left)} if entered else set()
        unsent += [] if entered else left
    assert pairs == sorted(expected)
    assert behind.packets[found.unsent].tolist() == sorted(unsent)
