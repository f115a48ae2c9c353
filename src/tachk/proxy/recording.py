"""What a relay saw on both of its sides, as a capture: pcap with nanoseconds, UDP and IPv4 in Ethernet frames."""

from __future__ import annotations

import struct
from ipaddress import IPv4Address
from typing import BinaryIO, Final

from tachk.xrce.messages import Endpoint

_ETHERNET: Final = 1
_HEADER: Final = struct.pack("<IHHiIII", 0xA1B23C4D, 2, 4, 0, 0, 65535, _ETHERNET)
_FRAME: Final = bytes(12) + b"\x08\x00"
_UDP: Final = 17
_LARGEST_DATAGRAM: Final = 65507


class Recording:
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
        """Lets readers of the file see what was written."""
        self._file.flush()
