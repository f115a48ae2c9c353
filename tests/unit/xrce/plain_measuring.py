"""Measures captures message by message, as `tachk.xrce.measuring` says what is measured: the answer to compare with.

Samples are tuples: the value, and the packets that it came from.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from tachk.xrce.events import SubmessageEvent
from tachk.xrce.streams import nearest_number
from tachk.xrce.transmission import ReadTransmission
from tachk.xrce.wire import SubmessageKind

MILLISECOND = 1e6
SAMPLES = {SubmessageKind.WRITE_DATA, SubmessageKind.DATA}
Sample = tuple[Any, ...]


@dataclass
class Moment:
    """``what``: sent, heartbeat or came; ``number``: of a message, or the first one of an ACKNACK about the stream."""

    what: str
    time: int
    number: int | None
    again: bool
    before: int
    waiting: int
    one: ReadTransmission

    @property
    def answers(self) -> bool:
        return self.what == "came" and self.number is not None


def between(earlier: Moment, later: Moment) -> Sample:
    return (later.time - earlier.time) / MILLISECOND, earlier.one.packet, later.one.packet


def moments(ours: Sequence[ReadTransmission], from_client: bool, stream: int) -> list[Moment]:
    """What happens at the sender of a stream."""
    there = [(time, one) for one in ours for time in times_at(one, from_client)]
    found: list[Moment] = []
    sent = acknowledged = 0
    for time, one in sorted(there, key=lambda pair: (pair[0], pair[1].packet)):
        about = [event for event in one.events if event.fields.get("subject") == stream]
        before = max(sent - acknowledged, 0)
        if one.to_agent != from_client:
            number = None
            for event in about:
                if event.kind is SubmessageKind.ACKNACK:
                    number = nearest_number(integer(event, "first"), sent)
                    acknowledged = max(acknowledged, min(number, sent))
            found.append(Moment("came", time, number, False, before, max(sent - acknowledged, 0), one))
            continue
        if SubmessageKind.CREATE_CLIENT in one.kinds:
            sent = acknowledged = 0
        first = one.events[0]
        if first.stream == stream and first.sequence is not None:
            number = nearest_number(first.sequence, sent)
            again, sent = number < sent, max(sent, number + 1)
            found.append(Moment("sent", time, number, again, 0, max(sent - acknowledged, 0), one))
        if any(event.kind is SubmessageKind.HEARTBEAT for event in about):
            found.append(Moment("heartbeat", time, None, False, 0, max(sent - acknowledged, 0), one))
    return found


def times_at(one: ReadTransmission, from_client: bool) -> list[int]:
    if one.to_agent == from_client or one.arrivals is None:
        return [one.sent]
    return [arrival.time for arrival in one.arrivals]


def integer(event: SubmessageEvent, name: str) -> int:
    value = event.fields[name]
    assert isinstance(value, int)
    return value


def wants_answer(one: ReadTransmission) -> bool:
    return one.is_reliable or SubmessageKind.HEARTBEAT in one.kinds


def overdue(activity: Moment, heartbeat: Moment) -> bool:
    waited = (heartbeat.time - activity.time) / MILLISECOND
    return activity.what == "sent" and waited < 5 and (heartbeat.waiting > 1 or not 0.9 < waited < 1.4)


def waits(found: Sequence[Moment]) -> Iterator[Sample]:
    """Since activity, since the HEARTBEAT before, the same of that one, and the packets."""
    activity: Moment | None = None
    anchor: Moment | None = None
    previous: float | None = None
    for moment in found:
        if moment.what == "heartbeat":
            if moment.waiting and activity and anchor and not overdue(activity, moment):
                since, beat = between(activity, moment)[0], between(anchor, moment)[0]
                yield since, beat, previous, anchor.one.packet, activity.one.packet, moment.one.packet
                previous = beat
            anchor = moment
        elif moment.answers or (
            moment.what == "sent" and (anchor is None or (moment.waiting == 1 and not moment.again))
        ):
            anchor, previous = moment, None
        activity = moment


def starvings(found: Sequence[Moment], period: float) -> Iterator[Sample]:
    """The length, the longest gap, the times between other packets that came in, and the packets."""
    start: Moment | None = None
    inside: list[Moment] = []
    for moment in found:
        if start is not None and (moment.what == "heartbeat" or moment.answers or not moment.waiting):
            times = [start.time, *(each.time for each in inside), moment.time]
            length, *packets = between(start, moment)
            if length > 1.25 * period:
                came = [each.time for each in inside if each.what == "came" and not each.answers]
                gap = max(b - a for a, b in pairwise(times)) / MILLISECOND
                yield length, gap, tuple((b - a) / MILLISECOND for a, b in pairwise(came)), *packets
            start, inside = None, []
        elif start is not None:
            inside.append(moment)
        if start is None and moment.waiting:
            start = moment


def agent_rounds(found: Sequence[Moment]) -> tuple[list[Sample], list[Sample]]:
    again: list[Sample] = []
    first: list[Sample] = []
    anchor: Moment | None = None
    for moment in found:
        if not moment.waiting:
            anchor = None
        elif moment.what == "heartbeat":
            if anchor is not None:
                (again if anchor.what == "heartbeat" else first).append(between(anchor, moment))
            anchor = moment
        elif anchor is None:
            anchor = moment
    return again, first


def longest(found: Sequence[Moment]) -> int:
    most, since = 0, None
    for moment in found:
        since = None if not moment.waiting else moment.time if since is None else since
        most = max(most, moment.time - since) if since is not None else most
    return most


def round_trips(found: Sequence[Moment]) -> Iterator[Sample]:
    repeated = {moment.number for moment in found if moment.again}
    waiting: list[Moment] = []
    for moment in found:
        if moment.what == "sent" and moment.number not in repeated:
            waiting.append(moment)
        elif moment.answers:
            yield from (between(each, moment) for each in waiting if (each.number or 0) < (moment.number or 0))
            waiting = [each for each in waiting if (each.number or 0) >= (moment.number or 0)]


def repairs(found: Sequence[Moment]) -> Iterator[Sample]:
    lost: dict[int, Moment] = {}
    unseen: dict[int, Moment] = {}
    repeated = {moment.number for moment in found if moment.again}
    for moment in found:
        number, one = moment.number or 0, moment.one
        if moment.what == "sent" and not moment.again and not one.is_observed:
            unseen[number] = moment
        elif moment.what == "sent" and not moment.again:
            lost.pop(number, None)
            if one.is_lost:
                lost[number] = moment
        elif moment.what == "sent" and number in lost and one.arrivals:
            left = lost.pop(number)
            yield (one.arrived - left.time) / MILLISECOND, left.one.packet, one.packet
        elif moment.answers:
            for each in [each for each in unseen if each < number]:
                left = unseen.pop(each)
                if each in repeated:
                    yield between(left, moment)


def paces(found: Sequence[Moment]) -> list[Sample]:
    written = [each for each in found if each.what == "sent" and not each.again and SAMPLES & each.one.kinds]
    return [between(before, after) for before, after in pairwise(written)]


def made_room(found: Sequence[Moment], most: int) -> list[tuple[int, int]]:
    return [
        (before.one.packet, after.one.packet)
        for before, after in pairwise(found)
        if before.what == "came" and before.before == most > before.waiting
        if after.what == "sent" and not after.again and after.time - before.time < 5 * MILLISECOND
    ]


def reactions(ours: Sequence[ReadTransmission]) -> Iterator[Sample]:
    answers = [one for one in ours if one.to_agent and SubmessageKind.ACKNACK in one.kinds]
    times = [one.sent for one in answers]
    for one in ours:
        if not one.to_agent and one.arrivals and wants_answer(one):
            place = bisect_left(times, one.arrived)
            if place < len(answers):
                yield (times[place] - one.arrived) / MILLISECOND, one.arrivals[0].packet, answers[place].packet


def said(one: ReadTransmission) -> str:
    return repr((one.link, one.to_agent, [(e.kind, e.stream, e.sequence, e.fields) for e in one.events]))


def overtakings(transmissions: Sequence[ReadTransmission]) -> Iterator[Sample]:
    sent: dict[str, list[int]] = {}
    for one in transmissions:
        sent.setdefault(said(one), []).append(one.sent)
    newest: dict[tuple[int, bool], tuple[int, ReadTransmission]] = {}
    for one in sorted((one for one in transmissions if one.arrivals), key=lambda one: one.arrived):
        way, times = (one.link, one.to_agent), sent[said(one)]
        at_most = max((time for time in times if time <= one.arrived), default=min(times))
        if way in newest and newest[way][0] > at_most:
            earlier = newest[way][1]
            yield (one.arrived - earlier.arrived) / MILLISECOND, earlier.packet, one.packet
        if way not in newest or newest[way][0] < min(times):
            newest[way] = min(times), one


def twice(ours: Sequence[ReadTransmission]) -> int:
    waiting: dict[str, int] = {}
    count = 0
    for one in ours:
        before = waiting.pop(said(one), None)
        if before is not None and one.sent - before < 50 * MILLISECOND:
            count += 1
        else:
            waiting[said(one)] = one.sent
    return count


def asleep(ours: Sequence[ReadTransmission], end: int) -> Iterator[Sample]:
    """When a client falls asleep, and wakes, how much earlier it may sleep, and the packets."""
    spoken = [one for one in ours if one.to_agent]
    for number, last in enumerate(spoken):
        waking = spoken[number + 1] if number + 1 < len(spoken) else None
        until = waking.sent if waking else end
        unanswered = [
            one
            for one in ours
            if not one.to_agent and last.sent < one.sent < until and wants_answer(one)
            if one.is_lost or until - one.arrived > 20 * MILLISECOND
        ]
        if until - last.sent >= 2e9 and len(unanswered) >= 2 and until - unanswered[0].sent >= 2e9:
            begin = unanswered[0].sent
            yield begin, until, begin - last.sent, unanswered[0].packet, waking.packet if waking else None


def read_by_client(ours: Sequence[ReadTransmission]) -> list[tuple[Any, ...]]:
    """ACKNACKs that a client sends, and what comes to it, in the order of times."""
    found: list[tuple[Any, ...]] = []
    for one in ours:
        for time in [one.sent] if one.to_agent else [arrival.time for arrival in one.arrivals or ()]:
            for event in one.events:
                row = _at_client(event)
                found += [(time, one.packet, row)] if row else []
    return [(time, *row) for time, _, row in sorted(found, key=lambda each: each[:2])]


def _at_client(event: SubmessageEvent) -> tuple[Any, ...] | None:
    if event.kind is SubmessageKind.CREATE_CLIENT:
        return "begins", 0, False
    about = event.fields.get("subject") == 0x80
    if event.to_agent:
        missing = event.fields.get("missing")
        is_answer = event.kind is SubmessageKind.ACKNACK and about and isinstance(missing, list)
        return ("acknack", integer(event, "first"), frozenset(missing)) if is_answer else None
    if event.kind is SubmessageKind.HEARTBEAT and about:
        return "heartbeat", integer(event, "last"), False
    if event.stream == 0x80 and event.sequence is not None and event.place == 0:
        return "message", event.sequence, event.kind is SubmessageKind.FRAGMENT and not event.fields["last"]
    return None


def unanswered(stream: Sequence[tuple[Any, ...]]) -> int:
    answers = [number for number, each in enumerate(stream) if each[1] == "acknack"]
    received = [each for each in stream[: answers[-1]] if each[1] in ("heartbeat", "message")] if answers else []
    return max(len(received) - len(answers), 0)


def differences(stream: Sequence[tuple[Any, ...]], size: int) -> int:
    """The number of ACKNACKs that a client with ``size`` slots would not have sent."""
    slots: dict[int, bool] = {}
    handled = announced = wrong = 0
    waiting = deque[tuple[Any, ...]]()
    sleeps = unanswered(stream) > 0
    for each in stream:
        if each[1] != "acknack":
            waiting.append(each)
            continue
        while waiting and (waiting[0][1] == "begins" or (sleeps and each[0] - waiting[0][0] > 100 * MILLISECOND)):
            if waiting.popleft()[1] == "begins":
                slots, handled, announced = {}, 0, 0
        if not waiting:
            continue
        _, what, last_bits, is_piece = waiting.popleft()
        number = nearest_number(last_bits, handled)
        if what == "message" and handled <= number < handled + size:
            slots.setdefault(number, is_piece)
        announced = max(announced, number + 1)
        while True:
            together = next((n for n in range(size) if slots.get(handled + n) is not True), None)
            if together is None or handled + together not in slots:
                break
            for _ in range(together + 1):
                del slots[handled]
                handled += 1
        first = next(n for n in range(handled, handled + size + 1) if n not in slots)
        missing = frozenset(n % 65536 for n in range(first, min(announced, first + 16)) if not _in_use(slots, n, size))
        wrong += (each[2], each[3]) != (first % 65536, missing)
    return wrong


def _in_use(slots: dict[int, bool], number: int, size: int) -> bool:
    return any(each % size == number % size for each in slots)
