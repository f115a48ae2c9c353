"""Messages on serial lines: eProsima's framing, after HDLC (ISO/IEC 13239), with a CRC.

A frame is 0x7E, address of the sender, address of the receiver, length, message, CRC. Behind the first byte every 0x7E
and 0x7D is written as 0x7D and the byte with bit 5 inverted. Length and CRC are little-endian, and count or cover the
message as it was before that. The Agent has address 0.
"""

from __future__ import annotations

from typing import Final

from tachk.base.records import dataclass

_BEGIN: Final = 0x7E
_ESCAPE: Final = 0x7D
_INVERTED: Final = 0x20
AGENT_ADDRESS: Final = 0


@dataclass(frozen=True, slots=True)
class SerialFrame:
    """Attributes:
    sender, receiver: addresses; None where the frame ends before.
    message: what it carries, as far as it came.
    problem: why it would be dropped; empty if it would not.
    crc: what it states, if that is not the CRC of the message.
    """

    sender: int | None
    receiver: int | None
    message: bytes
    problem: str = ""
    crc: int | None = None


class FrameReader:
    """Finds the frames in the bytes of one direction of a line, whatever pieces they come in."""

    def __init__(self) -> None:
        self._plain: bytearray | None = None
        """The bytes of the frame so far, without escapes; None between frames."""
        self._escaped = False
        self._between = 0

    def push(self, octets: bytes) -> list[SerialFrame]:
        """The frames that these bytes complete. Bytes between frames are given when the next frame begins."""
        found = []
        for octet in octets:
            if octet == _BEGIN:
                found += self.close()
                self._plain = bytearray()
            elif self._plain is None:
                self._between += 1
            elif octet == _ESCAPE:
                self._escaped = True
            else:
                self._plain.append(octet ^ _INVERTED if self._escaped else octet)
                self._escaped = False
                if len(self._plain) >= 6 and len(self._plain) == 6 + _size(self._plain):
                    found.append(_whole(self._plain))
                    self._plain = None
        return found

    def close(self) -> list[SerialFrame]:
        """The unfinished part: a frame, or bytes that belong to none."""
        found = [_cut(self._plain)] if self._plain else []
        if self._between:
            found.append(SerialFrame(None, None, b"", f"{self._between} bytes belong to no frame"))
        self._plain, self._escaped, self._between = None, False, 0
        return found


def crc16(message: bytes) -> int:
    """CRC-16/ARC: polynomial 0x8005, reflected, from 0."""
    crc = 0
    for octet in message:
        crc = crc >> 8 ^ _TABLE[(crc ^ octet) & 0xFF]
    return crc


def _entry(index: int) -> int:
    for _ in range(8):
        index = index >> 1 ^ 0xA001 if index & 1 else index >> 1
    return index


_TABLE: Final = tuple(map(_entry, range(256)))


def _size(plain: bytearray) -> int:
    return int.from_bytes(plain[2:4], "little")


def _whole(plain: bytearray) -> SerialFrame:
    message = bytes(plain[4:-2])
    stated, found = int.from_bytes(plain[-2:], "little"), crc16(message)
    if stated == found:
        return SerialFrame(plain[0], plain[1], message)
    problem = f"the CRC of a frame is {stated:#06x}, but should be {found:#06x}"
    return SerialFrame(plain[0], plain[1], message, problem, stated)


def _cut(plain: bytearray) -> SerialFrame:
    if len(plain) < 4:
        return SerialFrame(None, None, b"", f"a frame ends after {len(plain)} bytes, inside its header")
    size = _size(plain)
    message = bytes(plain[4 : 4 + size])
    return SerialFrame(plain[0], plain[1], message, f"of a frame with {size} bytes only {len(message)} came")
