"""Legs of the way between clients and Agents: what one capture point saw between two endpoints, as columns."""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from hashlib import blake2b
from typing import Final

import numpy as np

from tachk.base.records import dataclass
from tachk.xrce.datagrams import Flags
from tachk.xrce.messages import Endpoint
from tachk.xrce.packets import Numbers
from tachk.xrce.serial_line import NO_ENDPOINT
from tachk.xrce.submessages import NOTHING, Submessages, parsed
from tachk.xrce.wire import SESSION_IDS_NONE, SubmessageKind

_DIGEST: Final = 16
"""A digest of a message has so many bytes."""

_LONGEST_RELAY: Final = 5_000_000_000
"""Nanoseconds from a CREATE_CLIENT to its copy behind a relay."""


@dataclass(frozen=True, slots=True)
class Creation:
    """A CREATE_CLIENT: when it was sent, its bytes, and the key of the client."""

    time: int
    octets: bytes
    key: str


@dataclass(frozen=True, slots=True)
class MessageColumns:
    """Messages of a leg; an entry for each in every column.

    Attributes:
        numbers: how many messages with known ends come before it in the capture.
        packets, times: the number of its packet, and nanoseconds since the epoch.
        digests: two numbers that stand for its bytes.
        to_agent: whether the client sent it.
        dropped: whether its receiver did not take it.
    """

    numbers: Numbers
    packets: Numbers
    times: Numbers
    digests: Numbers
    to_agent: Flags
    dropped: Flags

    def where(self, chosen: Numbers | Flags) -> MessageColumns:
        """Those at these places, or where a column of truth values is true."""
        return MessageColumns(
            self.numbers[chosen],
            self.packets[chosen],
            self.times[chosen],
            self.digests[chosen],
            self.to_agent[chosen],
            self.dropped[chosen],
        )


class Leg:
    """The packets that one capture point saw between two endpoints.

    Attributes:
        creation: the first CREATE_CLIENT; None if there is none.
        session: as the client says in the headers of its messages; None if it says none.
        first: the number of the packet of its first message.
        begins: whether the client sent that.
    """

    def __init__(self, client: Endpoint, agent: Endpoint) -> None:
        self.client = client
        self.agent = agent
        self.creation: Creation | None = None
        self.session: int | None = None
        self.first = 0
        self.begins = False
        self._rows = array("q")
        self._digests = bytearray()
        self._others: list[MessageColumns] = []

    def add(self, number: int, packet: int, time: int, to_agent: bool, dropped: bool, octets: bytes) -> None:
        if not self._rows:
            self.first, self.begins = packet, to_agent
        self._rows.extend((number << 2 | to_agent << 1 | dropped, packet, time))
        self._digests += blake2b(octets, digest_size=_DIGEST).digest()

    @property
    def key(self) -> str:
        return "" if self.creation is None else self.creation.key

    def goes_on(self, other: Leg, legs: Sequence[Leg]) -> bool:
        """True if the client of the other leg, whose relay was recorded on both sides, has got this address later: the
        messages have its session, come to the same port of the relay, and it is the only client with it there."""
        here = [leg for leg in legs if leg.agent == self.agent and leg.session == self.session and leg.creation]
        later = self.begins and self.first > other.first
        return later and self.creation is None and self.session is not None and here == [other]

    def take(self, others: Iterable[Leg]) -> None:
        """Has their messages, too."""
        self._others += [columns for leg in others for columns in (leg._own(), *leg._others)]

    def is_before(self, other: Leg) -> bool:
        """True if a relay passes messages of this leg on to the other one."""
        ours, theirs = self.creation, other.creation
        return (
            ours is not None
            and theirs is not None
            and self.agent != other.agent
            and ours.octets == theirs.octets
            and 0 <= theirs.time - ours.time < _LONGEST_RELAY
        )

    def _own(self) -> MessageColumns:
        coded, packets, times = np.frombuffer(self._rows, np.int64).reshape(-1, 3).T
        digests = np.frombuffer(self._digests, np.int64).reshape(-1, 2)
        return MessageColumns(coded >> 2, packets, times, digests, coded & 2 != 0, coded & 1 != 0)

    def columns(self) -> MessageColumns:
        """Its messages, in the order of packets."""
        own = self._own()
        if not self._others:
            return own
        pieces = [own, *self._others]
        together = MessageColumns(
            *(
                np.concatenate([getattr(each, name) for each in pieces])
                for name in ("numbers", "packets", "times", "digests", "to_agent", "dropped")
            )
        )
        return together.where(np.argsort(together.packets, kind="stable"))


class Legs:
    """The legs of a capture, in the order in which they begin.

    Attributes:
        messages: how many messages with known ends there were so far.
    """

    def __init__(self) -> None:
        self.messages = 0
        self._legs: dict[tuple[Endpoint, Endpoint], Leg] = {}

    def all(self) -> list[Leg]:
        return list(self._legs.values())

    def add(self, found: Submessages, endpoints: Sequence[Endpoint], dropped: frozenset[int]) -> Numbers:
        """Adds the messages of a piece. Returns the number of each of them, -1 for those without known ends."""
        messages = found.messages
        known = with_ends(found)
        numbers = np.where(known, np.cumsum(known) - 1 + self.messages, -1)
        self.messages += int(known.sum())
        sessions = np.full(len(known), NOTHING, np.int64)
        sessions[found.message] = found.session
        creations: dict[int, int] = {}
        for entry in np.flatnonzero(found.kind == SubmessageKind.CREATE_CLIENT).tolist():
            creations.setdefault(int(found.message[entry]), entry)
        octets = messages.octets.tobytes()
        pairs: dict[tuple[int, int], Leg] = {}
        rows = zip(
            *(column.tolist() for column in (numbers, messages.clients, messages.agents, messages.packets)),
            *(column.tolist() for column in (messages.times, messages.to_agent, messages.starts, messages.sizes)),
            sessions.tolist(),
            strict=True,
        )
        for place, (number, client, agent, packet, time, to_agent, start, size, session) in enumerate(rows):
            if number < 0:
                continue
            leg = pairs.get((client, agent))
            if leg is None:
                ends = endpoints[client], endpoints[agent]
                leg = pairs[client, agent] = self._legs.setdefault(ends, Leg(*ends))
            content = octets[start : start + size]
            leg.add(number, packet, time, to_agent, place in dropped, content)
            if to_agent and leg.session is None and session >= 0 and session not in SESSION_IDS_NONE:
                leg.session = session
            if to_agent and leg.creation is None and place in creations:
                key = parsed(found, creations[place]).key.hex().upper()
                leg.creation = Creation(time, content, key)
        return numbers


def with_ends(found: Submessages) -> Flags:
    """For each message of a piece, whether it is known between whom it was sent."""
    messages = found.messages
    known = (messages.clients != NO_ENDPOINT) & (messages.agents != NO_ENDPOINT)
    there = np.zeros(len(known), np.bool_)
    there[found.message] = True
    both: Flags = known & there
    return both
