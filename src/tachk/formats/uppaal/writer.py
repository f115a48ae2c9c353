"""Models as UPPAAL's XML, which UPPAAL 4.1 and 5 open.

The behaviour comes from the expanded model, the picture from its layout; where there is none, templates are placed
anew. A document that was read and is written without a change says the same, looks the same and asks the same.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from jinja2 import Environment, FunctionLoader, StrictUndefined, Template
from markupsafe import Markup

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.resources import template_text
from tachk.base.span import Source
from tachk.formats.layout.completion import complete
from tachk.formats.plain.plain_model import PlainModel
from tachk.formats.uppaal.query_writer import QueryView, query_views
from tachk.formats.uppaal.section_writer import Sections, same, sections
from tachk.formats.uppaal.template_reader import branchpoint_id, documentation
from tachk.frontend.loaded import LoadedModel
from tachk.syntax import ast
from tachk.syntax.edge_clauses import edge_clauses
from tachk.syntax.parsing.parser import (
    parse_assignment,
    parse_constraint,
    parse_expression,
    parse_rate,
    parse_select,
    parse_synchronisation,
)
from tachk.syntax.picture_layout import (
    EDGE_LABELS,
    LOCATION_LABELS,
    EdgeLayout,
    LabelLayout,
    Layout,
    NodeLayout,
    Point,
    TemplateLayout,
    keyed_edges,
    nodes_of,
)
from tachk.syntax.printing.expression_printer import print_clause, print_expression, print_rate

_NEWER = ("1.5", "1.6")
_NEWER_ATTRIBUTES = ("id", "action")
_ADDRESS = "http://www.it.uu.se/research/group/darts/uppaal/flat-{}.dtd"
_ADDRESSES = {"1.1": "1_2", "1.5": "1_5", "1.6": "1_6"}
_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")

Parse = Callable[[Source], tuple[Any, tuple[Diagnostic, ...]]]
_PARSERS: dict[str, Parse] = {
    "invariant": parse_constraint,
    "exponentialrate": parse_rate,
    "select": parse_select,
    "guard": parse_constraint,
    "synchronisation": parse_synchronisation,
    "assignment": parse_assignment,
    "probability": parse_expression,
}


@dataclass(frozen=True, slots=True)
class LabelView:
    kind: str
    position: Point
    text: str


@dataclass(frozen=True, slots=True)
class NodeView:
    id: str
    is_branchpoint: bool
    position: Point
    colour: str
    name: str
    name_position: Point
    labels: tuple[LabelView, ...] = ()
    urgent: bool = False
    committed: bool = False


@dataclass(frozen=True, slots=True)
class EdgeView:
    attributes: tuple[tuple[str, str], ...]
    source: str
    target: str
    labels: tuple[LabelView, ...]
    nails: tuple[Point, ...]


@dataclass(frozen=True, slots=True)
class TemplateView:
    name: str
    position: Point | None
    parameter: str | None
    declaration: str | None
    nodes: tuple[NodeView, ...]
    initial: str
    edges: tuple[EdgeView, ...]
    extra: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ModelView:
    """The parts that the template of the file needs, every text in its final form."""

    dtd: str
    dtd_address: str
    declaration: str
    templates: tuple[TemplateView, ...]
    charts: tuple[str, ...]
    system: str
    options: tuple[tuple[str, str], ...]
    queries: tuple[QueryView, ...]
    extra: tuple[str, ...]


def print_uppaal(model: LoadedModel, plain: PlainModel, layout: Layout | None = None) -> str:
    """The text of the XML file.

    Args:
        model: as it was loaded.
        plain: the same, expanded.
        layout: of the model; without one, its own if it came from XML, else everything is placed anew.
    """
    return _file().render(model=_view(model, plain, layout or model.layout or Layout()))


def _view(model: LoadedModel, plain: PlainModel, layout: Layout) -> ModelView:
    written = sections(model, plain, layout)
    originals = [item for item in model.items if isinstance(item, ast.Template)]
    ids = _Ids({node.id for template in layout.templates.values() for node in template.nodes.values() if node.id})
    templates = [
        _template(original, template, layout.templates.get(original.name.name), written, ids)
        for original, template in zip(originals, plain.templates, strict=True)
    ]
    queries = query_views(model, plain, layout.queries)
    newer = (
        bool(layout.options)
        or any(query.results or query.options for query in queries)
        or any(name in _NEWER_ATTRIBUTES for t in templates for edge in t.edges for name, _ in edge.attributes)
    )
    dtd = layout.dtd if layout.dtd in _NEWER else "1.6" if newer else "1.1"
    return ModelView(
        dtd,
        _ADDRESS.format(_ADDRESSES[dtd]),
        written.declaration(layout.declaration),
        tuple(templates),
        tuple(element for element in layout.extra if element.startswith("<lsc")),
        written.system(layout.system),
        layout.options,
        queries,
        tuple(element for element in layout.extra if not element.startswith("<lsc")),
    )


class _Ids:
    """Hands out identifiers of locations that no file has used."""

    def __init__(self, used: set[str]) -> None:
        self.used = used
        self.number = -1

    def new(self) -> str:
        self.number += 1
        while f"id{self.number}" in self.used:
            self.number += 1
        return f"id{self.number}"


def _template(
    original: ast.Template, template: ast.Template, known: TemplateLayout | None, written: Sections, ids: _Ids
) -> TemplateView:
    """Args:
    original: of the model, whose names are those of the layout; it has the same locations and edges in the same order.
    """
    layout = complete(original, known)
    declaration = written.template_declaration(template, layout.declaration)
    verbatim = declaration if declaration == layout.declaration else None
    own: set[str] = set()
    views: list[NodeView] = []
    by_name: dict[str, str] = {}
    for old, node in zip(nodes_of(original), nodes_of(template), strict=True):
        picture = layout.nodes[old.name.name]
        identifier = picture.id
        if not identifier or identifier in own:
            named = isinstance(node, ast.Branchpoint)
            identifier = branchpoint_id(template.name.name, node.name.name) if named else ids.new()
        own.add(identifier)
        by_name[node.name.name] = identifier
        views.append(_node(old, node, picture, identifier, _comments(written, node, verbatim)))
    order = {key: place for place, key in enumerate(known.edges if known else ())}
    edges = tuple(
        _edge(edge, layout.edges[key], by_name, _comments(written, edge, verbatim))
        for key, edge in sorted(
            ((key, edge) for (key, _), edge in zip(keyed_edges(original), template.edges, strict=True)),
            key=lambda entry: order.get(entry[0], len(order)),
        )
    )
    return TemplateView(
        template.name.name,
        layout.name if known is None else known.name,
        written.parameter(template, layout.parameter),
        declaration,
        tuple(views),
        next((by_name[node.name.name] for node in template.locations if node.initial), ""),
        edges,
        layout.extra,
    )


def _node(
    old: ast.LocationDeclaration | ast.Branchpoint,
    node: ast.LocationDeclaration | ast.Branchpoint,
    picture: NodeLayout,
    identifier: str,
    comments: list[str],
) -> NodeView:
    assert picture.position is not None and picture.name is not None, "a complete layout has all positions"
    # A name that was made up stays out of the picture; one that was put right does not.
    shown = "" if picture.written_name == "" and node.name.name == old.name.name else node.name.name
    if isinstance(node, ast.Branchpoint):
        return NodeView(identifier, True, picture.position, picture.colour, shown, picture.name)
    texts: dict[str, tuple[object, str]] = {}
    if node.invariant is not None:
        texts["invariant"] = node.invariant, print_expression(node.invariant)
    if node.exponential_rate is not None:
        rate = node.exponential_rate, node.rate_divisor
        texts["exponentialrate"] = rate, print_rate(*rate)
    labels = _labels(texts, node.doc, picture.labels, LOCATION_LABELS, comments)
    return NodeView(
        identifier,
        False,
        picture.position,
        picture.colour,
        shown,
        picture.name,
        labels,
        node.urgent and not node.committed,
        node.committed,
    )


def _comments(
    written: Sections, node: ast.LocationDeclaration | ast.Branchpoint | ast.EdgeDeclaration, declaration: str | None
) -> list[str]:
    """The comments beside a location or edge that do not stand in the declarations of its template.

    Args:
        declaration: the section as it was written; None if it is formatted.
    """
    return [comment for comment in written.comments_beside(node) if comment not in (declaration or "")]


def _edge(edge: ast.EdgeDeclaration, picture: EdgeLayout, ids: Mapping[str, str], comments: list[str]) -> EdgeView:
    assert edge.source is not None, "an edge of the classic form has a source"
    texts = {clause.kind.label: (clause.value, print_clause(clause)) for clause in edge_clauses(edge)}
    attributes = dict(picture.attributes)
    if picture.colour:
        attributes["color"] = picture.colour
    if not edge.controllable:
        attributes["controllable"] = "false"
    return EdgeView(
        tuple(attributes.items()),
        ids[edge.source.name],
        ids[edge.target.name],
        _labels(texts, edge.doc, picture.labels, EDGE_LABELS, comments),
        picture.nails,
    )


def _labels(
    texts: Mapping[str, tuple[object, str]],
    doc: str,
    pictures: Mapping[str, LabelLayout],
    kinds: tuple[str, ...],
    comments: list[str],
) -> tuple[LabelView, ...]:
    """The labels that are not empty: as they were written where that means the same, else formatted.

    Args:
        texts: what the labels of the document mean, and how it is formatted.
        kinds: the labels that a document can hold. Others are kept as they were written.
    """
    labels: list[LabelView] = []
    for kind in (*kinds, *(kind for kind in pictures if kind not in kinds)):
        picture = pictures[kind]
        assert picture.position is not None, "a complete layout has all positions"
        if kind in texts:
            meant, text = texts[kind]
            if picture.text is not None and same(picture.text, _PARSERS[kind], meant):
                text = picture.text
        elif kind == "comments":
            seen = "".join(label.text for label in labels)
            old = picture.text or ""
            loose = [comment for comment in comments if comment not in seen and comment not in old]
            text = "\n".join(part for part in (doc, *loose) if part)
            if documentation(old) == doc and not loose:
                text = old
        else:
            text = "" if kind in kinds else picture.text or ""
        if text.strip():
            labels.append(LabelView(kind, picture.position, text))
    return tuple(labels)


@cache
def _file() -> Template:
    environment = Environment(
        loader=FunctionLoader(template_text),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["text"] = _escaped
    environment.filters["verbatim"] = Markup
    return environment.get_template("uppaal/model.xml.j2")


def _escaped(text: str) -> Markup:
    """Text between tags: quotes stay as they are, what XML cannot hold becomes a blank."""
    clean = _NO_XML.sub(" ", text).replace("\r", " ")
    return Markup(clean.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;"))
