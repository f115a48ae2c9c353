"""Links that stop for good, and Agents that do: what is not a single loss, since nothing follows that repairs it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from tachk.base.records import dataclass
from tachk.xrce.datagrams import Flags
from tachk.xrce.measuring.conversation import MILLISECOND
from tachk.xrce.measuring.quantity import Confidence, Quantity, QuantityUnit, gathered, packed_groups, seen
from tachk.xrce.packed_transmissions import PackedTransmissions
from tachk.xrce.packets import Numbers
from tachk.xrce.transmissions import Capture
from tachk.xrce.wire import SubmessageKind

_OF_STREAMS: Final = (SubmessageKind.HEARTBEAT, SubmessageKind.ACKNACK)
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
        rows: which of the transmissions ``sent``, from the first to the last.
        is_unanswered: they may have arrived, but the Agent answers none of them.
    """

    link: int
    to_agent: bool
    sent: PackedTransmissions
    rows: Numbers
    is_unanswered: bool

    @property
    def length(self) -> float:
        """Milliseconds from the first to the last."""
        return int(self.sent.sent[self.rows[-1]] - self.sent.sent[self.rows[0]]) / MILLISECOND

    @property
    def packets(self) -> Numbers:
        """The numbers of their packets."""
        return self.sent.packets[self.rows]


def stops(recording: Capture, is_expected: Flags) -> Iterator[StreamStop]:
    """The ways that stop for good.

    Args:
        is_expected: for each transmission whether it cannot arrive, as its receiver sleeps.
    """
    sent = recording.transmissions
    for link in range(len(recording.links)):
        for to_agent in (True, False):
            rows = _of_streams(sent, link, to_agent)
            ours = rows[~is_expected[rows]]
            arrives = np.flatnonzero(~sent.is_lost[ours])
            lost = ours[arrives[-1] + 1 :] if len(arrives) else ours
            if _is_long(sent, lost):
                yield StreamStop(link, to_agent, sent, lost, False)
            elif to_agent:
                answers = sent.sent[_of_streams(sent, link, to_agent=False)]
                last = answers.max() if len(answers) else recording.begin
                silent = ours[(sent.sent[ours] > last) & sent.wants_answer(ours)]
                if _is_long(sent, silent):
                    yield StreamStop(link, to_agent, sent, silent, True)


def _is_long(sent: PackedTransmissions, rows: Numbers) -> bool:
    return len(rows) >= _FEWEST and bool(sent.sent[rows[-1]] - sent.sent[rows[0]] >= _SHORTEST)


def _of_streams(sent: PackedTransmissions, link: int, to_agent: bool) -> Numbers:
    rows = sent.rows(link, to_agent)
    return rows[sent.is_reliable[rows] | sent.having(rows, *_OF_STREAMS)]


def stops_quantity(found: Sequence[tuple[str, StreamStop]]) -> Quantity:
    """The time to the end in which nothing came through."""
    samples = gathered(
        packed_groups(file, np.array([stop.length]), stop.packets, np.array([len(stop.rows)])) for file, stop in found
    )
    name, title = "stopped", "at the end, nothing of a stream comes through one way"
    if not samples:
        return seen(name, title, (), "on every way something of the streams comes through in the end")
    ways = sorted({_words(stop) for _, stop in found})
    longest = max(stop.length for _, stop in found)
    how = f"the longest; {', '.join(ways)}"
    return Quantity(name, title, QuantityUnit.MILLISECONDS, samples, longest, Confidence.MEASURED, how)


def _words(stop: StreamStop) -> str:
    if stop.is_unanswered:
        return "the Agent answers a client no more"
    return "messages to the Agent are lost" if stop.to_agent else "messages to a client are lost"
