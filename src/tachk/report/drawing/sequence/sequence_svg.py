"""Sequence charts as self-contained SVG: light, for screens and paper, understood without colours."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from html import escape
from math import hypot

from tachk.formats.layout.label_text import text_width
from tachk.report.drawing.sequence.layout import Arrow, ChartLabel, ChartLayout, Cut, LifelineBand, LocationBox
from tachk.report.drawing.themes import with_dark

_ARROW_LENGTH, _ARROW_WIDTH = 10, 4
_CROSS = 5
_NAME_HEIGHT = 22
_LEGEND = 26
_TITLE = 26
_BAND = 5

_STYLE = """\
.paper{fill:#fff}
text{font:12px "DejaVu Sans",Verdana,Arial,sans-serif;white-space:pre}
.title{font-size:14px;font-weight:bold;fill:#222}
.name{fill:#8b1a1a;text-anchor:middle}
.box{fill:#f4f6fa;stroke:#1f3b63}
.lifeline{stroke:#9aa7b8;stroke-width:1}
.halo{paint-order:stroke;stroke:#fff;stroke-width:3px;stroke-linejoin:round}
.time{fill:#555}
.gap{fill:#777;font-style:italic}
.note{fill:#5b3a8c;font-style:italic}
.data{fill:#1f3b63}
.answer{fill:#006400}
.heartbeat{fill:#8a5a00}
.other{fill:#444}
.lost{fill:#a4161a}
.line{fill:none;stroke-width:1.2}
.line.data,.head.data{stroke:#1f3b63}
.line.answer,.head.answer{stroke:#006400}
.line.heartbeat,.head.heartbeat{stroke:#b8860b}
.line.other,.head.other{stroke:#666}
.line.lost{stroke:#a4161a}
.head.heartbeat{fill:#b8860b}
.head.other{fill:#666}
.line{fill:none}
.repeated{stroke-dasharray:7 3}
.copy{stroke-dasharray:2 3}
.cross{stroke:#a4161a;stroke-width:2}
.pointer{stroke:#bbb;stroke-width:.8}
.band{fill:#c9bfe0;stroke:#5b3a8c;stroke-width:.6}
.cut{stroke:#777;stroke-width:1;fill:none}
.location{fill:#fff8e6;stroke:#8b1a1a;stroke-width:.8}
.place{fill:#8b1a1a;text-anchor:middle}"""

_DARK_STYLE = """\
.paper{fill:#15181c}
.title{fill:#e6e9ed}
.name{fill:#ff9d8a}
.box{fill:#1f242a;stroke:#9dbbe8}
.lifeline{stroke:#5b6470}
.halo{stroke:#15181c}
.time{fill:#a2abb6}
.gap{fill:#8f98a3}
.note{fill:#c9a8ff}
.data{fill:#8fb8f0}
.answer{fill:#7fd18b}
.heartbeat{fill:#e3b341}
.other{fill:#c8ced6}
.lost{fill:#ff8f8f}
.line{fill:none}
.line.data,.head.data{stroke:#8fb8f0}
.line.answer,.head.answer{stroke:#7fd18b}
.line.heartbeat,.head.heartbeat{stroke:#e3b341}
.line.other,.head.other{stroke:#a2abb6}
.line.lost{stroke:#ff8f8f}
.head.heartbeat{fill:#e3b341}
.head.other{fill:#a2abb6}
.cross{stroke:#ff8f8f}
.pointer{stroke:#5b6470}
.band{fill:#4a3a66;stroke:#c9a8ff}
.cut{stroke:#8f98a3}
.location{fill:#3a2f14;stroke:#e6c25c}
.place{fill:#ffe2a8}"""


@dataclass(frozen=True, slots=True)
class SequencePicture:
    """A drawn chart; a notebook shows it.

    Attributes:
        layout: where everything stands.
        content: SVG elements.
    """

    layout: ChartLayout = field(repr=False)
    content: str = field(repr=False)
    width: int
    height: int

    @property
    def svg(self) -> str:
        """The picture as the text of a file that needs no other file."""
        chart = self.layout.chart
        size = f'width="{self.width}" height="{self.height}" viewBox="0 0 {self.width} {self.height}"'
        return "\n".join(
            (
                f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img" aria-labelledby="title description">',
                f'<title id="title">{escape(chart.title)}</title>',
                f'<desc id="description">{escape(chart.description)}</desc>',
                f"<style>{with_dark(_STYLE, _DARK_STYLE)}</style>",
                f'<rect width="{self.width}" height="{self.height}" class="paper"/>',
                self.content,
                "</svg>",
                "",
            )
        )

    def _repr_svg_(self) -> str:
        return self.svg


def draw_chart(layout: ChartLayout) -> SequencePicture:
    """The picture of a chart."""
    legend = list(_legend(layout))
    height = _TITLE + layout.height + (_LEGEND if legend else 0)
    width = max(layout.width, text_width(layout.chart.title) * 4 // 3 + 40, _legend_width(layout))
    content = [
        f'<text class="title" x="16" y="20">{escape(layout.chart.title)}</text>',
        f'<g transform="translate(0 {_TITLE})">',
        *(line for x in layout.lifelines for line in _lifeline(x, layout)),
        *(_band(band) for band in layout.bands),
        *(_cut(x, cut) for cut in layout.cuts for x in layout.lifelines),
        *(line for arrow in layout.arrows for line in _arrow(arrow)),
        *(line for label in layout.labels for line in _label(label)),
        *(line for location in layout.locations for line in _location(location)),
        *(line for x, name in zip(layout.lifelines, layout.chart.lifelines, strict=True) for line in _name(x, name)),
        "</g>",
        f'<g transform="translate(16 {height - _LEGEND + 8})">',
        *legend,
        "</g>",
    ]
    return SequencePicture(layout, "\n".join(content), width, height)


def _lifeline(x: int, layout: ChartLayout) -> Iterator[str]:
    yield f'<line class="lifeline" x1="{x}" y1="{_NAME_HEIGHT}" x2="{x}" y2="{layout.height - 8}"/>'


def _name(x: int, name: str) -> Iterator[str]:
    width = text_width(name) + 16
    yield f'<rect class="box" x="{x - width / 2:g}" y="2" width="{width}" height="{_NAME_HEIGHT}" rx="3"/>'
    yield f'<text class="name" x="{x}" y="17">{escape(name)}</text>'


def _location(location: LocationBox) -> Iterator[str]:
    left, top, right, bottom = location.box
    size = f'width="{right - left:g}" height="{bottom - top:g}" rx="{(bottom - top) / 2:g}"'
    full = f"<title>{escape(location.full)}</title>" if location.full else ""
    yield f'<rect class="location" x="{left:g}" y="{top:.1f}" {size}/>'
    yield f'<text class="place" x="{location.x}" y="{location.y + 4:.1f}">{full}{escape(location.text)}</text>'


def _band(band: LifelineBand) -> str:
    place = f'x="{band.x - _BAND}" y="{band.top:.1f}" width="{2 * _BAND}" height="{band.bottom - band.top:.1f}"'
    return f'<rect class="band" {place}><title>{escape(band.phase.text)}</title></rect>'


def _cut(x: int, cut: Cut) -> str:
    """A zigzag over a lifeline, on white."""
    top, bottom = cut.top, cut.bottom
    middle = (top + bottom) / 2
    points = f"{x},{top:.1f} {x - 5},{middle - 2:.1f} {x + 5},{middle + 2:.1f} {x},{bottom:.1f}"
    hidden = f'<rect x="{x - 6}" y="{top:.1f}" width="12" height="{bottom - top:.1f}" class="paper"/>'
    return f'{hidden}<polyline class="cut" points="{points}"/>'


def _arrow(arrow: Arrow) -> Iterator[str]:
    message = arrow.message
    kind = "lost" if message.is_lost else message.category.value
    style = f"line {kind}{' repeated' if message.is_repeated else ''}"
    if not message.arrivals and not message.is_lost:
        style = f"line {kind} copy"
    for x, y in arrow.ends:
        yield f'<line class="{style}" x1="{arrow.x}" y1="{arrow.y:.1f}" x2="{x:.1f}" y2="{y:.1f}"/>'
        yield from _cross(x, y) if message.is_lost else _head(arrow.x, arrow.y, x, y, kind)
    for x, y in arrow.copies:
        yield f'<line class="line {kind} copy" x1="{arrow.x}" y1="{arrow.y:.1f}" x2="{x:.1f}" y2="{y:.1f}"/>'
        yield from _head(arrow.x, arrow.y, x, y, kind)


def _cross(x: float, y: float) -> Iterator[str]:
    """The cross at which a lost message ends."""
    for sign in (1, -1):
        ends = f'x1="{x - _CROSS:.1f}" y1="{y - sign * _CROSS:.1f}" x2="{x + _CROSS:.1f}" y2="{y + sign * _CROSS:.1f}"'
        yield f'<line class="cross" {ends}/>'


def _head(x1: float, y1: float, x2: float, y2: float, kind: str) -> Iterator[str]:
    length = hypot(x2 - x1, y2 - y1) or 1.0
    dx, dy = (x2 - x1) / length, (y2 - y1) / length
    back_x, back_y = x2 - dx * _ARROW_LENGTH, y2 - dy * _ARROW_LENGTH
    sides = " ".join(
        f"{back_x - sign * dy * _ARROW_WIDTH:.1f},{back_y + sign * dx * _ARROW_WIDTH:.1f}" for sign in (1, -1)
    )
    yield f'<polygon class="head {kind}" points="{x2:.1f},{y2:.1f} {sides}"/>'


def _label(label: ChartLabel) -> Iterator[str]:
    if label.pointer is not None:
        x, y = label.pointer
        yield f'<line class="pointer" x1="{x:.1f}" y1="{y:.1f}" x2="{label.x:.1f}" y2="{label.y - 4:.1f}"/>'
    full = f"<title>{escape(label.full)}</title>" if label.full else ""
    place = f'x="{label.x:.1f}" y="{label.y:.1f}" text-anchor="{label.anchor}"'
    yield f'<text class="{label.style} halo" {place}>{full}{escape(label.text)}</text>'


def _entries(layout: ChartLayout) -> Iterator[tuple[str, str]]:
    """The entries of the legend of this chart: the class of a line and words."""
    messages = layout.chart.messages
    if any(message.is_repeated and not message.is_lost for message in messages):
        yield "line data repeated", "sent again"
    if any(message.is_lost for message in messages):
        yield "cross", "lost"
    if any(len(message.arrivals) > 1 for message in messages):
        yield "line data copy", "copy"
    if layout.cuts:
        yield "cut", "time left out"
    for text in dict.fromkeys(band.phase.text for band in layout.bands):
        yield "band", text


def _legend(layout: ChartLayout) -> Iterator[str]:
    x = 0
    for style, words in _entries(layout):
        match style:
            case "cross":
                yield f'<line class="line lost" x1="{x}" y1="4" x2="{x + 20}" y2="4"/>'
                yield from _cross(x + 22, 4)
            case "cut":
                yield _cut(x + 14, Cut(-1, 9))
            case "band":
                yield f'<rect class="band" x="{x + 9}" y="-2" width="10" height="12"/>'
            case _:
                yield f'<line class="{style}" x1="{x}" y1="4" x2="{x + 28}" y2="4"/>'
        yield f'<text class="time" x="{x + 34}" y="8">{escape(words)}</text>'
        x += 34 + text_width(words) + 22


def _legend_width(layout: ChartLayout) -> int:
    return 32 + sum(56 + text_width(words) for _, words in _entries(layout))
