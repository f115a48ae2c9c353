"""Follows all clients of a capture, message by message."""

from __future__ import annotations

from typing import Final

import numpy as np

from tachk.records import dataclass
from tachk.xrce import wire
from tachk.xrce.packets import Numbers
from tachk.xrce.signals.changes import ChangeLog, Changes
from tachk.xrce.signals.clients import NEVER, Client, Side, Stream, Wait, Way
from tachk.xrce.signals.samples import Exchange, topic_of
from tachk.xrce.streams import Item
from tachk.xrce.submessages import Submessages
from tachk.xrce.wire import Kind

SILENCE: Final = 2_000_000_000
"""After so many nanoseconds without a message a client counts as asleep: ten heartbeats of the Agent."""

ANSWER: Final = 100_000_000
"""A client that is awake answers messages of a reliable stream, and HEARTBEATs, within so many nanoseconds."""

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
)
"""Of all clients together: every message that clients have sent has arrived at the Agent; every sample that they have
written has arrived at every reader; a client is silent for long; something came to such a client, which has not
answered in time; the Agent has got what clients sent; readers have got it in order; a message of a client is neither
there nor named as missing, or one of the Agent; the Agent has unconfirmed messages; a message of a client is not there,
and its client has not heard so."""

_SESSION: Final = 0xFFFE
"""The object id of the client itself."""

_WRITER, _READER = 0x5, 0x6
_ENDS: Final = (_WRITER, _READER)

_CARRYING: Final = (Kind.WRITE_DATA, Kind.DATA, Kind.CREATE, Kind.DELETE, Kind.FRAGMENT)
_TELLING: Final = (*_CARRYING, Kind.ACKNACK, Kind.HEARTBEAT, Kind.CREATE_CLIENT)


_Header = tuple[int, int, int, int, int, bool]
"""Which message of its piece, its time, its packet, client, Agent, whether the client sends."""

_Telling = tuple[int, int, int, int, int, int, int, int, int, int]
"""Kind, stream and number of the message, first, last, bitmap, subject, object, where the payload begins and ends."""


@dataclass(frozen=True, slots=True)
class StreamChanges:
    """``side`` and ``way`` say which stream."""

    side: Side
    way: Way
    changes: Changes


@dataclass(frozen=True, slots=True)
class Block:
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
    situation: Changes
    streams: tuple[StreamChanges, ...]
    sleeps: tuple[tuple[Side, Changes], ...]


@dataclass(frozen=True, slots=True)
class Waited:
    """``sent``, ``confirmed``: rows; ``duration`` in nanoseconds."""

    sent: int
    confirmed: int
    duration: int


class Follower:
    """Takes messages, and gives what they say as `Block`.

    Attributes:
        sides: of all clients, in the order in which they were seen.
        longest: the confirmation for which the Agent has waited longest.
        latest: until when everything is known, in nanoseconds since the epoch.
    """

    def __init__(self, silence: int = SILENCE) -> None:
        self._silence = silence
        self.sides: list[Side] = []
        self._by_endpoints: dict[tuple[int, int], Side] = {}
        self._clients: dict[str, Client] = {}
        self._exchange = Exchange()
        self._situation_log = ChangeLog(len(SITUATION))
        self._times: list[Numbers] = []
        self._packets: list[Numbers] = []
        self._inserted: list[tuple[int, int, int]] = []
        self._rows = 0
        self.latest = 0
        self._time = 0
        self._alarm = NEVER
        self.longest: Waited | None = None
        self._open = [0, 0]
        self._lost = [0, 0]
        self._unheard = [0, 0]
        self._complete = self._ordered = self._unaltered = True
        self._changed = True
        self._known: tuple[int, ...] = ()
        self._row = 0
        self._before = 0
        self._number = 0
        self._to_agent = False
        self._side = Side(0, 0, 0)
        self._stream: Stream | None = None

    # ---- what comes in ----

    def push(self, found: Submessages) -> None:
        """The messages of a piece."""
        messages = found.messages
        if not len(messages.times):
            return
        times = np.maximum(np.maximum.accumulate(messages.times), self.latest)
        self.latest = int(times[-1])
        chosen = np.flatnonzero((found.place == 0) | np.isin(found.kind, _TELLING))
        message = found.message[chosen]
        of_message = (times, messages.packets, messages.clients, messages.agents, messages.to_agent)
        of_stream = (found.kind, found.stream, found.sequence, found.first, found.last, found.bitmap, found.subject)
        of_content = (found.object, found.starts, found.starts + found.sizes)
        headers = zip(message.tolist(), *(column[message].tolist() for column in of_message), strict=True)
        tellings = zip(*(column[chosen].tolist() for column in (*of_stream, *of_content)), strict=True)
        octets = messages.octets.tobytes()
        base, self._before = self._rows, len(self._inserted)
        for header, telling, place, entry in zip(
            headers, tellings, found.place[chosen].tolist(), chosen.tolist(), strict=True
        ):
            if place == 0:
                self._message(base, header, telling)
            self._told(telling, place, entry, found, octets)
            if self._changed:
                self._look(self._row)
        self._rows += len(times)
        self._times.append(times)
        self._packets.append(messages.packets)

    def _message(self, base: int, header: _Header, telling: _Telling) -> None:
        """The next message begins."""
        index, time, packet, client, agent, to_agent = header
        kind, stream, number, *_ = telling
        if time >= self._alarm:
            self._rows += self._time_passes(time, base + index + len(self._inserted) - self._before)
        self._row = base + index + len(self._inserted) - self._before
        self._time, self._to_agent = time, to_agent
        side = self._side = self._found_side(client, agent, time)
        if to_agent:
            self._woken(side, time)
        self._stream = None
        if stream >= wire.FIRST_RELIABLE_STREAM and kind >= 0:
            self._stream = side.stream((to_agent, stream))
            self._number = self._stream.state.message(number)
            self._noted(self._stream)
        if side.asleep and not to_agent and side.asked is None and (self._stream or kind == Kind.HEARTBEAT):
            side.asked, side.asked_by = time, packet
            self._alarm = min(self._alarm, time + ANSWER)

    def _told(self, telling: _Telling, place: int, entry: int, found: Submessages, octets: bytes) -> None:
        """The next submessage of the message."""
        kind, _, _, first, last, bitmap, subject, number, start, end = telling
        side = self._side
        if kind == Kind.ACKNACK:
            self._acknack(side.stream((not self._to_agent, subject)), first, bitmap)
        elif kind == Kind.HEARTBEAT:
            held = side.stream((self._to_agent, subject))
            held.state.heartbeat(first, last)
            self._noted(held)
        elif kind == Kind.CREATE_CLIENT:
            self._created(side, octets[start + 8 : start + 12].hex().upper())
        elif kind == Kind.DELETE and number == _SESSION:
            self._ended(side)
        elif self._stream is not None and kind in _CARRYING:
            item = _item(found, entry, kind, number, octets[start:end])
            if self._stream.state.carries(self._number, place, item):
                self._unaltered, self._changed = False, True

    def wait(self, time: int) -> None:
        """Nothing has come until this time, in nanoseconds since the epoch."""
        if time >= self._alarm:
            self._rows += self._time_passes(time, self._rows)
        self.latest = max(self.latest, time)

    def waiting(self) -> Wait | None:
        """For what the Agent waits still, and longest."""
        transfers = (transfer for client in self._owners() for transfer in client.transfers.values())
        waits = [transfer.waiting[0][1] for transfer in transfers if transfer.waiting]
        return min(waits, key=lambda wait: wait.time) if waits else None

    def _owners(self) -> set[Client]:
        return {side.owner for side in self.sides}

    def take(self) -> Block:
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
        block = Block(times, packets, self._situation_log.take(first), streams, sleeps)
        self._times, self._packets, self._inserted = [], [], []
        return block

    # ---- clients ----

    def _found_side(self, client: int, agent: int, time: int) -> Side:
        side = self._by_endpoints.get((client, agent))
        if side is None:
            side = self._by_endpoints[client, agent] = Side(client, agent, time)
            self.sides.append(side)
            self._alarm = min(self._alarm, time + self._silence)
        return side

    def _woken(self, side: Side, time: int) -> None:
        if side.asleep:
            self._alarm = min(self._alarm, time + self._silence)
            self._changed = True
        side.woken(time, self._row)

    def _time_passes(self, time: int, row: int) -> int:
        """Whoever has been silent for long, until this time. Returns how many rows have been put in, from this one."""
        count = 0
        while self.sides:
            side = min(self.sides, key=lambda one: one.due(self._silence, ANSWER))
            self._alarm = side.due(self._silence, ANSWER)
            if self._alarm > time:
                break
            self._inserted.append((row + count, self._alarm, side.asked_by if side.asleep else 0))
            if side.asleep:
                side.disturbed = True
            else:
                side.asleep = True
                side.sleep_log.note(row + count, (1,))
            self._look(row + count)
            count += 1
        return count

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
            self._open[transfer.to_agent] -= transfer.open
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
        stream.log.note(self._row, stream.state.values())
        transfer = stream.transfer or stream.side.owner.transfer(stream)
        was_open, was_lost, was_unheard = transfer.open, transfer.lost, transfer.unheard
        transfer.look()
        if transfer.open != was_open:
            self._open[transfer.to_agent] += transfer.open - was_open
            self._changed = True
        if transfer.lost != was_lost:
            self._lost[transfer.to_agent] += transfer.lost - was_lost
            self._changed = True
        if transfer.unheard != was_unheard:
            self._unheard[transfer.to_agent] += transfer.unheard - was_unheard
            self._changed = True
        if not transfer.to_agent:
            ended = transfer.confirmed(self._row, self._time)
            if ended is not None and (self.longest is None or self._time - ended.time > self.longest.duration):
                self.longest = Waited(ended.row, self._row, self._time - ended.time)

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
        standing = self._exchange.standing()
        if standing != (self._complete, self._ordered):
            self._complete, self._ordered = standing
            self._changed = True

    def _delivered(self, client: Client, way: Way, item: Item) -> None:
        match item:
            case (Kind.WRITE_DATA, int(number), int(sample)):
                self._exchange.written((client, number), sample)
            case (Kind.DATA, int(number), int(sample)):
                self._exchange.got((client, number), sample)
            case (Kind.CREATE, int(number), 0x5, str() | None as topic):
                self._exchange.new_writer((client, number), topic)
            case (Kind.CREATE, int(number), 0x6, str() | None as topic):
                self._exchange.new_reader((client, number), topic)
            case (Kind.DELETE, int(number)):
                self._exchange.close(client, number)
            case (Kind.FRAGMENT, bytes(piece), is_last):
                whole = client.pieces.setdefault(way, bytearray())
                whole += piece
                if is_last:
                    self._whole(client, way, bytes(client.pieces.pop(way)))
            case _:
                pass

    def _whole(self, client: Client, way: Way, submessage: bytes) -> None:
        """Fragments have become a submessage."""
        if len(submessage) >= 8 and submessage[0] in (Kind.WRITE_DATA, Kind.DATA):
            number = int.from_bytes(submessage[6:8], "big")
            self._delivered(client, way, (Kind(submessage[0]), number, hash(submessage[8:])))

    # ---- all of it ----

    def _look(self, row: int) -> None:
        """Notes the situation if it has changed."""
        self._changed = False
        asleep = [side for side in self.sides if side.asleep and side is side.owner.own_side]
        now = (
            not self._open[True],
            self._complete and not self._open[True],
            bool(asleep),
            any(side.disturbed for side in asleep),
            self._unaltered,
            self._ordered,
            self._lost[True] > 0,
            self._lost[False] > 0,
            self._open[False] > 0,
            self._unheard[True] > 0,
        )
        if now != self._known:
            self._known = now
            self._situation_log.note(row, now)


def _item(found: Submessages, entry: int, kind: int, number: int, payload: bytes) -> Item:
    """What a submessage carries, as far as it says something of samples."""
    match kind:
        case Kind.WRITE_DATA | Kind.DATA:
            return kind, number, hash(payload[4:])
        case Kind.CREATE:
            new = found.contents[entry].new
            if new.kind not in _ENDS:
                return kind, number
            described = new.what.description
            return kind, number, new.kind, topic_of(described.format, described.description)
        case Kind.FRAGMENT:
            return kind, payload, bool(int(found.flags[entry]) & wire.LAST_FRAGMENT)
        case _:
            return kind, number
