"""Repair of damaged frames in which a single byte was damaged and only one repair fits.

A receiver drops the frame; only who asks what was sent needs this. The CRC is linear: the difference between the CRC
that a frame states and that of its message is the CRC of the damage alone. CRC-16/ARC distinguishes all bursts of up to
16 bits at one place, so for each place in the message at most one other byte fits, and for most places none.
"""

from __future__ import annotations

from typing import Final

from tachk.xrce.events import events
from tachk.xrce.messages import Endpoint, one_message
from tachk.xrce.serial_framing import SerialFrame, crc16
from tachk.xrce.submessages import submessages
from tachk.xrce.wire import SubmessageKind

_WITHOUT_STREAM: Final = (SubmessageKind.ACKNACK, SubmessageKind.HEARTBEAT)
_ANYWHERE: Final = (
    SubmessageKind.CREATE_CLIENT,
    SubmessageKind.STATUS_AGENT,
    SubmessageKind.GET_INFO,
    SubmessageKind.INFO,
    SubmessageKind.DELETE,
    SubmessageKind.STATUS,
    SubmessageKind.TIMESTAMP,
    SubmessageKind.TIMESTAMP_REPLY,
)
_NO_ENDPOINT: Final = Endpoint("", 0)


def repaired(frame: SerialFrame) -> bytes | None:
    """The message that was sent; None if that is not known for sure."""
    if frame.crc is None:
        return None
    found = [message for message in _candidates(frame.message, frame.crc) if _is_message(message)]
    return found[0] if len(found) == 1 else None


def _candidates(message: bytes, stated: int) -> list[bytes]:
    """The messages with which the frame differs from what came in one byte of the message or of the CRC."""
    damage = crc16(message) ^ stated
    found = [message] if damage & 0xFF == 0 or damage >> 8 == 0 else []
    for place in range(len(message)):
        behind = bytes(len(message) - place - 1)
        alone = [crc16(bytes([1 << bit]) + behind) for bit in range(8)]
        byte = next((byte for byte in range(1, 256) if _sum(alone, byte) == damage), 0)
        if byte:
            found.append(message[:place] + bytes([message[place] ^ byte]) + message[place + 1 :])
    return found


def _sum(alone: list[int], byte: int) -> int:
    """The CRC of damage to several bits, from those of each bit alone."""
    crc = 0
    for bit in range(8):
        if byte >> bit & 1:
            crc ^= alone[bit]
    return crc


def _is_message(octets: bytes) -> bool:
    """True if these bytes are a message, and in a stream of the kind that DDS-XRCE has for its content."""
    found = list(events(submessages(one_message(octets)), [_NO_ENDPOINT]))
    return bool(found) and all(
        not event.problem and (event.stream == 0 if event.kind in _WITHOUT_STREAM else event.stream != 0)
        for event in found
        if event.kind not in _ANYWHERE
    )
