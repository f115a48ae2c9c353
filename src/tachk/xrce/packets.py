"""Packets of capture files: pcap, and pcapng (draft-ietf-opsawg-pcap and -pcapng), from a file or a pipe.

The file is read in pieces, and what a piece completes is given at once, as columns: a live capture can be followed, and
a large one is never in memory as a whole.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import Any, BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from tachk.base.records import dataclass

Octets = NDArray[np.uint8]
Numbers = NDArray[np.int64]
Column = NDArray[Any]
"""Numbers, often in fewer bytes, or truth values."""


class CaptureError(Exception):
    """A file that is not a capture, or one of a kind that is not read. The message says which."""


@dataclass(frozen=True, slots=True)
class Packets:
    """Packets that follow one another in a capture; one entry for each in every column but ``octets``.

    Attributes:
        octets: the bytes that hold them all.
        starts, sizes: where each begins in ``octets``, and how many bytes were captured.
        missing: how many bytes of each were not captured.
        times: nanoseconds since the epoch.
        links: the link type, as the registry of pcap numbers it.
        first: the number of the first of them in the capture, from 1.
    """

    octets: Octets
    starts: Numbers
    sizes: Numbers
    missing: Numbers
    times: Numbers
    links: Numbers
    first: int


_PIECE: Final = 1 << 22
_LARGEST_BLOCK: Final = 1 << 28

_PCAP: Final = {
    b"\xd4\xc3\xb2\xa1": ("<", 1000),
    b"\xa1\xb2\xc3\xd4": (">", 1000),
    b"\x4d\x3c\xb2\xa1": ("<", 1),
    b"\xa1\xb2\x3c\x4d": (">", 1),
}
"""From the first bytes to the byte order, and the nanoseconds of a unit of time."""

PCAP_HEADER: Final = 24

USER_LINKS: Final = range(147, 163)
"""Link types that everybody may give a meaning of their own (LINKTYPE_USER0 to LINKTYPE_USER15)."""

_SECTION: Final = b"\x0a\x0d\x0d\x0a"


def is_capture(begin: bytes) -> bool:
    """True if a file that begins with these bytes is a capture."""
    return begin[:4] in _PCAP or begin[:4] == _SECTION


def link_of_pcap(begin: bytes) -> int | None:
    """The link type of the pcap capture whose header these bytes are; None for another file."""
    if begin[:4] not in _PCAP or len(begin) < PCAP_HEADER:
        return None
    order, _ = _PCAP[begin[:4]]
    (link,) = struct.unpack_from(order + "I", begin, 20)
    return int(link) & 0xFFFF  # above are flags about checksums


def read_packets(stream: BinaryIO) -> Iterator[Packets]:
    """The packets of a capture in pieces.

    Where reading gives None, as a pipe does that need not be waited for, the piece has no packets.

    Raises CaptureError: before the first piece if the file is not a capture, later where it ends inside a packet or is
    damaged; what came before has been given by then.
    """
    pending = _Pending(stream)
    if not pending.reaches(4):
        raise CaptureError("the file is empty" if not pending.octets else "the file is too short for a capture")
    begin = bytes(pending.octets[:4])
    if begin in _PCAP:
        yield from _pcap(pending, *_PCAP[begin])
    elif begin == _SECTION:
        yield from _pcapng(pending)
    else:
        raise CaptureError("the file is neither a pcap nor a pcapng capture")


class _Pending:
    """The bytes read of a stream and not yet used."""

    def __init__(self, stream: BinaryIO) -> None:
        # A pipe gives what is there, whereas a file gives as much as is requested.
        self._read = stream.read1 if hasattr(stream, "read1") else stream.read
        self.octets = bytearray()

    def more(self) -> bool | None:
        """True if more has come, False at the end; None if there is nothing yet."""
        read = self._read(_PIECE)
        if read is None:
            return None
        self.octets += read
        return bool(read)

    def reaches(self, size: int) -> bool:
        while len(self.octets) < size:
            if self.more() is False:
                return False
        return True

    def take(self, size: int) -> bytearray:
        taken = self.octets[:size]
        self.octets = self.octets[size:]
        return taken


class _Gathered:
    """The rows of the next piece."""

    def __init__(self) -> None:
        self.rows: list[tuple[int, int, int, int, int]] = []
        self.given = 0

    def packets(self, octets: bytearray) -> Packets:
        starts, sizes, missing, times, links = np.array(self.rows, np.int64).reshape(-1, 5).T
        first, self.given, self.rows = self.given + 1, self.given + len(self.rows), []
        return Packets(np.frombuffer(octets, np.uint8), starts, sizes, missing, times, links, first)


def _pcap(pending: _Pending, order: str, unit: int) -> Iterator[Packets]:
    if not pending.reaches(PCAP_HEADER):
        raise CaptureError("the file ends inside its header")
    link = link_of_pcap(bytes(pending.take(PCAP_HEADER)))
    assert link is not None
    size_of = struct.Struct(order + "I").unpack_from
    given = 0
    ended = False
    while not ended:
        more = pending.more()
        ended = more is False
        octets, at = pending.octets, 0
        begins: list[int] = []
        last = len(octets) - 16
        while at <= last:
            (size,) = size_of(octets, at + 8)
            if size > _LARGEST_BLOCK:
                raise CaptureError(f"packet {given + len(begins) + 1} claims to have {size} bytes")
            behind = at + 16 + size
            if behind > last + 16:
                break
            begins.append(at)
            at = behind
        if begins or more is None:
            yield _pcap_packets(pending.take(at), np.array(begins, np.int64), order, unit, link, given + 1)
            given += len(begins)
    if pending.octets:
        raise CaptureError(f"the file ends inside packet {given + 1}")


def _pcap_packets(octets: bytearray, begins: Numbers, order: str, unit: int, link: int, first: int) -> Packets:
    """The packets whose headers begin at these places."""
    held = np.frombuffer(octets, np.uint8)
    headers = held[begins[:, None] + np.arange(16)].view(order + "u4").astype(np.int64)
    seconds, fraction, size, original = headers.T
    times = seconds * 1_000_000_000 + fraction * unit
    missing = np.maximum(original - size, 0)
    return Packets(held, begins + 16, size, missing, times, np.full(len(begins), link, np.int64), first)


@dataclass(frozen=True, slots=True)
class _Interface:
    """``per_second``: how many units of time make a second; ``offset``: nanoseconds to add."""

    link: int
    per_second: int = 1_000_000
    offset: int = 0


_INTERFACE, _OLD_PACKET, _SIMPLE_PACKET, _PACKET = 1, 2, 3, 6
_RESOLUTION, _OFFSET = 9, 14
_BODY: Final = 8


def _pcapng(pending: _Pending) -> Iterator[Packets]:
    order = "<"
    interfaces: list[_Interface] = []
    gathered = _Gathered()
    ended = False
    while not ended:
        more = pending.more()
        ended = more is False
        octets, at = pending.octets, 0
        while at + 12 <= len(octets):
            if octets[at : at + 4] == _SECTION:
                order = _order_of(octets[at + 8 : at + 12])
                interfaces = []
            kind, size = struct.unpack_from(order + "II", octets, at)
            if size < 12 or size % 4 or size > _LARGEST_BLOCK:
                raise CaptureError(f"a block behind packet {gathered.given + len(gathered.rows)} has a wrong length")
            if at + size > len(octets):
                break
            if kind == _INTERFACE:
                interfaces.append(_interface(order, memoryview(octets)[at + _BODY : at + size - 4]))
            elif kind in (_PACKET, _OLD_PACKET, _SIMPLE_PACKET):
                gathered.rows.append(_block(order, kind, interfaces, octets, at, size))
            at += size
        taken = pending.take(at)
        if gathered.rows or more is None:
            yield gathered.packets(taken)
    if pending.octets:
        raise CaptureError(f"the file ends inside a block behind packet {gathered.given}")


def _order_of(magic: bytearray) -> str:
    if magic == b"\x4d\x3c\x2b\x1a":
        return "<"
    if magic == b"\x1a\x2b\x3c\x4d":
        return ">"
    raise CaptureError("a section of the pcapng file has no byte order")


def _interface(order: str, body: memoryview) -> _Interface:
    if len(body) < 8:
        raise CaptureError("the description of an interface in the pcapng file is too short")
    (link,) = struct.unpack_from(order + "H", body)
    per_second, offset, at = 1_000_000, 0, 8
    while at + 4 <= len(body):
        code, size = struct.unpack_from(order + "HH", body, at)
        value = body[at + 4 : at + 4 + size]
        if code == _RESOLUTION and size == 1:
            per_second = 1 << (value[0] & 0x7F) if value[0] & 0x80 else 10 ** value[0]
        elif code == _OFFSET and size == 8:
            (seconds,) = struct.unpack(order + "q", value)
            offset = seconds * 1_000_000_000
        at += 4 + size + -size % 4
    return _Interface(link, per_second, offset)


def _block(
    order: str, kind: int, interfaces: list[_Interface], octets: bytearray, at: int, size: int
) -> tuple[int, int, int, int, int]:
    """The row of a packet: where it begins, bytes, bytes that are missing, time, link type."""
    number, ticks = 0, None
    if kind == _SIMPLE_PACKET:
        header = 4
        (original,) = struct.unpack_from(order + "I", octets, at + _BODY)
        captured = min(original, size - 16)
    elif size < 32:
        raise CaptureError("a packet of the pcapng file is too short")
    else:
        header = 20
        number, high, low, captured, original = struct.unpack_from(order + "IIIII", octets, at + _BODY)
        number = number & 0xFFFF if kind == _OLD_PACKET and order == "<" else number
        number = number >> 16 if kind == _OLD_PACKET and order == ">" else number
        ticks = high << 32 | low
    if number >= len(interfaces) or captured > size - 12 - header:
        raise CaptureError("a packet of the pcapng file is damaged, or its interface is not described")
    interface = interfaces[number]
    time = 0 if ticks is None else ticks * 1_000_000_000 // interface.per_second + interface.offset
    return at + _BODY + header, captured, max(original - captured, 0), time, interface.link
