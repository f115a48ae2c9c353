"""The content of a datagram, as far as rules need it."""

from __future__ import annotations

from tachk.base.records import dataclass
from tachk.xrce.messages import one_message
from tachk.xrce.proxy.rules import ChosenPackets, PacketDirection
from tachk.xrce.submessages import MALFORMED, NOTHING, submessages
from tachk.xrce.wire import FIRST_RELIABLE_STREAM, SubmessageKind


@dataclass(frozen=True, slots=True)
class Said:
    """A submessage. ``number``: as in `ChosenPackets`; None where there is none."""

    kind: SubmessageKind
    number: int | None
    names_missing: bool


def said(octets: bytes) -> tuple[Said, ...]:
    """The submessages of a datagram, in their order. What is none is left out."""
    found = submessages(one_message(octets))
    sayings = []
    for entry in range(len(found.kind)):
        kind, first = int(found.kind[entry]), int(found.first[entry])
        if kind == MALFORMED:
            continue
        reliable = int(found.stream[entry]) >= FIRST_RELIABLE_STREAM
        number = first if first != NOTHING else int(found.sequence[entry]) if reliable else None
        sayings.append(Said(SubmessageKind(kind), number, int(found.bitmap[entry]) > 0))
    return tuple(sayings)


def are_among(sayings: tuple[Said, ...], way: PacketDirection, port: int, packets: ChosenPackets) -> bool:
    """True if a packet that says this, goes this way and belongs to the client of this port is one of them."""
    if packets.way not in (None, way) or packets.port not in (None, port):
        return False
    if packets.kind is None:
        return True
    return any(
        one.kind is packets.kind
        and (packets.number is None or packets.number == one.number)
        and (one.names_missing or not packets.names_missing)
        for one in sayings
    )
