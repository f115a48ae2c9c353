"""Clients, the places where their packets were captured, and their streams.

Where both sides of a relay are in a capture, a client is seen at two ports. The side on which its CREATE_CLIENT came
first is that of the client. What a client knows is taken from its side, what the Agent knows from the Agent's.
"""

from __future__ import annotations

from collections import deque
from typing import Final

from tachk.base.records import dataclass
from tachk.xrce.signals.changes import ChangeLog
from tachk.xrce.streams import SIGNALS, StreamState

NEVER: Final = 1 << 62

Way = tuple[bool, int]
"""True if the client sends, and the id of the stream."""


class Stream:
    """One direction of a stream, as it is seen at one side of a client.

    Attributes:
        state: what is known of it.
        log: where its changes are noted.
        side: where it is seen.
        way: which stream.
        transfer: between its two ends, if that has been looked for.
        begun: something has been seen of it.
    """

    __slots__ = ("begun", "log", "side", "state", "transfer", "way")

    def __init__(self, side: Side, way: Way) -> None:
        self.state = StreamState()
        self.log = ChangeLog(len(SIGNALS))
        self.side, self.way = side, way
        self.transfer: Transfer | None = None
        self.begun = False


class Side:
    """A client at one port of an Agent, or of a relay.

    Attributes:
        client_endpoint, agent_endpoint: their numbers.
        owner: whose packets they are.
        session: as the client says in the headers of its messages; None before it has said one.
        last_sent: when the client sent something last.
        owing_since: the time since which it owes an answer to a message; None: it owes none. While it is awake it is
            noted only where arrivals are seen.
        owing_packet: the number of the packet to answer.
        asleep: the client has been silent for long, or has owed an answer for long.
        disturbed: something was sent to it while asleep, and it has not answered.
        ended: it has closed its session.
        forgotten: nothing is noted of it any more.
        sleep_log: changes of ``asleep``.
    """

    def __init__(self, client_endpoint: int, agent_endpoint: int, time: int) -> None:
        self.client_endpoint = client_endpoint
        self.agent_endpoint = agent_endpoint
        self.owner = Client("", [self])
        self.session: int | None = None
        self.last_sent = time
        self.owing_since: int | None = None
        self.owing_packet = 0
        self.asleep = self.disturbed = self.ended = self.forgotten = False
        self.sleep_log = ChangeLog(1)
        self.streams: dict[Way, Stream] = {}

    @property
    def sees_arrivals(self) -> bool:
        """True if what is sent to the client is known to arrive here: the other side of the relay was recorded, too."""
        return len(self.owner.sides) > 1 and self is self.owner.own_side

    def due(self, silence: int, patience: int, answer: int) -> int:
        """The time from which it counts as asleep, or as disturbed, if nothing comes before.

        Args:
            silence: the longest silence of a client that is awake.
            patience: the longest time for which it owes an answer.
            answer: the longest time for an answer, if its silence has shown already that it sleeps.
        """
        if self.ended or self.disturbed or (self.asleep and self.owing_since is None):
            return NEVER
        if self.asleep:
            return (self.owing_since or 0) + answer
        silent = self.last_sent + silence
        return silent if self.owing_since is None else min(silent, self.owing_since + patience)

    def woken(self, time: int, row: int) -> None:
        """It has sent something, or is no longer there."""
        self.last_sent, self.owing_since = time, None
        if self.asleep:
            self.asleep = self.disturbed = False
            self.sleep_log.note(row, (0,))

    def stream(self, way: Way) -> Stream:
        """A stream, which begins here if it is not known."""
        found = self.streams.get(way)
        if found is None:
            found = self.streams[way] = Stream(self, way)
        return found


@dataclass(frozen=True, slots=True)
class MessageWait:
    """``number``: of the first message that is not confirmed; it was sent in this row, at this time."""

    number: int
    row: int
    time: int


class Transfer:
    """A stream in one direction between its two ends.

    Attributes:
        reached: the number up to which all has arrived. It stays where the receiver alone begins anew.
        open: something that was sent has not arrived.
        unconfirmed: something that was sent has not arrived as far as its sender knows.
        lost: something that was sent has not come to the other end, and that end has not named it as missing.
        unheard: something that was sent has not come to the other end, and the sender does not know that it is missing.
        waiting: where and when what is not confirmed was sent; each for the messages before a number.
    """

    __slots__ = ("lost", "open", "reached", "receiver", "sender", "to_agent", "unconfirmed", "unheard", "waiting")

    def __init__(self, sender: StreamState, receiver: StreamState, to_agent: bool) -> None:
        self.sender, self.receiver, self.to_agent = sender, receiver, to_agent
        self.reached = 0
        self.open = self.unconfirmed = self.lost = self.unheard = False
        self.waiting: deque[tuple[int, MessageWait]] = deque()

    def restart(self) -> None:
        """The sender begins anew."""
        self.reached = 0
        self.waiting.clear()

    def confirmed(self, row: int, time: int) -> MessageWait | None:
        """Notes when messages were sent. Returns the longest wait that has ended now."""
        sent, arrived = self.sender.sent, self.sender.arrived
        longest = None
        if sent <= arrived and not self.waiting:
            return None
        while self.waiting and self.waiting[0][1].number < arrived:
            wait = self.waiting[0][1]
            longest = longest or wait
            if self.waiting[0][0] > arrived:
                self.waiting[0] = (self.waiting[0][0], MessageWait(arrived, wait.row, wait.time))
                break
            self.waiting.popleft()
        known = max(self.waiting[-1][0] if self.waiting else 0, arrived)
        if sent > known:
            self.waiting.append((sent, MessageWait(known, row, time)))
        return longest

    def update(self) -> None:
        """Looks again whether something is open, unconfirmed or lost."""
        receiver, sender, reached = self.receiver, self.sender, self.reached
        sent = sender.sent
        if receiver.arrived > reached:
            reached = self.reached = receiver.arrived
        self.open = reached < sent
        self.unconfirmed = sender.arrived < sent
        if reached < sent:
            self.lost = receiver.lacks(reached, sent)
            self.unheard = receiver.lacks_unheard(reached, sent, sender)
        else:
            self.lost = self.unheard = False


class Client:
    """Attributes:
    key: as its CREATE_CLIENT says; empty if that is not in the capture.
    sides: where it is seen, its own side first.
    transfers: by stream and direction.
    pieces: of a submessage that comes in fragments, by stream and direction.
    """

    def __init__(self, key: str, sides: list[Side]) -> None:
        self.key = key
        self.sides = sides
        self.transfers: dict[Way, Transfer] = {}
        self.pieces: dict[Way, bytearray] = {}

    @property
    def own_side(self) -> Side:
        return self.sides[0]

    def is_settled(self, until: int) -> bool:
        """True if it has closed its session, sent nothing since this time, and nothing is on its way."""
        return all(side.ended and side.last_sent < until and not side.asleep for side in self.sides) and not any(
            one.open or one.lost or one.unheard or one.waiting for one in self.transfers.values()
        )

    def is_silent(self, since: int) -> bool:
        """True if it has sent nothing since this time."""
        return all(side.last_sent < since for side in self.sides)

    def transfer(self, stream: Stream) -> Transfer:
        """The other end of a stream."""
        way = stream.way
        if way not in self.transfers:
            near, far = self.sides[0].stream(way).state, self.sides[-1].stream(way).state
            self.transfers[way] = Transfer(near, far, True) if way[0] else Transfer(far, near, False)
        stream.transfer = self.transfers[way]
        return self.transfers[way]

    def forget(self) -> None:
        """Its streams have other ends now."""
        self.transfers = {}
        for side in self.sides:
            for stream in side.streams.values():
                stream.transfer = None
