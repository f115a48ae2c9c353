"""Pictures of templates as UPPAAL draws them, as self-contained SVG."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from math import log10

from tachk.formats.layout.label_text import LINE_HEIGHT, edge_labels, location_labels, text_height, text_width
from tachk.formats.layout.placement.geometry import RADIUS
from tachk.report.drawing.edge_lines import Place, RouteEnds, ends_on_rims, head, path_of
from tachk.report.drawing.themes import with_dark
from tachk.syntax import ast
from tachk.syntax.picture_layout import EdgeKey, EdgeLayout, LabelLayout, NodeLayout, Point, TemplateLayout, keyed_edges
from tachk.syntax.printing.expression_printer import print_parameters

_MARGIN = 24
_BASELINE = 12
_BRANCHPOINT_RADIUS = 4

STYLE = """\
.paper{fill:#fff}
text{font:12px "DejaVu Sans",Verdana,Arial,sans-serif;white-space:pre}
.title{font-size:14px;font-weight:bold}
.node{fill:#c5d9f1;stroke:#1f3b63}
.edge{fill:none;stroke:#222}
.uncontrollable{stroke-dasharray:6 4}
.head{fill:#222}
.taken{stroke:#1a7f37}
.taken-head{fill:#1a7f37}
.never{stroke:#b35900;stroke-dasharray:3 4}
.never-head{fill:#b35900}
.nail{fill:#222}
.name{fill:#8b1a1a}
.invariant{fill:#a020f0}
.exponentialrate{fill:#c71585}
.comments{fill:#777;font-style:italic}
.mark{text-anchor:middle;fill:#1f3b63;font-size:12px}
.select{fill:#b8860b}
.guard{fill:#006400}
.synchronisation{fill:#008b8b}
.assignment{fill:#0000cd}
.probability{fill:#8b4513}"""

DARK_STYLE = """\
.paper{fill:#15181c}
text{fill:#e6e9ed}
.node{fill:#23395d;stroke:#9dbbe8}
.edge{stroke:#b6bec8}
.head{fill:#b6bec8}
.taken{stroke:#5fc47f}
.taken-head{fill:#5fc47f}
.never{stroke:#e0914a}
.never-head{fill:#e0914a}
.nail{fill:#b6bec8}
.name{fill:#ff9d8a}
.invariant{fill:#d79bff}
.exponentialrate{fill:#ff8ecb}
.comments{fill:#9aa3ad}
.mark{fill:#d5e3fa}
.select{fill:#e3b341}
.guard{fill:#7fd18b}
.synchronisation{fill:#5cc9c9}
.assignment{fill:#8fb0ff}
.probability{fill:#d9a066}"""
"""For dark screens; a rule in each line, as in `STYLE`."""


@dataclass(frozen=True, slots=True)
class Picture:
    """A drawing; a notebook shows it.

    Attributes:
        name: of the template, or of the model where several are drawn together.
        title: what a viewer calls it.
        left, top, width, height: the part of the plane that is shown.
        content: SVG elements.
    """

    name: str
    title: str
    left: int
    top: int
    width: int
    height: int
    content: str = field(repr=False)

    @property
    def view(self) -> str:
        """The attribute of SVG that says which part of the plane is shown."""
        return f'viewBox="{self.left} {self.top} {self.width} {self.height}"'

    @property
    def svg(self) -> str:
        """The picture as the text of a file that needs no other file."""
        return "\n".join(
            (
                f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width}" height="{self.height}" {self.view}>',
                f"<title>{escape(self.title)}</title>",
                f"<style>{with_dark(STYLE, DARK_STYLE)}</style>",
                f'<rect x="{self.left}" y="{self.top}" width="{self.width}" height="{self.height}" class="paper"/>',
                self.content,
                "</svg>",
                "",
            )
        )

    def _repr_svg_(self) -> str:
        return self.svg


def draw_template(
    template: ast.Template, layout: TemplateLayout, taken: Mapping[EdgeKey, int] | None = None
) -> Picture:
    """The picture of a template; what has no place in the layout is left out.

    Colours and marks are UPPAAL's: a double circle for the initial location, C for committed, U for urgent, a dashed
    line for an edge that the environment controls.

    Args:
        taken: how often each edge was taken. Edges that were are green, the thicker the more often, others orange and
            dotted.
    """
    picture = _SvgCanvas()
    routes = _routes(template, layout)
    ends = ends_on_rims(routes)
    for key, edge in keyed_edges(template):
        if key in routes:
            often = None if taken is None else taken.get(key, 0)
            _draw_edge(picture, edge, layout.edges.get(key, EdgeLayout()), key, routes[key], ends[key], often)
    for location in template.locations:
        _draw_location(picture, location, layout.nodes.get(location.name.name, NodeLayout()))
    for branchpoint in template.branchpoints:
        centre = layout.nodes.get(branchpoint.name.name, NodeLayout()).position
        if centre is not None:
            picture.see(centre.x, centre.y)
            picture.add(f'<circle class="head" cx="{centre.x}" cy="{centre.y}" r="{_BRANCHPOINT_RADIUS}"/>')
    title = f"{template.name.name}({print_parameters(template.parameters)})"
    if taken is not None:
        edges = [key for key, _ in keyed_edges(template)]
        title += f" · {sum(taken.get(key, 0) > 0 for key in edges)} of {len(edges)} edges taken"
    return picture.finish(template.name.name, title)


def together(name: str, pictures: Sequence[Picture]) -> Picture:
    """Pictures one below the other."""
    content = []
    top = 0
    for picture in pictures:
        place = f'x="0" y="{top}" width="{picture.width}" height="{picture.height}"'
        content += [f"<svg {place} {picture.view}>", picture.content, "</svg>"]
        top += picture.height
    width = max((picture.width for picture in pictures), default=0)
    return Picture(name, name, 0, 0, width, top, "\n".join(content))


class _SvgCanvas:
    """The elements of a picture and the box around them."""

    def __init__(self) -> None:
        self.elements: list[str] = []
        self.left = self.top = float("inf")
        self.right = self.bottom = float("-inf")

    def see(self, x: float, y: float) -> None:
        self.left, self.right = min(self.left, x), max(self.right, x)
        self.top, self.bottom = min(self.top, y), max(self.bottom, y)

    def add(self, element: str) -> None:
        self.elements.append(element)

    def text(self, kind: str, position: Point, text: str) -> None:
        """A text with its top left corner at a position."""
        self.see(*position)
        self.see(position.x + text_width(text), position.y + text_height(text))
        for at, line in enumerate(text.split("\n")):
            baseline = position.y + _BASELINE + at * LINE_HEIGHT
            self.add(f'<text class="{kind}" x="{position.x}" y="{baseline}">{escape(line)}</text>')

    def finish(self, name: str, title: str) -> Picture:
        if not self.elements:
            self.see(0, 0)
        self.text("title", Point(round(self.left), round(self.top - 32)), title)
        left, top = round(self.left) - _MARGIN, round(self.top) - _MARGIN
        width, height = round(self.right) + _MARGIN - left, round(self.bottom) + _MARGIN - top
        return Picture(name, title, left, top, width, height, "\n".join(self.elements))


def _draw_location(picture: _SvgCanvas, location: ast.LocationDeclaration, layout: NodeLayout) -> None:
    if layout.position is None:
        return
    x, y = layout.position
    picture.see(x - RADIUS, y - RADIUS)
    picture.see(x + RADIUS, y + RADIUS)
    colour = f' style="fill:{escape(layout.colour)}"' if layout.colour else ""
    name = escape(location.name.name)
    picture.add(f'<circle class="node" data-location="{name}" cx="{x}" cy="{y}" r="{RADIUS}"{colour}/>')
    if location.initial:
        picture.add(f'<circle class="node" cx="{x}" cy="{y}" r="{RADIUS - 4}"{colour}/>')
    mark = "C" if location.committed else "∪" if location.urgent else ""
    if mark:
        picture.add(f'<text class="mark" x="{x}" y="{y + 4}">{mark}</text>')
    written = location.name.name if layout.written_name is None else layout.written_name
    if layout.name is not None and written:
        picture.text("name", layout.name, written)
    _draw_labels(picture, _with_comment(location_labels(location), location.doc), layout.labels)


def _with_comment(labels: Mapping[str, str], doc: str) -> dict[str, str]:
    return {**labels, "comments": doc} if doc else dict(labels)


def _draw_labels(picture: _SvgCanvas, texts: Mapping[str, str], layout: Mapping[str, LabelLayout]) -> None:
    for kind, text in texts.items():
        label = layout.get(kind, LabelLayout())
        if label.position is not None:
            picture.text(kind, label.position, text if label.text is None else label.text)


def _routes(template: ast.Template, layout: TemplateLayout) -> dict[EdgeKey, RouteEnds]:
    """The routes of those edges whose ends have a place."""
    branchpoints = {point.name.name for point in template.branchpoints}
    routes = {}
    for key, _ in keyed_edges(template):
        start, end = (layout.nodes.get(name, NodeLayout()).position for name in (key.source, key.target))
        if start is not None and end is not None:
            source, target = (
                _BRANCHPOINT_RADIUS if name in branchpoints else RADIUS for name in (key.source, key.target)
            )
            nails = layout.edges.get(key, EdgeLayout()).nails or (_loop_nails(start) if start == end else ())
            routes[key] = RouteEnds((start, *nails, end), (source, target))
    return routes


def _draw_edge(
    picture: _SvgCanvas,
    edge: ast.EdgeDeclaration,
    layout: EdgeLayout,
    key: EdgeKey,
    route: RouteEnds,
    ends: tuple[Place, Place],
    often: int | None,
) -> None:
    for point in route.points:
        picture.see(*point)
    path, before = path_of(route, ends)
    rules = [f"stroke:{escape(layout.colour)}"] if layout.colour else []
    if often:
        rules.append(f"stroke-width:{_width(often):g}")
    own_style = f' style="{";".join(rules)}"' if rules else ""
    kind = "edge" if edge.controllable else "edge uncontrollable"
    covered = "" if often is None else "taken" if often else "never"
    classes = f"{kind} {covered}".rstrip()
    picture.add(f'<path class="{classes}" data-edge="{escape(key.text)}" d="{path}"{own_style}/>')
    corners = " ".join(f"{x:g},{y:g}" for x, y in head(before, ends[1]))
    picture.add(f'<polygon class="{f"{covered}-head" if covered else "head"}" points="{corners}"/>')
    _draw_labels(picture, _with_comment(edge_labels(edge), edge.doc), layout.labels)


def _width(often: int) -> float:
    """Of the line of an edge that was taken so often: one unit more for each factor of ten, at most 5."""
    return round(min(1.5 + log10(often), 5.0), 1)


def _loop_nails(centre: Point) -> tuple[Point, ...]:
    """Nails for a self-loop that a file gives none: without them nothing would show."""
    return Point(centre.x - 28, centre.y - 12), Point(centre.x - 28, centre.y + 12)
