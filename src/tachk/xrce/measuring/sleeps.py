"""Silence: sleeping clients, and the Agent's idea of dead ones."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from tachk.base.records import dataclass
from tachk.xrce.datagrams import Flags
from tachk.xrce.events import SubmessageEvent
from tachk.xrce.measuring.conversation import MILLISECOND, Conversation, MomentKind, rows_of
from tachk.xrce.measuring.quantity import Confidence, Observation, PacketPlace, Quantity, QuantityUnit, roundest, seen
from tachk.xrce.packed_transmissions import PackedTransmissions
from tachk.xrce.packets import Numbers
from tachk.xrce.transmissions import Capture
from tachk.xrce.wire import SubmessageKind

_SHORTEST_SLEEP: Final = 2e9
"""Nanoseconds; a shorter silence is an outage of the link."""

_ANSWERS: Final = frozenset({SubmessageKind.ACKNACK, SubmessageKind.DELETE})

_AT_ONCE: Final = 20e6
"""Nanoseconds within which a client that is awake answers."""

UNLIMITED: Final = 0xFFFF


@dataclass(frozen=True, slots=True)
class Sleep:
    """A time in which a client sends nothing although packets are sent to it.

    Attributes:
        link: the index of its link.
        begin: when the first of them was sent, in nanoseconds since the epoch.
        end: when the client sends again.
        before: how much earlier it may have fallen asleep, in nanoseconds: it sent its last packet then.
        speaks_first: whether the client says more than an answer when it ends, and more than that it leaves.
        first: the first of those packets.
        waking: the packet that ends the silence; None at the end of the capture.
    """

    link: int
    begin: int
    end: int
    before: int
    speaks_first: bool
    first: int
    waking: int | None


def asleep(recording: Capture, found: Sequence[Sleep]) -> Flags:
    """For each transmission whether it was sent to a client that slept."""
    sent = recording.transmissions
    covered = np.zeros(len(sent), np.bool_)
    for link in sorted({sleep.link for sleep in found}):
        begins, ends = (
            np.sort([getattr(sleep, end) for sleep in found if sleep.link == link]) for end in ("begin", "end")
        )
        rows = sent.rows(link, to_agent=False)
        begun = np.searchsorted(begins, sent.sent[rows], side="right")
        covered[rows] = begun > np.searchsorted(ends, sent.sent[rows])
    return covered


def sleeps(recording: Capture) -> Iterator[Sleep]:
    """The sleeping times of all clients, as far as their silence shows them."""
    sent = recording.transmissions
    for link in range(len(recording.links)):
        spoken = sent.rows(link, to_agent=True)
        received = sent.rows(link, to_agent=False)
        received = received[sent.wants_answer(received)]
        received = received[np.argsort(sent.sent[received], kind="stable")]
        until = np.append(sent.sent[spoken[1:]], recording.end)
        for number in np.flatnonzero(until - sent.sent[spoken] >= _SHORTEST_SLEEP).tolist():
            waking = int(spoken[number + 1]) if number + 1 < len(spoken) else None
            found = _sleep(sent, int(spoken[number]), waking, received, int(until[number]))
            if found is not None:
                yield found


def _sleep(sent: PackedTransmissions, last: int, waking: int | None, received: Numbers, until: int) -> Sleep | None:
    """Args:
    received: the rows of what wants an answer, in the order of times.
    """
    times = sent.sent[received]
    rows = np.sort(received[np.searchsorted(times, sent.sent[last], side="right") : np.searchsorted(times, until)])
    unanswered = rows[sent.is_lost[rows] | (until - sent.arrived[rows] > _AT_ONCE)]
    if len(unanswered) < 2 or until - sent.sent[unanswered[0]] < _SHORTEST_SLEEP:
        return None
    begin = int(sent.sent[unanswered[0]])
    first, before = int(sent.packets[unanswered[0]]), begin - int(sent.sent[last])
    if waking is None:
        return Sleep(sent[last].link, begin, until, before, False, first, None)
    return Sleep(sent[last].link, begin, until, before, not sent[waking].kinds <= _ANSWERS, first, sent[waking].packet)


def sleep_quantity(found: Sequence[tuple[str, Sleep]]) -> Quantity:
    samples = tuple(
        Observation(
            (sleep.end - sleep.begin) / MILLISECOND,
            tuple(PacketPlace(file, packet) for packet in (sleep.first, sleep.waking) if packet is not None),
        )
        for file, sleep in found
    )
    name, title = "sleep", "silence of a client to which packets are sent"
    if not samples:
        return seen(name, title, (), "no client was silent for 2 s while packets were sent to it")
    _, longest = max(found, key=lambda pair: pair[1].end - pair[1].begin)
    length = longest.end - longest.begin
    value = roundest(length / MILLISECOND, (length + longest.before) / MILLISECOND, 100)
    how = "asleep or out of reach from the first packet without an answer to the next one of the client; the longest"
    confidence = Confidence.MEASURED if len(samples) > 1 else Confidence.ONE_SAMPLE
    return Quantity(name, title, QuantityUnit.MILLISECONDS, samples, value, confidence, how)


def dead_time(found: Sequence[tuple[Conversation, Capture]], period: float | None) -> Quantity:
    """After how long a silence of the client the Agent sends it no more HEARTBEATs."""
    name, title = "dead_time", "silence after which the Agent gives up a client"
    if period is None:
        return seen(name, title, (), "the period of the Agent's HEARTBEATs is not known, so none can be missed")
    bounds = [one for conversation, recording in found for one in _given_up(conversation, recording, period)]
    if not bounds:
        longest = [one for conversation, recording in found for one in _longest_silence(conversation, recording)]
        if not longest:
            return seen(name, title, (), "no client was silent with messages of the Agent unacknowledged")
        most = max(longest, key=lambda sample: sample.value)
        how = f"more than {most.value:.0f} ms: the Agent still sent a HEARTBEAT then"
        return Quantity(name, title, QuantityUnit.MILLISECONDS, (most,), None, Confidence.BOUND, how)
    low, high = max(low.value for low, _ in bounds), min(high.value for _, high in bounds)
    if high < low:
        how = f"one capture says more than {low:.0f} ms, another one less than {high:.0f} ms"
        return seen(name, title, (), how)
    how = f"the roundest number from the last HEARTBEAT ({low:.0f} ms) to the next that did not come ({high:.0f} ms)"
    samples = tuple(sample for pair in bounds for sample in pair)
    value = roundest(low, high, 100)
    return Quantity(name, title, QuantityUnit.MILLISECONDS, samples, value, Confidence.MEASURED, how)


def _given_up(
    conversation: Conversation, recording: Capture, period: float
) -> Iterator[tuple[Observation, Observation]]:
    """Silences at the last HEARTBEAT and at the one that should have been next."""
    received, moments, before = _silences(conversation, recording)
    beats = conversation.times[moments]
    following = np.append(beats[1:], conversation.end)
    spoken = np.append(received, conversation.end)[before]
    missed = np.minimum(following, spoken) - beats
    last = np.where(before > 0, np.append(received, 0)[before - 1], beats)
    chosen = (missed > 3 * period * MILLISECOND) & (beats - last > 10 * period * MILLISECOND)
    for moment, length in rows_of(moments[chosen], beats[chosen] - last[chosen]):
        silence, place = length / MILLISECOND, (conversation.place(moment),)
        yield Observation(silence, place), Observation(silence + period, place)


def _longest_silence(conversation: Conversation, recording: Capture) -> Iterator[Observation]:
    received, moments, before = _silences(conversation, recording)
    moments, before = moments[before > 0], before[before > 0]
    if len(moments):
        lengths = conversation.times[moments] - received[before - 1]
        longest = int(np.argmax(lengths))
        yield Observation(int(lengths[longest]) / MILLISECOND, (conversation.place(int(moments[longest])),))


def _silences(conversation: Conversation, recording: Capture) -> tuple[Numbers, Numbers, Numbers]:
    """The times at which packets of the client arrived at the Agent, the moments of HEARTBEATs with messages
    unacknowledged, and how many of these times are not later than each of them."""
    sent = recording.transmissions
    rows = sent.rows(conversation.link, to_agent=True)
    received = np.sort(sent.arrived[rows[~sent.is_lost[rows]]])
    moments = np.flatnonzero((conversation.kinds == MomentKind.HEARTBEAT) & (conversation.unacknowledged > 0))
    return received, moments, np.searchsorted(received, conversation.times[moments], side="right")


@dataclass(frozen=True, slots=True)
class ReadRequest:
    """A READ_DATA for at most so many samples, UNLIMITED or None for one.

    Attributes:
        number: of its message in its stream.
        time: when it was sent, in nanoseconds since the epoch.
    """

    link: int
    samples: int | None
    number: int | None
    time: int


def read_requests(recording: Capture) -> Iterator[ReadRequest]:
    """Every READ_DATA that a client sends, repetitions too."""
    for one in recording.transmissions.where(to_agent=True, kinds=frozenset({SubmessageKind.READ_DATA})):
        for event in one.events:
            if event.kind is SubmessageKind.READ_DATA:
                yield ReadRequest(one.link, _samples(event), event.sequence, one.sent)


def _samples(event: SubmessageEvent) -> int | None:
    value = event.fields["max_samples"]
    return value if isinstance(value, int) else None
