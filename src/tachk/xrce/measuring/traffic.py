"""Round trips, repairs, pace and windows of streams; losses, copies, overtaking and delays of links."""

from __future__ import annotations

from array import array
from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from tachk.xrce.datagrams import Flags
from tachk.xrce.joined_submessages import places_in
from tachk.xrce.measuring.conversation import MILLISECOND, Conversation, MomentKind, rows_of
from tachk.xrce.measuring.quantity import (
    Confidence,
    Observation,
    PackedSamples,
    Quantity,
    QuantityUnit,
    gathered,
    packed,
    packed_groups,
    seen,
)
from tachk.xrce.packed_transmissions import PackedTransmissions
from tachk.xrce.packets import Numbers
from tachk.xrce.transmissions import Capture
from tachk.xrce.wire import SubmessageKind

_NEVER: Final = 2**62
_SAMPLES: Final = (SubmessageKind.WRITE_DATA, SubmessageKind.DATA)
_SMALLEST_HISTORY: Final = 4
_AT_ONCE: Final = 5e6
"""Nanoseconds within which a sender that has waited for room sends on."""


def round_trips(conversation: Conversation) -> PackedSamples:
    """From a message that is sent once to the first ACKNACK that says that it has arrived."""
    is_sent = conversation.kinds == MomentKind.SENT
    repeated = np.isin(conversation.numbers, np.unique(conversation.numbers[is_sent & conversation.again]))
    waiting: list[tuple[int, int]] = []
    pairs = array("q")
    moments = np.flatnonzero((is_sent & ~repeated) | conversation.answers)
    for moment, answers, number in rows_of(moments, conversation.answers[moments], conversation.numbers[moments]):
        if not answers:
            waiting.append((number, moment))
        elif waiting:
            for sent, left in waiting:
                if sent < number:
                    pairs.extend((left, moment))
            waiting = [each for each in waiting if each[0] >= number]
    earlier, later = np.frombuffer(pairs, np.int64).reshape(-1, 2).T
    return conversation.between(earlier, later)


def reactions(file: str, recording: Capture) -> Iterator[PackedSamples]:
    """From a message that comes to a client to its next ACKNACK: it answers everything."""
    sent = recording.transmissions
    for link in range(len(recording.links)):
        answers = sent.rows(link, to_agent=True, kinds=(SubmessageKind.ACKNACK,))
        times = sent.sent[answers].tolist()
        rows = sent.rows(link, to_agent=False)
        rows = rows[sent.wants_answer(rows) & (sent.counts[rows] > 0)]
        arrived = sent.arrived[rows]
        # Times may go back, and of those only this search gives the same place every time.
        places = np.array([bisect_left(times, time) for time in arrived.tolist()], np.int64)
        answered = places < len(answers)
        rows, answer = rows[answered], answers[places[answered]]
        waits = (sent.sent[answer] - arrived[answered]) / MILLISECOND
        yield packed(file, waits, sent.arrivals[sent.first_arrivals[rows], 1], sent.packets[answer])


def repairs(conversation: Conversation) -> PackedSamples:
    """From a message that is lost to its first arrival; without a recording behind the loss, from a message that is
    repeated to the ACKNACK that says that it has arrived."""
    sent, numbers = conversation.transmissions, conversation.numbers
    is_sent = conversation.kinds == MomentKind.SENT
    repeated = set(numbers[is_sent & conversation.again].tolist())
    unobserved = is_sent & ~sent.is_observed[conversation.rows]
    once_lost = np.unique(numbers[is_sent & ~conversation.again & sent.is_lost[conversation.rows]])
    chosen = unobserved | (is_sent & np.isin(numbers, once_lost)) | (conversation.answers & unobserved.any())
    moments = np.flatnonzero(chosen)
    rows = conversation.rows[moments]
    lost: dict[int, int] = {}
    unseen: dict[int, int] = {}
    pairs, until = array("q"), array("q")
    for moment, answers, number, again, hidden, is_lost, arrived in rows_of(
        moments,
        conversation.answers[moments],
        numbers[moments],
        conversation.again[moments],
        unobserved[moments],
        sent.is_lost[rows],
        sent.arrived[rows],
    ):
        if answers:
            for each in [each for each in unseen if each < number]:
                left = unseen.pop(each)
                if each in repeated:
                    pairs.extend((left, moment))
                    until.append(int(conversation.times[moment]))
        elif not again and hidden:
            unseen[number] = moment
        elif not again:
            lost.pop(number, None)
            if is_lost:
                lost[number] = moment
        elif number in lost and not hidden and not is_lost:
            pairs.extend((lost.pop(number), moment))
            until.append(arrived)
    earlier, later = np.frombuffer(pairs, np.int64).reshape(-1, 2).T
    waits = (np.frombuffer(until, np.int64) - conversation.times[earlier]) / MILLISECOND
    return packed(conversation.file, waits, conversation.packets(earlier), conversation.packets(later))


def paces(conversation: Conversation) -> PackedSamples:
    """Between two samples that are written one after the other."""
    written = writes(conversation)
    return conversation.between(written[:-1], written[1:])


def writes(conversation: Conversation) -> Numbers:
    """The moments of messages with WRITE_DATA or DATA, each when it is sent first."""
    first = np.flatnonzero((conversation.kinds == MomentKind.SENT) & ~conversation.again)
    return first[conversation.transmissions.having(conversation.rows[first], *_SAMPLES)]


def longest_unacknowledged(conversation: Conversation) -> int:
    """For how long a sender had messages unacknowledged at a stretch, in nanoseconds."""
    first, last = stretches(conversation.unacknowledged > 0)
    return int((conversation.times[last] - conversation.times[first]).max(initial=0))


def stretches(which: Flags) -> tuple[Numbers, Numbers]:
    """Where stretches in which this is true begin, and where they end."""
    around = np.concatenate([[False], which, [False]])
    changes = np.flatnonzero(around[1:] != around[:-1])
    return changes[::2], changes[1::2] - 1


def window(name: str, title: str, found: Sequence[Conversation]) -> Quantity:
    """The most unacknowledged messages. That there may not be more shows where room is used as soon as it is there, and
    by the number, which is a power of two."""
    outstanding = [np.where(c.kinds == MomentKind.SENT, c.unacknowledged, 0) for c in found]
    most = max((int(each.max(initial=0)) for each in outstanding), default=0)
    if not most:
        return seen(name, title, (), "no message is sent", QuantityUnit.COUNT)
    waited = [(c, _waited(c, most)) for c in found]
    full = gathered(packed(c.file, np.full(len(m), most), c.packets(m - 1), c.packets(m)) for c, m in waited)
    if len(full) > 1 and most >= _SMALLEST_HISTORY and most & (most - 1) == 0:
        how = f"{len(full)} times a new message left at once when an ACKNACK had made room"
        return Quantity(name, title, QuantityUnit.COUNT, full, most, Confidence.MEASURED, how)
    how = f"at least {most}: no sender was seen to wait for room again and again"
    first = next(
        c.place(int(np.argmax(each == most))) for c, each in zip(found, outstanding, strict=True) if most in each
    )
    return Quantity(name, title, QuantityUnit.COUNT, (Observation(most, (first,)),), most, Confidence.BOUND, how)


def _waited(conversation: Conversation, most: int) -> Numbers:
    """The moments of new messages that leave at once when something that came has made room."""
    kinds, waiting = conversation.kinds, conversation.unacknowledged
    made_room = (kinds == MomentKind.CAME) & (conversation.before == most) & (waiting < most)
    new = (kinds == MomentKind.SENT) & ~conversation.again
    following = made_room[:-1] & new[1:] & (np.diff(conversation.times) < _AT_ONCE)
    return np.flatnonzero(following) + 1


def losses(file: str, recording: Capture, to_agent: bool) -> Iterator[PackedSamples]:
    """The part of the messages that are lost, in percent, for each link; the packets are those that are."""
    sent = recording.transmissions
    for link in range(len(recording.links)):
        rows = sent.rows(link, to_agent)
        rows = rows[sent.is_observed[rows]]
        if len(rows):
            lost = sent.packets[rows[sent.is_lost[rows]]]
            yield packed_groups(file, np.array([100 * len(lost) / len(rows)]), lost, np.array([len(lost)]))


def delays(file: str, recording: Capture) -> Iterator[PackedSamples]:
    """From one side of a relay to the other."""
    sent = recording.transmissions
    rows = np.repeat(np.arange(len(sent), dtype=np.int32), sent.counts)
    times, packets = sent.arrivals.T
    yield packed(file, (times - sent.sent[rows]) / MILLISECOND, sent.packets[rows], packets)


def copies(file: str, recording: Capture) -> Iterator[PackedSamples]:
    """Messages that arrive more than once, with how often."""
    sent = recording.transmissions
    several = sent.counts > 1
    counts = sent.counts[several]
    packets = sent.arrivals[places_in(sent.first_arrivals[several], counts), 1]
    yield packed_groups(file, counts, packets, counts)


def overtakings(file: str, recording: Capture) -> Iterator[PackedSamples]:
    """Messages that arrive before one that was sent before them; how many milliseconds before.

    Of messages with the same content that one counts which makes it the least surprising.
    """
    sent = recording.transmissions
    ways = [sent.rows(link, to_agent) for link in range(len(recording.links)) for to_agent in (True, False)]
    earlier, later = np.concatenate([np.zeros((0, 2), np.int64), *(_overtaken(sent, ours) for ours in ways)]).T
    order = np.lexsort((later, sent.arrived[later]))
    earlier, later = earlier[order], later[order]
    waits = (sent.arrived[later] - sent.arrived[earlier]) / MILLISECOND
    yield packed(file, waits, sent.packets[earlier], sent.packets[later])


def _overtaken(sent: PackedTransmissions, ours: Numbers) -> Numbers:
    """Pairs of rows of one way that cannot be explained otherwise: whichever of the messages with its content the first
    is, it was sent after the second, whichever of those with its content that is."""
    ours = _out_of_order(sent, ours)
    contents = sent.contents(ours)
    by_content = np.lexsort((sent.sent[ours], contents))
    times, contents = sent.sent[ours[by_content]], contents[by_content]
    first = np.zeros(len(ours), np.int64)
    first[by_content] = np.maximum.accumulate(np.where(np.diff(contents, prepend=-1) != 0, np.arange(len(ours)), 0))
    places = _as_arrived(sent, ours)
    earliest = times[first[places]]
    newest = np.maximum.accumulate(earliest)
    holder = np.maximum.accumulate(np.where(np.diff(newest, prepend=-1) > 0, np.arange(len(places)), 0))
    late = np.flatnonzero(newest[:-1] > earliest[1:]) + 1
    begins, moments = first[places[late]], sent.arrived[ours[places[late]]]
    ends = np.searchsorted(contents, contents[begins], side="right")
    limits = zip(moments.tolist(), (begins + 1).tolist(), ends.tolist(), strict=True)
    at_most = times[np.array([bisect_right(times, *limit) - 1 for limit in limits], np.int64)]
    overtaken = newest[late - 1] > at_most
    return ours[np.stack([places[holder[late - 1]], places[late]], axis=1)[overtaken]]


def _as_arrived(sent: PackedTransmissions, ours: Numbers) -> Numbers:
    """The places of those rows that arrived, in the order in which they did."""
    arrived = np.flatnonzero(sent.counts[ours] > 0)
    return arrived[np.argsort(sent.arrived[ours[arrived]], kind="stable")]


def _out_of_order(sent: PackedTransmissions, ours: Numbers) -> Numbers:
    """Those rows of a way that come before or behind one that was sent on the other side of them, and all that may say
    the same: messages with the same content have the same number. The others overtake nobody, and nobody them."""
    rows = ours[_as_arrived(sent, ours)]
    times = sent.sent[rows]
    if (times > sent.arrived[rows]).any():
        return ours  # times go back, so they do not say what came before
    later = np.append(np.minimum.accumulate(times[::-1])[::-1][1:], _NEVER)
    before = np.append(-_NEVER, np.maximum.accumulate(times)[:-1])
    found = rows[(later < times) | (before > times)]
    chosen: Numbers = ours[np.isin(sent.sequence[ours], sent.sequence[found])]
    return chosen
