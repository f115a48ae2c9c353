"""Datagrams for the tests of the relay."""

from __future__ import annotations

import struct

CREATE_CLIENT = bytes.fromhex("8000000000011000585243450100010FCCCCDDDD8100FC01")


def write_data(number: int) -> bytes:
    return struct.pack("<BBH", 0x81, 0x80, number) + bytes.fromhex("070108000011001503000000")


def data(number: int) -> bytes:
    return struct.pack("<BBH", 0x81, 0x80, number) + bytes.fromhex("0901080000 0E001600000000".replace(" ", ""))


def acknack(first: int, bitmap: int = 0) -> bytes:
    return bytes.fromhex("810000000A010500") + struct.pack("<H", first) + struct.pack(">H", bitmap) + b"\x80"


def heartbeat(first: int, last: int) -> bytes:
    return bytes.fromhex("810000000B010500") + struct.pack("<HH", first, last) + b"\x80"
