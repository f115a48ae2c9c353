"""Makes a long capture of a short one: the same two clients, with more samples.

    python -m bench.long_capture CAPTURE.pcap OUT.pcap [--samples 2500] [--pace 20] [--lose 2] [--without N] [--seed 1]

CAPTURE has both sides of a relay between eProsima's Agent, a client that writes one sample at a time, and one that
reads them. Before its first DELETE more samples are written, answered and handed on as these programs do, with delays
drawn at random; of the new messages to the Agent the relay loses some per cent, which the client then repeats. Nobody
has recorded this: it is there to measure speed with. `--without N` leaves out the N-th message of the publisher from
the end, with all that shows it: nobody sent it, though what followed was sent. `--drop N` leaves out the N-th packet
from the end.
"""

from __future__ import annotations

import argparse
import struct
from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import NamedTuple

from tachk.xrce.packets import read_packets
from tachk.xrce.transmissions import read_transmissions
from tachk.xrce.wire import SubmessageKind

_HEADERS = 42
"""Bytes of Ethernet, IPv4 and UDP."""
_PORTS = slice(34, 38)
_MILLISECOND = 1_000_000


class Packet(NamedTuple):
    time: int
    octets: bytes


class Hops(NamedTuple):
    """The same message before and behind the relay, as a pattern for others."""

    before: bytes
    behind: bytes


def packets_of(path: Path) -> list[Packet]:
    found: list[Packet] = []
    with path.open("rb") as stream:
        for piece in read_packets(stream):
            rows = zip(piece.times.tolist(), piece.starts.tolist(), piece.sizes.tolist(), strict=True)
            found += [Packet(time, piece.octets[at : at + size].tobytes()) for time, at, size in rows]
    return found


def written(packets: list[Packet], path: Path) -> None:
    header = struct.pack("<IHHiIII", 0xA1B23C4D, 2, 4, 0, 0, 65535, 1)
    rows = (
        struct.pack("<IIII", *divmod(packet.time, 1_000_000_000), len(packet.octets), len(packet.octets))
        + packet.octets
        for packet in packets
    )
    path.write_bytes(header + b"".join(rows))


class Prolonged:
    """Attributes:
    added: the new packets.
    time: of the next sample.
    number: of the next message to the Agent; ``handed`` of the next one to the reader.
    """

    def __init__(self, path: Path, random: Random, lose: float) -> None:
        self.random, self.lose = random, lose
        self.packets = packets_of(path)
        found = read_transmissions(path)
        whole = [one for one in found.transmissions if one.arrivals]
        last = {
            (one.to_agent, event.kind): one
            for one in whole
            for event in one.events
            if event.kind is not SubmessageKind.DELETE
        }
        self.end = (
            min(one.packet for one in whole if any(event.kind is SubmessageKind.DELETE for event in one.events)) - 1
        )
        write, handed = last[True, SubmessageKind.WRITE_DATA], last[False, SubmessageKind.DATA]
        own = [one for one in whole if one.link == write.link and one.packet > write.packet]
        answer = next(one for one in own if not one.to_agent and one.events[0].kind is SubmessageKind.ACKNACK)
        confirmation = last[True, SubmessageKind.ACKNACK]
        self.write, self.handed, self.answer, self.confirmation = (
            Hops(self.packets[one.packet - 1].octets, self.packets[one.arrivals[0].packet - 1].octets)
            for one in (write, handed, answer, confirmation)
            if one.arrivals
        )
        self.number = (write.events[0].sequence or 0) + 1
        self.to_reader = (handed.events[0].sequence or 0) + 1
        self.expected = self.number
        self.waiting: set[int] = set()
        self.last: dict[bytes, tuple[int, int]] = {}
        self.samples = self.number
        self.time = self.packets[self.end - 1].time
        self.added: list[Packet] = []

    def sample(self, pace: int) -> None:
        """The client writes one more sample; of those that were lost the Agent hears with it."""
        self.time += pace + self.random.randrange(_MILLISECOND // 5)
        number, self.number = self.number, self.number + 1
        answered = self._message(self.time, number, self.expected == number and self.random.random() < self.lose)
        if answered is not None and self.expected < number:
            for again in (number - 1, number):
                answered += 60_000
                self._message(answered, again, False)

    def _message(self, time: int, number: int, lost: bool) -> int | None:
        """A message of the client, and what comes of it. Returns when its ACKNACK is back; None if it was lost."""
        arrived = self._sent(time, self._numbered(self.write, number, number), lost)
        if lost:
            return None
        self.waiting.add(number)
        moment = arrived + self._short()
        pushed = []
        while self.expected in self.waiting:
            pushed.append(self.expected)
            self.expected += 1
        missing = sum(1 << (n - self.expected) for n in range(self.expected, number) if n not in self.waiting)
        back = self._sent(moment, self._acknack(self.answer, self.expected, missing), False)
        for each in pushed:
            moment += self._short()
            got = self._sent(moment, self._numbered(self.handed, self.to_reader, each), False)
            self.to_reader += 1
            self._sent(got + self._short(), self._acknack(self.confirmation, self.to_reader, 0), False)
        return back + self._short()

    def _short(self) -> int:
        return self.random.randrange(50_000, 200_000)

    def _sent(self, time: int, hops: Hops, lost: bool) -> int:
        way = hops.before[_PORTS]
        left, came = self.last.get(way, (0, 0))
        time = max(time, left + 1000)
        arrived = max(time + self.random.randrange(100_000, 400_000), came + 1000)
        self.last[way] = time, arrived
        self.added.append(Packet(time, hops.before))
        if not lost:
            self.added.append(Packet(arrived, hops.behind))
        return arrived

    def _numbered(self, like: Hops, number: int, sample: int) -> Hops:
        """A message that carries a sample: its number is in the header, the sample begins with one of its own."""
        at = _HEADERS + 2
        start = _HEADERS + 12
        return Hops(
            *(
                octets[:at]
                + struct.pack("<H", number % 65536)
                + octets[at + 2 : start]
                + struct.pack("<I", sample)
                + octets[start + 4 :]
                for octets in like
            )
        )

    @staticmethod
    def _acknack(like: Hops, first: int, missing: int) -> Hops:
        at = _HEADERS + 8
        content = struct.pack("<HBB", first % 65536, missing >> 8, missing & 255)
        return Hops(*(octets[:at] + content + octets[at + 4 :] for octets in like))

    def whole(self) -> Iterator[Packet]:
        """All packets; those behind the new ones come later by as much as these took."""
        shift = max([packet.time for packet in self.added], default=0) - self.packets[self.end - 1].time
        yield from self.packets[: self.end]
        yield from sorted(self.added)
        for packet in self.packets[self.end :]:
            yield Packet(packet.time + shift, packet.octets)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("capture", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--samples", type=int, default=2500)
    parser.add_argument("--pace", type=float, default=20, help="milliseconds between two samples")
    parser.add_argument("--lose", type=float, default=0, help="per cent of the new messages to the Agent")
    parser.add_argument("--without", type=int, default=0)
    parser.add_argument("--drop", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    made = Prolonged(asked.capture, Random(asked.seed), asked.lose / 100)
    for _ in range(asked.samples):
        made.sample(round(asked.pace * _MILLISECOND))
    packets = list(made.whole())
    if asked.drop:
        del packets[-asked.drop]
    written(packets, asked.out)
    if asked.without:
        found = read_transmissions(asked.out).transmissions
        gone = [one for one in found if any(event.kind is SubmessageKind.WRITE_DATA for event in one.events)][
            -asked.without
        ]
        out = {gone.packet, *(arrival.packet for arrival in gone.arrivals or ())}
        written([packet for number, packet in enumerate(packets, 1) if number not in out], asked.out)
    print(f"{asked.out}: {len(packets)} packets")


if __name__ == "__main__":
    main()
