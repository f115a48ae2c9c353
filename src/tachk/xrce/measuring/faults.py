"""Links that stop for good, and Agents that do: what is not a single loss, since nothing follows that repairs it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Final

from tachk.base.records import dataclass
from tachk.xrce.measuring.quantity import Confidence, Observation, PacketPlace, Quantity, QuantityUnit, seen
from tachk.xrce.transmission import Transmission
from tachk.xrce.transmissions import Capture
from tachk.xrce.wire import SubmessageKind

_MILLISECOND: Final = 1e6
_OF_STREAMS: Final = frozenset({SubmessageKind.HEARTBEAT, SubmessageKind.ACKNACK})
_FEWEST: Final = 3
"""So many messages have to be lost, or stay without an answer, at the end."""

_SHORTEST: Final = 250e6
"""Nanoseconds that this has to last."""


@dataclass(frozen=True, slots=True)
class StreamStop:
    """From some packet to the end nothing of the streams comes through on a way, or is answered there.

    Attributes:
        link: the index of the link in its recording.
        to_agent: which way.
        messages: how many, from the first to the last.
        is_unanswered: they may have arrived, but the Agent answers none of them.
    """

    link: int
    to_agent: bool
    messages: tuple[Transmission, ...]
    is_unanswered: bool


def stops(recording: Capture, is_expected: Callable[[Transmission], bool]) -> Iterator[StreamStop]:
    """The ways that stop for good.

    Args:
        is_expected: whether a message cannot arrive, as its receiver sleeps.
    """
    for link in range(len(recording.links)):
        for to_agent in (True, False):
            sent = recording.transmissions.where(link, to_agent)
            ours = [one for one in sent if _is_of_streams(one) and not is_expected(one)]
            lost = _tail(ours, lambda one: one.is_lost)
            if _is_long(lost):
                yield StreamStop(link, to_agent, lost, False)
            elif to_agent:
                last = _last_answer(recording, link)
                silent = tuple(one for one in ours if one.sent > last and _wants_answer(one))
                if _is_long(silent):
                    yield StreamStop(link, to_agent, silent, True)


def _tail(messages: Sequence[Transmission], belongs: Callable[[Transmission], bool]) -> tuple[Transmission, ...]:
    first = len(messages)
    while first and belongs(messages[first - 1]):
        first -= 1
    return tuple(messages[first:])


def _is_long(found: Sequence[Transmission]) -> bool:
    return len(found) >= _FEWEST and found[-1].sent - found[0].sent >= _SHORTEST


def _last_answer(recording: Capture, link: int) -> int:
    return max(
        (one.sent for one in recording.transmissions.where(link, to_agent=False) if _is_of_streams(one)),
        default=recording.begin,
    )


def _is_of_streams(one: Transmission) -> bool:
    return one.is_reliable or not _OF_STREAMS.isdisjoint(one.kinds)


def _wants_answer(one: Transmission) -> bool:
    return one.is_reliable or SubmessageKind.HEARTBEAT in one.kinds


def stops_quantity(found: Sequence[tuple[str, StreamStop]]) -> Quantity:
    """The time to the end in which nothing came through."""
    samples = [
        Observation(
            (stop.messages[-1].sent - stop.messages[0].sent) / _MILLISECOND,
            tuple(PacketPlace(file, one.packet) for one in stop.messages),
        )
        for file, stop in found
    ]
    name, title = "stopped", "at the end, nothing of a stream comes through one way"
    if not samples:
        return seen(name, title, (), "on every way something of the streams comes through in the end")
    ways = sorted({_words(stop) for _, stop in found})
    longest = max(sample.value for sample in samples)
    how = f"the longest; {', '.join(ways)}"
    return Quantity(name, title, QuantityUnit.MILLISECONDS, tuple(samples), longest, Confidence.MEASURED, how)


def _words(stop: StreamStop) -> str:
    if stop.is_unanswered:
        return "the Agent answers a client no more"
    return "messages to the Agent are lost" if stop.to_agent else "messages to a client are lost"
