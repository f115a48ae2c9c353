"""Events of a long capture as columns of numbers, which take a tenth of the memory. Each is made when it is read."""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Sequence
from fractions import Fraction
from operator import eq
from typing import Final, overload

import numpy as np
from numpy.typing import NDArray

from tachk.recordings.conformance.events import Cell, RecordedEvent
from tachk.xrce.conformance.payloads import BATCH, READER
from tachk.xrce.objects import Numbering
from tachk.xrce.packets import Numbers

_NOTHING: Final = -(2**62)
"""The value of a cell that is not there."""
_PIECE: Final = 10_000
_OPTIONAL, _INFERRED = 1, 2


class EventColumns:
    """Collects events in any order.

    Attributes:
        names, kinds: the events and the kinds of messages that there are.
    """

    def __init__(self) -> None:
        self.names: dict[str, int] = {}
        self.kinds: dict[str, int] = {}
        self._times, self._packets = array("q"), array("q")
        self._codes = array("i")
        self._numbers, self._details = array("q"), array("q")
        self._after, self._passes = array("q"), array("i")
        self._about = array("i")

    def __len__(self) -> int:
        return len(self._times)

    def add(
        self,
        time: int,
        packet: int,
        name: str,
        client: int,
        detail: int | None = None,
        link: int = -1,
        kind: str = "",
        number: int = 0,
        after: int = -1,
        optional: bool = False,
        inferred: bool = False,
        passes: int = -1,
        about: int = -1,
    ) -> None:
        """Adds an event. Without a link it has no cells but its client, and its detail if it has one.

        Args:
            client: the number of its link in the capture: that of the client may not be known yet.
            link: 0 from the client, 1 to it.
            after: how many events were added before that which comes before it.
            about: the topic or the data reader that the detail is about, as of a `Payload`.
        """
        self._times.append(time)
        self._packets.append(packet)
        flags = optional * _OPTIONAL + inferred * _INFERRED
        spoken = self.kinds.setdefault(kind, len(self.kinds)) if kind else 0
        known = self.names.setdefault(name, len(self.names))
        self._codes.extend((known << 8 | spoken << 4 | (link + 1) << 2 | flags, client))
        self._numbers.append(number)
        self._details.append(_NOTHING if detail is None else detail)
        self._after.append(after)
        self._passes.append(passes)
        self._about.append(about)

    def sorted(self, clients: Sequence[int], numbering: Numbering) -> PackedEvents:
        """The events in the order of their times and packets.

        Args:
            clients: the number of the client of each link.
            numbering: of topics and readers.
        """
        times, packets = (np.frombuffer(each, np.int64) for each in (self._times, self._packets))
        order = np.lexsort((packets, times))
        place = np.empty(len(order), np.int32)
        place[order] = np.arange(len(order), dtype=np.int32)
        after = np.frombuffer(self._after, np.int64)
        behind = np.where(after >= 0, place[after], -1).astype(np.int32)
        codes, links = np.frombuffer(self._codes, np.int32).reshape(-1, 2).T
        owners = np.array([*clients, 0], np.int32)[links]
        return PackedEvents(
            tuple(self.names),
            tuple(self.kinds),
            (
                times[order],
                packets[order],
                codes[order],
                owners[order],
                np.frombuffer(self._numbers, np.int64)[order],
                self._numbered(links, numbering)[order],
                behind[order],
                np.frombuffer(self._passes, np.int32)[order],
            ),
        )

    def _numbered(self, links: NDArray[np.int32], numbering: Numbering) -> Numbers:
        """The details, with the numbers of topics and readers."""
        details = np.frombuffer(self._details, np.int64)
        if numbering.is_plain:
            return details
        details, about = details.copy(), np.frombuffer(self._about, np.int32)
        sampled = np.flatnonzero((about >= 0) & (details >= 0))
        topics = about[sampled]
        more, first = np.divmod(details[sampled], BATCH)
        first = (first + np.array(numbering.before)[topics]) * numbering.topics
        details[sampled] = more * BATCH + first + np.array(numbering.of_topics)[topics]
        for (link, reader), number in numbering.of_readers.items():
            read = np.flatnonzero((about == reader) & (links == link) & (details < 0))
            form = -details[read] // READER
            details[read] -= READER * (number + form * (numbering.readers - 1))
        return details


class PackedEvents(Sequence[RecordedEvent]):
    """Attributes:
    names, kinds: by number, the events and the kinds of messages that there are.
    columns: times, packets, codes (name, kind, direction, flags), clients, numbers, details, numbers of events before,
        places that are passed.
    """

    def __init__(
        self, names: Sequence[str], kinds: Sequence[str], columns: tuple[NDArray[np.int32] | Numbers, ...]
    ) -> None:
        self.names, self.kinds = names, kinds
        self._columns = columns

    def __len__(self) -> int:
        return len(self._columns[0])

    @overload
    def __getitem__(self, number: int) -> RecordedEvent: ...
    @overload
    def __getitem__(self, number: slice) -> tuple[RecordedEvent, ...]: ...
    def __getitem__(self, number: int | slice) -> RecordedEvent | tuple[RecordedEvent, ...]:
        if isinstance(number, slice):
            return tuple(self._made(number))
        place = range(len(self))[number]
        return next(self._made(slice(place, place + 1)))

    def __iter__(self) -> Iterator[RecordedEvent]:
        for first in range(0, len(self), _PIECE):
            yield from self._made(slice(first, first + _PIECE))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and len(self) == len(other) and all(map(eq, self, other))

    def __hash__(self) -> int:
        return hash(tuple(column.tobytes() for column in self._columns))

    def _made(self, part: slice) -> Iterator[RecordedEvent]:
        for row in zip(*(column[part].tolist() for column in self._columns), strict=True):
            time, packet, code, client, number, detail, after, passes = row
            cells: dict[str, Cell] = {"client": client}
            if code & 12:
                cells["link"] = 2 * client + (code >> 2 & 3) - 1
                cells["kind"] = self.kinds[code >> 4 & 15]
                cells["number"] = number
            if detail != _NOTHING:
                cells["detail"] = detail
            yield RecordedEvent(
                Fraction(time),
                self.names[code >> 8],
                cells,
                f"packet {packet}",
                None if after < 0 else after,
                bool(code & _OPTIONAL),
                bool(code & _INFERRED),
                None if passes < 0 else passes,
            )
