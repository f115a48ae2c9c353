"""Captures of the tests with faults: lost, copied and damaged packets, clocks that go back, other traffic."""

from __future__ import annotations

import struct
from pathlib import Path
from random import Random

CAPTURES = Path(__file__).parents[2] / "data/captures"
_HEADERS = 42
"""Bytes of Ethernet, IPv4 and UDP."""
_SECOND = 1_000_000_000
Packet = tuple[int, bytes]
FAULTS = ("loss", "copy", "swap", "time", "damage", "cut", "foreign", "repeat", "back", "gap", "client")


def faulty_capture(path: Path, random: Random) -> Path:
    """Writes a capture with some of the faults."""
    sources = sorted(CAPTURES.glob("**/*.pcap"))
    head, packets = _packets(random.choice(sources))
    packets = packets[: random.choice((60, 400, 2000))]
    faults = set(random.sample(FAULTS, random.randrange(5)))
    if "client" in faults:
        others = [(time + random.randrange(_SECOND), _other_client(octets)) for time, octets in packets]
        packets = sorted(packets + others)
    found: list[Packet] = []
    often = random.choice((0.005, 0.03, 0.2))
    for time, octets in packets:
        happens = {fault for fault in faults if random.random() < often}
        if "loss" in happens:
            continue
        if "time" in happens:
            time = max(time + random.randrange(-_SECOND // 5, _SECOND // 5), 0)
        if "damage" in happens:
            at = random.randrange(_HEADERS, max(len(octets), _HEADERS + 1))
            damaged = bytes(octet ^ random.choice((1, 128, 255)) for octet in octets[at : at + 1])
            octets = octets[:at] + damaged + octets[at + 1 :]
        if "cut" in happens:
            octets = octets[: random.randrange(20, len(octets) + 1)]
        if "foreign" in happens:
            found.append((time, octets[:_HEADERS] + random.randbytes(len(octets[_HEADERS:]))))
        found.append((time, octets))
        if "copy" in happens:
            found.append((time + random.choice((0, 1, 1000, _SECOND // 100)), octets))
        if "repeat" in happens:
            found.append((time, random.choice(found)[1]))
    if "swap" in faults:
        for number in range(len(found) - 1):
            if random.random() < often:
                found[number : number + 2] = found[number + 1], found[number]
    for fault, seconds in (("back", -1), ("gap", 5)):
        if fault in faults:
            at = random.randrange(len(found) + 1)
            found[at:] = [(time + seconds * _SECOND, octets) for time, octets in found[at:]]
    path.write_bytes(head + b"".join(struct.pack("<IIII", *divmod(t, _SECOND), len(o), len(o)) + o for t, o in found))
    return path


def _packets(path: Path) -> tuple[bytes, list[Packet]]:
    octets = path.read_bytes()
    unit = 1 if octets[:4] == b"\x4d\x3c\xb2\xa1" else 1000
    at, found = 24, list[Packet]()
    while at < len(octets):
        seconds, fraction, size, _ = struct.unpack_from("<IIII", octets, at)
        found.append((seconds * _SECOND + fraction * unit, octets[at + 16 : at + 16 + size]))
        at += 16 + size
    return b"\x4d\x3c\xb2\xa1" + octets[4:24], found


def _other_client(octets: bytes) -> bytes:
    """The same packet to or from another port of the client."""
    ports = (int.from_bytes(octets[at : at + 2], "big") for at in (34, 36))
    changed = b"".join((port ^ 0x155 if port > 30000 else port).to_bytes(2, "big") for port in ports)
    return octets[:34] + changed + octets[38:]
