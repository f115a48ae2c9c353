"""Transmissions of a long capture as columns of numbers: each is made when it is read, and takes no memory before."""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Final, overload

import numpy as np

from tachk.base.records import dataclass
from tachk.xrce.events import SubmessageEvent, Value
from tachk.xrce.messages import Endpoint
from tachk.xrce.transmission import Transmission, TransmissionArrival
from tachk.xrce.wire import SubmessageKind

_NONE: Final = -1
_FEW: Final = 10_000


_Shape = tuple[frozenset[SubmessageKind | None], bool]


class PackedTransmissions(Sequence[Transmission]):
    """What a capture has of messages on their way, in the order in which they were sent."""

    def __init__(self, transmissions: Iterable[Transmission]) -> None:
        self.links, self.to_agent = array("i"), array("b")
        self.sent, self.packets = array("q"), array("q")
        self.first_arrivals, self.first_events = array("q", [0]), array("q", [0])
        self._unseen = bytearray()
        self._arrivals = array("q")
        self._events = _SubmessageColumns()
        self._shape = array("i")
        self._shapes: dict[_Shape, int] = {}
        self._by_number: list[_Shape] = []
        for one in transmissions:
            self.links.append(one.link)
            self.to_agent.append(one.to_agent)
            self.sent.append(one.sent)
            self.packets.append(one.packet)
            self._unseen.append(one.arrivals is None)
            for arrival in one.arrivals or ():
                self._arrivals.extend((arrival.time, arrival.packet))
            self.first_arrivals.append(len(self._arrivals) // 2)
            for event in one.events:
                self._events.add(event)
            self.first_events.append(len(self._events))
            shape = one.kinds, one.is_reliable
            number = self._shapes.setdefault(shape, len(self._by_number))
            if number == len(self._by_number):
                self._by_number.append(shape)
            self._shape.append(number)

    def __len__(self) -> int:
        return len(self.links)

    @overload
    def __getitem__(self, number: int) -> Transmission: ...
    @overload
    def __getitem__(self, number: slice) -> tuple[Transmission, ...]: ...
    def __getitem__(self, number: int | slice) -> Transmission | tuple[Transmission, ...]:
        if isinstance(number, slice):
            return tuple(_PackedTransmission(self, each) for each in range(len(self))[number])
        return _PackedTransmission(self, range(len(self))[number])

    def __iter__(self) -> Iterator[Transmission]:
        return (_PackedTransmission(self, row) for row in range(len(self.links)))

    def where(
        self,
        link: int | None = None,
        to_agent: bool | None = None,
        kinds: frozenset[SubmessageKind] | None = None,
    ) -> Iterator[Transmission]:
        """Those of a link, of a way, with a submessage of one of these kinds."""
        chosen = np.ones(len(self), np.bool_)
        if link is not None:
            chosen &= np.asarray(self.links) == link
        if to_agent is not None:
            chosen &= np.asarray(self.to_agent) == to_agent
        if kinds is not None:
            having = [not kinds.isdisjoint(own) for own, _ in self._by_number]
            chosen &= np.array([*having, False], np.bool_)[np.asarray(self._shape)]
        for first in range(0, len(chosen), _FEW):
            for row in np.flatnonzero(chosen[first : first + _FEW]).tolist():
                yield _PackedTransmission(self, first + row)

    def shape(self, row: int) -> _Shape:
        """The kinds of its submessages, and whether its number is acknowledged."""
        return self._by_number[self._shape[row]]

    def arrivals(self, row: int) -> tuple[TransmissionArrival, ...] | None:
        if self._unseen[row]:
            return None
        numbers, first, top = self._arrivals, self.first_arrivals[row], self.first_arrivals[row + 1]
        if top == first + 1:  # as most have
            return (TransmissionArrival(numbers[2 * first], numbers[2 * first + 1]),)
        return tuple([TransmissionArrival(numbers[2 * n], numbers[2 * n + 1]) for n in range(first, top)])

    def arrived(self, row: int) -> int:
        first = self.first_arrivals[row]
        return self.sent[row] if first == self.first_arrivals[row + 1] else self._arrivals[2 * first]

    def is_observed(self, row: int) -> bool:
        return not self._unseen[row]

    def is_lost(self, row: int) -> bool:
        return not self._unseen[row] and self.first_arrivals[row] == self.first_arrivals[row + 1]

    def events(self, row: int) -> tuple[SubmessageEvent, ...]:
        time, packet, to_agent = self.sent[row], self.packets[row], self.to_agent[row] != 0
        numbers = range(self.first_events[row], self.first_events[row + 1])
        return tuple([self._events.event(number, packet, time, to_agent) for number in numbers])


class _PackedTransmission:
    """One of `PackedTransmissions`, by its number."""

    __slots__ = ("_row", "_table")

    def __init__(self, table: PackedTransmissions, row: int) -> None:
        self._table, self._row = table, row

    @property
    def link(self) -> int:
        return self._table.links[self._row]

    @property
    def to_agent(self) -> bool:
        return self._table.to_agent[self._row] != 0

    @property
    def sent(self) -> int:
        return self._table.sent[self._row]

    @property
    def packet(self) -> int:
        return self._table.packets[self._row]

    @property
    def arrivals(self) -> tuple[TransmissionArrival, ...] | None:
        return self._table.arrivals(self._row)

    @property
    def events(self) -> tuple[SubmessageEvent, ...]:
        return self._table.events(self._row)

    @property
    def kinds(self) -> frozenset[SubmessageKind | None]:
        return self._table.shape(self._row)[0]

    @property
    def is_reliable(self) -> bool:
        return self._table.shape(self._row)[1]

    @property
    def is_observed(self) -> bool:
        return self._table.is_observed(self._row)

    @property
    def is_lost(self) -> bool:
        return self._table.is_lost(self._row)

    @property
    def arrived(self) -> int:
        return self._table.arrived(self._row)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _PackedTransmission) and (self._row, self._table) == (other._row, other._table)

    def __hash__(self) -> int:
        return hash((self._row, id(self._table)))


@dataclass(frozen=True, slots=True)
class _Head:
    """What many submessages have in common."""

    place: int
    client: Endpoint | None
    agent: Endpoint | None
    kind: SubmessageKind | None
    session: int | None
    stream: int | None
    said: tuple[Value, ...]


class _SubmessageColumns:
    """Submessages. Of the kinds that come in masses all is in columns, of others the fields are held as they are."""

    def __init__(self) -> None:
        self._heads: dict[_Head, int] = {}
        self._by_number: list[_Head] = []
        self._head, self._sequence = array("i"), array("i")
        self._one, self._other, self._request = array("q"), array("q"), array("i")
        self._octets = bytearray()
        self._rare: dict[int, tuple[Mapping[str, Value], str]] = {}

    def __len__(self) -> int:
        return len(self._head)

    def add(self, event: SubmessageEvent) -> None:
        fields = event.fields
        said: tuple[Value, ...] = ()
        one = other = request = 0
        match event.kind:
            case SubmessageKind.ACKNACK:
                first, missing = fields["first"], fields["missing"]
                assert isinstance(first, int)
                assert isinstance(missing, list)
                said, one = (fields["subject"],), first
                other = sum(1 << (number - first) % 65536 for number in missing)
            case SubmessageKind.HEARTBEAT:
                first, last = fields["first"], fields["last"]
                assert isinstance(first, int)
                assert isinstance(last, int)
                said, one, other = (fields["subject"],), first, last
            case SubmessageKind.WRITE_DATA | SubmessageKind.DATA:
                said, request = (fields["object"], fields["format"]), int(str(fields["request"]))
                one = len(self._octets)
                self._octets += bytes.fromhex(str(fields["sample"]))
                other = len(self._octets)
            case _:
                self._rare[len(self._head)] = fields, event.problem
        head = _Head(event.place, event.client, event.agent, event.kind, event.session, event.stream, said)
        number = self._heads.get(head)
        if number is None:
            number = self._heads[head] = len(self._by_number)
            self._by_number.append(head)
        self._head.append(number)
        self._sequence.append(_NONE if event.sequence is None else event.sequence)
        self._one.append(one)
        self._other.append(other)
        self._request.append(request)

    def event(self, number: int, packet: int, time: int, to_agent: bool) -> SubmessageEvent:
        head, sequence = self._by_number[self._head[number]], self._sequence[number]
        problem = ""
        if number in self._rare:
            fields, problem = self._rare[number]
        else:
            fields = self._fields(head, self._one[number], self._other[number], self._request[number])
        return SubmessageEvent(
            packet,
            head.place,
            time,
            head.client,
            head.agent,
            to_agent,
            head.kind,
            head.session,
            head.stream,
            None if sequence == _NONE else sequence,
            fields,
            problem,
        )

    def _fields(self, head: _Head, one: int, other: int, request: int) -> dict[str, Value]:
        if head.kind is SubmessageKind.ACKNACK:
            missing = [(one + bit) % 65536 for bit in range(16) if other >> bit & 1] if other else []
            return {"subject": head.said[0], "first": one, "missing": missing}
        if head.kind is SubmessageKind.HEARTBEAT:
            return {"subject": head.said[0], "first": one, "last": other}
        about, form = head.said
        sample = self._octets[one:other].hex()
        return {"request": request, "object": about, "format": form, "sample": sample}
