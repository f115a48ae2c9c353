"""Transmissions of a capture as columns of numbers: each becomes an object when it is read, and not before."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache, cached_property
from typing import Final, overload

import numpy as np

from tachk.xrce import contents
from tachk.xrce.datagrams import Flags
from tachk.xrce.events import SubmessageEvent, events
from tachk.xrce.joined_submessages import places_in
from tachk.xrce.messages import Endpoint
from tachk.xrce.packets import Column, Numbers
from tachk.xrce.submessages import Submessages
from tachk.xrce.transmission import Transmission, TransmissionArrival
from tachk.xrce.wire import FIRST_RELIABLE_STREAM, SubmessageKind

_FEW: Final = 10_000
_BITS: Final[Mapping[SubmessageKind | None, int]] = {
    kind: 1 << number for number, kind in enumerate((*SubmessageKind, None))
}
"""By the kind of a submessage, None for one that is malformed."""


class PackedTransmissions(Sequence[Transmission]):
    """What a capture has of messages on their way, in the order in which they were sent.

    Attributes:
        links, to_agent, sent, packets: of each what `Transmission` says.
        stream, sequence: as in the header of the message; negative where that is cut.
        kinds: of its submessages, as bits.
        is_observed, is_lost, arrived: of each what `Transmission` says.
        counts: how many arrivals it has.
        arrivals: of all of them, one behind the other: the times and the packets.
        first_arrivals: where those of each begin.
        submessages: of all of them; ``first_events`` says where those of each begin, ``event_counts`` how many it has.
    """

    def __init__(self, rows: Numbers, arrivals: Numbers, found: Submessages, endpoints: list[Endpoint]) -> None:
        """Args:
        rows, arrivals: as in `tachk.xrce.transmissions.Transmissions`.
        found: their messages, in the order of their numbers.
        endpoints: those of the messages, by number.
        """
        self.submessages, self._endpoints = found, endpoints
        first = np.flatnonzero(np.diff(found.message, prepend=-1))
        counts = np.diff(np.append(first, len(found.message))).astype(np.int32)
        bits = np.bitwise_or.reduceat(_bits_of(found.kind), first) if len(first) else first
        columns: list[Column] = [found.messages.times, found.messages.packets, bits, first, counts]
        if (np.diff(rows[:, 0]) < 0).any():
            order = np.argsort(np.argsort(rows[:, 0]))
            columns = [column[order] for column in columns]
        self.sent, self.packets, self.kinds, self.first_events, self.event_counts = columns
        self.stream, self.sequence = found.stream[self.first_events], found.sequence[self.first_events]
        self.links, self.to_agent = rows[:, 1].copy(), rows[:, 2] != 0
        self.counts = np.maximum(rows[:, 3], 0)
        self.first_arrivals = np.cumsum(self.counts) - self.counts
        self.arrivals = arrivals
        self.is_observed, self.is_lost = rows[:, 3] >= 0, rows[:, 3] == 0
        self.arrived = self.sent.copy()
        some = self.counts > 0
        self.arrived[some] = arrivals[self.first_arrivals[some], 0]

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
        return (_PackedTransmission(self, row) for row in range(len(self)))

    def of_link(self, link: int) -> Numbers:
        """The rows of a link."""
        order, ends = self._by_link
        return order[ends[link] : ends[link + 1]]

    @cached_property
    def _by_link(self) -> tuple[Numbers, list[int]]:
        """All rows, those of one link behind those of another one, and where each link begins."""
        counts = np.bincount(self.links, minlength=int(self.links.max(initial=-1)) + 2)
        return np.argsort(self.links, kind="stable"), [0, *np.cumsum(counts).tolist()]

    @cached_property
    def is_reliable(self) -> Flags:
        """Whether the number of each is acknowledged."""
        found: Flags = self.stream >= FIRST_RELIABLE_STREAM
        return found

    @cached_property
    def samples(self) -> Column:
        """For each submessage a number that stands for its sample; see `tachk.xrce.contents`."""
        return contents.samples(self.submessages, self._endpoints)

    def samples_of(self, rows: Numbers, *kinds: SubmessageKind) -> tuple[Column, Numbers]:
        """The `samples` in the submessages of these kinds of some rows, and the row of each."""
        numbers = places_in(self.first_events[rows], self.event_counts[rows])
        chosen = np.isin(self.submessages.kind[numbers], kinds)
        return self.samples[numbers[chosen]], np.repeat(rows, self.event_counts[rows])[chosen]

    def contents(self, rows: Numbers) -> Column:
        """For each of some rows a number that stands for what it says, and for its way."""
        counts = self.event_counts[rows]
        ways = np.repeat(2 * self.links[rows] + self.to_agent[rows], counts)
        entries = places_in(self.first_events[rows], counts)
        return contents.joined_contents(contents.contents(self.submessages, entries, self.samples, ways), counts)

    @property
    def last_time(self) -> int:
        """When the last thing happens: a transmission that does not arrive, or the last arrival of another one."""
        some = self.counts > 0
        times = self.sent.copy()
        times[some] = self.arrivals[(self.first_arrivals + self.counts)[some] - 1, 0]
        return int(times.max()) if len(times) else 0

    def having(self, rows: Numbers, *kinds: SubmessageKind) -> Flags:
        """Which of some rows have a submessage of one of these kinds."""
        found: Flags = self.kinds[rows] & sum(_BITS[kind] for kind in kinds) != 0
        return found

    def wants_answer(self, rows: Numbers) -> Flags:
        """Which of some rows a receiver that is awake answers: messages with a number that is acknowledged, and
        HEARTBEATs."""
        return self.is_reliable[rows] | self.having(rows, SubmessageKind.HEARTBEAT)

    def rows(
        self, link: int | None = None, to_agent: bool | None = None, kinds: Iterable[SubmessageKind] = ()
    ) -> Numbers:
        """Those of a link, of a way, with a submessage of one of these kinds; without any of all."""
        rows = np.arange(len(self)) if link is None else self.of_link(link)
        if to_agent is not None:
            rows = rows[self.to_agent[rows] == to_agent]
        return rows[self.having(rows, *kinds)] if kinds else rows

    def where(
        self,
        link: int | None = None,
        to_agent: bool | None = None,
        kinds: frozenset[SubmessageKind] | None = None,
    ) -> Iterator[Transmission]:
        """Those of a link, of a way, with a submessage of one of these kinds."""
        rows = self.rows(link, to_agent, kinds or ())
        for first in range(0, len(rows), _FEW):
            for row in rows[first : first + _FEW].tolist():
                yield _PackedTransmission(self, row)

    def arrivals_of(self, row: int) -> tuple[TransmissionArrival, ...] | None:
        if not self.is_observed[row]:
            return None
        first = int(self.first_arrivals[row])
        places = self.arrivals[first : first + int(self.counts[row])].tolist()
        return tuple([TransmissionArrival(time, packet) for time, packet in places])

    def events_of(self, row: int) -> tuple[SubmessageEvent, ...]:
        first = int(self.first_events[row])
        return tuple(events(self.submessages, self._endpoints, np.arange(first, first + int(self.event_counts[row]))))


def _bits_of(kinds: Column) -> Column:
    table = np.zeros(257, np.int32)
    for kind, bit in _BITS.items():
        table[-1 if kind is None else kind] = bit
    return table[kinds]


@cache
def _kinds_of(bits: int) -> frozenset[SubmessageKind | None]:
    return frozenset(kind for kind, bit in _BITS.items() if bits & bit)


class _PackedTransmission:
    """One of `PackedTransmissions`, by its number."""

    __slots__ = ("_row", "_table")

    def __init__(self, table: PackedTransmissions, row: int) -> None:
        self._table, self._row = table, row

    @property
    def link(self) -> int:
        return int(self._table.links[self._row])

    @property
    def to_agent(self) -> bool:
        return bool(self._table.to_agent[self._row])

    @property
    def sent(self) -> int:
        return int(self._table.sent[self._row])

    @property
    def packet(self) -> int:
        return int(self._table.packets[self._row])

    @property
    def arrivals(self) -> tuple[TransmissionArrival, ...] | None:
        return self._table.arrivals_of(self._row)

    @property
    def events(self) -> tuple[SubmessageEvent, ...]:
        return self._table.events_of(self._row)

    @property
    def kinds(self) -> frozenset[SubmessageKind | None]:
        return _kinds_of(int(self._table.kinds[self._row]))

    @property
    def is_reliable(self) -> bool:
        return bool(self._table.is_reliable[self._row])

    @property
    def is_observed(self) -> bool:
        return bool(self._table.is_observed[self._row])

    @property
    def is_lost(self) -> bool:
        return bool(self._table.is_lost[self._row])

    @property
    def arrived(self) -> int:
        return int(self._table.arrived[self._row])

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _PackedTransmission) and (self._row, self._table) == (other._row, other._table)

    def __hash__(self) -> int:
        return hash((self._row, id(self._table)))
