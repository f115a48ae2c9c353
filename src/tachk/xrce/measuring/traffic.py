"""Round trips, repairs, pace and windows of streams; losses, copies, overtaking and delays of links."""

from __future__ import annotations

from array import array
from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from hashlib import blake2b
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tachk.xrce.measuring.conversation import Came, Conversation, SentMessage
from tachk.xrce.measuring.quantity import Confidence, Observation, PacketPlace, Quantity, QuantityUnit, seen
from tachk.xrce.transmission import Transmission
from tachk.xrce.transmissions import Capture
from tachk.xrce.wire import SubmessageKind

_MILLISECOND: Final = 1e6
_NEVER: Final = 2**62
_SAMPLES: Final = frozenset({SubmessageKind.WRITE_DATA, SubmessageKind.DATA})
_SMALLEST_HISTORY: Final = 4
_AT_ONCE: Final = 5e6
"""Nanoseconds within which a sender that has waited for room sends on."""


def round_trips(conversation: Conversation) -> Iterator[Observation]:
    """From a message that is sent once to the first ACKNACK that says that it has arrived."""
    repeated = {moment.number for moment in conversation.moments if isinstance(moment, SentMessage) and moment.again}
    waiting: list[SentMessage] = []
    for moment in conversation.moments:
        if isinstance(moment, SentMessage) and moment.number not in repeated:
            waiting.append(moment)
        elif isinstance(moment, Came) and moment.first is not None:
            for sent in [each for each in waiting if each.number < moment.first]:
                waiting.remove(sent)
                places = conversation.place(sent), conversation.place(moment)
                yield Observation((moment.time - sent.time) / _MILLISECOND, places)


def reactions(file: str, recording: Capture) -> Iterator[Observation]:
    """From a message that comes to a client to its next ACKNACK: it answers everything."""
    for link in range(len(recording.links)):
        acknacks = frozenset({SubmessageKind.ACKNACK})
        answers = list(recording.transmissions.where(link, to_agent=True, kinds=acknacks))
        times = [one.sent for one in answers]
        for one in recording.transmissions.where(link, to_agent=False):
            arrivals = one.arrivals if _wants_answer(one) else None
            if not arrivals:
                continue
            place = bisect_left(times, one.arrived)
            if place < len(answers):
                places = PacketPlace(file, arrivals[0].packet), PacketPlace(file, answers[place].packet)
                yield Observation((times[place] - one.arrived) / _MILLISECOND, places)


def _wants_answer(one: Transmission) -> bool:
    return one.is_reliable or SubmessageKind.HEARTBEAT in one.kinds


def repairs(conversation: Conversation) -> Iterator[Observation]:
    """From a message that is lost to its first arrival; without a recording behind the loss, from a message that is
    repeated to the ACKNACK that says that it has arrived."""
    first: dict[int, SentMessage] = {}
    unseen: dict[int, SentMessage] = {}
    repeated = {each.number for each in conversation.moments if isinstance(each, SentMessage) and each.again}
    for moment in conversation.moments:
        if isinstance(moment, SentMessage):
            if not moment.again and not moment.transmission.is_observed:
                unseen[moment.number] = moment
            elif not moment.again:
                first.pop(moment.number, None)
                if moment.transmission.is_lost:
                    first[moment.number] = moment
            elif moment.number in first and moment.transmission.arrivals:
                lost = first.pop(moment.number)
                places = conversation.place(lost), conversation.place(moment)
                yield Observation((moment.transmission.arrived - lost.time) / _MILLISECOND, places)
        elif isinstance(moment, Came) and moment.first is not None:
            for number in [each for each in unseen if each < moment.first]:
                sent = unseen.pop(number)
                if number in repeated:
                    places = conversation.place(sent), conversation.place(moment)
                    yield Observation((moment.time - sent.time) / _MILLISECOND, places)


def paces(conversation: Conversation) -> Iterator[Observation]:
    """Between two samples that are written one after the other."""
    for before, after in pairwise(writes(conversation)):
        places = conversation.place(before), conversation.place(after)
        yield Observation((after.time - before.time) / _MILLISECOND, places)


def writes(conversation: Conversation) -> list[SentMessage]:
    """Messages with WRITE_DATA or DATA, each when it is sent first."""
    return [
        moment
        for moment in conversation.moments
        if isinstance(moment, SentMessage) and not moment.again and not _SAMPLES.isdisjoint(moment.transmission.kinds)
    ]


def longest_unacknowledged(conversation: Conversation) -> int:
    """For how long a sender had messages unacknowledged at a stretch, in nanoseconds."""
    longest = 0
    since: int | None = None
    for moment in conversation.moments:
        if not moment.unacknowledged:
            since = None
        elif since is None:
            since = moment.time
        else:
            longest = max(longest, moment.time - since)
    return longest


def window(name: str, title: str, found: Sequence[Conversation]) -> Quantity:
    """The most unacknowledged messages. That there may not be more shows where room is used as soon as it is there, and
    by the number, which is a power of two."""
    most = max((m.unacknowledged for c in found for m in c.moments if isinstance(m, SentMessage)), default=0)
    if not most:
        return seen(name, title, (), "no message is sent", QuantityUnit.COUNT)
    at_most = [
        Observation(most, (c.place(m),))
        for c in found
        for m in c.moments
        if isinstance(m, SentMessage) and m.unacknowledged == most
    ]
    full = [Observation(most, (c.place(a), c.place(b))) for c in found for a, b in _waited(c, most)]
    if len(full) > 1 and most >= _SMALLEST_HISTORY and most & (most - 1) == 0:
        how = f"{len(full)} times a new message left at once when an ACKNACK had made room"
        return Quantity(name, title, QuantityUnit.COUNT, tuple(full), most, Confidence.MEASURED, how)
    how = f"at least {most}: no sender was seen to wait for room again and again"
    return Quantity(name, title, QuantityUnit.COUNT, tuple(at_most[:1]), most, Confidence.BOUND, how)


def _waited(conversation: Conversation, most: int) -> Iterator[tuple[Came, SentMessage]]:
    for before, after in pairwise(conversation.moments):
        if (
            isinstance(before, Came)
            and isinstance(after, SentMessage)
            and not after.again
            and before.before == most > before.unacknowledged
            and after.time - before.time < _AT_ONCE
        ):
            yield before, after


def losses(file: str, recording: Capture, to_agent: bool) -> Iterator[Observation]:
    """The part of the messages that are lost, in percent, for each link; the packets are those that are."""
    for link in range(len(recording.links)):
        known = [t for t in recording.transmissions.where(link, to_agent) if t.is_observed]
        if known:
            lost = [t for t in known if t.is_lost]
            yield Observation(100 * len(lost) / len(known), tuple(PacketPlace(file, t.packet) for t in lost))


def delays(file: str, recording: Capture) -> Iterator[Observation]:
    """From one side of a relay to the other."""
    for one in recording.transmissions:
        for arrival in one.arrivals or ():
            places = PacketPlace(file, one.packet), PacketPlace(file, arrival.packet)
            yield Observation((arrival.time - one.sent) / _MILLISECOND, places)


def copies(file: str, recording: Capture) -> Iterator[Observation]:
    """Messages that arrive more than once, with how often."""
    for one in recording.transmissions:
        arrivals = one.arrivals
        if arrivals is not None and len(arrivals) > 1:
            yield Observation(len(arrivals), tuple(PacketPlace(file, arrival.packet) for arrival in arrivals))


def overtakings(file: str, recording: Capture) -> Iterator[Observation]:
    """Messages that arrive before one that was sent before them; how many milliseconds before.

    Of messages with the same content that one counts which makes it the least surprising.
    """
    for one, late in _overtaken(recording.transmissions):
        places = PacketPlace(file, one.packet), PacketPlace(file, late.packet)
        yield Observation((late.arrived - one.arrived) / _MILLISECOND, places)


def _overtaken(transmissions: Sequence[Transmission]) -> Iterator[tuple[Transmission, Transmission]]:
    """Pairs that cannot be explained otherwise: whichever of the messages with its content the first is, it was sent
    after the second, whichever of those with its content that is."""
    contents = _contents(transmissions)
    sent = array("q", (one.sent for one in transmissions))
    by_content = np.argsort(contents, kind="stable")
    times = array("q", np.frombuffer(sent, np.int64)[by_content].tobytes())
    first = np.searchsorted(contents[by_content], contents)
    top = np.searchsorted(contents[by_content], contents, side="right")
    arrived = array("q", (one.arrived if one.arrivals else _NEVER for one in transmissions))
    order = np.argsort(np.frombuffer(arrived, np.int64), kind="stable")
    newest: dict[tuple[int, bool], tuple[int, int]] = {}
    for number in order[: len(order) - arrived.count(_NEVER)].tolist():
        one = transmissions[number]
        way, begin = (one.link, one.to_agent), int(first[number])
        at_most = times[bisect_right(times, arrived[number], begin, int(top[number])) - 1]
        if way in newest and newest[way][0] > at_most:
            yield transmissions[newest[way][1]], one
        if way not in newest or newest[way][0] < times[begin]:
            newest[way] = times[begin], number


def _contents(transmissions: Sequence[Transmission]) -> NDArray[np.int64]:
    """A number for what each of them says; equal ones have equal numbers."""
    digests = bytearray()
    for one in transmissions:
        said = one.link, one.to_agent, *((e.kind, e.stream, e.sequence, e.fields) for e in one.events)
        digests += blake2b(repr(said).encode(), digest_size=16).digest()
    rows = np.frombuffer(digests, np.int64).reshape(-1, 2)
    order = np.lexsort((rows[:, 1], rows[:, 0]))
    differs = (np.diff(rows[order], axis=0) != 0).any(axis=1)
    numbers = np.zeros(len(rows), np.int64)
    numbers[order[1:]] = np.cumsum(differs)
    return numbers
