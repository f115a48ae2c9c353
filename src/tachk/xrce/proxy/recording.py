"""The traffic on both sides of a relay as a capture: pcap with nanoseconds, UDP and IPv4 in Ethernet frames."""

from __future__ import annotations

import heapq
import struct
from ipaddress import IPv4Address
from typing import BinaryIO, Final

from tachk.xrce.messages import Endpoint

_ETHERNET: Final = 1
_HEADER: Final = struct.pack("<IHHiIII", 0xA1B23C4D, 2, 4, 0, 0, 65535, _ETHERNET)
_FRAME: Final = bytes(12) + b"\x08\x00"
_UDP: Final = 17
_LARGEST_DATAGRAM: Final = 65507


class CaptureWriter:
    """Writes a capture as packets come. Checksums of UDP are left out, as IPv4 allows."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._identification = 0
        file.write(_HEADER)

    def packet(self, time: int, source: Endpoint, destination: Endpoint, octets: bytes) -> None:
        """A datagram of at most 65,507 bytes that passed at this time, in nanoseconds since the epoch."""
        assert len(octets) <= _LARGEST_DATAGRAM
        self._identification = (self._identification + 1) % 65536
        udp = struct.pack(">HHHH", source.port, destination.port, 8 + len(octets), 0) + octets
        frame = _FRAME + self._network_header(source, destination, len(udp)) + udp
        seconds, nanoseconds = divmod(time, 1_000_000_000)
        self._file.write(struct.pack("<IIII", seconds, nanoseconds, len(frame), len(frame)) + frame)

    def _network_header(self, source: Endpoint, destination: Endpoint, size: int) -> bytes:
        hosts = IPv4Address(source.host).packed + IPv4Address(destination.host).packed
        header = struct.pack(">BBHHHBBH", 0x45, 0, 20 + size, self._identification, 0x4000, 64, _UDP, 0) + hosts
        total = sum(struct.unpack(">10H", header))
        total = (total & 0xFFFF) + (total >> 16)
        total = (total & 0xFFFF) + (total >> 16)
        return header[:10] + struct.pack(">H", total ^ 0xFFFF) + header[12:]

    def flush(self) -> None:
        """Flushes the file, so that its readers see all packets."""
        self._file.flush()


class Sorted:
    """Packets in the order of their times; some are reported later than others that passed behind them."""

    def __init__(self, recording: CaptureWriter) -> None:
        self._recording = recording
        self._waiting: list[tuple[int, int, Endpoint, Endpoint, bytes]] = []
        self._packets = 0

    def packet(self, time: int, source: Endpoint, destination: Endpoint, octets: bytes) -> None:
        """As `CaptureWriter.packet`. Packets of one time stay in the order of these calls."""
        heapq.heappush(self._waiting, (time, self._packets, source, destination, octets))
        self._packets += 1

    def write(self, before: int | None) -> None:
        """Writes what passed before a time, of which all is known now, so that readers of the file see it; or all."""
        while self._waiting and (before is None or self._waiting[0][0] < before):
            time, _, source, destination, octets = heapq.heappop(self._waiting)
            self._recording.packet(time, source, destination, octets)
        self._recording.flush()
