"""The times of HEARTBEATs: the law of a client's timer, its period, and the period of the Agent.

A client has one of three laws. STEADY: the timer runs from the first unacknowledged message, from each HEARTBEAT and
from each ACKNACK. REARMED: it starts again also at every message that leaves or comes in, and at every call of a run
function, which no capture shows. DOUBLING: as STEADY, but each wait is twice the one before, until an ACKNACK comes.
The law is the one by which HEARTBEATs come on time that would come at another time by the others.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from enum import StrEnum
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tachk.base.records import dataclass
from tachk.xrce.datagrams import Flags
from tachk.xrce.measuring.conversation import MILLISECOND, Conversation, MomentKind, rows_of
from tachk.xrce.measuring.quantity import (
    Confidence,
    Observation,
    PackedSamples,
    PacketPlace,
    Quantity,
    QuantityUnit,
    punctual,
    roundest,
    seen,
    values_of,
)
from tachk.xrce.packets import Numbers


class HeartbeatLaw(StrEnum):
    STEADY = "steady"
    REARMED = "re-armed"
    DOUBLING = "doubling"


USUAL_PERIOD: Final = 100.0
"""Milliseconds; UCLIENT_MIN_HEARTBEAT_TIME_INTERVAL of the client since 2.1. Assumed where no capture shows one."""

_AT_ONCE: Final = 5.0
"""Milliseconds."""

_TICK: Final = 1.0
"""Milliseconds by which a client's timer is late: its clock has no finer steps."""

_FIRST_OF_OLD: Final = (0.9, 1.4)
"""Milliseconds; clients up to 2.0 send the first HEARTBEAT 1 ms after a message, by a clock of such steps."""

_FEW: Final = 4
"""The number of waits below which a client's period cannot be separated from its other activity."""

_CLEARLY: Final = 1.25
"""By how much two times have to differ to distinguish two laws."""


@dataclass(frozen=True, slots=True)
class HeartbeatWait:
    """The wait for a client's HEARTBEAT, in milliseconds.

    Attributes:
        activity: since something left or came in, or since messages were unacknowledged.
        beat: since the HEARTBEAT before, or since messages were unacknowledged, or since the last ACKNACK.
        previous: the same of the HEARTBEAT before, if no ACKNACK came between them.
        places: packets at both ends.
    """

    activity: float
    beat: float
    previous: float | None
    places: tuple[PacketPlace, ...]


@dataclass(frozen=True, slots=True)
class Starving:
    """Milliseconds in which a client had unacknowledged messages and no HEARTBEAT left.

    Attributes:
        length: all of them.
        gap: the longest part in which nothing left and nothing came in.
        traffic: how far apart packets came in meanwhile that have nothing to do with the stream.
        places: the packets at both ends.
    """

    length: float
    gap: float
    traffic: tuple[float, ...]
    places: tuple[PacketPlace, ...]


def waits(conversation: Conversation) -> Iterator[HeartbeatWait]:
    """The waits for all HEARTBEATs that a client sends about a stream."""
    kinds, unacknowledged = conversation.kinds, conversation.unacknowledged
    sent, beats = kinds == MomentKind.SENT, kinds == MomentKind.HEARTBEAT
    starts = beats | conversation.answers | (sent & (unacknowledged == 1) & ~conversation.again)
    starts[np.flatnonzero(starts | sent)[:1]] = True
    anchors = last_before(starts)
    awaited = beats & (unacknowledged > 0) & ~_overdue(conversation)
    moments = np.flatnonzero(beats)
    previous: float | None = None
    for moment, anchor, is_awaited in rows_of(moments, anchors[moments], awaited[moments]):
        if anchor < 0:
            continue
        if kinds[anchor] != MomentKind.HEARTBEAT:
            previous = None
        if is_awaited:
            places = tuple(dict.fromkeys(map(conversation.place, (anchor, moment - 1, moment))))
            beat = conversation.wait(anchor, moment)
            yield HeartbeatWait(conversation.wait(moment - 1, moment), beat, previous, places)
            previous = beat


def last_before(which: Flags) -> Numbers:
    """For each moment the last one before it where this is true; -1 without any."""
    found = np.full(len(which), -1, np.int64)
    found[1:] = np.maximum.accumulate(np.where(which, np.arange(len(which)), -1))[:-1]
    return found


def _overdue(conversation: Conversation) -> Flags:
    """Which HEARTBEATs come when the timer had run out while the client was in no run function: then HEARTBEAT follows
    at once what the next call sends first. Where nothing but that is unacknowledged, and HEARTBEAT does not follow at
    once but a tick of the clock later, it is the first one of an old client."""
    waited = np.diff(conversation.times) / MILLISECOND
    first_of_old = (_FIRST_OF_OLD[0] < waited) & (waited < _FIRST_OF_OLD[1])
    beats = (conversation.kinds[:-1] == MomentKind.SENT) & (conversation.kinds[1:] == MomentKind.HEARTBEAT)
    found = np.zeros(len(conversation.times), np.bool_)
    found[1:] = beats & (waited < _AT_ONCE) & ((conversation.unacknowledged[1:] > 1) | ~first_of_old)
    return found


def overdue(conversation: Conversation) -> PackedSamples:
    """From a message to the HEARTBEAT that follows it at once: the client was in no run function when it was due."""
    moments = np.flatnonzero(_overdue(conversation) & (conversation.unacknowledged > 0))
    return conversation.between(moments - 1, moments)


def starvings(conversation: Conversation, period: float) -> Iterator[Starving]:
    """Stretches longer than the period in which a client has unacknowledged messages, sends no HEARTBEAT and gets no
    ACKNACK.

    What lasts until the end of the capture is none: the client may have ended.
    """
    times, waiting = conversation.times, conversation.unacknowledged > 0
    ends = ~waiting | (conversation.kinds == MomentKind.HEARTBEAT) | conversation.answers
    starts = waiting & (ends | ~np.append(False, waiting[:-1]))
    first, end = np.flatnonzero(starts), np.flatnonzero(ends)
    following = np.searchsorted(end, first, side="right")
    first, last = first[following < len(end)], end[following[following < len(end)]]
    long = (times[last] - times[first]) / MILLISECOND > _CLEARLY * period
    for start, moment in rows_of(first[long], last[long]):
        gap = int(np.diff(times[start : moment + 1]).max()) / MILLISECOND
        inside = slice(start + 1, moment)
        came = (conversation.kinds[inside] == MomentKind.CAME) & ~conversation.answers[inside]
        traffic = tuple((np.diff(times[inside][came]) / MILLISECOND).tolist())
        places = conversation.place(start), conversation.place(moment)
        yield Starving(conversation.wait(start, moment), gap, traffic, places)


def client_law(found: Sequence[HeartbeatWait]) -> tuple[HeartbeatLaw | None, tuple[HeartbeatWait, ...], int]:
    """The law that most HEARTBEATs follow that distinguish laws, those that do, and how many follow another one.

    Where several periods are possible, the usual one counts.
    """
    if not found:
        return None, (), 0
    rearmed, steady = min(each.activity for each in found), min(each.beat for each in found)
    if any(_fits_usual(each.activity) for each in found):
        rearmed = USUAL_PERIOD  # a packet that came just before a HEARTBEAT had not been read yet
    if steady > rearmed * _CLEARLY and _is_near(rearmed, USUAL_PERIOD):
        steady = rearmed
    votes = [(_vote(wait, rearmed, steady), wait) for wait in found]
    counted = Counter(law for law, _ in votes if law is not None)
    if not counted:
        return None, (), 0
    law = max(HeartbeatLaw, key=lambda each: counted[each])
    if 2 * counted[law] <= counted.total():
        return None, (), 0
    return law, tuple(wait for vote, wait in votes if vote is law), counted.total() - counted[law]


def _vote(wait: HeartbeatWait, rearmed: float, steady: float) -> HeartbeatLaw | None:
    """The only law by which a HEARTBEAT comes on time, if the period is one of these by the two laws."""
    if wait.previous and 1.8 < wait.beat / wait.previous < 2.2 and wait.activity == wait.beat:
        return HeartbeatLaw.DOUBLING
    by_activity, by_beat = _is_near(wait.activity, rearmed), _is_near(wait.beat, steady)
    if by_activity == by_beat:
        return None
    return HeartbeatLaw.REARMED if by_activity else HeartbeatLaw.STEADY


def _is_near(time: float, period: float) -> bool:
    return period / _CLEARLY < time < period * _CLEARLY


def law_quantity(
    found: Sequence[HeartbeatWait], starved: Sequence[Starving], period: float
) -> tuple[HeartbeatLaw | None, Quantity]:
    """The law of a client, and what says so: HEARTBEATs, or that none came for longer than any other law allows."""
    law, following, against = client_law(found)
    silent = [one for one in starved if one.length > 3 * period]
    name, title = "client_heartbeat_law", "intervals that show the heartbeat policy of the client"
    if law is None and not silent:
        missing = "no HEARTBEAT tells the policies apart: other packets must come shortly before one"
        return None, Quantity(name, title, QuantityUnit.MILLISECONDS, (), None, Confidence.NOT_ENOUGH, missing)
    law = law or HeartbeatLaw.REARMED
    how = f"{law.value}; HEARTBEATs that show it: {len(following)}, that contradict it: {against}"
    samples = [Observation(wait.activity, wait.places) for wait in following]
    if silent and law is HeartbeatLaw.REARMED:
        longest = max(one.length for one in silent)
        how += f"; messages were unacknowledged for up to {longest:.0f} ms, and none came"
        samples += [Observation(one.length, one.places) for one in silent]
    confidence = Confidence.MEASURED if len(samples) > 1 else Confidence.ONE_SAMPLE
    return law, Quantity(name, title, QuantityUnit.MILLISECONDS, tuple(samples), None, confidence, how)


def client_period(found: Sequence[HeartbeatWait], law: HeartbeatLaw | None) -> Quantity:
    """The time that a client waits for an ACKNACK."""
    name, title = "client_heartbeat", "period of the client's HEARTBEATs"
    since = [Observation(wait.beat if law is HeartbeatLaw.STEADY else wait.activity, wait.places) for wait in found]
    if law is HeartbeatLaw.DOUBLING:
        since = [sample for sample, wait in zip(since, found, strict=True) if wait.previous is None]
        title = "first wait of the client's HEARTBEATs"
    if not since:
        return seen(name, title, (), "the client sends no HEARTBEAT with messages unacknowledged")
    prompt = punctual(since)
    if len(since) == 1 and not _fits_usual(since[0].value) and law is not HeartbeatLaw.DOUBLING:
        how = f"at most {since[0].value:.0f} ms: one HEARTBEAT came so late, and something may have put it off"
        least = since[0].value if since[0].value < USUAL_PERIOD else None
        return Quantity(name, title, QuantityUnit.MILLISECONDS, tuple(since), least, Confidence.BOUND, how)
    confidence = Confidence.MEASURED if len(prompt) > 1 else Confidence.ONE_SAMPLE
    shortest = min(s.value for s in prompt)
    fitting = [s for s in since if _fits_usual(s.value)]
    if len(prompt) < _FEW and law is not HeartbeatLaw.DOUBLING and fitting:
        how = f"the usual period, which {len(fitting)} of {len(since)} fit"
        confidence = Confidence.MEASURED if len(fitting) > 1 else Confidence.ONE_SAMPLE
        return Quantity(name, title, QuantityUnit.MILLISECONDS, tuple(since), USUAL_PERIOD, confidence, how)
    if not shortest:
        how = "two HEARTBEATs are there at the same time: their packets were recorded twice, or copied"
        return Quantity(name, title, QuantityUnit.MILLISECONDS, tuple(since), None, Confidence.NOT_ENOUGH, how)
    value = roundest(shortest - _TICK, max(_middle(values_of(prompt)), shortest), len(prompt))
    how = f"the roundest number near the shortest waits, {len(prompt)} of {len(since)}"
    return Quantity(name, title, QuantityUnit.MILLISECONDS, tuple(since), value, confidence, how)


def _fits_usual(wait: float) -> bool:
    """True if a wait may be that of the usual period: recorded a little early at its end or late at its begin, or kept
    by what else the client had to do."""
    return 0.85 * USUAL_PERIOD < wait < 1.2 * USUAL_PERIOD


def agent_rounds(conversation: Conversation) -> tuple[PackedSamples, PackedSamples]:
    """The times of the Agent's HEARTBEATs about a stream: between two with messages unacknowledged all the time, and
    from the first unacknowledged message to the first HEARTBEAT."""
    waiting = conversation.unacknowledged > 0
    beats = waiting & (conversation.kinds == MomentKind.HEARTBEAT)
    anchors = last_before(beats | (waiting & ~np.append(False, waiting[:-1])))
    moments = np.flatnonzero(beats & np.append(False, waiting[:-1]))
    again = beats[anchors[moments]]
    between, first = (conversation.between(anchors[chosen], chosen) for chosen in (moments[again], moments[~again]))
    return between, first


_LEFT_OUT: Final = 2.5


def agent_period(between: PackedSamples, first: PackedSamples) -> tuple[Quantity, Quantity]:
    """The period of the Agent's HEARTBEATs, and how long the first one waits: anything up to a period, because one
    thread goes round all clients, whatever they do."""
    name, title = "agent_heartbeat", "period of the Agent's HEARTBEATs"
    phase = seen(
        "agent_first_heartbeat",
        "from the first unacknowledged message to the Agent's HEARTBEAT",
        first.as_they_are(),
        "no HEARTBEAT of the Agent is the first after a message",
    )
    if not between:
        how = "the Agent sends no two HEARTBEATs with messages unacknowledged all the time between them"
        return seen(name, title, (), how), phase
    waits = between.values
    middle = _middle(waits)
    between = between.chosen(waits < _LEFT_OUT * middle)
    waits = between.values
    regular = waits[np.abs(waits - middle) < middle / 10]
    samples = between.as_they_are()
    if 2 * len(regular) <= len(waits):
        how = f"only {len(regular)} of {len(waits)} are near their median: something delays them"
        return Quantity(name, title, QuantityUnit.MILLISECONDS, samples, None, Confidence.BOUND, how), phase
    middle = np.sort(regular)[(len(regular) - 1) // 2].item()
    value = roundest(regular.min().item(), middle, len(regular))
    how = f"the roundest number up to the median of the regular ones, {len(regular)} of {len(waits)}"
    confidence = Confidence.MEASURED if len(regular) > 1 else Confidence.ONE_SAMPLE
    return Quantity(name, title, QuantityUnit.MILLISECONDS, samples, value, confidence, how), phase


def _middle(waits: NDArray[np.float64]) -> float:
    found: float = np.sort(waits)[len(waits) // 2].item()
    return found
