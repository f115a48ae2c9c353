"""Follows all clients of a capture, message by message."""

from __future__ import annotations

from typing import Final

import numpy as np

from tachk.records import dataclass
from tachk.xrce import wire
from tachk.xrce.packets import Numbers
from tachk.xrce.signals.changes import ChangeLog, Changes
from tachk.xrce.signals.clients import NEVER, Client, Side, Wait, Way
from tachk.xrce.signals.samples import Exchange, topic_of
from tachk.xrce.streams import Item
from tachk.xrce.submessages import Submessages, parsed
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
)
"""Of all clients together: every message that clients have sent has arrived at the Agent; every sample that they have
written has arrived at every reader; a client is silent for long; something came to such a client, which has not
answered in time; the Agent has got what clients sent; readers have got it in order; a message of a client is neither
there nor named as missing, or one of the Agent; the Agent has unconfirmed messages."""

_SESSION: Final = 0xFFFE
"""The object id of the client itself."""

_CARRYING: Final = (Kind.WRITE_DATA, Kind.DATA, Kind.CREATE, Kind.DELETE, Kind.FRAGMENT)
_TELLING: Final = (*_CARRYING, Kind.ACKNACK, Kind.HEARTBEAT, Kind.CREATE_CLIENT)


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
        self._latest = 0
        self._time = 0
        self._alarm = NEVER
        self.longest: Waited | None = None
        self._open = [0, 0]
        self._lost = [0, 0]
        self._complete = self._ordered = self._unaltered = True
        self._known: tuple[int, ...] = ()

    # ---- what comes in ----

    def push(self, found: Submessages) -> None:
        """The messages of a piece."""
        messages = found.messages
        if not len(messages.times):
            return
        times = np.maximum(np.maximum.accumulate(messages.times), self._latest)
        self._latest = int(times[-1])
        octets = messages.octets.tobytes()
        is_first = found.place == 0
        chosen = np.flatnonzero(is_first | np.isin(found.kind, _TELLING))
        message = found.message[chosen]
        of_message = (times, messages.clients, messages.agents, messages.to_agent)
        of_submessage = (found.kind, found.stream, found.sequence, found.first, found.last, found.bitmap, found.subject)
        base = self._rows
        inserted = 0
        side = way = None
        number = row = 0
        rows = zip(
            chosen.tolist(),
            message.tolist(),
            found.place[chosen].tolist(),
            *(column[message].tolist() for column in of_message),
            *(column[chosen].tolist() for column in of_submessage),
            strict=True,
        )
        for (
            entry,
            index,
            place,
            time,
            client,
            agent,
            to_agent,
            kind,
            stream,
            wired,
            first,
            last,
            bitmap,
            subject,
        ) in rows:
            if place == 0:
                if time >= self._alarm:
                    inserted += self._time_passes(time, base + index + inserted)
                row, self._time = base + index + inserted, time
                side = self._side(client, agent, time)
                if to_agent:
                    self._woken(side, time, row)
                way = None
                if stream >= wire.FIRST_RELIABLE_STREAM and kind >= 0:
                    way = (to_agent, stream)
                    state = side.stream(way)[0]
                    number = state.message(wired)
                    self._noted(side, way, row)
            assert side is not None
            if side.asleep and not to_agent and side.asked is None and (way is not None or kind == Kind.HEARTBEAT):
                side.asked, side.asked_by = time, int(messages.packets[index])
                self._alarm = min(self._alarm, time + ANSWER)
            if kind == Kind.ACKNACK:
                self._acknack(side, (not to_agent, subject), first, bitmap, row)
            elif kind == Kind.HEARTBEAT:
                about = (to_agent, subject)
                side.stream(about)[0].heartbeat(first, last)
                self._noted(side, about, row)
            elif kind == Kind.CREATE_CLIENT:
                key = octets[int(found.starts[entry]) + 8 :][:4]
                side = self._created(side, key.hex().upper(), time, row)
            elif kind == Kind.DELETE and int(found.object[entry]) == _SESSION:
                self._ended(side, row)
            elif (
                way is not None
                and kind in _CARRYING
                and side.stream(way)[0].carries(number, place, _item(found, entry, kind, octets))
            ):
                self._unaltered = False
            self._look(row)
        self._rows += len(times) + inserted
        self._times.append(times)
        self._packets.append(messages.packets)

    def wait(self, time: int) -> None:
        """Nothing has come until this time, in nanoseconds since the epoch."""
        if time >= self._alarm:
            self._rows += self._time_passes(time, self._rows)
        self._latest = max(self._latest, time)

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
        block = Block(
            times,
            packets,
            self._situation_log.take(first),
            tuple(
                StreamChanges(side, way, log.take(first))
                for side in self.sides
                for way, (_, log) in side.streams.items()
                if log
            ),
            tuple((side, side.sleep_log.take(first)) for side in self.sides if side.sleep_log),
        )
        self._times, self._packets, self._inserted = [], [], []
        return block

    # ---- clients ----

    def _side(self, client: int, agent: int, time: int) -> Side:
        side = self._by_endpoints.get((client, agent))
        if side is None:
            side = self._by_endpoints[client, agent] = Side(client, agent, time)
            self.sides.append(side)
            self._alarm = min(self._alarm, time + self._silence)
        return side

    def _woken(self, side: Side, time: int, row: int) -> None:
        if side.asleep:
            self._alarm = min(self._alarm, time + self._silence)
        side.woken(time, row)

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

    def _created(self, side: Side, key: str, time: int, row: int) -> Side:
        """A session begins, or begins again. Returns the side at which it does."""
        owner = self._clients.setdefault(key, Client(key, []))
        if side.owner is not owner:
            known = [one for one in owner.sides if one.agent_endpoint == side.agent_endpoint]
            side = self._moved(known[0], side, time, row) if known else self._joined(owner, side)
        side.ended = False
        self._alarm = min(self._alarm, time + self._silence)
        for state, _ in side.streams.values():
            state.restart(0)
            for transfer in owner.transfers.values():
                if transfer.sender is state:
                    transfer.restart()
        for one in owner.sides:
            for way in one.streams:
                self._noted(one, way, row)
        return side

    def _moved(self, old: Side, new: Side, time: int, row: int) -> Side:
        """A client comes again from another port: what is known of it goes on."""
        self._by_endpoints[new.client_endpoint, new.agent_endpoint] = old
        self._by_endpoints.pop((old.client_endpoint, old.agent_endpoint), None)
        old.client_endpoint = new.client_endpoint
        self._woken(old, time, row)
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
        owner.transfers = {}

    def _ended(self, side: Side, row: int) -> None:
        side.ended = True
        if side is side.owner.own_side:
            self._exchange.close(side.owner, None)

    # ---- streams ----

    def _noted(self, side: Side, way: Way, row: int) -> None:
        state, log = side.stream(way)
        log.note(row, state.values())
        transfer = side.owner.transfer(way)
        ended = transfer.confirmed(row, self._time)
        if ended is not None and (self.longest is None or self._time - ended.time > self.longest.duration):
            self.longest = Waited(ended.row, row, self._time - ended.time)
        opened, lost = transfer.look()
        self._open[transfer.to_agent] += opened
        self._lost[transfer.to_agent] += lost

    def _acknack(self, side: Side, way: Way, first: int, bitmap: int, row: int) -> None:
        state = side.stream(way)[0]
        arrived = state.acknack(first, bitmap)
        self._noted(side, way, row)
        transfer = side.owner.transfer(way)
        if arrived and state is transfer.receiver:
            for number in arrived:
                content = state.contents.pop(number, None)
                sent = content if transfer.sender is state else transfer.sender.contents.pop(number, None)
                if content is not None:
                    self._unaltered &= sent is None or sent == content
                    for item in content.values():
                        self._delivered(side.owner, way, item)
            standing = self._exchange.standing()
            self._complete, self._ordered = standing.complete, standing.ordered

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
        """Notes the situation where it has changed."""
        asleep = arrived = False
        for side in self.sides:
            if side.asleep and side is side.owner.own_side:
                asleep = True
                arrived |= side.disturbed
        now = (
            not self._open[True],
            self._complete and not self._open[True],
            asleep,
            arrived,
            self._unaltered,
            self._ordered,
            self._lost[True] > 0,
            self._lost[False] > 0,
            self._open[False] > 0,
        )
        if now != self._known:
            self._known = now
            self._situation_log.note(row, now)


def _item(found: Submessages, entry: int, kind: int, octets: bytes) -> Item:
    """What a submessage carries, as far as it says something of samples."""
    start = int(found.starts[entry])
    end = start + int(found.sizes[entry])
    match kind:
        case Kind.WRITE_DATA | Kind.DATA:
            return kind, int(found.object[entry]), hash(octets[start + 4 : end])
        case Kind.CREATE:
            new = (found.contents.get(entry) or parsed(found, entry)).new
            number = int(found.object[entry])
            if new.kind not in (0x5, 0x6):
                return kind, number
            described = new.what.description
            return kind, number, new.kind, topic_of(described.format, described.description)
        case Kind.FRAGMENT:
            return kind, octets[start:end], bool(int(found.flags[entry]) & wire.LAST_FRAGMENT)
        case _:
            return kind, int(found.object[entry])
