"""Captures of DDS-XRCE as recordings, in the words of `models/micro_xrce_dds/protocol.ta`.

Clients are numbered: first those that write samples, then the others, each kind in the order in which they begin. What
client c sends is on the link 2 c, what the Agent sends to it on 2 c + 1. The events:

    sent(client, link, kind, number, detail)      a message leaves its sender
    arrived(client, link, kind, number, detail)   it comes to its receiver
    written(client, detail)                       a client puts a new message into its output stream
    written_best_effort(client, detail)           a client puts samples into its best-effort output stream
    created_again(client)                         one more CREATE_CLIENT of a session reaches the Agent

Samples, topics and data readers have the numbers of `tachk.xrce.objects`.

A message with several submessages is one event, and so is a piece of a larger one (FRAGMENT). The recording of a client
ends where it deletes its session.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.conformance.events import Closing, EventLog
from tachk.xrce.conformance.packed_events import EventColumns
from tachk.xrce.conformance.payloads import BEST_EFFORT, MessageContents, Payload, UnknownContentError, begins_sample
from tachk.xrce.events import SubmessageEvent as Submessage
from tachk.xrce.objects import constants_of
from tachk.xrce.packets import CaptureError
from tachk.xrce.streams import nearest_number
from tachk.xrce.transmission import Transmission
from tachk.xrce.transmissions import open_transmissions
from tachk.xrce.wire import SESSION_IDS_NONE, SubmessageKind

_CLIENT_OBJECT = "FFFE"
_KINDS = "DATA", "HEARTBEAT", "ACKNACK", "PING", BEST_EFFORT


_Content = tuple[str, int, Payload]
"""A message of the automata: kind, number, and what it carries."""


class _Counter(NamedTuple):
    """Attributes:
    of_client: the client counts, and not the Agent.
    kind: of the messages that show the count.
    """

    of_client: bool
    kind: str


class _StreamCounts:
    """Numbers of messages of one client and its Agent: they go on where those of packets, of 16 bits, go round."""

    def __init__(self) -> None:
        self._last: dict[_Counter, int] = {}

    def number(self, counter: _Counter, number: int) -> int:
        """The number that a packet means, and the last one of its counter from now on."""
        found = nearest_number(number, self._last.get(counter, 0))
        self._last[counter] = found
        return found

    def create(self) -> None:
        """A session begins at the Agent, which counts from 0 again; the client goes on, if it is one more."""
        self._last = {counter: number for counter, number in self._last.items() if counter.of_client}


def read_capture(path: Path, ports: Iterable[int] = ()) -> EventLog:
    """The events of a capture; the model starts shortly before the first of them.

    Where only one side of the way was recorded, each message may have arrived or not. Raises UsageError.
    """
    try:
        found = open_transmissions(path, ports)
    except FileNotFoundError:
        raise UsageError(f"there is no file {path}") from None
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}") from None
    except CaptureError as error:
        raise UsageError(f"{path}: {error}") from None
    if not len(found):
        raise UsageError(
            f"{path} has no message of DDS-XRCE by UDP, TCP or on a serial line",
            "give the port of the Agent with --port",
        )
    return _CaptureEventReader(path, len(found.links)).recording(found)


class _CaptureEventReader:
    def __init__(self, path: Path, links: int) -> None:
        self.path = path
        self.writes = [False] * links
        self.contents = MessageContents()
        self.events = EventColumns()
        self.written = [0] * links
        self.counts = [_StreamCounts() for _ in range(links)]
        self.deleted: list[int | None] = [None] * links
        self.created = [0] * links

    def recording(self, transmissions: Iterable[Transmission]) -> EventLog:
        """Times are counted from the first transmission, in nanoseconds."""
        begin, end = None, 0
        for one in transmissions:
            begin = one.sent if begin is None else begin
            end = max(end, one.arrivals[-1].time if one.arrivals else one.sent)
            self.writes[one.link] |= any(begins_sample(event) for event in one.events)
            self._transmission(one, begin)
        begin = begin or 0
        clients = _numbered(self.writes)
        closings = tuple(
            Closing(column, value, Fraction(time - begin), by_sender=column == "link" and value % 2 == 0)
            for link, time in enumerate(self.deleted)
            if time is not None
            for column, value in _of_client(clients[link])
        )
        numbering = self.contents.objects.numbering(self.contents.counts())
        events, end_time = self.events.sorted(clients, numbering), Fraction(end - begin)
        words, constants = {"kind": _KINDS}, constants_of(numbering)
        return EventLog(str(self.path), events, Fraction(1), None, end_time, closings, begin, words, constants)

    def _transmission(self, one: Transmission, begin: int) -> None:
        link = one.link
        if self.deleted[link] is not None:
            return
        time = one.sent - begin
        kinds = [event.kind for event in one.events]
        if SubmessageKind.DELETE in kinds and any(_deletes_client(event) for event in one.events):
            self.deleted[link] = one.sent
            return
        # The leg of a client and that of the Agent: one and the same if there is no relay.
        here, there = (2 * link, 2 * link + 1) if one.to_agent else (2 * link + 1, 2 * link)
        if SubmessageKind.CREATE_CLIENT in kinds:
            if one.arrivals != ():
                self.counts[link].create()
            for arrival in one.arrivals or ():
                self.created[link] += 1
                if self.created[link] > 1:
                    self.events.add(arrival.time - begin, arrival.packet, "created_again", link, passes=there)
            return
        if None in kinds:
            self._reject_damaged(one)
        for kind, number, (detail, about) in self._contents(one):
            if one.to_agent and self._is_new(link, kind, number):
                name = "written_best_effort" if kind == BEST_EFFORT else "written"
                self.events.add(time, one.packet, name, link, detail or 0, inferred=True, about=about)
            sent = len(self.events)
            said = link, detail, int(not one.to_agent), kind, number
            self.events.add(time, one.packet, "sent", *said, passes=here, about=about)
            if one.arrivals is None:
                self.events.add(time, one.packet, "arrived", *said, sent, optional=True, passes=there, about=about)
            for arrival in one.arrivals or ():
                self.events.add(arrival.time - begin, arrival.packet, "arrived", *said, sent, passes=there, about=about)

    def _is_new(self, link: int, kind: str, number: int) -> bool:
        """True if the client has just put a message into its stream; of a best-effort stream nothing is sent again."""
        if kind == "DATA" and number == self.written[link]:
            self.written[link] += 1
            return True
        return kind == BEST_EFFORT

    def _contents(self, one: Transmission) -> Iterator[_Content]:
        """The content of a message for the automata: entries of a stream, ACKNACK, HEARTBEAT, a request."""
        first, counts = one.events[0], self.counts[one.link]
        if (first.is_reliable or first.is_best_effort) and first.sequence is not None:
            kind = "DATA" if first.is_reliable else BEST_EFFORT
            number = counts.number(_Counter(one.to_agent, kind), first.sequence)
            yield kind, number, self._payload(one, number)
            return
        if not one.to_agent and first.kind is SubmessageKind.DATA:  # outside any stream: nothing has a number
            yield BEST_EFFORT, 0, self._payload(one, 0)
            return
        for event in one.events:
            fields = event.fields
            if event.kind is SubmessageKind.HEARTBEAT:
                own = _Counter(one.to_agent, "DATA")
                last = counts.number(own, _integer(fields["last"]))
                yield "HEARTBEAT", counts.number(own, _integer(fields["first"])), Payload(last + 1)
            elif event.kind is SubmessageKind.ACKNACK:
                start, missing = _integer(fields["first"]), fields["missing"]
                assert isinstance(missing, list)
                bitmap = sum(1 << (number - start) % 65536 for number in missing)
                yield "ACKNACK", counts.number(_Counter(one.to_agent, "ACKNACK"), start), Payload(bitmap)
            elif event.kind is SubmessageKind.GET_INFO and one.to_agent and event.session not in SESSION_IDS_NONE:
                yield "PING", 0, Payload(0)

    def _reject_damaged(self, one: Transmission) -> None:
        """Raises UsageError for what the automata have no word for and would take for silence."""
        for event in one.events:
            if event.kind is None:
                self._reject(one, f"message is damaged, so what its sender has sent is unknown: {event.problem}")

    def _reject(self, one: Transmission, why: str) -> None:
        raise UsageError(f"{self.path}, packet {one.packet}: this {why}", "tachk monitor judges such captures, too")

    def _payload(self, one: Transmission, number: int) -> Payload:
        try:
            return self.contents.payload(one, number)
        except UnknownContentError as error:
            self._reject(one, str(error))
            raise


def _deletes_client(event: Submessage) -> bool:
    return event.kind is SubmessageKind.DELETE and event.fields.get("object") == _CLIENT_OBJECT


def _of_client(number: int) -> Iterator[tuple[str, int]]:
    """The columns that identify a client, with their values."""
    yield "client", number
    yield "link", 2 * number
    yield "link", 2 * number + 1


def _integer(value: object) -> int:
    assert isinstance(value, int)
    return value


def _numbered(writes: Sequence[bool]) -> list[int]:
    """The number of the client of each link, of which some write samples."""
    order = sorted(range(len(writes)), key=lambda link: (not writes[link], link))
    return [order.index(link) for link in range(len(writes))]
