"""The layout of a sequence chart.

Lifelines stand side by side, far enough apart for the labels between them. Time goes down, in one of two ways.
Compressed: every message gets a line of its own, with a little more room the longer nothing happens. To scale: equal
times are equal lengths, and labels that would stand on one another move apart, each with a line to its arrow. In both,
long silences are cut out and marked.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from itertools import pairwise
from math import log10
from statistics import median

from tachk.formats.layout.label_text import text_width
from tachk.report.drawing.sequence.chart import (
    Chart,
    EnteredLocation,
    Event,
    Message,
    Moment,
    Note,
    Phase,
    begun,
    moments,
)

LINE = 17
"""From one label to the next one below it."""

_ASCENT = 11
_LABEL_DISTANCE = LINE - 2
"""The same where labels had to move; more than the height of a text."""

_NEAR = 400
"""Labels placed before that may still be in the way."""

HEADER = 44
"""From the top of the lifelines to the first event."""

_FOOTER = 24
_NARROWEST, _WIDEST = 130, 330
_AROUND = 26
_MARGIN = 16
_TIMES = 50
"""The least width of the column of times, at the left."""

_ABOVE_ARROW = 5
"""From an arrow up to the base line of its label, whose letters may reach below that line."""

_ARRIVAL = 7
"""A message that takes time arrives at least so far below the place where it was sent."""

_FAR = 12 * LINE
"""The end of an arrow that is longer downwards gets a label, too."""

_CROSSED = 10
"""More room below the cross of a lost message."""

_NOTED = 8
"""More room below a note, which stands in the middle of its line."""

_BOXED = 8
"""More room below a location, which stands in a box."""

_BOX_HEIGHT, _BOX_PADDING = 18, 7

_TOGETHER, _BOXES_TOGETHER = 16, 24
"""To scale: from one event down to the next one at the same time, and where one of them is a box."""

_BREAK = 30
_QUIET = 6
"""A silence is long if it takes so many times as long as the usual time between two events, and"""

_PARTS = 40
"""if fewer of them than this make up the whole time."""

_FEW, _MUCH, _PART = 4, 3, 5
"""To scale, at most four silences are left out, that are three times as long as others and a fifth of all others."""

_TALLEST = 2400
"""A chart to scale gets about so high, unless its labels need more."""


class TimeAxis(StrEnum):
    """The scale of time, which goes down."""

    COMPRESSED = "compressed"
    SCALE = "scale"


@dataclass(frozen=True, slots=True)
class Arrow:
    """A message from a point to others; a cross stands at the end of one that is lost.

    Attributes:
        x, y: where it is sent.
        ends: where it arrives: x and y, the first arrival first, for each receiver.
        copies: the same of further arrivals.
    """

    message: Message
    x: int
    y: float
    ends: tuple[tuple[float, float], ...]
    copies: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class ChartLabel:
    """A text with its anchor at the left (``start``), right (``end``) or ``middle``; y is its base line.

    Attributes:
        style: a class of the picture's style.
        pointer: where a line leads to from the label; None if it stands where it belongs.
        full: the whole text where it was cut off.
    """

    text: str
    x: float
    y: float
    anchor: str
    style: str
    pointer: tuple[float, float] | None = None
    full: str = ""

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Left, top, right, bottom."""
        width = text_width(self.text)
        left = {"start": self.x, "end": self.x - width, "middle": self.x - width / 2}[self.anchor]
        return left, self.y - _ASCENT, left + width, self.y + 3


@dataclass(frozen=True, slots=True)
class LocationBox:
    """A location on a lifeline, in a box with its middle at x and y.

    Attributes:
        full: the whole text where it was cut off.
    """

    text: str
    x: int
    y: float
    full: str = ""

    @property
    def width(self) -> int:
        return _box_width(self.text)

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Left, top, right, bottom."""
        across, down = self.width / 2, _BOX_HEIGHT / 2
        return self.x - across, self.y - down, self.x + across, self.y + down


@dataclass(frozen=True, slots=True)
class LifelineBand:
    """A phase along a lifeline, from one y to another."""

    phase: Phase
    x: int
    top: float
    bottom: float


@dataclass(frozen=True, slots=True)
class Cut:
    """A silence that was cut out, from one y to another."""

    top: float
    bottom: float


@dataclass(frozen=True, slots=True)
class ChartLayout:
    """A chart with places for everything.

    Attributes:
        lifelines: the x of each.
        width, height: of the picture.
    """

    chart: Chart
    lifelines: tuple[int, ...]
    arrows: tuple[Arrow, ...]
    labels: tuple[ChartLabel, ...]
    locations: tuple[LocationBox, ...]
    bands: tuple[LifelineBand, ...]
    cuts: tuple[Cut, ...]
    width: int
    height: int


def lay_out(chart: Chart, axis: TimeAxis = TimeAxis.COMPRESSED) -> ChartLayout:
    """Finds a place for everything. No two labels overlap."""
    xs = _columns(chart)
    rows = _ChartRows(chart, axis)
    arrows = tuple(_arrow(message, rows, xs) for message in chart.messages)
    locations = tuple(_location(event, rows, xs) for event in chart.events if isinstance(event, EnteredLocation))
    labels = _without_overlap([*_labels(chart, rows, xs), *rows.times(), *rows.cut_texts()], locations)
    bands = tuple(
        LifelineBand(
            phase, xs[phase.lifeline], rows.at(phase.begin), max(rows.at(phase.end), rows.at(phase.begin) + LINE)
        )
        for phase in chart.phases
    )
    lowest = max([rows.bottom, *(label.y for label in labels), *(band.bottom for band in bands)])
    right = max([xs[-1] + 60 if xs else 200, *(label.box[2] for label in labels), *(one.box[2] for one in locations)])
    return ChartLayout(
        chart,
        xs,
        arrows,
        tuple(labels),
        locations,
        bands,
        tuple(rows.cuts),
        int(right + _MARGIN),
        int(lowest + _FOOTER),
    )


def _columns(chart: Chart) -> tuple[int, ...]:
    """The positions of lifelines: labels and names fit between them."""
    count = len(chart.lifelines)
    lanes = [float(_NARROWEST)] * max(count - 1, 0)
    widths = [text_width(name) + 24 for name in chart.lifelines]
    for event in chart.events:
        if isinstance(event, EnteredLocation):
            widths[event.lifeline] = max(widths[event.lifeline], _box_width(_shown(event)))
    for lane in range(count - 1):
        lanes[lane] = max(lanes[lane], (widths[lane] + widths[lane + 1]) / 2 + 16)
    for event in chart.events:
        beside = _lane(event)
        if beside is not None and 0 <= beside < count - 1:
            lanes[beside] = max(lanes[beside], min(text_width(_shown(event)), _WIDEST) + _AROUND)
    xs = [_times_width(chart) + (widths[0] // 2 + 4 if count else 0)]
    for lane_width in lanes:
        xs.append(round(xs[-1] + lane_width))
    return tuple(xs[:count])


def _times_width(chart: Chart) -> int:
    """The width of the column of times, which begins with tags."""
    tags = max((text_width(message.tag) for message in chart.messages), default=0)
    found = [begun(event).time for event in chart.events]
    whole = [max(found) - min(found)] if found else []
    times = max((text_width(f"{decimal(time)} {chart.unit}") for time in (*found, *whole)), default=0)
    return _MARGIN + max(times, _TIMES) + (tags + 10 if tags else 0) + _MARGIN


def _lane(event: Event) -> int | None:
    """Between which lifelines the label of an event stands: those with this number and the next."""
    if isinstance(event, EnteredLocation):
        return None
    if isinstance(event, Note):
        return event.lifeline
    furthest = max(event.receivers, key=lambda each: abs(each - event.sender), default=event.sender)
    return event.sender if furthest >= event.sender else event.sender - 1


def _box_width(text: str) -> int:
    return text_width(text) + 2 * _BOX_PADDING


def _shown(event: Event) -> str:
    """The marks at an event."""
    if not isinstance(event, Message):
        return _cut(event.text)
    said = event.label
    if event.is_repeated:
        said += " again"
    if event.is_lost:
        said += " lost"
    if event.is_under_way:
        said += " sent before"
    elif len(event.arrivals) > 1:
        said += f" ×{len(event.arrivals)}"
    return _cut(said)


def _cut(text: str) -> str:
    """As much of a text as fits between two lifelines."""
    if text_width(text) <= _WIDEST:
        return text
    shown = len(text)
    while shown > 1 and text_width(text[:shown] + "…") > _WIDEST:
        shown -= 1
    return text[:shown].rstrip() + "…"


class _ChartRows:
    """The vertical positions of moments.

    Attributes:
        cuts: silences that are left out.
        bottom: of the last line.
    """

    def __init__(self, chart: Chart, axis: TimeAxis) -> None:
        self._chart = chart
        self._right = _times_width(chart) - _MARGIN
        self.cuts: list[Cut] = []
        self._cut_times: list[tuple[float, str]] = []
        self._moments = sorted({moment for event in chart.events for moment in moments(event)})
        if axis is TimeAxis.SCALE:
            self._ys = list(self._to_scale())
        else:
            self._ys = list(self._compressed())
        self.bottom = (self._ys[-1] if self._ys else HEADER) + LINE

    def _compressed(self) -> Iterator[float]:
        """Every event begins a line of its own; arrivals stand between the lines."""
        begins = {begun(event) for event in self._chart.events}
        gaps = [b.time - a.time for a, b in pairwise(sorted(begins)) if b.time > a.time]
        usual = median(gaps) if gaps else Fraction(1)
        quiet = max(_QUIET * usual, sum(gaps, Fraction(0)) / _PARTS)
        below = {message.sent: _CROSSED for message in self._chart.messages if message.is_lost}
        below |= {event.moment: _NOTED for event in self._chart.events if isinstance(event, Note)}
        below |= {event.moment: _BOXED for event in self._chart.events if isinstance(event, EnteredLocation)}
        y = float(HEADER)
        last: Moment | None = None
        for moment in self._moments:
            if last is not None:
                gap = moment.time - last.time
                if gap > quiet:
                    y = self._cut(y, gap)
                else:
                    y += LINE if moment in begins else _ARRIVAL
                    y += log10(1 + float(gap / usual)) * 10 if gap else 0.0
                y += below.get(last, 0)
            last = moment
            yield y

    def _cut(self, top: float, gap: Fraction) -> float:
        """Leaves a silence out; how far down it ends."""
        middle = top + _BREAK / 2 + 3
        self.cuts.append(Cut(middle - 5, middle + 5))
        self._cut_times.append((middle + 4, f"{decimal(gap)} {self._chart.unit}".rstrip()))
        return top + _BREAK + 6

    def _to_scale(self) -> Iterator[float]:
        gaps = [b.time - a.time for a, b in pairwise(self._moments)]
        longest = _longest_shown(gaps)
        shown = sum((gap for gap in gaps if gap <= longest), Fraction(0))
        wanted = min(max(len(self._chart.events) * LINE * 1.6, 200), _TALLEST)
        scale = wanted / float(shown) if shown else 1.0
        boxes: dict[Moment, list[int]] = {}
        for event in self._chart.events:
            if isinstance(event, EnteredLocation):
                boxes.setdefault(event.moment, []).append(event.lifeline)
        free: dict[int, float] = {}
        begins = {begun(event) for event in self._chart.events}
        before: Moment | None = None
        y = float(HEADER)
        for number, moment in enumerate(self._moments):
            if number:
                gap = gaps[number - 1]
                y = self._cut(y, gap) if gap > longest else y + float(gap) * scale
            if moment in begins:
                if before is not None and before.time == moment.time:
                    y += _BOXES_TOGETHER if before in boxes or moment in boxes else _TOGETHER
                before = moment
            for lifeline in boxes.get(moment, ()):
                y = max(y, free.get(lifeline, 0.0))
            free |= dict.fromkeys(boxes.get(moment, ()), y + _BOX_HEIGHT + 2)
            yield y

    def at(self, moment: Moment) -> float:
        """The vertical position of a moment; interpolated between two that are known."""
        number = bisect_right(self._moments, moment)
        if not number:
            return HEADER - LINE / 2
        if number == len(self._moments) or self._moments[number - 1] == moment:
            return self._ys[number - 1]
        (begin, _), (end, _) = self._moments[number - 1], self._moments[number]
        part = float((moment.time - begin) / (end - begin)) if end > begin else 0.5
        return self._ys[number - 1] + part * (self._ys[number] - self._ys[number - 1])

    def times(self) -> Iterator[ChartLabel]:
        """The times of events, as far as there is room; equal times stand once."""
        last_y, last_time = float("-inf"), None
        if any(message.tag for message in self._chart.messages):
            yield ChartLabel("packet", _MARGIN, HEADER / 2 - 5, "start", "gap")
        for event in self._chart.events:
            moment = begun(event)
            y = self.at(moment)
            if y - last_y < LINE - 3 or (isinstance(event, Message) and event.is_under_way):
                continue
            if isinstance(event, Message) and event.tag:
                yield ChartLabel(event.tag, _MARGIN, y + 4, "start", "gap")
            if moment.time != last_time:
                text = f"{decimal(moment.time)} {self._chart.unit}".rstrip()
                yield ChartLabel(text, self._right, y + 4, "end", "time")
            last_y, last_time = y, moment.time

    def cut_texts(self) -> Iterator[ChartLabel]:
        for y, text in self._cut_times:
            yield ChartLabel(text, self._right, y, "end", "gap")


def _longest_shown(gaps: Sequence[Fraction]) -> Fraction:
    """Silences that are longer are left out: those few that are much longer than others and take much of the chart."""
    longest = sorted(gaps, reverse=True)
    shown = longest[0] if longest else Fraction(0)
    for left_out in range(1, min(_FEW, len(longest) - 1) + 1):
        shortest, rest = longest[left_out - 1], longest[left_out:]
        if shortest >= _MUCH * rest[0] > 0 and shortest * _PART > sum(rest):
            shown = rest[0]
    return shown


def _arrow(message: Message, rows: _ChartRows, xs: Sequence[int]) -> Arrow:
    x, y = xs[message.sender], rows.at(message.sent)
    if not message.arrivals:
        ends = tuple((x + (xs[one] - x) * 0.62, y + _ARRIVAL) for one in message.receivers[:1])
        return Arrow(message, x, y, ends, ())
    first, *others = message.arrivals
    ends = tuple((float(xs[one]), rows.at(first)) for one in message.receivers)
    copies = tuple((float(xs[one]), rows.at(moment)) for moment in others for one in message.receivers)
    return Arrow(message, x, y, ends, copies)


def _location(event: EnteredLocation, rows: _ChartRows, xs: Sequence[int]) -> LocationBox:
    text = _shown(event)
    return LocationBox(text, xs[event.lifeline], rows.at(event.moment), "" if text == event.text else event.text)


def _labels(chart: Chart, rows: _ChartRows, xs: Sequence[int]) -> Iterator[ChartLabel]:
    left = _times_width(chart)
    for event in chart.events:
        if isinstance(event, EnteredLocation):
            continue
        y = rows.at(begun(event))
        text = _shown(event)
        if isinstance(event, Note):
            middle = max((xs[0] + xs[-1]) / 2 if xs else 0.0, left + text_width(text) / 2)
            x = xs[event.lifeline] + 12 if event.lifeline is not None else middle
            anchor = "middle" if event.lifeline is None else "start"
            yield ChartLabel(text, x, y + 4, anchor, "note", None, "" if text == event.text else event.text)
            continue
        furthest = max(event.receivers, key=lambda each: abs(each - event.sender), default=event.sender)
        style = "lost" if event.is_lost else event.category.value
        full = event.detail
        yield from _late_arrivals(event, rows, xs)
        if furthest >= event.sender:
            yield ChartLabel(text, xs[event.sender] + 10, y - _ABOVE_ARROW, "start", style, None, full)
        else:
            yield ChartLabel(text, xs[event.sender] - 10, y - _ABOVE_ARROW, "end", style, None, full)


def _late_arrivals(message: Message, rows: _ChartRows, xs: Sequence[int]) -> Iterator[ChartLabel]:
    """Labels at the ends of long arrows, whose beginnings are out of sight."""
    sent = rows.at(message.sent)
    for number, moment in enumerate(message.arrivals):
        y = rows.at(moment)
        if not (message.is_under_way and number == 0) and y - sent < _FAR:
            continue
        text = _cut(f"{message.label} comes again" if number else f"{message.label} comes")
        for receiver in message.receivers[:1]:
            right = receiver >= message.sender
            x, anchor = (xs[receiver] - 10, "end") if right else (xs[receiver] + 10, "start")
            yield ChartLabel(text, x, y - _ABOVE_ARROW, anchor, message.category.value, None, message.detail)


def _without_overlap(labels: Sequence[ChartLabel], boxes: Sequence[LocationBox]) -> list[ChartLabel]:
    """Labels that would overlap others, or boxes, move down, and get a line to where they belong."""
    placed: list[ChartLabel] = []
    lowest: dict[tuple[float, str], float] = {}
    for label in sorted(labels, key=lambda each: each.y):
        moved = _free(label, [*boxes, *placed[-_NEAR:]], lowest)
        placed.append(moved)
        lowest[label.x, label.anchor] = moved.y
    return placed


def _free(
    label: ChartLabel,
    placed: Sequence[ChartLabel | LocationBox],
    lowest: Mapping[tuple[float, str], float],
) -> ChartLabel:
    y = max(label.y, lowest.get((label.x, label.anchor), float("-inf")) + _LABEL_DISTANCE)
    moved = label if y == label.y else _at(label, y)
    while above := [other for other in placed if overlap(moved, other)]:
        moved = _at(label, max(other.box[3] for other in above) + _ASCENT + 1)
    return moved


def _at(label: ChartLabel, y: float) -> ChartLabel:
    pointer = (label.x, label.y + 4) if y - label.y > LINE / 2 else None
    return ChartLabel(label.text, label.x, y, label.anchor, label.style, pointer, label.full)


def overlap(one: ChartLabel | LocationBox, other: ChartLabel | LocationBox) -> bool:
    """True if the boxes of two texts have a point in common."""
    left, top, right, bottom = one.box
    left_2, top_2, right_2, bottom_2 = other.box
    return left < right_2 and left_2 < right and top < bottom_2 and top_2 < bottom


def decimal(time: Fraction) -> str:
    """A time with at most one decimal where it is long, and three digits that matter where it is short."""
    value = float(time)
    if value == int(value):
        return f"{int(value)}"
    return f"{value:.1f}" if value >= 10 else f"{value:.3g}"
