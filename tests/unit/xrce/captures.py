"""Captures made in the tests, and where recorded ones are."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from tachk.xrce.serial_framing import crc16

RECORDED = Path(__file__).resolve().parents[4] / "shared" / "captures"
"""Captures of real clients and Agents, beside a working copy of the developers; they are not part of the project."""

needs_recorded = pytest.mark.skipif(not RECORDED.is_dir(), reason="the recorded captures are not beside the project")

HEARTBEAT = bytes.fromhex("810000000B0105000400040080")
ACKNACK = bytes.fromhex("810000000A0105000400000180")
WRITE_DATA = bytes.fromhex("81800400070108000011001503000000")
CREATE_CLIENT = bytes.fromhex("8000000000011000585243450100010FCCCCDDDD8100FC01")


def udp(payload: bytes, source: int = 40000, destination: int = 8888) -> bytes:
    """A UDP datagram over IPv4, from one port of this machine to another."""
    header = struct.pack(">HHHH", source, destination, 8 + len(payload), 0)
    return ipv4(17, header + payload)


def tcp(payload: bytes, number: int, source: int = 40000, destination: int = 8888, flags: int = 0x18) -> bytes:
    header = struct.pack(">HHIIBBHHH", source, destination, number, 0, 5 << 4, flags, 1024, 0, 0)
    return ipv4(6, header + payload)


def ipv4(protocol: int, payload: bytes, fragment: int = 0) -> bytes:
    size = 20 + len(payload)
    header = struct.pack(">BBHHHBBH4s4s", 0x45, 0, size, 0, fragment, 64, protocol, 0, b"\x7f\0\0\1", b"\x7f\0\0\1")
    return header + payload


def ipv6(protocol: int, payload: bytes) -> bytes:
    here = bytes(15) + b"\1"
    return struct.pack(">IHBB16s16s", 6 << 28, len(payload), protocol, 64, here, here) + payload


def ethernet(packet: bytes, kind: int = 0x0800, tags: bytes = b"") -> bytes:
    return bytes(12) + tags + struct.pack(">H", kind) + packet


def pcap(packets: list[bytes], link: int = 101, order: str = "<", nanoseconds: bool = True, cut: int = 65535) -> bytes:
    """A pcap file; packet n is captured n milliseconds after second 1000."""
    magic = 0xA1B23C4D if nanoseconds else 0xA1B2C3D4
    unit = 1 if nanoseconds else 1000
    records = [
        struct.pack(order + "IIII", 1000, n * 1_000_000 // unit, min(len(packet), cut), len(packet)) + packet[:cut]
        for n, packet in enumerate(packets)
    ]
    return struct.pack(order + "IHHiIII", magic, 2, 4, 0, 0, cut, link) + b"".join(records)


def timed(packets: list[tuple[float, bytes]]) -> bytes:
    """A pcap file of packets that are captured so many milliseconds after second 1000."""
    whole = pcap([packet for _, packet in packets])
    header, at = bytearray(whole), 24
    for milliseconds, packet in packets:
        nanoseconds = round(1_000_000 * milliseconds)
        struct.pack_into("<II", header, at, 1000 + nanoseconds // 10**9, nanoseconds % 10**9)
        at += 16 + len(packet)
    return bytes(header)


def pcapng(packets: list[bytes], link: int = 101, order: str = "<", resolution: bytes = b"\x09") -> bytes:
    """A pcapng file with the same times, in units of the resolution as if_tsresol has it."""
    option = struct.pack(order + "HH", 9, 1) + resolution + bytes(3) + bytes(4)
    per_second = 2 ** (resolution[0] & 127) if resolution[0] & 128 else 10 ** resolution[0]
    blocks = [
        block(0x0A0D0D0A, struct.pack(order + "IHHq", 0x1A2B3C4D, 1, 0, -1), order),
        block(1, struct.pack(order + "HHI", link, 0, 0) + option, order),
    ]
    for n, packet in enumerate(packets):
        ticks = 1000 * per_second + n * per_second // 1000
        header = struct.pack(order + "IIIII", 0, ticks >> 32, ticks & 0xFFFFFFFF, len(packet), len(packet))
        blocks.append(block(6, header + packet + bytes(-len(packet) % 4), order))
    return b"".join(blocks)


def framed(sender: int, receiver: int, message: bytes) -> bytes:
    """A frame of a serial line."""
    plain = bytes((sender, receiver)) + struct.pack("<H", len(message)) + message + struct.pack("<H", crc16(message))
    return b"\x7e" + plain.replace(b"\x7d", b"\x7d\x5d").replace(b"\x7e", b"\x7d\x5e")


def block(kind: int, body: bytes, order: str = "<") -> bytes:
    size = struct.pack(order + "I", 12 + len(body))
    return struct.pack(order + "I", kind) + size + body + size
