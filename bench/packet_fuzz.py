"""Random and mutated messages: each becomes events, told as text and as JSON, and nothing raises.

    python bench/packet_fuzz.py [MESSAGES] [SEED] [CAPTURE...]

MESSAGES (10^6) are spread evenly over UDP, TCP and serial lines. Mutated are those of the CAPTUREs, and some that are
written here.
"""

from __future__ import annotations

import random
import struct
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from io import BytesIO
from itertools import pairwise
from pathlib import Path

from tachk.xrce.capture_decoder import CaptureDecoder
from tachk.xrce.events import SubmessageEvent, decode, decode_serial
from tachk.xrce.report.json import event_to_json
from tachk.xrce.report.text import event_to_text
from tachk.xrce.serial_framing import crc16
from tachk.xrce.signals.following import SignalTracker

MESSAGES = [
    "8000000000011000585243450100010FCCCCDDDD8100FC01",
    "8100000004010B000000585243450100010F00",
    "818001000801100000 0E001680000001FFFF000000000000",
    "81800400070108000011001503000000",
    "8180040009010800000E001600000000",
    "810000000B01050004000400 80",
    "810000000A0105000400000180",
    "8180000001011400000A001101010000050000006162636400000000",
    "81800500 0D030600 010203040506",
    "81000000 0E010800 0000000000000000",
    "81000000 0F011800 000000000000000000000000000000000000000000000000",
    "81800600 02010800 000AFFFD02000000",
    "81800700 03010400 000AFFFE",
    "81800800 05010600 000A00110000",
    "81800900 06010800 000A001100000000",
    "81000000 0C010000",
]
PIECE = 5000


def mutated(pool: list[bytes], rnd: random.Random) -> bytes:
    if rnd.random() < 0.2:
        return rnd.randbytes(rnd.randrange(40))
    message = bytearray(rnd.choice(pool))
    for _ in range(rnd.randrange(4)):
        kind = rnd.random()
        place = rnd.randrange(len(message) + 1)
        if kind < 0.5 and message:
            message[place % len(message)] = rnd.randrange(256)
        elif kind < 0.7:
            del message[place:]
        elif kind < 0.85:
            message += rnd.randbytes(rnd.randrange(8))
        else:
            message[place:place] = rnd.choice(pool)[: rnd.randrange(30)]
    return bytes(message)


def pcap(packets: Iterable[bytes]) -> bytes:
    records = (
        struct.pack("<IIII", 1000 + n // 100, n % 100 * 10_000_000, len(packet), len(packet)) + packet
        for n, packet in enumerate(packets)
    )
    return struct.pack("<IHHiIII", 0xA1B23C4D, 2, 4, 0, 0, 65535, 101) + b"".join(records)


def ip(protocol: int, payload: bytes) -> bytes:
    host = b"\x7f\0\0\1"
    return struct.pack(">BBHHHBBH4s4s", 0x45, 0, 20 + len(payload), 0, 0, 64, protocol, 0, host, host) + payload


def ends(rnd: random.Random) -> bytes:
    client = rnd.randrange(40000, 40004)
    return struct.pack(">HH", *((client, 8888) if rnd.random() < 0.5 else (8888, client)))


def by_udp(messages: list[bytes], rnd: random.Random) -> bytes:
    return pcap(ip(17, ends(rnd) + struct.pack(">HH", 8 + len(one), 0) + one) for one in messages)


def by_tcp(messages: list[bytes], rnd: random.Random) -> bytes:
    """Connections of 20 messages, cut into segments that come in disorder; some are damaged, some do not come."""
    segments: list[bytes] = []
    for begin in range(0, len(messages), 20):
        stream = b"".join(struct.pack("<H", len(one)) + one for one in messages[begin : begin + 20])
        segments += connection(stream, 40000 + begin // 20, rnd)
    return pcap(segments)


def connection(stream: bytes, port: int, rnd: random.Random) -> list[bytes]:
    cuts = sorted({0, len(stream), *(rnd.randrange(len(stream) + 1) for _ in range(20))})
    segments = [
        ip(6, struct.pack(">HHIIBBHHH", port, 8888, a, 0, 5 << 4, 0x18, 1024, 0, 0) + damaged(stream[a:b], rnd, 0.02))
        for a, b in pairwise(cuts)
        if rnd.random() > 0.01
    ]
    for place in range(len(segments) - 1):
        if rnd.random() < 0.05:
            segments[place], segments[place + 1] = segments[place + 1], segments[place]
    return segments


def by_serial(messages: list[bytes], rnd: random.Random) -> bytes:
    line = bytearray()
    for one in messages:
        plain = bytes(rnd.choice([(1, 0), (0, 1)])) + struct.pack("<H", len(one)) + one + struct.pack("<H", crc16(one))
        frame = b"\x7e" + plain.replace(b"\x7d", b"\x7d\x5d").replace(b"\x7e", b"\x7d\x5e")
        line += damaged(frame, rnd)
    return bytes(line)


def damaged(octets: bytes, rnd: random.Random, how_often: float = 0.1) -> bytes:
    if not octets or rnd.random() > how_often:
        return octets
    place = rnd.randrange(len(octets))
    return octets[:place] + bytes([rnd.randrange(256)]) * rnd.randrange(3) + octets[place + 1 :]


def told(events: Iterator[SubmessageEvent]) -> Counter[str]:
    found: Counter[str] = Counter()
    for event in events:
        event_to_text(event, 0)
        event_to_json(event)
        found["malformed" if event.kind is None else event.kind.name] += 1
    return found


def main(count: int, seed: int, captures: list[Path]) -> None:
    rnd = random.Random(seed)
    pool = [bytes.fromhex(message) for message in MESSAGES]
    for capture in captures:
        with capture.open("rb") as stream:
            for found in CaptureDecoder(stream, (8888, 9001, 9002, 9003)).pieces():
                starts, sizes = found.messages.starts.tolist(), found.messages.sizes.tolist()
                octets = found.messages.octets.tobytes()
                pool += {octets[start : start + size] for start, size in zip(starts, sizes, strict=True)}
    begin, sent = time.process_time(), 0
    for carried, framing in (("UDP", by_udp), ("TCP", by_tcp), ("serial", by_serial)):
        total: Counter[str] = Counter()
        for _ in range(-(-count // 3 // PIECE)):
            capture = framing([mutated(pool, rnd) for _ in range(PIECE)], rnd)
            total += told(decode_serial(BytesIO(capture)) if carried == "serial" else decode(BytesIO(capture)))
            if carried != "serial":
                tracker = SignalTracker()
                for found in CaptureDecoder(BytesIO(capture), (8888,)).pieces():
                    tracker.push(found)
                    tracker.take()
            sent += PIECE
        print(carried, dict(total.most_common()))
    print(f"{sent} messages, nothing raised, {time.process_time() - begin:.0f} s CPU")


if __name__ == "__main__":
    given = sys.argv[1:]
    main(int(given[0]) if given else 1_000_000, int(given[1]) if given[1:] else 1, [Path(one) for one in given[2:]])
