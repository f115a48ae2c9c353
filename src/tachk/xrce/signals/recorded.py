"""A whole capture: its rows, and what they say of clients and streams."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from tachk.base.records import dataclass
from tachk.xrce.capture_decoder import CaptureDecoder
from tachk.xrce.messages import Endpoint
from tachk.xrce.packets import Numbers
from tachk.xrce.serial_line import SerialDecoder
from tachk.xrce.signals.changes import SignalChanges
from tachk.xrce.signals.clients import Side, Way
from tachk.xrce.signals.following import SITUATION, RowBlock, SignalTracker
from tachk.xrce.streams import SIGNALS


@dataclass(frozen=True, slots=True)
class StreamHistory:
    """One direction of a reliable stream, at one place.

    Attributes:
        client, agent: who talks.
        key: of the client, as its CREATE_CLIENT says; empty if that is not in the capture.
        to_agent: whether the client sends.
        stream: its id.
        changes: of the `SIGNALS`.
    """

    client: Endpoint
    agent: Endpoint
    key: str
    to_agent: bool
    stream: int
    changes: SignalChanges

    def signal(self, name: str, count: int) -> Numbers:
        """One of the `SIGNALS` in each of so many rows; 0 before anything is known."""
        return self.changes.spread(SIGNALS.index(name), count)


@dataclass(frozen=True, slots=True)
class ClientHistory:
    """A client at one place. ``changes``: of whether it is asleep."""

    client: Endpoint
    agent: Endpoint
    key: str
    changes: SignalChanges


@dataclass(frozen=True, slots=True)
class LongestWaits:
    """The messages of the Agent, or of clients, that waited longest for confirmation: if these are in time, all are.

    Attributes:
        waited: the rows in which the one was sent and confirmed that waited longest; None if another one has waited for
            longer until the end.
        waits: the row in which the first one was sent that is not confirmed at the end.
    """

    waited: tuple[int, int] | None
    waits: int | None

    def open(self, count: int) -> NDArray[np.bool_]:
        """In each row, whether one of them is on its way."""
        rows = np.zeros(count, np.bool_)
        if self.waited is not None:
            rows[self.waited[0] : self.waited[1]] = True
        if self.waits is not None:
            rows[self.waits :] = True
        return rows

    def idle(self, count: int) -> NDArray[np.bool_]:
        """In each row, whether none is, or one has just been confirmed."""
        rows = ~self.open(count)
        if self.waited is not None:
            rows[self.waited[1]] = True
        return rows


@dataclass(frozen=True, slots=True)
class CaptureSignals:
    """Attributes:
    times: nanoseconds since the epoch, one for each message to or from an Agent and for each client that counts as
        asleep from then on, not decreasing.
    packets: the number of the packet in the capture; 0 in rows without one.
    situation: changes of the `SITUATION`.
    streams: of each stream and direction, client by client.
    clients: each client, at each port at which it is seen.
    observed: the message of the Agent that is confirmed last after it was sent, and that of a client.
    problem: why the capture ends too early; empty if it does not.
    """

    times: Numbers
    packets: Numbers
    situation: SignalChanges
    streams: tuple[StreamHistory, ...]
    clients: tuple[ClientHistory, ...]
    observed: tuple[LongestWaits, LongestWaits]
    problem: str = ""


def read_recorded(stream: BinaryIO, ports: Iterable[int], signals: bool = True) -> CaptureSignals:
    """The signals of a capture. Raises CaptureError for a file that is not a capture.

    Args:
        ports: of Agents; without any 8888, and each one to which a session is created.
        signals: whether the changes of streams are wanted; without them, a fifth of the time is saved.
    """
    return _recorded(CaptureDecoder(stream, ports), signals)


def read_recorded_serial(stream: BinaryIO, signals: bool = True) -> CaptureSignals:
    """The signals of a capture of a serial line; frames that a receiver would drop are left out. Raises CaptureError
    for a file without bytes."""
    return _recorded(SerialDecoder(stream, damaged=False), signals)


def _recorded(decoder: CaptureDecoder | SerialDecoder, signals: bool) -> CaptureSignals:
    tracker = SignalTracker(streams=signals)
    blocks = []
    for found in decoder.pieces():
        tracker.push(found)
        blocks.append(tracker.take())
    joined = _Joined(blocks)
    ends = decoder.endpoints
    streams = tuple(
        StreamHistory(
            ends[side.client_endpoint],
            ends[side.agent_endpoint],
            side.owner.key,
            *way,
            joined.streams.get((side, way), _nothing(len(SIGNALS))),
        )
        for side in tracker.sides
        for way, stream in side.streams.items()
        if stream.begun
    )
    clients = tuple(
        ClientHistory(
            ends[side.client_endpoint],
            ends[side.agent_endpoint],
            side.owner.key,
            joined.sleeps.get(side, _nothing(1)),
        )
        for side in tracker.sides
    )
    observed = _observed(tracker, joined.times, False), _observed(tracker, joined.times, True)
    return CaptureSignals(joined.times, joined.packets, joined.situation, streams, clients, observed, decoder.problem)


def _observed(tracker: SignalTracker, times: Numbers, to_agent: bool) -> LongestWaits:
    waiting, waited = tracker.waiting(to_agent), tracker.longest[to_agent]
    if waiting is not None and (waited is None or int(times[-1]) - waiting.time >= waited.duration):
        waited = None
    return LongestWaits(
        None if waited is None else (waited.sent, waited.confirmed), None if waiting is None else waiting.row
    )


class _Joined:
    """Blocks one behind the other."""

    def __init__(self, blocks: Sequence[RowBlock]) -> None:
        nothing = np.zeros(0, np.int64)
        self.times = np.concatenate([nothing, *(block.times for block in blocks)])
        self.packets = np.concatenate([nothing, *(block.packets for block in blocks)])
        situation: list[SignalChanges] = []
        streams: dict[tuple[Side, Way], list[SignalChanges]] = {}
        sleeps: dict[Side, list[SignalChanges]] = {}
        first = 0
        for block in blocks:
            situation.append(_behind(first, block.situation))
            for one in block.streams:
                streams.setdefault((one.side, one.way), []).append(_behind(first, one.changes))
            for side, changes in block.sleeps:
                sleeps.setdefault(side, []).append(_behind(first, changes))
            first += len(block.times)
        self.situation = _joined([_nothing(len(SITUATION)), *situation])
        self.streams = {which: _joined(parts) for which, parts in streams.items()}
        self.sleeps = {side: _joined(parts) for side, parts in sleeps.items()}


def _nothing(width: int) -> SignalChanges:
    return SignalChanges(np.zeros(0, np.int64), np.zeros((0, width), np.int64))


def _behind(first: int, changes: SignalChanges) -> SignalChanges:
    return SignalChanges(changes.rows + first, changes.values)


def _joined(parts: Sequence[SignalChanges]) -> SignalChanges:
    return SignalChanges(np.concatenate([part.rows for part in parts]), np.concatenate([part.values for part in parts]))
