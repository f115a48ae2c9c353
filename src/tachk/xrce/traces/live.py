"""A capture while it is made: rows as packets come, and rows that say that nothing has come.

Where no packet comes, the time of the capture goes on with a clock: from the time of the last packet by as much as has
passed since it was read, less what a packet may need from the network to here. So silence lets deadlines pass.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any, BinaryIO, Final, Protocol, cast

import numpy as np

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.exact_numbers import DIGITS
from tachk.recordings.traces.trace import Ticks, Values
from tachk.recordings.traces.trace_csv import Rows
from tachk.xrce.capture_decoder import CaptureDecoder
from tachk.xrce.messages import Endpoint
from tachk.xrce.packets import PCAP_HEADER, USER_LINKS, CaptureError, is_capture, link_of_pcap
from tachk.xrce.serial_line import Peeked, SerialDecoder
from tachk.xrce.signals.changes import SignalChanges
from tachk.xrce.signals.clients import Side, Way
from tachk.xrce.signals.following import GONE, SITUATION, RowBlock, SignalTracker
from tachk.xrce.signals.samples import TooManyUnread
from tachk.xrce.streams import SIGNALS
from tachk.xrce.traces.trace_packets import PROPERTIES, WITH_HINDSIGHT
from tachk.xrce.wire import FIRST_RELIABLE_STREAM

LATENESS: Final = 1_000_000_000
"""Nanoseconds that a packet may need from the network to the reader."""

_DECIMALS: Final = 9
_MOST_ROWS: Final = 1 << 16
"""Rows whose packets are known, for reports."""

_WITH_HINDSIGHT: Final = frozenset(chain.from_iterable(WITH_HINDSIGHT))
_OF_STREAM: Final = re.compile(
    rf"(?P<client>client_[0-9A-Za-z]+?)(?:_at_(?P<port>{DIGITS}))?\."
    rf"(?:(?P<way>to|from)_agent(?:_(?P<stream>[89A-F][0-9A-F]))?\.(?P<signal>{'|'.join(SIGNALS)})|asleep)"
)


class Arriving(Protocol):
    """The source of the bytes of a capture."""

    def read1(self, size: int, /) -> bytes | None:
        """The bytes that have come; empty at the end, None if nothing has come for a while."""
        ...

    def close(self) -> None: ...


def needs_hindsight(columns: Collection[str]) -> bool:
    """True if one of these columns is known only when the capture is over."""
    return any(name in _WITH_HINDSIGHT for name in columns)


@dataclass(slots=True, eq=False)
class _LiveColumn:
    """A column that is wanted, and its value in the last row.

    Attributes:
        situation: which one of the `SITUATION` it is, and whether negated; None for columns of a client.
        client, port, way, signal: of a column of a client; no way: whether it sleeps.
        side: to which client it was found to belong.
    """

    situation: tuple[int, bool] | None = None
    client: str = ""
    port: int | None = None
    way: Way | None = None
    signal: int = 0
    side: Side | None = None
    value: int = 0

    def spread(self, changes: SignalChanges | None, count: int) -> Values:
        """Its values in a block."""
        index, negated = (self.signal, False) if self.situation is None else self.situation
        if changes is None or not len(changes.rows):
            values = np.full(count, self.value, np.int64)
        else:
            values = changes.spread(index, count, self.value)
        self.value = int(values[-1])
        return (values != negated).astype(np.uint8) if self.situation is not None else values.astype(np.float64)


class LivePackets:
    """Attributes:
    name: as messages print it.
    unit: of its times.
    """

    unit = "s"
    _tracker: SignalTracker

    def __init__(self, name: str, stream: Arriving, ports: Sequence[int], clock: Callable[[], int]) -> None:
        """Args:
        ports: of Agents; without any 8888, and each one to which a session is created, or a serial line.
        clock: nanoseconds that never go back.
        """
        self.name = name
        self._decoder: CaptureDecoder | SerialDecoder | None = None
        self._ports = ports
        self._stream = stream
        self._clock = clock
        self._pruned_at = 0
        self._start: int | None = None
        self._reported = 0
        self._last_rows = np.zeros((2, 0), np.int64)

    def blocks(self, columns: Collection[str] | None, decimals: int) -> Iterator[Rows]:
        """Rows as they come, in seconds since the first message. Memory does not grow with the capture.

        Raises UsageError: for other columns than those of captures, for times that would be rounded, for what is no
        capture, or a damaged one.
        """
        wanted = {name: _column(name) for name in columns or ()}
        if decimals < _DECIMALS:
            raise UsageError("the times of captures have nine decimals", "leave out --decimals")
        self._tracker = SignalTracker(streams=any(column.way is not None for column in wanted.values()))
        packets, read_at = 0, self._clock()
        try:
            self._decoder = decoder = self._opened()
            for found in decoder.pieces():
                now = self._clock()
                self._tracker.push(found)
                if decoder.packets > packets:
                    packets, read_at = decoder.packets, now
                elif self._start is not None:
                    self._tracker.wait(decoder.time + now - read_at - LATENESS)
                block = self._tracker.take()
                waited = self._tracker.latest
                if self._start is None and len(block.times):
                    self._start = int(block.times[0])
                if self._start is not None and (len(block.times) or waited > self._reported):
                    yield self._rows(block, wanted, waited)
                if waited >= self._pruned_at + GONE:
                    self._pruned_at = waited
                    self._tracker.forget_gone()
            if self._start is None and isinstance(decoder, SerialDecoder):
                raise CaptureError("this is neither a pcap nor a pcapng capture, nor has it a message of a serial line")
        except (CaptureError, TooManyUnread) as error:
            raise UsageError(f"{self.name}: {error}") from None
        finally:
            self._stream.close()

    def _opened(self) -> CaptureDecoder | SerialDecoder:
        """The reader of the stream. A stream that does not begin as a capture holds the bytes of a serial line, and so
        does a capture with a link of the user."""
        stream = Peeked(cast("BinaryIO", self._stream), PCAP_HEADER)
        octets = cast("BinaryIO", stream)
        if is_capture(stream.begin) and (self._ports or link_of_pcap(stream.begin) not in USER_LINKS):
            return CaptureDecoder(octets, self._ports)
        return SerialDecoder(octets, damaged=False, clock=self._clock)

    def packets(self, times: Ticks) -> Ticks:
        """The numbers of the packets at these times in nanoseconds since the first message; 0 where there is none, or
        it is not known any more."""
        places = np.searchsorted(self._last_rows[0], times, side="right") - 1
        found = (
            self._last_rows[:, np.maximum(places, 0)] if self._last_rows.size else np.zeros((2, len(times)), np.int64)
        )
        return np.where((places >= 0) & (found[0] == times), found[1], 0)

    def _rows(self, block: RowBlock, wanted: dict[str, _LiveColumn], waited: int) -> Rows:
        """The rows of a block, and one that says that nothing has changed until now."""
        times, count = block.times, len(block.times)
        is_later = not count or waited > int(times[-1])
        values = {name: self._values(name, column, block, count) for name, column in wanted.items()}
        if is_later:
            times = np.append(times, waited)
            values = {name: _longer(one, _last(wanted[name])) for name, one in values.items()}
        self._reported = int(times[-1])
        assert self._start is not None
        rows = np.stack([block.times - self._start, block.packets])
        self._last_rows = np.concatenate([self._last_rows, rows], axis=1)[:, -_MOST_ROWS:]
        return Rows(times - self._start, values, _DECIMALS)

    def _values(self, name: str, column: _LiveColumn, block: RowBlock, count: int) -> Values:
        if not count:
            return _last(column)[:0]
        if column.situation is not None:
            return column.spread(block.situation, count)
        found: SignalChanges | None = None
        if column.way is None:
            candidates: list[tuple[Side, SignalChanges]] = list(block.sleeps)
        else:
            candidates = [(one.side, one.changes) for one in block.streams if one.way == column.way]
        for side, changes in candidates:
            if self._belongs(column, side):
                if column.side not in (None, side) and not column.side.forgotten:
                    raise UsageError(
                        f"{name}: the client is seen at several ports", f"say which: {column.client}_at_PORT"
                    )
                column.side, found = side, changes
        return column.spread(found, count)

    def _belongs(self, column: _LiveColumn, side: Side) -> bool:
        client, agent = (self._endpoint(number) for number in (side.client_endpoint, side.agent_endpoint))
        return column.client == f"client_{side.owner.key or client.port}" and column.port in (None, agent.port)

    def _endpoint(self, number: int) -> Endpoint:
        assert self._decoder is not None
        return self._decoder.endpoints[number]


def _longer(values: Values, more: Values) -> Values:
    longer: Values = np.concatenate([values, more])
    return longer


def _last(column: _LiveColumn) -> Values:
    """The value of a column in the last row."""
    none: Any = SignalChanges(np.zeros(0, np.int64), np.zeros((0, 1), np.int64))
    return column.spread(none, 1)


def _column(name: str) -> _LiveColumn:
    """The device or address of a name. Raises UsageError."""
    if name in PROPERTIES:
        signal, negated = PROPERTIES[name]
        return _LiveColumn(situation=(SITUATION.index(signal), negated))
    match = _OF_STREAM.fullmatch(name)
    if match is None:
        if name in _WITH_HINDSIGHT:
            raise UsageError(f"{name} is known only when the capture is over", "leave out this formula, or --live")
        help_ = did_you_mean(name, PROPERTIES) or f"known are {', '.join(PROPERTIES)}, and columns of clients"
        raise UsageError(f"captures have no column {name!r}", help_)
    port = None if match["port"] is None else int(match["port"])
    if match["way"] is None:
        return _LiveColumn(client=match["client"], port=port)
    stream = FIRST_RELIABLE_STREAM if match["stream"] is None else int(match["stream"], 16)
    return _LiveColumn(
        client=match["client"], port=port, way=(match["way"] == "to", stream), signal=SIGNALS.index(match["signal"])
    )
