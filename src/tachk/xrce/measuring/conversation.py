"""A reliable stream in one direction, as its sender sees it: messages, answers and missing acknowledgements.

All that happens is in columns of numbers, one entry a moment: a long capture has millions of them.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from enum import IntEnum
from typing import Any, Final

import numpy as np

from tachk.base.records import dataclass
from tachk.xrce.datagrams import Flags
from tachk.xrce.joined_submessages import places_in
from tachk.xrce.measuring.quantity import PackedSamples, PacketPlace, packed
from tachk.xrce.packed_transmissions import PackedTransmissions
from tachk.xrce.packets import Column, Numbers
from tachk.xrce.streams import nearest_number
from tachk.xrce.transmissions import Capture
from tachk.xrce.wire import FIRST_RELIABLE_STREAM, SubmessageKind

MILLISECOND: Final = 1e6
"""Nanoseconds."""


class MomentKind(IntEnum):
    """A message of the stream leaves, or a HEARTBEAT about it; or something comes in."""

    SENT = 0
    HEARTBEAT = 1
    CAME = 2


@dataclass(frozen=True, slots=True)
class Conversation:
    """What happens at the sender of a stream; an entry for each moment in every column from ``times`` on.

    Attributes:
        file: the name of the capture.
        link: the index of the link in its recording.
        from_client: whether the client sends the stream.
        stream: its id.
        transmissions: those of the capture.
        end: when the capture ends, in nanoseconds since the epoch.
        times: when it is, in nanoseconds since the epoch; in this order.
        kinds: a `MomentKind`.
        rows: the numbers of the transmissions.
        numbers: of what is SENT its number, which goes on at 65536; of what CAME and answers the first number that is
            not acknowledged.
        again: whether what is SENT left before.
        answers: whether what CAME has an ACKNACK about the stream.
        before, unacknowledged: how many messages were unacknowledged before this moment, and how many are now.
    """

    file: str
    link: int
    from_client: bool
    stream: int
    transmissions: PackedTransmissions
    end: int
    times: Numbers
    kinds: Column
    rows: Column
    numbers: Column
    again: Flags
    answers: Flags
    before: Column
    unacknowledged: Column

    def packets(self, moments: Numbers | Flags) -> Numbers:
        """The numbers of the packets of some moments."""
        return self.transmissions.packets[self.rows[moments]]

    def place(self, moment: int) -> PacketPlace:
        return PacketPlace(self.file, int(self.transmissions.packets[self.rows[moment]]))

    def wait(self, earlier: int, later: int) -> float:
        """The milliseconds between two moments."""
        return int(self.times[later] - self.times[earlier]) / MILLISECOND

    def between(self, earlier: Numbers, later: Numbers) -> PackedSamples:
        """The milliseconds between moments."""
        waits = (self.times[later] - self.times[earlier]) / MILLISECOND
        return packed(self.file, waits, self.packets(earlier), self.packets(later))


def conversations(file: str, recording: Capture) -> Iterator[Conversation]:
    """Every stream of a capture in each direction in which messages of it are sent."""
    for link in range(len(recording.links)):
        for from_client in (True, False):
            end = _SendingEnd(file, recording, link, from_client)
            for stream in end.streams():
                yield end.conversation(stream)


class _SendingEnd:
    """One end of a link, with what leaves and what comes in there in the order of times.

    Attributes:
        ours: the rows of the link.
        entry: for each that leaves or comes in its place in ``ours``; what comes in several times is there as often.
        times: of each.
        owner, event: of all submessages of the link the place in ``ours``, and the number.
    """

    def __init__(self, file: str, recording: Capture, link: int, from_client: bool) -> None:
        self.file, self.recording, self.link, self.from_client = file, recording, link, from_client
        sent = recording.transmissions
        self.ours = sent.of_link(link)
        self.own = sent.to_agent[self.ours] == from_client
        arrives = ~self.own & sent.is_observed[self.ours]
        counts = np.where(arrives, sent.counts[self.ours], 1)
        entry = np.repeat(np.arange(len(self.ours), dtype=np.int32), counts)
        times = sent.sent[self.ours][entry]
        places = places_in(sent.first_arrivals[self.ours[arrives]], sent.counts[self.ours[arrives]])
        times[arrives[entry]] = sent.arrivals[places, 0]
        order = np.argsort(times, kind="stable")
        self.entry, self.times = entry[order], times[order]
        self.event = places_in(sent.first_events[self.ours], sent.event_counts[self.ours])
        self.owner = np.repeat(np.arange(len(self.ours), dtype=np.int32), sent.event_counts[self.ours])

    def streams(self) -> list[int]:
        """The reliable ones of which messages leave."""
        streams = self.recording.transmissions.stream[self.ours[self.own]]
        return [int(stream) for stream in np.unique(streams[streams >= FIRST_RELIABLE_STREAM])]

    def conversation(self, stream: int) -> Conversation:
        sent, entry, event = self.recording.transmissions, self.entry, self.event
        own = self.own[entry]
        rows = self.ours[entry]
        leaves = own & (sent.stream[rows] == stream) & (sent.sequence[rows] >= 0)
        begins = own & sent.having(rows, SubmessageKind.CREATE_CLIENT)
        about = sent.submessages.subject[event] == stream
        beats = np.zeros(len(self.ours), np.bool_)
        beats[self.owner[about & (sent.submessages.kind[event] == SubmessageKind.HEARTBEAT)]] = True
        acknacks = about & (sent.submessages.kind[event] == SubmessageKind.ACKNACK)
        counts = np.bincount(self.owner[acknacks], minlength=len(self.ours))
        answered = np.where(own, 0, counts[entry])
        firsts = sent.submessages.first[event[acknacks]][places_in((np.cumsum(counts) - counts)[entry], answered)]

        at = np.concatenate(
            [np.flatnonzero(begins), np.flatnonzero(leaves), np.repeat(np.arange(len(entry)), answered)]
        )
        order = np.argsort(at, kind="stable")
        what = np.repeat(
            np.array([_BEGINS, _LEAVES, _ANSWERED], np.int8), [int(begins.sum()), int(leaves.sum()), len(firsts)]
        )
        said = np.concatenate([np.zeros(int(begins.sum()), np.int32), sent.sequence[rows[leaves]], firsts])
        numbers, again, outstanding = _followed(what[order], said[order])
        steps = np.bincount(at, minlength=len(entry))
        done = np.cumsum(steps)

        beat = own & beats[entry]
        moment = np.repeat(np.arange(len(entry)), np.where(own, leaves.astype(np.int64) + beat, 1))
        second = np.diff(moment, prepend=-1) == 0
        kinds = np.where(
            own[moment], np.where(leaves[moment] & ~second, MomentKind.SENT, MomentKind.HEARTBEAT), MomentKind.CAME
        )
        last = done[moment]
        return Conversation(
            self.file,
            self.link,
            self.from_client,
            stream,
            sent,
            self.recording.end,
            self.times[moment],
            kinds.astype(np.int8),
            rows[moment].astype(np.int32),
            numbers[last],
            again[last] & (kinds == MomentKind.SENT),
            (kinds == MomentKind.CAME) & (steps[moment] > 0),
            outstanding[last - steps[moment]],
            outstanding[last],
        )


_BEGINS, _LEAVES, _ANSWERED = range(3)
_FEW: Final = 100_000


def rows_of(*columns: Column) -> Iterator[tuple[Any, ...]]:
    """Entries of columns, one by one; not all of them become Python's numbers at once."""
    for first in range(0, len(columns[0]), _FEW):
        yield from zip(*(column[first : first + _FEW].tolist() for column in columns), strict=True)


def _followed(what: Column, said: Column) -> tuple[Column, Flags, Column]:
    """Follows a stream step by step: a session begins, a message with this number leaves, an ACKNACK with this first
    number comes.

    Returns the numbers, which go on at 65536, whether each is less than that of the next new message, and how many
    messages are unacknowledged then; an entry for the time before all steps comes first.
    """
    numbers, again, outstanding = array("i", [0]), bytearray(1), array("i", [0])
    sent = acknowledged = 0
    for step, last_bits in rows_of(what, said):
        number, before = nearest_number(last_bits, sent), sent
        if step == _BEGINS:
            sent = acknowledged = 0
        elif step == _LEAVES:
            sent = max(sent, number + 1)
        else:
            acknowledged = max(acknowledged, min(number, sent))
        numbers.append(number)
        again.append(number < before)
        outstanding.append(max(sent - acknowledged, 0))
    return (
        np.frombuffer(numbers, np.int32),
        np.frombuffer(again, np.bool_),
        np.frombuffer(outstanding, np.int32),
    )
