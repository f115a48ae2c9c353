"""The picture of a document, and the other content of a UPPAAL file that is not a behaviour of its model.

Everything is keyed by names of the document, so a layout outlives changes of the text: what it does not know is placed
anew, what it knows too much is left out. Coordinates are UPPAAL's: integers, y grows downwards.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from tachk.base.records import dataclass, field
from tachk.syntax import ast
from tachk.syntax.edge_clauses import ClauseKind
from tachk.syntax.walk import edges_with_sources


class Point(NamedTuple):
    x: int
    y: int


class EdgeKey(NamedTuple):
    """An edge by the names of its ends; ``occurrence`` counts the edges between the same two from 0, in the order in
    which the document has them."""

    source: str
    target: str
    occurrence: int = 0

    @property
    def text(self) -> str:
        """The name of the edge in pictures."""
        return f"{self.source} {self.target} {self.occurrence}"


LOCATION_LABELS = ("invariant", "exponentialrate", "comments")
EDGE_LABELS = (*(kind.label for kind in ClauseKind), "comments")
"""UPPAAL's names for the labels that a document holds, in the order in which they are written."""


@dataclass(frozen=True, slots=True)
class LabelLayout:
    """Attributes:
    position: of the label's top left corner; None where the file gives none.
    text: the label as it was written, where the formatter would write it otherwise, or where the document holds nothing
        of it (``testcode`` and the like). Used again only while it still means the same.
    """

    position: Point | None = None
    text: str | None = None


@dataclass(frozen=True, slots=True)
class NodeLayout:
    """The picture of a location or branchpoint.

    Attributes:
        position: its centre.
        name: the position of its name.
        labels: by UPPAAL's names of their kinds.
        colour: as UPPAAL writes it, ``#ff0000``; empty for the default.
        id: the identifier in the file; empty if there is none yet.
        written_name: what the file has instead of the document's name: empty for a location without a name, or a name
            that is not an identifier or not unique. None where they agree.
    """

    position: Point | None = None
    name: Point | None = None
    labels: Mapping[str, LabelLayout] = field(default_factory=dict)
    colour: str = ""
    id: str = ""
    written_name: str | None = None


@dataclass(frozen=True, slots=True)
class EdgeLayout:
    """The picture of an edge.

    Attributes:
        nails: the points through which it passes, from source to target.
        attributes: other attributes of the element, such as ``id`` and ``action``.
    """

    nails: tuple[Point, ...] = ()
    labels: Mapping[str, LabelLayout] = field(default_factory=dict)
    colour: str = ""
    attributes: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class TemplateLayout:
    """Attributes:
    name: the position of the template's name.
    nodes: locations and branchpoints by name.
    extra: elements that tachk does not know, as they stood in the file.
    parameter, declaration: the text of the sections, used again only while it still means the same.
    """

    name: Point | None = None
    nodes: Mapping[str, NodeLayout] = field(default_factory=dict)
    edges: Mapping[EdgeKey, EdgeLayout] = field(default_factory=dict)
    extra: tuple[str, ...] = ()
    parameter: str | None = None
    declaration: str | None = None


@dataclass(frozen=True, slots=True)
class QueryLayout:
    """The information in a file about a query besides formula, comment and expectation.

    Attributes:
        name: of the property in the document; empty for an entry without a formula, which serves as a heading.
        comment: as it was written, where it differs from what the document gives.
        formula: likewise.
        options: key and value of each.
        results: the elements ``expect`` and ``result`` as they stood in the file.
    """

    name: str
    comment: str | None = None
    formula: str | None = None
    options: tuple[tuple[str, str], ...] = ()
    results: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Layout:
    """Attributes:
    templates: by name.
    dtd: the version of the file format, ``1.1`` to ``1.6``; empty where the file does not say.
    options: of the whole list of queries.
    queries: in the order of the file, headings included.
    extra: elements that tachk does not know, as they stood in the file, such as message sequence charts.
    declaration, system: the text of the sections, as in `TemplateLayout`.
    """

    templates: Mapping[str, TemplateLayout] = field(default_factory=dict)
    dtd: str = ""
    options: tuple[tuple[str, str], ...] = ()
    queries: tuple[QueryLayout, ...] = ()
    extra: tuple[str, ...] = ()
    declaration: str | None = None
    system: str | None = None


def nodes_of(template: ast.Template) -> tuple[ast.LocationDeclaration | ast.Branchpoint, ...]:
    """The locations of a template, then its branchpoints."""
    return (*template.locations, *template.branchpoints)


def keyed_edges(template: ast.Template) -> Iterator[tuple[EdgeKey, ast.EdgeDeclaration]]:
    """All edges of a template with their keys, whichever way the template is written."""
    seen: Counter[tuple[str, str]] = Counter()
    for source, edge in edges_with_sources(template):
        ends = source, edge.target.name
        yield EdgeKey(*ends, seen[ends]), edge
        seen[ends] += 1
