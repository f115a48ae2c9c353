"""Rounds of messages that repeat themselves in a capture, such as unanswered HEARTBEATs, which are shown once."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from itertools import pairwise
from statistics import median
from typing import Final

from tachk.base.records import replace
from tachk.report.drawing.sequence.chart import Chart, Event, Message, Note, begun
from tachk.report.drawing.sequence.layout import decimal

_LONGEST: Final = 6
"""Messages of a round."""

_FEWEST: Final = 6
"""Rounds: fewer are drawn as they are."""


def shown_once(chart: Chart) -> Chart:
    """The chart with the first and the last of such rounds, and a note of how many are between them."""
    shown: list[Event] = []
    place = 0
    alike = [_alike(event) for event in chart.events]
    while place < len(alike):
        length, rounds = _rounds(alike, place)
        end = place + length * rounds
        if rounds >= _FEWEST:
            shown += chart.events[place : place + length]
            shown.append(_note(chart, place, length, rounds))
            shown += chart.events[end - length : end]
        else:
            end = place + 1
            shown.append(chart.events[place])
        place = end
    return replace(chart, events=tuple(shown))


def _alike(event: Event) -> Hashable:
    """The common appearance of two events."""
    if not isinstance(event, Message):
        return event
    return event.sender, event.receivers, event.label, event.is_lost, event.is_repeated, len(event.arrivals)


def _rounds(alike: Sequence[Hashable], place: int) -> tuple[int, int]:
    """The length of the shortest round that begins here and repeats itself often, and how often it comes."""
    for length in range(1, _LONGEST + 1):
        first = alike[place : place + length]
        rounds = 1
        while alike[place + rounds * length : place + (rounds + 1) * length] == first:
            rounds += 1
        if rounds >= _FEWEST:
            return length, rounds
    return 1, 1


def _note(chart: Chart, place: int, length: int, rounds: int) -> Note:
    begins = [begun(chart.events[place + number * length]) for number in range(rounds)]
    every = median(later.time - earlier.time for earlier, later in pairwise(begins))
    left_out = chart.events[place + length : place + (rounds - 1) * length]
    tags = [event.tag for event in left_out if isinstance(event, Message) and event.tag]
    packets = f", packets {tags[0]} to {tags[-1]}" if tags else ""
    return Note(None, begins[1], f"↻ {rounds - 2} times, every {decimal(every)} {chart.unit}".rstrip() + packets)
