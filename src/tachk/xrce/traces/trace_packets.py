"""Captures of packets as traces: what DDS-XRCE streams have sent, acknowledged and lost, over time.

The columns of a client are named after its key, or its port where the capture does not hold its CREATE_CLIENT:
``client_AAAABBBB.to_agent.outstanding``; a stream other than 80 is named: ``to_agent_81``. Where one client is seen
at several ports of an Agent, because a relay was recorded on both sides, ``_at_9001`` follows its name.

The columns of all clients together have the names that the properties in queries/micro_xrce_dds.ta use.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property, partial
from pathlib import Path
from typing import Final

import numpy as np

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.time_units import NANOSECONDS
from tachk.recordings.traces.arrivals import arriving, no_arrivals, topic_of
from tachk.recordings.traces.trace import Trace, Values, cut_off_warning
from tachk.recordings.traces.trace_header import no_such_column
from tachk.xrce.events import DEFAULT_PORT
from tachk.xrce.packets import CaptureError, Numbers
from tachk.xrce.signals.changes import ChangeLog, SignalChanges
from tachk.xrce.signals.following import SITUATION
from tachk.xrce.signals.recorded import (
    CaptureSignals,
    ClientHistory,
    LongestWaits,
    StreamHistory,
    read_recorded,
    read_recorded_serial,
)
from tachk.xrce.signals.samples import TooManyUnread
from tachk.xrce.streams import SIGNALS
from tachk.xrce.transmission import Transmission
from tachk.xrce.transmissions import Capture, read_transmissions
from tachk.xrce.wire import FIRST_RELIABLE_STREAM

HOP_SIGNALS: Final = ("lost", "copies", "overtaken", "delay_ms")
"""The signals of all messages of a client, or of the Agent to it, so far: the number of lost ones, counted when they
were sent; of copies; of those that came after one that was sent later; and the delay of the last one that came, of
which `hop_changes` has nanoseconds."""

Direction = tuple[str, bool]
"""The key of a client, and whether it sends."""


def hop_changes(recording: Capture, packets: Numbers) -> Mapping[Direction, SignalChanges]:
    """The `HOP_SIGNALS` of each client whose relay was recorded on both sides.

    Args:
        packets: the number of the packet in each row.
    """
    sent: dict[Direction, list[Transmission]] = {}
    for one in recording.transmissions:
        link = recording.links[one.link]
        if link.relay is not None and link.key:
            sent.setdefault((link.key, one.to_agent), []).append(one)
    return {direction: _changes(ones, _RowOfPacket(packets)) for direction, ones in sent.items()}


class _RowOfPacket:
    """The row of a packet: its first one, or else that of the next packet that has one.

    Packets to a port have no row before a session is created there.
    """

    def __init__(self, packets: Numbers) -> None:
        self._packets, self._firsts = np.unique(packets, return_index=True)

    def __getitem__(self, packet: int) -> int | None:
        place = int(np.searchsorted(self._packets, packet))
        return int(self._firsts[place]) if place < len(self._firsts) else None


def _changes(sent: Iterable[Transmission], rows: _RowOfPacket) -> SignalChanges:
    happened: list[tuple[int, int, int, int]] = []  # row, lost, place in order of sending, delay
    for place, one in enumerate(sorted(sent, key=lambda transmission: transmission.packet)):
        moments = [(one.packet, 1, 0)] if one.is_lost else []
        moments += [(each.packet, -copy, each.time - one.sent) for copy, each in enumerate(one.arrivals or ())]
        for packet, what, delay in moments:
            row = rows[packet]
            if row is not None:  # otherwise no row is left that could hold it
                happened.append((row, what, place, delay))
    log = ChangeLog(len(HOP_SIGNALS))
    lost = copies = overtaken = delay = 0
    latest = -1
    for row, what, place, took in sorted(happened):
        if what > 0:
            lost += 1
        elif what < 0:
            copies += 1
        else:
            overtaken += place < latest
            latest = max(latest, place)
            delay = took
        log.note(row, (lost, copies, overtaken, delay))
    return log.take(0)


_UNIT = "s"

PROPERTIES: Final = {
    **{name: (name, False) for name in SITUATION},
    "tenthAtAgent": ("allToAgent", False),
    "tenthAtClient": ("allToClient", False),
    "marked": ("lost", True),
    "learned": ("unheard", True),
    "noticed": ("missing", True),
    "caughtUp": ("behind", True),
    "answered": ("waiting", True),
}
"""The subjects of the properties of the reliable stream, each as one of the `SITUATION`, and True if it is negated."""

WITH_HINDSIGHT: Final = (("unconfirmed.Open", "unconfirmed.Idle"), ("pending", "acknowledged"))
"""The subjects of the properties of single messages, of the Agent and of clients: which message waits longest is known
only when the capture is over."""


@dataclass(frozen=True, slots=True, eq=False)
class PacketRecording:
    """Attributes:
    signals: what gives the values of each column.
    warnings: as of a `Trace`.
    """

    name: str
    recorded: CaptureSignals
    signals: dict[str, Callable[[], Values]]
    unit: str = _UNIT
    warnings: tuple[str, ...] = ()

    @property
    def columns(self) -> tuple[str, ...]:
        return tuple(self.signals)

    def read(self, columns: Collection[str] | None = None) -> Trace:
        wanted = self.columns if columns is None else columns
        arrivals = arriving(wanted, self.columns)
        for column in wanted:
            if column in arrivals:
                raise no_arrivals(self.name, topic_of(column) or "", _instead(arrivals[column]))
            if column not in self.signals:
                raise no_such_column(column, self.columns, self.name)
        times = self.recorded.times
        start = int(times[0])
        return Trace(
            self.name,
            times - start,
            {column: self.signals[column]() for column in self.columns if column in wanted},
            int(times[-1]) - start,
            NANOSECONDS[_UNIT],
            _UNIT,
            Fraction(0),
            packets=self.recorded.packets,
            warnings=self.warnings,
        )


def _instead(columns: Sequence[str]) -> str:
    """The help for arrivals of columns: each packet gives all columns a value, so that every packet would be an arrival
    of all."""
    count = next((name for name in columns if name.endswith(".delivered")), columns[0])
    return f"write `change({count})`: a capture holds packets, and what they change"


def open_packets(path: Path, time: str | None, unit: str | None, ports: Sequence[int]) -> PacketRecording:
    """Reads a capture. Its times are in seconds since its first message to or from an Agent.

    Where no packet is from or for an Agent, its packets may hold the bytes of a serial line.

    Args:
        ports: of Agents; without any 8888, and each one to which a session is created; with one, it is a network.

    Raises UsageError, also where nothing is from or for these ports.
    """
    if time is not None or unit is not None:
        raise UsageError("a capture has its own times: it takes neither a time column nor a unit")
    again = _Again(path, ports)
    try:
        recorded = again.recorded(signals=False)
        if not len(recorded.times) and not ports:
            again = _Again(path, ports, serial=True)
            recorded = again.recorded(signals=False)
    except (CaptureError, TooManyUnread) as error:
        raise UsageError(f"{path}: {error}") from None
    except FileNotFoundError:
        raise UsageError(f"there is no file {path}") from None
    is_cut_off = recorded.problem.startswith("the file ends inside") and len(recorded.times) > 0
    if recorded.problem and not is_cut_off:
        raise UsageError(f"{path}: {recorded.problem}", f"tachk xrce decode {path} shows the packets before")
    if not len(recorded.times):
        listed = ", ".join(map(str, ports or (DEFAULT_PORT,)))
        raise UsageError(f"{path} has no packet to or from port {listed}", "give the port of the Agent with --port")
    warnings = (cut_off_warning(str(path), recorded.problem),) if is_cut_off else ()
    return PacketRecording(str(path), recorded, dict(_signals(recorded, again)), warnings=warnings)


class _Again:
    """The parts of a capture that are read on demand."""

    def __init__(self, path: Path, ports: Sequence[int], serial: bool = False) -> None:
        self._path, self._ports, self._serial = path, ports, serial

    def recorded(self, signals: bool) -> CaptureSignals:
        with self._path.open("rb") as stream:
            if self._serial:
                return read_recorded_serial(stream, signals)
            return read_recorded(stream, self._ports, signals)

    def transmissions(self) -> Capture:
        """The effects of a lossy hop on messages."""
        return read_transmissions(self._path, self._ports)

    @cached_property
    def streams(self) -> tuple[StreamHistory, ...]:
        """The streams with their signals."""
        return self.recorded(signals=True).streams


def _signals(recorded: CaptureSignals, again: _Again) -> Iterator[tuple[str, Callable[[], Values]]]:
    count = len(recorded.times)
    seen = Counter(name for name, _ in {(_name(one), one.agent.port) for one in recorded.clients})

    def place(one: StreamHistory | ClientHistory) -> str:
        return _name(one) + (f"_at_{one.agent.port}" if seen[_name(one)] > 1 else "")

    hops = cache(lambda: hop_changes(again.transmissions(), recorded.packets))
    for key in dict.fromkeys(one.key for one in recorded.clients if one.key and seen[_name(one)] > 1):
        for to_agent in (True, False):
            for number, signal in enumerate(HOP_SIGNALS):
                name = column_of(f"client_{key}", to_agent, FIRST_RELIABLE_STREAM, signal)
                yield name, partial(_hop, hops, (key, to_agent), number, count)
    for number, history in enumerate(recorded.streams):
        for signal in SIGNALS:
            yield (
                column_of(place(history), history.to_agent, history.stream, signal),
                partial(_values, again, number, signal, count),
            )
    for client in recorded.clients:
        yield f"{place(client)}.asleep", partial(_flag, client.changes, 0, count, False)
    for (is_open, is_idle), observed in zip(WITH_HINDSIGHT, recorded.observed, strict=True):
        yield is_open, partial(_open, observed, count)
        yield is_idle, partial(_idle, observed, count)
    for name, (signal, negated) in PROPERTIES.items():
        yield name, partial(_flag, recorded.situation, SITUATION.index(signal), count, negated)


def column_of(client: str, to_agent: bool, stream: int, signal: str) -> str:
    """The name of a column."""
    way = "to_agent" if to_agent else "from_agent"
    other = "" if stream == FIRST_RELIABLE_STREAM else f"_{stream:02X}"
    return f"{client}.{way}{other}.{signal}"


def _values(again: _Again, number: int, signal: str, count: int) -> Values:
    return again.streams[number].signal(signal, count).astype(np.uint8 if signal == "confirmed" else float)


def _hop(hops: Callable[[], Mapping[Direction, SignalChanges]], of: Direction, number: int, count: int) -> Values:
    changes = hops().get(of)
    values = np.zeros(count) if changes is None else changes.spread(number, count).astype(float)
    return values / 1e6 if HOP_SIGNALS[number] == "delay_ms" else values


def _open(observed: LongestWaits, count: int) -> Values:
    return observed.open(count).astype(np.uint8)


def _idle(observed: LongestWaits, count: int) -> Values:
    return observed.idle(count).astype(np.uint8)


def _flag(changes: SignalChanges, signal: int, count: int, negated: bool) -> Values:
    return changes.spread(signal, count).astype(np.uint8) ^ np.uint8(negated)


def _name(one: StreamHistory | ClientHistory) -> str:
    return f"client_{one.key or one.client.port}"
