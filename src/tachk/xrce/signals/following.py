"""Follows all clients of a capture, message by message."""

from __future__ import annotations

from typing import Final

import numpy as np

from tachk.base.records import dataclass
from tachk.xrce import wire
from tachk.xrce.packets import Numbers
from tachk.xrce.signals.changes import ChangeLog, SignalChanges
from tachk.xrce.signals.clients import NEVER, Client, MessageWait, Side, Stream, Way
from tachk.xrce.signals.samples import SampleExchange, topic_of
from tachk.xrce.streams import Item
from tachk.xrce.submessages import Submessages
from tachk.xrce.wire import SubmessageKind

SILENCE: Final = 2_000_000_000
"""After so many nanoseconds without a message a client counts as asleep: ten heartbeats of the Agent."""

ANSWER: Final = 100_000_000
"""A client that is awake answers messages of a reliable stream, and HEARTBEATs, within so many nanoseconds."""

PATIENCE: Final = 500_000_000
"""A client that leaves what came to it without an answer for so many nanoseconds counts as asleep: five times `ANSWER`,
two heartbeats of the Agent. Only where packets are recorded at the client: elsewhere they may have been lost."""

SITUATION: Final = (
    "allToAgent",
    "allToClient",
    "sleep",
    "arrive",
    "TDDSisSent",
    "FDDSisSent",
    "lost",
    "missing",
    "behind",
    "unheard",
    "waiting",
)
"""The signals of all clients together: every message that clients have sent has arrived at the Agent; every sample that
they have written has arrived at every reader; a client is silent for long; something came to such a client, which has
not answered in time; the Agent has got what clients sent; readers have got it in order; a message of a client is
neither there nor named as missing, or one of the Agent; the Agent has unconfirmed messages; a message of a client is
not there, and its client does not know that; a client has unconfirmed messages."""

GONE: Final = 60_000_000_000
"""A client that has closed its session, and from which nothing has come for so many nanoseconds, does not come back."""

VANISHED: Final = 3_600_000_000_000
"""A client from which nothing has come for so many nanoseconds has vanished: from then on it counts as one that has
closed its session, whatever it owes or is owed."""

_SESSION: Final = 0xFFFE
"""The object id of the client itself."""

_WRITER, _READER = 0x5, 0x6
_ENDS: Final = (_WRITER, _READER)

# Kinds as plain numbers: each message is compared with some of them.
_ACKNACK: Final = int(SubmessageKind.ACKNACK)
_HEARTBEAT: Final = int(SubmessageKind.HEARTBEAT)
_CREATE_CLIENT: Final = int(SubmessageKind.CREATE_CLIENT)
_CREATE: Final = int(SubmessageKind.CREATE)
_DELETE: Final = int(SubmessageKind.DELETE)
_FRAGMENT: Final = int(SubmessageKind.FRAGMENT)
_WRITE_DATA: Final = int(SubmessageKind.WRITE_DATA)
_DATA: Final = int(SubmessageKind.DATA)

_CARRYING: Final = (_WRITE_DATA, _DATA, _CREATE, _DELETE, _FRAGMENT)
_OF_SAMPLES: Final = (*_CARRYING, _ACKNACK, _HEARTBEAT, _CREATE_CLIENT)

_RELIABLE: Final = int(wire.FIRST_RELIABLE_STREAM)


@dataclass(frozen=True, slots=True)
class StreamChanges:
    """``side`` and ``way`` say which stream."""

    side: Side
    way: Way
    changes: SignalChanges


@dataclass(frozen=True, slots=True)
class RowBlock:
    """Rows that follow one another: one for each message, and one where a client begins to count as asleep.

    Attributes:
        times: nanoseconds since the epoch, not decreasing.
        packets: the number of the packet in the capture; 0 in rows without one.
        situation: changes of the `SITUATION`.
        streams: changes of the `SIGNALS` of each stream.
        sleeps: for each side, whether its client is asleep.
    """

    times: Numbers
    packets: Numbers
    situation: SignalChanges
    streams: tuple[StreamChanges, ...]
    sleeps: tuple[tuple[Side, SignalChanges], ...]


@dataclass(frozen=True, slots=True)
class Waited:
    """``sent``, ``confirmed``: rows; ``duration`` in nanoseconds."""

    sent: int
    confirmed: int
    duration: int


class SignalTracker:
    """Takes messages, and gives their signals as `RowBlock`.

    Attributes:
        sides: of all clients, in the order in which they were seen.
        longest: the confirmation for which the Agent has waited longest, and that for which a client has.
        latest: until when everything is known, in nanoseconds since the epoch.
    """

    def __init__(self, silence: int = SILENCE, streams: bool = True) -> None:
        """Args:
        silence: after so many nanoseconds without a message a client counts as asleep.
        streams: whether the changes of streams are noted, too.
        """
        self._silence = silence
        self._notes_streams = streams
        self.sides: list[Side] = []
        self._by_endpoints: dict[tuple[int, int], Side] = {}
        self._clients: dict[str, Client] = {}
        self._exchange = SampleExchange()
        self._situation_log = ChangeLog(len(SITUATION))
        self._times: list[Numbers] = []
        self._packets: list[Numbers] = []
        self._inserted: list[tuple[int, int, int]] = []
        self._rows = 0
        self.latest = 0
        self._time = 0
        self._alarm = NEVER
        self.longest: list[Waited | None] = [None, None]
        self._open = 0
        self._unconfirmed = [0, 0]
        self._lost = [0, 0]
        self._unheard = [0, 0]
        self._complete = self._ordered = self._unaltered = True
        self._changed = True
        self._known: tuple[int, ...] = ()
        self._row = 0
        self._before = 0
        self._base = 0
        self._side = Side(0, 0, 0)

    # ---- messages ----

    def push(self, found: Submessages) -> None:
        """The messages of a piece."""
        messages = found.messages
        if not len(messages.times):
            return
        times = np.maximum(np.maximum.accumulate(messages.times), self.latest)
        self.latest = int(times[-1])
        chosen = np.flatnonzero((found.place == 0) | np.isin(found.kind, _OF_SAMPLES))
        message = found.message[chosen]
        of_message = (times, messages.packets, messages.clients, messages.agents, messages.to_agent)
        of_stream = (found.kind, found.stream, found.sequence, found.first, found.last, found.bitmap, found.subject)
        columns = [message, *(column[message] for column in of_message), *(column[chosen] for column in of_stream)]
        columns += [found.place[chosen], found.session[chosen], chosen]
        octets = messages.octets.tobytes()
        self._base, self._before = self._rows, len(self._inserted)
        for index, time, packet, client, agent, to_agent, kind, stream, sequence, first, last, bitmap, subject, \
                place, session, entry in zip(*(column.tolist() for column in columns), strict=True):  # fmt: skip
            if place == 0:
                self._message(index, time, client, agent, to_agent, session)
                side = self._side
                held = None
                if stream >= _RELIABLE and kind >= 0:
                    held = side.streams.get((to_agent, stream)) or side.stream((to_agent, stream))
                    number = held.state.message(sequence)
                    self._noted(held)
                if not to_agent and side.owing_since is None and (held or kind == _HEARTBEAT):
                    if side.asleep or side.sees_arrivals:
                        side.owing_since, side.owing_packet = time, packet
                        self._alarm = min(self._alarm, self._due(side))
            if kind == _ACKNACK:
                way = not to_agent, subject
                self._acknack(self._side.streams.get(way) or self._side.stream(way), first, bitmap)
            elif kind == _HEARTBEAT:
                receiving_stream = self._side.stream((to_agent, subject))
                receiving_stream.state.heartbeat(first, last)
                self._noted(receiving_stream)
            elif kind == _CREATE_CLIENT:
                begin = int(found.starts[entry])
                self._created(self._side, octets[begin + 8 : begin + 12].hex().upper())
            elif kind == _DELETE and found.object[entry] == _SESSION:
                self._ended(self._side)
            elif held is not None and kind in _CARRYING:
                if held.state.note_item(number, place, _item(found, entry, kind, octets)):
                    self._unaltered, self._changed = False, True
            elif kind == _DATA and held is None and not to_agent and self._side is self._side.owner.own_side:
                self._delivered(self._side.owner, (to_agent, stream), _item(found, entry, kind, octets))
                self._stand()
            if self._changed:
                self._note_situation(self._row)
        self._rows += len(times)
        self._times.append(times)
        self._packets.append(messages.packets)

    def _message(self, index: int, time: int, client: int, agent: int, to_agent: bool, session: int) -> None:
        """The next message begins.

        Args:
            index: its place in the piece.
            session: as in its header.
        """
        row = self._base + index + len(self._inserted) - self._before
        if time >= self._alarm:
            self._rows += self._time_passes(time, row)
            row = self._base + index + len(self._inserted) - self._before
        self._row, self._time = row, time
        known = self._by_endpoints.get((client, agent)) or (
            self._moved_on(client, agent, session) if to_agent else None
        )
        side = self._side = known or self._new_side(client, agent, time)
        if to_agent:
            if _is_session(session):
                side.session = session
            if side.asleep:
                self._woken(side, time)
            else:
                side.last_sent, side.owing_since = time, None

    def wait(self, time: int) -> None:
        """Nothing has come until this time, in nanoseconds since the epoch."""
        if time >= self._alarm:
            self._rows += self._time_passes(time, self._rows)
        self.latest = max(self.latest, time)

    def forget_gone(self) -> None:
        """Keeps nothing of clients that have vanished, nor of those that have closed their session, are long silent,
        and owe and are owed nothing.

        A reader of a capture without an end calls this now and then. The rows stay what they are, unless a client has
        vanished: there is a row then in which it is no longer there.
        """
        gone = [owner for owner in self._owners() if owner.is_settled(self.latest - GONE)]
        vanished = [owner for owner in self._owners() if owner.is_silent(self.latest - VANISHED) and owner not in gone]
        for owner in vanished:
            self._forget(owner)
            self._exchange.drop(owner)
        for owner in gone + vanished:
            for side in owner.sides:
                side.forgotten = True
                self.sides.remove(side)
            self._by_endpoints = {ends: one for ends, one in self._by_endpoints.items() if one not in owner.sides}
            self._clients.pop(owner.key, None)
            self._exchange.forget(owner)
        if vanished:
            self._complete, self._ordered = self._exchange.standing()
            self._inserted.append((self._rows, self.latest, 0))
            self._note_situation(self._rows)
            self._rows += 1

    def waiting(self, to_agent: bool) -> MessageWait | None:
        """The longest wait of the Agent for a confirmation, or of a client; None if nobody waits."""
        transfers = (transfer for client in self._owners() for transfer in client.transfers.values())
        waits = [one.waiting[0][1] for one in transfers if one.waiting and one.to_agent == to_agent]
        return min(waits, key=lambda wait: wait.time) if waits else None

    def _owners(self) -> set[Client]:
        return {side.owner for side in self.sides}

    def take(self) -> RowBlock:
        """The rows since the last call. Of what they say nothing is kept but where it has led to."""
        nothing = np.zeros(0, np.int64)
        times, packets = np.concatenate([nothing, *self._times]), np.concatenate([nothing, *self._packets])
        first = self._rows - len(times) - len(self._inserted)
        if self._inserted:
            places = [row - first - count for count, (row, _, _) in enumerate(self._inserted)]
            times = np.insert(times, places, [time for _, time, _ in self._inserted])
            packets = np.insert(packets, places, [packet for _, _, packet in self._inserted])
        streams = tuple(
            StreamChanges(side, stream.way, stream.log.take(first))
            for side in self.sides
            for stream in side.streams.values()
            if stream.log
        )
        sleeps = tuple((side, side.sleep_log.take(first)) for side in self.sides if side.sleep_log)
        block = RowBlock(times, packets, self._situation_log.take(first), streams, sleeps)
        self._times, self._packets, self._inserted = [], [], []
        return block

    # ---- clients ----

    def _new_side(self, client: int, agent: int, time: int) -> Side:
        side = self._by_endpoints[client, agent] = Side(client, agent, time)
        self.sides.append(side)
        self._alarm = min(self._alarm, time + self._silence)
        return side

    def _moved_on(self, client: int, agent: int, session: int) -> Side | None:
        """The only client behind a relay, both sides of which were recorded, that has this session at this port of it:
        it has another address now, which the Agent does not see. None if there is none."""
        if not _is_session(session):
            return None
        here = [side for side in self.sides if side.agent_endpoint == agent and side.session == session]
        if len(here) != 1 or here[0].ended or len(here[0].owner.sides) == 1 or here[0] is not here[0].owner.own_side:
            return None
        self._by_endpoints[client, agent] = here[0]
        here[0].client_endpoint = client
        return here[0]

    def _woken(self, side: Side, time: int) -> None:
        if side.asleep:
            self._alarm = min(self._alarm, time + self._silence)
            self._changed = True
        side.woken(time, self._row)

    def _time_passes(self, time: int, row: int) -> int:
        """Adds rows, from this one on, for the sides that become silent until this time. Returns how many."""
        count = 0
        while self.sides:
            side = min(self.sides, key=self._due)
            self._alarm = self._due(side)
            if self._alarm > time:
                break
            self._inserted.append((row + count, self._alarm, 0 if side.owing_since is None else side.owing_packet))
            side.disturbed = side.owing_since is not None and self._alarm >= side.owing_since + ANSWER
            if not side.asleep:
                side.asleep = True
                side.sleep_log.note(row + count, (1,))
            self._note_situation(row + count)
            count += 1
        return count

    def _due(self, side: Side) -> int:
        return side.due(self._silence, PATIENCE, ANSWER)

    def _created(self, side: Side, key: str) -> None:
        """A session begins, or begins again."""
        owner = self._clients.setdefault(key, Client(key, []))
        if side.owner is not owner:
            known = [one for one in owner.sides if one.agent_endpoint == side.agent_endpoint]
            side = self._moved(known[0], side) if known else self._joined(owner, side)
        side.ended = False
        self._alarm = min(self._alarm, self._time + self._silence)
        for stream in side.streams.values():
            stream.state.restart(0)
            for transfer in owner.transfers.values():
                if transfer.sender is stream.state:
                    transfer.restart()
        for one in owner.sides:
            for stream in tuple(one.streams.values()):
                self._noted(stream)

    def _moved(self, old: Side, new: Side) -> Side:
        """A client comes again from another port: what is known of it goes on."""
        self._forget(new.owner)
        self._by_endpoints[new.client_endpoint, new.agent_endpoint] = old
        self._by_endpoints.pop((old.client_endpoint, old.agent_endpoint), None)
        old.client_endpoint = new.client_endpoint
        self._woken(old, self._time)
        new.ended = True
        return old

    def _joined(self, owner: Client, side: Side) -> Side:
        """A client is seen at a further port."""
        self._forget(side.owner)
        self._forget(owner)
        owner.sides.append(side)
        side.owner = owner
        return side

    def _forget(self, owner: Client) -> None:
        """Its streams have other ends now."""
        for transfer in owner.transfers.values():
            self._open -= transfer.to_agent and transfer.open
            self._unconfirmed[transfer.to_agent] -= transfer.unconfirmed
            self._lost[transfer.to_agent] -= transfer.lost
            self._unheard[transfer.to_agent] -= transfer.unheard
        owner.forget()
        self._changed = True

    def _ended(self, side: Side) -> None:
        side.ended = True
        if side is side.owner.own_side:
            self._exchange.close(side.owner, None)

    # ---- streams ----

    def _noted(self, stream: Stream) -> None:
        state = stream.state
        stream.begun = True
        if self._notes_streams:
            stream.log.note(self._row, state.values())
        transfer = stream.transfer or stream.side.owner.transfer(stream)
        was_open, was_lost, was_unheard = transfer.open, transfer.lost, transfer.unheard
        was_unconfirmed = transfer.unconfirmed
        transfer.update()
        to_agent = transfer.to_agent
        if to_agent and transfer.open != was_open:
            self._open += transfer.open - was_open
            self._changed = True
        if transfer.unconfirmed != was_unconfirmed:
            self._unconfirmed[to_agent] += transfer.unconfirmed - was_unconfirmed
            self._changed = True
        if transfer.lost != was_lost:
            self._lost[to_agent] += transfer.lost - was_lost
            self._changed = True
        if transfer.unheard != was_unheard:
            self._unheard[to_agent] += transfer.unheard - was_unheard
            self._changed = True
        ended = transfer.confirmed(self._row, self._time)
        if ended is not None:
            longest = self.longest[to_agent]
            if longest is None or self._time - ended.time > longest.duration:
                self.longest[to_agent] = Waited(ended.row, self._row, self._time - ended.time)

    def _acknack(self, stream: Stream, first: int, bitmap: int) -> None:
        state = stream.state
        arrived = state.acknack(first, bitmap)
        self._noted(stream)
        transfer = stream.transfer
        if not arrived or transfer is None or state is not transfer.receiver:
            return
        for number in sorted(number for number in state.contents if number < arrived.stop):
            content = state.contents.pop(number)
            sent = content if transfer.sender is state else transfer.sender.contents.pop(number, None)
            if sent is not None and sent != content:
                self._unaltered, self._changed = False, True
            for item in content.values():
                self._delivered(stream.side.owner, stream.way, item)
        self._stand()

    def _stand(self) -> None:
        """Updates whether readers have got all samples, and in order."""
        standing = self._exchange.standing()
        if standing != (self._complete, self._ordered):
            self._complete, self._ordered = standing
            self._changed = True

    def _delivered(self, client: Client, way: Way, item: Item) -> None:
        match item:
            case (SubmessageKind.WRITE_DATA, int(number), int(sample)):
                self._exchange.written((client, number), sample)
            case (SubmessageKind.DATA, int(number), int(sample)):
                self._exchange.got((client, number), sample)
            case (SubmessageKind.CREATE, int(number), 0x5, str() | None as topic):
                self._exchange.new_writer((client, number), topic)
            case (SubmessageKind.CREATE, int(number), 0x6, str() | None as topic):
                self._exchange.new_reader((client, number), topic)
            case (SubmessageKind.DELETE, int(number)):
                self._exchange.close(client, number)
            case (SubmessageKind.FRAGMENT, bytes(piece), is_last):
                whole = client.pieces.setdefault(way, bytearray())
                whole += piece
                if is_last:
                    self._whole(client, way, bytes(client.pieces.pop(way)))
            case _:
                pass

    def _whole(self, client: Client, way: Way, submessage: bytes) -> None:
        """Fragments have become a submessage."""
        if len(submessage) >= 8 and submessage[0] in (SubmessageKind.WRITE_DATA, SubmessageKind.DATA):
            number = int.from_bytes(submessage[6:8], "big")
            self._delivered(client, way, (SubmessageKind(submessage[0]), number, hash(submessage[8:])))

    # ---- all of it ----

    def _note_situation(self, row: int) -> None:
        """Notes the situation if it has changed."""
        self._changed = False
        asleep = [side for side in self.sides if side.asleep and side is side.owner.own_side]
        now = (
            not self._open,
            self._complete and not self._open,
            bool(asleep),
            any(side.disturbed for side in asleep),
            self._unaltered,
            self._ordered,
            self._lost[True] > 0,
            self._lost[False] > 0,
            self._unconfirmed[False] > 0,
            self._unheard[True] > 0,
            self._unconfirmed[True] > 0,
        )
        if now != self._known:
            self._known = now
            self._situation_log.note(row, now)


def _is_session(number: int) -> bool:
    return number > 0 and number not in wire.SESSION_IDS_NONE


def _item(found: Submessages, entry: int, kind: int, octets: bytes) -> Item:
    """The samples in a submessage."""
    begin = found.starts.item(entry)
    payload = octets[begin : begin + found.sizes.item(entry)]
    if kind == _FRAGMENT:
        return kind, payload, bool(int(found.flags[entry]) & wire.LAST_FRAGMENT)
    number = found.object.item(entry)
    if kind in (_WRITE_DATA, _DATA):
        return kind, number, hash(payload[4:])
    if kind == _CREATE:
        new = found.contents[entry].new
        if new.kind in _ENDS:
            described = new.what.description
            return kind, number, new.kind, topic_of(described.format, described.description)
    return kind, number
