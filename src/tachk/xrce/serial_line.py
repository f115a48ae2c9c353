"""From the bytes of a serial line to submessages, piece by piece."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import BinaryIO, Final

import numpy as np

from tachk.base.records import replace
from tachk.xrce.messages import Endpoint, Messages
from tachk.xrce.packets import CaptureError, is_capture, read_packets
from tachk.xrce.serial_framing import AGENT_ADDRESS, FrameReader, SerialFrame
from tachk.xrce.submessages import Submessages, submessages

_PIECE: Final = 1 << 16
NO_ENDPOINT: Final = -1
"""The number of an endpoint that is not known."""


class SerialDecoder:
    """The traffic of a serial line: its bytes alone, or a capture whose packets hold them.

    One direction, or both if frames do not lie inside each other. Bytes alone have the times of a clock, 0 without one,
    and frames are counted instead of packets. Where reading gives None, as a pipe does that need not be waited for, a
    piece has no messages.

    Attributes:
        endpoints: whoever sent or received, by number.
        dropped: which messages of the last piece a receiver has dropped, though it is known what they were.
        packets: how many have been read.
        time: of the last one, in nanoseconds since the epoch.
        problem: why a capture ends too early; empty if it does not.
    """

    def __init__(
        self,
        stream: BinaryIO,
        damaged: bool = True,
        clock: Callable[[], int] = lambda: 0,
        repair: Callable[[SerialFrame], bytes | None] = lambda frame: None,
    ) -> None:
        """Args:
        damaged: give also frames that a receiver would drop.
        clock: nanoseconds, when bytes come alone.
        repair: what message the sender of a damaged frame has sent, if that is known.
        """
        self._stream = stream
        self._clock = clock
        self._damaged = damaged
        self._repair = repair
        self.dropped: frozenset[int] = frozenset()
        self._frames = FrameReader()
        self._numbers: dict[int, int] = {}
        self.endpoints: list[Endpoint] = []
        self.packets = 0
        self.time = 0
        self.problem = ""

    def pieces(self) -> Iterator[Submessages]:
        """The messages in frames. Raises CaptureError for a file without bytes."""
        stream = Peeked(self._stream)
        if not stream.begin:
            raise CaptureError("the file is empty")
        yield from self._captured(stream) if is_capture(stream.begin) else self._bare(stream)

    def _captured(self, stream: Peeked) -> Iterator[Submessages]:
        try:
            for packets in read_packets(stream):  # type: ignore[arg-type]
                rows: list[tuple[SerialFrame, int, int]] = []
                for entry in range(len(packets.times)):
                    self.packets, self.time = packets.first + entry, int(packets.times[entry])
                    start, size = int(packets.starts[entry]), int(packets.sizes[entry])
                    found = self._frames.push(packets.octets[start : start + size].tobytes())
                    rows += [(frame, self.packets, self.time) for frame in found]
                yield self._submessages(rows)
        except CaptureError as error:
            if not self.packets:
                raise
            self.problem = str(error)
        yield self._submessages([(frame, self.packets, self.time) for frame in self._frames.close()])

    def _bare(self, stream: Peeked) -> Iterator[Submessages]:
        while (octets := stream.read1(_PIECE)) != b"":
            yield self._counted(self._frames.push(octets or b""))
        yield self._counted(self._frames.close())

    def _counted(self, frames: list[SerialFrame]) -> Submessages:
        first, self.packets = self.packets + 1, self.packets + len(frames)
        if frames:
            self.time = self._clock()
        return self._submessages([(frame, first + number, self.time) for number, frame in enumerate(frames)])

    def _submessages(self, rows: list[tuple[SerialFrame, int, int]]) -> Submessages:
        if not self._damaged:
            rows = [row for row in rows if not row[0].problem]
        frames = [frame for frame, _, _ in rows]
        sent = [self._repair(frame) if frame.problem else None for frame in frames]
        self.dropped = frozenset(entry for entry, message in enumerate(sent) if message is not None)
        frames = [f if m is None else replace(f, message=m, problem="") for f, m in zip(frames, sent, strict=True)]
        octets = [b"" if frame.problem else frame.message for frame in frames]
        sizes = np.array([len(message) for message in octets], np.int64)
        to_agent = [frame.sender != AGENT_ADDRESS for frame in frames]
        clients = [frame.sender if sent else frame.receiver for frame, sent in zip(frames, to_agent, strict=True)]
        agents = [frame.receiver if sent else frame.sender for frame, sent in zip(frames, to_agent, strict=True)]
        return submessages(
            Messages(
                np.frombuffer(b"".join(octets), np.uint8),
                np.array([packet for _, packet, _ in rows], np.int64),
                np.array([time for _, _, time in rows], np.int64),
                np.array([self._number(address) for address in clients], np.int64),
                np.array([self._number(address) for address in agents], np.int64),
                np.array(to_agent, np.bool_),
                np.cumsum(sizes) - sizes,
                sizes,
                np.zeros(len(rows), np.int64),
                {entry: frame.problem for entry, frame in enumerate(frames) if frame.problem},
            )
        )

    def _number(self, address: int | None) -> int:
        if address is None:
            return NO_ENDPOINT
        if address not in self._numbers:
            self._numbers[address] = len(self.endpoints)
            self.endpoints.append(Endpoint("serial", address))
        return self._numbers[address]


class Peeked:
    """A stream whose first bytes have been looked at."""

    def __init__(self, stream: BinaryIO, size: int = 4) -> None:
        self._more = stream.read1 if hasattr(stream, "read1") else stream.read
        self.begin = b""
        while len(self.begin) < size and (octets := self._more(_PIECE)) != b"":
            self.begin += octets or b""
        self._first = self.begin

    def read1(self, size: int = -1) -> bytes | None:
        """The bytes that have come; empty at the end, None if nothing has come for a while."""
        if self._first:
            first, self._first = self._first, b""
            return first
        octets: bytes | None = self._more(size)
        return octets

    read = read1
