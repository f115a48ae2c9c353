"""Which messages are found where nobody has said at which port an Agent listens."""

from __future__ import annotations

import io
from collections.abc import Sequence

import pytest

from tachk.xrce.datagrams import datagrams
from tachk.xrce.messages import MessageReader
from tachk.xrce.packets import read_packets
from tests.unit.xrce.captures import ACKNACK, CREATE_CLIENT, HEARTBEAT, WRITE_DATA, pcap, tcp

PORT = 24800


def segments(*payloads: bytes, first: int = 4000) -> list[bytes]:
    """What a client sends over one connection, from its SYN on."""
    packets, number = [tcp(b"", first, destination=PORT, flags=0x02)], first + 1
    for payload in payloads:
        packets.append(tcp(payload, number, destination=PORT))
        number += len(payload)
    return packets


def read(packets: Sequence[bytes], at_once: bool, ports: Sequence[int] = ()) -> list[bytes]:
    reader = MessageReader(ports)
    pieces = [packets] if at_once else [[packet] for packet in packets]
    found = []
    for piece in pieces:
        for columns in read_packets(io.BytesIO(pcap(list(piece)))):
            messages = reader.read(datagrams(columns))
            whole = messages.octets.tobytes()
            spans = zip(messages.starts.tolist(), messages.sizes.tolist(), strict=True)
            found += [whole[start : start + size] for start, size in spans if size]
    return found


def length(message: bytes) -> bytes:
    return len(message).to_bytes(2, "little")


MESSAGES = [CREATE_CLIENT, WRITE_DATA, HEARTBEAT, ACKNACK]


@pytest.mark.parametrize("at_once", [True, False])
@pytest.mark.parametrize("parts", [1, 2, 3])
def test_a_session_by_tcp_is_read_from_its_first_segment_on(at_once: bool, parts: int) -> None:
    """The length of a message comes with it, in a segment of its own, or in two."""
    payloads: list[bytes] = []
    for message in MESSAGES:
        size = length(message)
        payloads += {1: [size + message], 2: [size, message], 3: [size[:1], size[1:], message]}[parts]
    packets = segments(*payloads)
    assert read(packets, at_once) == read(packets, at_once, [PORT]) == MESSAGES


def test_another_connection_of_short_segments_does_not_matter() -> None:
    """It has the same ports the other way round, or its numbers do not fit."""
    other = [tcp(b"ab", 7, source=5, destination=6), tcp(b"cd", 900, destination=PORT)]
    packets = [*other, *segments(length(CREATE_CLIENT), CREATE_CLIENT, length(HEARTBEAT) + HEARTBEAT)]
    assert read(packets, at_once=False) == [CREATE_CLIENT, HEARTBEAT]
