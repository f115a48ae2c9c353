"""What a capture says of reliable streams: numbers sent, acknowledged and missing, from messages alone.

Numbers have 16 bits on the wire and go round; here they go on. They begin again where a session is created.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from tachk.records import dataclass
from tachk.xrce import wire
from tachk.xrce.messages import Endpoint
from tachk.xrce.packets import Numbers
from tachk.xrce.reading import CaptureReading
from tachk.xrce.submessages import Submessages
from tachk.xrce.wire import Kind

SIGNALS: Final = ("sent", "acknowledged", "outstanding", "missing", "heartbeats", "repetitions")
"""Of a stream: how many messages have been sent, how many the last ACKNACK says have arrived without gap, how many no
ACKNACK has said that of, how many the last ACKNACK says are missing, how many HEARTBEATs and how many repetitions have
been sent."""

_CYCLE: Final = 1 << 16


@dataclass(frozen=True, slots=True)
class StreamHistory:
    """One direction of a reliable stream.

    Attributes:
        client, agent: who talks.
        key: of the client, as its CREATE_CLIENT says; empty if that is not in the capture.
        to_agent: whether the client sends.
        stream: its id.
        rows: where in `Streams.times` something changed.
        values: for each of these, the `SIGNALS` from then on.
    """

    client: Endpoint
    agent: Endpoint
    key: str
    to_agent: bool
    stream: int
    rows: Numbers
    values: NDArray[np.int64]

    def signal(self, name: str, count: int) -> Numbers:
        """One of the `SIGNALS` in each of so many rows; 0 before anything is known."""
        values = np.concatenate([[0], self.values[:, SIGNALS.index(name)]])
        return values[np.searchsorted(self.rows, np.arange(count), side="right")]


@dataclass(frozen=True, slots=True)
class Streams:
    """Attributes:
    times: nanoseconds since the epoch, one for each message to or from an Agent, not decreasing.
    packets: the number of its packet in the capture.
    histories: of each stream and direction, in the order in which they began.
    problem: why the capture ends too early; empty if it does not.
    """

    times: Numbers
    packets: Numbers
    histories: tuple[StreamHistory, ...]
    problem: str = ""


def read_streams(stream: BinaryIO, ports: Iterable[int]) -> Streams:
    """What a capture says of the reliable streams of clients. Raises CaptureError for what is no capture."""
    reading = CaptureReading(stream, ports)
    follower = _Follower()
    for found in reading.pieces():
        follower.push(found)
    return follower.streams(reading.endpoints, reading.problem)


class _Stream:
    """What is known of one direction of a stream."""

    def __init__(self) -> None:
        self.rows: list[int] = []
        self.values: list[tuple[int, ...]] = []
        self.heartbeats = 0
        self.repetitions = 0
        self.restart()

    def restart(self) -> None:
        self.sent = 0
        self.acknowledged = 0
        self.arrived = 0
        self.missing = 0

    def message(self, number: int) -> None:
        number = near(number, self.sent)
        if number < self.sent:
            self.repetitions += 1
        self.sent = max(self.sent, number + 1)

    def heartbeat(self, first: int, last: int) -> None:
        """The sender holds these: the last of them has been sent, even if the capture has not seen it."""
        self.heartbeats += 1
        first, last = near(first, self.sent), near(last, self.sent)
        if first <= last:
            self.sent = max(self.sent, last + 1)

    def acknack(self, first: int, bitmap: int) -> None:
        self.acknowledged = near(first, self.sent)
        self.arrived = max(self.arrived, self.acknowledged)
        self.missing = bitmap.bit_count()

    def note(self, row: int) -> None:
        outstanding = max(self.sent - self.arrived, 0)
        values = (self.sent, self.acknowledged, outstanding, self.missing, self.heartbeats, self.repetitions)
        if self.rows and self.rows[-1] == row:
            self.values[-1] = values
        else:
            self.rows.append(row)
            self.values.append(values)


def near(number: int, reference: int) -> int:
    """The number with these last 16 bits that is nearest to another one."""
    return reference + (number - reference + _CYCLE // 2) % _CYCLE - _CYCLE // 2


_Way = tuple[int, int, bool, int]
"""Client, Agent, whether the client sends, stream."""


class _Follower:
    """Follows all streams, message by message."""

    def __init__(self) -> None:
        self.times: list[Numbers] = []
        self.packets: list[Numbers] = []
        self._rows = 0
        self._latest = 0
        self._streams: dict[_Way, _Stream] = {}
        self._keys: dict[tuple[int, int], str] = {}

    def push(self, found: Submessages) -> None:
        messages = found.messages
        if not len(messages.times):
            return
        times = np.maximum(np.maximum.accumulate(messages.times), self._latest)
        self._latest = int(times[-1])
        self.times.append(times)
        self.packets.append(messages.packets)
        begins = (found.stream >= wire.FIRST_RELIABLE_STREAM) & (found.place == 0) & (found.kind >= 0)
        told = np.isin(found.kind, (Kind.ACKNACK, Kind.HEARTBEAT, Kind.CREATE_CLIENT))
        chosen = np.flatnonzero(begins | told)
        message = found.message[chosen]
        of_message = (messages.clients, messages.agents, messages.to_agent)
        of_submessage = (found.kind, found.stream, found.sequence, found.first, found.last, found.bitmap, found.subject)
        rows = zip(
            chosen.tolist(),
            (message + self._rows).tolist(),
            begins[chosen].tolist(),
            *(column[message].tolist() for column in of_message),
            *(column[chosen].tolist() for column in of_submessage),
            strict=True,
        )
        for entry, row, begun, client, agent, to_agent, kind, stream, number, first, last, bitmap, subject in rows:
            if begun:
                self._stream((client, agent, to_agent, stream)).message(number)
                self._stream((client, agent, to_agent, stream)).note(row)
            if kind == Kind.HEARTBEAT:
                held = self._stream((client, agent, to_agent, subject))
                held.heartbeat(first, last)
                held.note(row)
            elif kind == Kind.ACKNACK:
                acknowledged = self._stream((client, agent, not to_agent, subject))
                acknowledged.acknack(first, bitmap)
                acknowledged.note(row)
            elif kind == Kind.CREATE_CLIENT:
                self._created(client, agent, found.messages.octets[found.starts[entry] + 8 :][:4].tobytes(), row)
        self._rows += len(times)

    def _stream(self, way: _Way) -> _Stream:
        return self._streams.setdefault(way, _Stream())

    def _created(self, client: int, agent: int, key: bytes, row: int) -> None:
        self._keys[client, agent] = key.hex().upper()
        for way, stream in self._streams.items():
            if way[:2] == (client, agent):
                stream.restart()
                stream.note(row)

    def streams(self, endpoints: list[Endpoint], problem: str) -> Streams:
        histories = tuple(
            StreamHistory(
                endpoints[client],
                endpoints[agent],
                self._keys.get((client, agent), ""),
                to_agent,
                stream,
                np.array(followed.rows, np.int64),
                np.array(followed.values, np.int64).reshape(-1, len(SIGNALS)),
            )
            for (client, agent, to_agent, stream), followed in self._streams.items()
        )
        nothing = np.zeros(0, np.int64)
        return Streams(
            np.concatenate([nothing, *self.times]), np.concatenate([nothing, *self.packets]), histories, problem
        )
