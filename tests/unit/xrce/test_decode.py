"""From the bytes of a capture to events."""

from __future__ import annotations

import csv
import struct
from collections import Counter
from io import BytesIO
from itertools import pairwise

import pytest

from tachk.xrce.events import SubmessageEvent, decode
from tachk.xrce.packets import CaptureError
from tachk.xrce.wire import SubmessageKind
from tests.unit.xrce.captures import (
    ACKNACK,
    CREATE_CLIENT,
    HEARTBEAT,
    RECORDED,
    WRITE_DATA,
    block,
    ethernet,
    ipv4,
    ipv6,
    needs_recorded,
    pcap,
    pcapng,
    tcp,
    udp,
)


def decoded(capture: bytes, *ports: int) -> list[SubmessageEvent]:
    return list(decode(BytesIO(capture), ports or (8888,)))


def told(capture: bytes) -> list[tuple[int, str]]:
    return [(event.packet, event.problem or event.kind.name) for event in decoded(capture)]


def test_who_says_what_when():
    to, from_ = decoded(pcap([udp(HEARTBEAT), udp(ACKNACK, 8888, 40000)]))
    assert (to.packet, to.time, to.kind, to.to_agent) == (1, 1_000_000_000_000, SubmessageKind.HEARTBEAT, True)
    assert to.fields == {"subject": 0x80, "first": 4, "last": 4}
    assert (from_.time - to.time, from_.to_agent) == (1_000_000, False)
    assert str(from_.client) == "127.0.0.1:40000"
    assert str(from_.agent) == "127.0.0.1:8888"
    assert from_.fields == {"subject": 0x80, "first": 4, "missing": [4]}


def test_the_bitmap_of_an_acknack_has_its_first_byte_for_the_higher_numbers():
    message = bytes.fromhex("810000000A010500FEFF010380")
    (event,) = decoded(pcap([udp(message)]))
    assert event.fields["missing"] == [65534, 65535, 6]


def test_fields_in_the_other_byte_order():
    (event,) = decoded(pcap([udp(bytes.fromhex("810000000B0005000004000980"))]))
    assert event.fields == {"subject": 0x80, "first": 4, "last": 9}


def test_a_session_with_a_key_has_a_longer_header():
    (event,) = decoded(pcap([udp(bytes.fromhex("01800500AABBCCDD") + WRITE_DATA[4:])]))
    assert (event.kind, event.session, event.sequence) == (SubmessageKind.WRITE_DATA, 1, 5)


def test_several_submessages_begin_at_multiples_of_four():
    message = HEARTBEAT + bytes(3) + ACKNACK[4:] + bytes(3) + WRITE_DATA[4:]
    events = decoded(pcap([udp(message)]))
    assert [(event.place, event.kind) for event in events] == [
        (0, SubmessageKind.HEARTBEAT),
        (1, SubmessageKind.ACKNACK),
        (2, SubmessageKind.WRITE_DATA),
    ]


def test_a_write_without_length_takes_the_rest_of_its_message():
    (event,) = decoded(pcap([udp(bytes.fromhex("818004000701000000110015030000000102"))]))
    assert event.fields["sample"] == "030000000102"


def test_a_session_is_created():
    (event,) = decoded(pcap([udp(CREATE_CLIENT)]))
    assert event.fields == {
        "version": "1.0",
        "vendor": "010F",
        "key": "CCCCDDDD",
        "new_session": 0x81,
        "mtu": 508,
        "properties": {},
    }


@pytest.mark.parametrize(
    ("message", "problem"),
    [
        ("", "a message has a header of 4 or 8 bytes, this one has 0 bytes"),
        ("810000", "a message has a header of 4 or 8 bytes, this one has 3 bytes"),
        ("01000000AABB", "the header of a message with a client key has 8 bytes, this one has 6 bytes"),
        ("81000000", "the message is empty"),
        ("810000000B01", "the header of a submessage has 4 bytes, 2 are left"),
        ("8100000063010000", "99 is not a kind of submessage"),
        ("810000000B01050004000400", "HEARTBEAT claims to have 5 bytes, 4 are left"),
        ("810000000B01020004000400", "HEARTBEAT has 2 bytes, at least 5 are needed"),
        ("8000000000011000585243460100010FCCCCDDDD8100FC01", "CREATE_CLIENT is damaged: it does not begin with "),
        ("8180000001010D00000A00110501000004000000" + "41", "CREATE is damaged: it ends too early"),
        (
            "818000000101120000" + "0A00110201000005000000" + "4142434445" + "0001",
            "CREATE is damaged: a text in it is ",
        ),
        ("8180000001010600000A00110901", "CREATE is damaged: an id in it is none of those that exist"),
    ],
)
def test_what_is_no_message_says_why(message, problem):
    events = decoded(pcap([udp(bytes.fromhex(message)), udp(HEARTBEAT)]))
    assert events[0].kind is None
    assert events[0].problem.startswith(problem)
    assert events[-1].kind is SubmessageKind.HEARTBEAT


def test_what_was_not_captured_is_malformed():
    packet = udp(HEARTBEAT)
    assert told(pcap([packet], cut=len(packet) - 2)) == [(1, "2 of 13 bytes of the message were not captured")]


def test_the_first_piece_of_a_fragmented_packet_is_malformed_and_the_others_have_no_port():
    whole = udp(WRITE_DATA)[20:]
    first, second = ipv4(17, whole[:16], 0x2000), ipv4(17, whole[16:], 2)
    assert told(pcap([first, second])) == [(1, "8 of 16 bytes of the message were not captured")]


def test_other_traffic_is_left_out():
    icmp = ipv4(1, bytes(40))
    assert told(pcap([icmp, udp(HEARTBEAT, 53, 53), b"\x45", b"", udp(HEARTBEAT)])) == [(5, "HEARTBEAT")]
    assert [event.packet for event in decoded(pcap([udp(HEARTBEAT), udp(HEARTBEAT, 1, 2019)]), 2019, 2018)] == [2]


@pytest.mark.parametrize("order", "<>")
def test_kinds_of_captures(order):
    packets = [udp(HEARTBEAT), udp(ACKNACK)]
    expected = decoded(pcap(packets))
    assert decoded(pcap(packets, order=order, nanoseconds=False)) == expected
    assert decoded(pcap([ethernet(packet) for packet in packets], 1, order)) == expected
    assert decoded(pcapng(packets, order=order)) == expected
    assert decoded(pcapng(packets, order=order, resolution=b"\x06")) == expected
    milliseconds = [event.time // 1_000_000 for event in decoded(pcapng(packets, order=order, resolution=b"\x9e"))]
    assert milliseconds == [1_000_000, 1_000_000]  # in units of 2 to the power of -30, rounded down


@pytest.mark.parametrize(
    ("link", "frame"),
    [
        (1, lambda packet: ethernet(packet, tags=bytes.fromhex("81000001"))),
        (1, lambda packet: ethernet(packet, tags=bytes.fromhex("88A8000181000002"))),
        (113, lambda packet: bytes(14) + b"\x08\x00" + packet),
        (276, lambda packet: b"\x08\x00" + bytes(18) + packet),
        (0, lambda packet: struct.pack("<I", 2) + packet),
        (108, lambda packet: struct.pack(">I", 2) + packet),
        (228, lambda packet: packet),
    ],
)
def test_link_types(link, frame):
    assert told(pcap([frame(udp(HEARTBEAT))], link)) == [(1, "HEARTBEAT")]


def test_ip_version_6():
    payload = struct.pack(">HHHH", 40000, 8888, 8 + len(HEARTBEAT), 0) + HEARTBEAT
    (event,) = decoded(pcap([ipv6(17, payload)]))
    assert (event.kind, str(event.client)) == (SubmessageKind.HEARTBEAT, "[::1]:40000")


def prefixed(*messages: bytes) -> bytes:
    return b"".join(struct.pack("<H", len(message)) + message for message in messages)


def test_tcp_puts_segments_in_order_and_drops_repeated_bytes():
    stream = prefixed(HEARTBEAT, WRITE_DATA, ACKNACK)
    start = 2**32 - 7  # the numbers go round on the way
    segments = [(0, 9), (20, len(stream)), (5, 22), (0, 9)]
    packets = [tcp(b"", start - 1, flags=2)]
    packets += [tcp(stream[a:b], (start + a) % 2**32) for a, b in segments]
    assert told(pcap(packets)) == [(4, "HEARTBEAT"), (4, "WRITE_DATA"), (4, "ACKNACK")]


def test_tcp_that_was_under_way_when_the_capture_began():
    assert told(pcap([tcp(prefixed(HEARTBEAT), 77), tcp(prefixed(ACKNACK), 92)])) == [(1, "HEARTBEAT"), (2, "ACKNACK")]


def test_what_tcp_lacks_is_malformed():
    stream = prefixed(HEARTBEAT, WRITE_DATA, ACKNACK)
    assert told(pcap([tcp(stream[:9], 0), tcp(b"", 9, flags=4)])) == [
        (2, "6 of 13 bytes of the message were not captured")
    ]
    behind = len(prefixed(HEARTBEAT, WRITE_DATA))
    assert told(pcap([tcp(stream[:15], 0), tcp(stream[behind:], behind)])) == [
        (1, "HEARTBEAT"),
        (2, "18 of 18 bytes of the message were not captured"),
        (2, "ACKNACK"),
    ]
    cut = tcp(stream[:behind], 0)
    assert told(pcap([cut, tcp(stream[behind:], behind)], cut=len(cut) - 4)) == [
        (1, "HEARTBEAT"),
        (1, "4 of 16 bytes of the message were not captured"),
        (2, "ACKNACK"),
    ]


def test_padding_behind_a_short_segment_is_not_data():
    packet = tcp(b"", 100) + bytes(6)
    assert told(pcap([ethernet(packet), ethernet(tcp(prefixed(HEARTBEAT), 100))], 1)) == [(2, "HEARTBEAT")]


def test_a_capture_that_is_cut_gives_what_is_there():
    whole = pcap([udp(HEARTBEAT), udp(ACKNACK)])
    assert told(whole[:-1]) == [(1, "HEARTBEAT"), (2, "the file ends inside packet 2")]
    cut = pcapng([udp(HEARTBEAT), udp(ACKNACK)])[:-1]
    assert told(cut) == [(1, "HEARTBEAT"), (2, "the file ends inside a block behind packet 1")]


@pytest.mark.parametrize(
    ("capture", "problem"),
    [
        (b"", "the file is empty"),
        (b"ab", "the file is too short for a capture"),
        (b"PK\3\4" + bytes(50), "the file is neither a pcap nor a pcapng capture"),
        (pcap([])[:20], "the file ends inside its header"),
        (block(0x0A0D0D0A, bytes(16)), "a section of the pcapng file has no byte order"),
        (pcapng([])[:-4] + block(6, bytes(20)), "a block behind packet 0 has a wrong length"),
    ],
)
def test_what_is_no_capture(capture, problem):
    with pytest.raises(CaptureError, match=problem):
        decoded(capture)


class Pipe(BytesIO):
    """Gives a capture in small pieces, as a pipe does."""

    reads = 0

    def read1(self, size: int | None = -1) -> bytes:
        self.reads += 1
        return self.read(11)


def test_events_come_as_soon_as_their_packets_are_there():
    pipe = Pipe(pcap([udp(HEARTBEAT)] * 20))
    seen = [pipe.reads for _ in decode(pipe, (8888,))]
    assert len(seen) == 20
    assert all(one < other for one, other in pairwise(seen))


@needs_recorded
@pytest.mark.parametrize("log", sorted(RECORDED.glob("*.proxy.csv")), ids=lambda path: path.name.split(".")[0])
def test_recorded_captures_agree_with_the_log_of_the_relay(log):
    expected: Counter[str] = Counter()
    with log.open(newline="") as rows:
        for row in csv.DictReader(rows):
            expected.update(part.split("(")[0].strip() for part in row["decoded"].split(" + "))
    capture = log.with_name(log.name.replace(".proxy.csv", ".pcap"))
    with capture.open("rb") as stream:
        found = Counter(event.kind.name for event in decode(stream, (8888, 9001, 9002, 9003)))
    if log.name.startswith("f3c"):
        expected["WRITE_DATA"] += 210  # which the relay has not logged in its storm
    assert found == expected
