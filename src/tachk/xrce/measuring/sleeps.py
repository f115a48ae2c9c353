"""Silence: sleeping clients, and the Agent's idea of dead ones."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from typing import Final

from tachk.base.records import dataclass
from tachk.xrce.events import SubmessageEvent
from tachk.xrce.measuring.conversation import Beat, Conversation
from tachk.xrce.measuring.quantity import Confidence, Observation, PacketPlace, Quantity, QuantityUnit, roundest, seen
from tachk.xrce.transmission import Transmission
from tachk.xrce.transmissions import Capture
from tachk.xrce.wire import SubmessageKind

_MILLISECOND: Final = 1e6
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

    def covers(self, one: Transmission) -> bool:
        """True if a message was sent to the client during this time."""
        return one.link == self.link and not one.to_agent and self.begin <= one.sent <= self.end


def sleeps(recording: Capture) -> Iterator[Sleep]:
    """The sleeping times of all clients, as far as their silence shows them."""
    for link in range(len(recording.links)):
        ours = list(recording.transmissions.where(link))
        spoken = [one for one in ours if one.to_agent]
        received = [one for one in ours if not one.to_agent]
        for number, last in enumerate(spoken):
            following = spoken[number + 1] if number + 1 < len(spoken) else None
            found = _sleep(link, last, following, received, recording.end)
            if found is not None:
                yield found


def _sleep(
    link: int, last: Transmission, waking: Transmission | None, received: Sequence[Transmission], end: int
) -> Sleep | None:
    until = end if waking is None else waking.sent
    if until - last.sent < _SHORTEST_SLEEP:
        return None
    unanswered = [
        one
        for one in received
        if last.sent < one.sent < until and _wants_answer(one) and (one.is_lost or until - one.arrived > _AT_ONCE)
    ]
    if len(unanswered) < 2 or until - unanswered[0].sent < _SHORTEST_SLEEP:
        return None
    begin = unanswered[0].sent
    by_itself = waking is not None and not waking.kinds <= _ANSWERS
    waking_packet = None if waking is None else waking.packet
    return Sleep(link, begin, until, begin - last.sent, by_itself, unanswered[0].packet, waking_packet)


def _wants_answer(one: Transmission) -> bool:
    return one.is_reliable or SubmessageKind.HEARTBEAT in one.kinds


def sleep_quantity(found: Sequence[tuple[str, Sleep]]) -> Quantity:
    samples = tuple(
        Observation(
            (sleep.end - sleep.begin) / _MILLISECOND,
            tuple(PacketPlace(file, packet) for packet in (sleep.first, sleep.waking) if packet is not None),
        )
        for file, sleep in found
    )
    name, title = "sleep", "silence of a client to which packets are sent"
    if not samples:
        return seen(name, title, (), "no client was silent for 2 s while packets were sent to it")
    _, longest = max(found, key=lambda pair: pair[1].end - pair[1].begin)
    length = longest.end - longest.begin
    value = roundest(length / _MILLISECOND, (length + longest.before) / _MILLISECOND, 100)
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
    received = _received(conversation, recording)
    beats = [moment for moment in conversation.moments if isinstance(moment, Beat) and moment.unacknowledged]
    for number, beat in enumerate(beats):
        before = bisect_right(received, beat.time)
        following = beats[number + 1].time if number + 1 < len(beats) else conversation.end
        spoken = received[before] if before < len(received) else conversation.end
        missed = min(following, spoken) - beat.time
        last = received[before - 1] if before else beat.time
        if missed > 3 * period * _MILLISECOND and beat.time - last > 10 * period * _MILLISECOND:
            silence = (beat.time - last) / _MILLISECOND
            place = (conversation.place(beat),)
            yield Observation(silence, place), Observation(silence + period, place)


def _longest_silence(conversation: Conversation, recording: Capture) -> Iterator[Observation]:
    received = _received(conversation, recording)
    for moment in conversation.moments:
        if isinstance(moment, Beat) and moment.unacknowledged:
            before = bisect_right(received, moment.time)
            if before:
                yield Observation((moment.time - received[before - 1]) / _MILLISECOND, (conversation.place(moment),))


def _received(conversation: Conversation, recording: Capture) -> list[int]:
    """The times at which packets of the client arrived at the Agent."""
    sent = recording.transmissions.where(conversation.link, to_agent=True)
    return sorted(one.arrived for one in sent if not one.is_lost)


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
