"""Legs of the way between clients and Agents: what one capture point saw between two endpoints, as columns."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from hashlib import blake2b
from typing import Final

import numpy as np

from tachk.base.records import dataclass
from tachk.xrce.datagrams import Flags
from tachk.xrce.joined_submessages import GrowingColumns
from tachk.xrce.messages import Endpoint
from tachk.xrce.packets import Numbers, Octets
from tachk.xrce.serial_line import NO_ENDPOINT
from tachk.xrce.submessages import NOTHING, Submessages, parsed
from tachk.xrce.wire import SESSION_IDS_NONE, SubmessageKind

DIGEST: Final = 16
"""A digest of a message has so many bytes."""

_FEW: Final = 100_000

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
        digests: of its bytes, two numbers.
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


_COLUMNS: Final = {
    "numbers": np.int64,
    "packets": np.int64,
    "times": np.int64,
    "digests": np.int64,
    "to_agent": np.bool_,
    "dropped": np.bool_,
}


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
        self._columns = GrowingColumns(_COLUMNS)
        self._others: list[Leg] = []

    def add(self, messages: MessageColumns) -> None:
        """Adds its next messages."""
        if not self.first:
            self.first, self.begins = int(messages.packets[0]), bool(messages.to_agent[0])
        self._columns.extend({name: getattr(messages, name).ravel() for name in _COLUMNS})

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
        self._others += others

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

    def columns(self) -> MessageColumns:
        """Its messages, in the order of packets. It has none from then on."""
        whole = self._columns.whole()
        own = MessageColumns(**{**whole, "digests": whole["digests"].reshape(-1, 2)})
        self._columns = GrowingColumns(_COLUMNS)
        if not self._others:
            return own
        pieces = [own, *(leg.columns() for leg in self._others)]
        together = MessageColumns(*(np.concatenate([getattr(each, name) for each in pieces]) for name in _COLUMNS))
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
        there = np.flatnonzero(known)
        not_taken = np.zeros(len(known), np.bool_)
        not_taken[list(dropped)] = True
        columns = MessageColumns(
            numbers[there],
            messages.packets[there],
            messages.times[there],
            digests(messages.octets, messages.starts[there], messages.sizes[there]),
            messages.to_agent[there],
            not_taken[there],
        )
        ends, first, leg_of = np.unique(
            np.stack([messages.clients[there], messages.agents[there]], axis=1),
            axis=0,
            return_index=True,
            return_inverse=True,
        )
        for number in np.argsort(first).tolist():
            client, agent = (endpoints[end] for end in ends[number])
            leg = self._legs.setdefault((client, agent), Leg(client, agent))
            ours = leg_of.reshape(-1) == number
            leg.add(columns.where(ours))
            self._note_session(leg, found, there[ours & columns.to_agent])
        return numbers

    def _note_session(self, leg: Leg, found: Submessages, sent: Numbers) -> None:
        """Notes what messages of the client say of its session."""
        if leg.session is None:
            sessions = np.full(len(found.messages.starts), NOTHING, np.int64)
            sessions[found.message] = found.session
            sessions = sessions[sent]
            said = sessions[(sessions >= 0) & ~np.isin(sessions, SESSION_IDS_NONE)]
            leg.session = int(said[0]) if len(said) else None
        if leg.creation is None:
            created = (found.kind == SubmessageKind.CREATE_CLIENT) & np.isin(found.message, sent)
            for entry in np.flatnonzero(created)[:1].tolist():
                messages, message = found.messages, found.message[entry]
                start, size = int(messages.starts[message]), int(messages.sizes[message])
                octets = messages.octets[start : start + size].tobytes()
                key = parsed(found, entry).key.hex().upper()
                leg.creation = Creation(int(messages.times[message]), octets, key)


def digests(octets: Octets, starts: Numbers, sizes: Numbers) -> Numbers:
    """A digest of each stretch of bytes, as a row of two numbers: rows are equal where stretches are."""
    whole, found = memoryview(octets.data), bytearray()
    for begin in range(0, len(starts), _FEW):
        few = slice(begin, begin + _FEW)
        stretches = zip(starts[few].tolist(), (starts[few] + sizes[few]).tolist(), strict=True)
        found += b"".join([blake2b(whole[start:end], digest_size=DIGEST).digest() for start, end in stretches])
    return np.frombuffer(found, np.int64).reshape(-1, 2)


def with_ends(found: Submessages) -> Flags:
    """For each message of a piece, whether it is known between whom it was sent."""
    messages = found.messages
    known = (messages.clients != NO_ENDPOINT) & (messages.agents != NO_ENDPOINT)
    there = np.zeros(len(known), np.bool_)
    there[found.message] = True
    both: Flags = known & there
    return both
