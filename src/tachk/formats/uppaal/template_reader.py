"""One ``<template>`` of a UPPAAL document: its names, its syntax tree and its picture."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic, Label
from tachk.base.job import check_job
from tachk.base.span import Span
from tachk.formats.uppaal.xml_text import Extract, Extracted
from tachk.formats.uppaal.xml_tree import Element
from tachk.syntax import ast
from tachk.syntax.edge_clauses import edge_clauses
from tachk.syntax.parsing.parser import (
    parse_assignment,
    parse_constraint,
    parse_declarations,
    parse_expression,
    parse_parameters,
    parse_rate,
    parse_select,
    parse_synchronisation,
)
from tachk.syntax.parsing.tables import lexer
from tachk.syntax.picture_layout import (
    EDGE_LABELS,
    LOCATION_LABELS,
    EdgeLayout,
    LabelLayout,
    NodeLayout,
    Point,
    TemplateLayout,
    keyed_edges,
)
from tachk.syntax.printing.expression_printer import (
    print_clause,
    print_expression,
    print_rate,
)

IDENTIFIER = re.compile(r"[A-Za-z_]\w*", re.ASCII)

_COMMENT = re.compile(r"^[ \t]*(//[^\n]*|/\*[\s\S]*?\*/)[ \t]*(?:\n|\Z)", re.MULTILINE)
_OTHER_LABELS = ("testcode", "testcodeEnter", "testcodeExit")
_READ_SEPARATELY = {"name", "parameter", "declaration", "location", "branchpoint", "init", "transition"}
_SHOWN = {"exponentialrate": "exponential rate", "assignment": "update"}


@dataclass(slots=True)
class _NodeElement:
    """A location or branchpoint with its name in the document."""

    element: Element
    name: str
    written: str | None
    labels: dict[str, Element] = field(default_factory=dict)


@dataclass(slots=True)
class _EdgeElement:
    """An edge between nodes that exist."""

    element: Element
    source: str
    target: str
    labels: dict[str, Element] = field(default_factory=dict)


class TemplateReader:
    """Reads one template in two steps: `outline` finds the names and takes out the text, `build` parses it.

    Attributes:
        diagnostics: what was found wrong so far.
    """

    def __init__(self, element: Element, extract: Extract) -> None:
        self.element = element
        self.extract = extract
        self.diagnostics: list[Diagnostic] = []
        self.nodes: list[_NodeElement] = []
        self.transitions: list[_EdgeElement] = []
        self.initial: str | None = None
        name = element.first("name")
        self.name_element = name
        self.name = name.text.strip() if name is not None else ""

    # ---- the outline ----

    def outline(self) -> None:
        shown = self.name or "a template without a name"
        self.extract.mark(self.element, shown)
        if self.name_element is not None:
            self.extract.add(self.name_element, f"{shown}, name")
        if not self.name:
            self.report("E0124", self.element.tag, "this template has no name", "add <name>P</name>")
        elif not _is_free(self.name):
            assert self.name_element is not None, "a name that is not empty has an element"
            self.report("E0124", self.name_element.span, f"`{self.name}` cannot name a template", "use an identifier")
        for element in self.element.all("parameter"):
            self.extract.add(element, f"{shown}, parameters")
        for element in self.element.all("declaration"):
            self.extract.add(element, f"{shown}, declarations")
        by_id = self._name_nodes()
        for node in self.nodes:
            self._outline_node(node)
        self._outline_initial(by_id)
        for element in self.element.all("transition"):
            self._outline_transition(element, by_id)

    def _name_nodes(self) -> dict[str, str]:
        """Gives every location and branchpoint a name of its own; the names by identifier."""
        by_id: dict[str, str] = {}
        elements = [e for e in self.element.children if e.name in ("location", "branchpoint")]
        written = [self._written(element) for element in elements]
        proper = {name for name in written if _is_free(name)}
        used: set[str] = set()
        for element, text in zip(elements, written, strict=True):
            if _is_free(text) and text not in used:
                name = text
            else:
                wanted = re.sub(r"\W", "_", text or "_" + element.attributes.get("id", ""), flags=re.ASCII)
                wanted = wanted if IDENTIFIER.fullmatch(wanted) else f"_{wanted}"
                name = _unused(wanted, used | proper)
            used.add(name)
            self.nodes.append(_NodeElement(element, name, None if name == text else text))
            identifier = element.attributes.get("id", "")
            if identifier in by_id:
                self.report("E0124", element.tag, f"two locations of `{self.name}` have the id `{identifier}`", None)
            by_id[identifier] = name
            if text and name != text:
                place = element.first("name")
                self.report(
                    "W0121",
                    element.tag if place is None else place.span,
                    f"location `{text}` of `{self.name}` is called `{name}` here",
                    "the name of a location must be an identifier, not a reserved word, and unique in its template",
                )
        return by_id

    def _written(self, element: Element) -> str:
        """The name in the file. Branchpoints have none, so those that have one in the text keep it in their id."""
        name = element.first("name")
        if name is not None:
            return name.text.strip()
        identifier = element.attributes.get("id", "")
        own = identifier.removeprefix(f"{self.name}.")
        return own if element.name == "branchpoint" and own != identifier and _is_free(own) else ""

    def _outline_node(self, node: _NodeElement) -> None:
        kind = "branchpoint" if node.element.name == "branchpoint" else "location"
        names = f"{self.name}, {kind} {node.name}"
        name = node.element.first("name")
        if name is None or node.written is not None:
            self.extract.mark(node.element, names)
        else:
            self.extract.mark(node.element, names)
            self.extract.add(name, f"{names}, name")
        node.labels = self._outline_labels(node.element, names, LOCATION_LABELS)
        self.extract.end_line(node.element)

    def _outline_initial(self, by_id: Mapping[str, str]) -> None:
        element = self.element.first("init")
        if element is None:
            return
        reference = element.attributes.get("ref", "")
        self.initial = by_id.get(reference)
        if self.initial is None and reference:
            self.report("E0124", element.tag, f"the initial location `{reference}` does not exist", None)

    def _outline_transition(self, element: Element, by_id: Mapping[str, str]) -> None:
        ends: list[str] = []
        for what in ("source", "target"):
            end = element.first(what)
            reference = "" if end is None else end.attributes.get("ref", "")
            if end is None or not reference:
                self.report("E0124", element.tag, f"this edge of `{self.name}` has no {what}", None)
            elif reference not in by_id:
                message = f"the {what} of this edge, `{reference}`, is not a location of `{self.name}`"
                self.report("E0124", end.tag, message, None)
            else:
                ends.append(by_id[reference])
        if len(ends) < 2:
            return
        names = f"{self.name}, edge {ends[0]} -> {ends[1]}"
        self.extract.mark(element, names)
        transition = _EdgeElement(element, ends[0], ends[1], self._outline_labels(element, names, EDGE_LABELS))
        self.extract.end_line(element)
        self.transitions.append(transition)

    def _outline_labels(self, owner: Element, names: str, kinds: tuple[str, ...]) -> dict[str, Element]:
        """The labels of an element by kind: misspelt kinds put right, of several of one kind the last."""
        labels: dict[str, Element] = {}
        for label in owner.all("label"):
            kind = label.attributes.get("kind", "")
            if kind not in kinds and kind not in _OTHER_LABELS:
                kind = self._meant(label, kind, kinds)
            before = labels.get(kind)
            if before is not None:
                if not label.text.strip():
                    continue
                if before.text.strip():
                    message = f"{_shown(kind)} is given twice, the last one counts"
                    labelled = (Label(before.span, "this one is passed over"),)
                    self.diagnostics.append(Diagnostic("W0122", message, label.span, "remove one", labelled))
            labels[kind] = label
        for kind in (*kinds, *(kind for kind in labels if kind not in kinds)):
            if kind in labels:
                self.extract.add(labels[kind], f"{names}, {_shown(kind)}")
        return labels

    def _meant(self, label: Element, kind: str, kinds: tuple[str, ...]) -> str:
        close = get_close_matches(kind.lower(), kinds, n=1, cutoff=0.8)
        if not label.text.strip():
            return kind
        if close:
            message = f"unknown kind of label `{kind}`, read as `{close[0]}`"
            self.report("W0120", label.tag, message, f'write kind="{close[0]}": UPPAAL passes over this label')
            return close[0]
        self.report("W0120", label.tag, f"a label of the unknown kind `{kind}` has no effect", None)
        return kind

    def report(self, code: str, span: Span, message: str, help: str | None) -> None:
        self.diagnostics.append(Diagnostic(code, message, span, help))

    # ---- the tree and the picture ----

    def build(self, texts: Extracted) -> tuple[ast.Template, TemplateLayout]:
        """The template and its picture. Labels that cannot be read are missing in it."""
        name_place = texts.tag(self.element) if self.name_element is None else texts.trimmed(self.name_element)
        parameters: list[ast.Parameter] = []
        for element in self.element.all("parameter"):
            parameters += self._parsed(parse_parameters, texts.text(element), ())
        declarations: list[ast.Declaration] = []
        doc = ""
        for element in self.element.all("declaration"):
            span = texts.text(element)
            if not declarations:
                doc, span = _leading_doc(span)
            declarations += self._parsed(parse_declarations, span, ())
        edges = []
        pictures = []
        for transition in self.transitions:
            edge, labels = self._edge(transition, texts)
            edges.append(edge)
            attributes = {k: v for k, v in transition.element.attributes.items() if k not in ("color", "controllable")}
            nails = tuple(p for p in map(_point, transition.element.all("nail")) if p is not None)
            colour = transition.element.attributes.get("color", "")
            pictures.append(EdgeLayout(nails, labels, colour, attributes))
        locations = []
        nodes = {}
        for node in self.nodes:
            labels = {}
            if node.element.name == "location":
                location, labels = self._location(node, texts)
                locations.append(location)
            nodes[node.name] = self._picture(node, labels)
        points = [node for node in self.nodes if node.element.name == "branchpoint"]
        end = max([self._end(texts), *(part.span.end for part in (*locations, *edges))])
        template = ast.Template(
            Span(texts.source, texts.tag(self.element).start, end),
            ast.Identifier(name_place, self.name),
            tuple(parameters),
            tuple(declarations),
            tuple(locations),
            tuple(
                ast.Branchpoint(texts.tag(node.element), ast.Identifier(texts.tag(node.element), node.name))
                for node in points
            ),
            tuple(edges),
            classic=True,
            doc=doc,
        )
        extra = tuple(e.span.text for e in self.element.children if e.name not in _READ_SEPARATELY)
        picture = TemplateLayout(
            None if self.name_element is None else _point(self.name_element),
            nodes,
            dict(zip((key for key, _ in keyed_edges(template)), pictures, strict=True)),
            extra,
            section(self.element, "parameter"),
            section(self.element, "declaration"),
        )
        return template, picture

    def _end(self, texts: Extracted) -> int:
        last = texts.tag(self.element).end
        for element in self._elements_with_text():
            last = max(last, texts.text(element).end)
        return last

    def code(self, texts: Extracted) -> Iterator[Span]:
        """The places of everything that is read as code."""
        yield from (texts.text(element) for element in self.element.all("parameter"))
        for place, element in enumerate(self.element.all("declaration")):
            span = texts.text(element)
            yield span if place else _leading_doc(span)[1]
        for labels in (*(node.labels for node in self.nodes), *(edge.labels for edge in self.transitions)):
            for kind, label in labels.items():
                if kind != "comments" and (kind in LOCATION_LABELS or kind in EDGE_LABELS):
                    yield texts.text(label)

    def comments(self, texts: Extracted) -> Iterator[ast.Comment]:
        """The comments that stand in labels of comments."""
        for labels in (*(node.labels for node in self.nodes), *(edge.labels for edge in self.transitions)):
            if "comments" in labels:
                yield from comments_in_label(texts.text(labels["comments"]))

    def _elements_with_text(self) -> Iterator[Element]:
        yield from self.element.all("declaration")
        for node in self.nodes:
            yield from node.labels.values()
        for transition in self.transitions:
            yield from transition.labels.values()

    def _location(self, node: _NodeElement, texts: Extracted) -> tuple[ast.LocationDeclaration, dict[str, LabelLayout]]:
        place = texts.tag(node.element)
        name = node.element.first("name")
        identifier = ast.Identifier(
            place if name is None or node.written is not None else texts.trimmed(name), node.name
        )
        invariant = self._label(node.labels, "invariant", parse_constraint, texts, None)
        rate, divisor = self._label(node.labels, "exponentialrate", parse_rate, texts, (None, None))
        end = max([identifier.span.end, *(texts.text(label).end for label in node.labels.values())])
        location = ast.LocationDeclaration(
            Span(texts.source, place.start, end),
            identifier,
            invariant,
            rate,
            initial=node.name == self.initial,
            urgent=node.element.first("urgent") is not None,
            committed=node.element.first("committed") is not None,
            doc=_comment(node.labels),
            rate_divisor=divisor,
        )
        printed = {
            "invariant": "" if invariant is None else print_expression(invariant),
            "exponentialrate": "" if rate is None else print_rate(rate, divisor),
            "comments": location.doc,
        }
        return location, _label_layouts(node.labels, printed)

    def _edge(self, transition: _EdgeElement, texts: Extracted) -> tuple[ast.EdgeDeclaration, dict[str, LabelLayout]]:
        check_job()
        labels = transition.labels
        place = texts.tag(transition.element)
        end = max([place.end, *(texts.text(label).end for label in labels.values())])
        edge = ast.EdgeDeclaration(
            Span(texts.source, place.start, end),
            ast.Identifier(place, transition.source),
            ast.Identifier(place, transition.target),
            self._label(labels, "select", parse_select, texts, ()),
            self._label(labels, "guard", parse_constraint, texts, None),
            self._label(labels, "synchronisation", parse_synchronisation, texts, None),
            self._label(labels, "assignment", parse_assignment, texts, ()),
            self._label(labels, "probability", parse_expression, texts, None),
            controllable=transition.element.attributes.get("controllable") != "false",
            doc=_comment(labels),
        )
        printed = {clause.kind.label: print_clause(clause) for clause in edge_clauses(edge)}
        return edge, _label_layouts(labels, {**printed, "comments": edge.doc})

    def _label(
        self,
        labels: Mapping[str, Element],
        kind: str,
        parse: Callable[[Span], tuple[Any, tuple[Diagnostic, ...]]],
        texts: Extracted,
        nothing: Any,
    ) -> Any:
        element = labels.get(kind)
        if element is None or not element.text.strip():
            return nothing
        return self._parsed(parse, texts.text(element), nothing)

    def _parsed(self, parse: Callable[[Span], tuple[Any, tuple[Diagnostic, ...]]], span: Span, nothing: Any) -> Any:
        value, diagnostics = parse(span)
        self.diagnostics += diagnostics
        return nothing if value is None else value

    def _picture(self, node: _NodeElement, labels: dict[str, LabelLayout]) -> NodeLayout:
        name = node.element.first("name")
        attributes = node.element.attributes
        return NodeLayout(
            _point(node.element),
            None if name is None else _point(name),
            labels,
            attributes.get("color", ""),
            attributes.get("id", ""),
            node.written,
        )


def branchpoint_id(template: str, name: str) -> str:
    """An identifier that keeps the name of a branchpoint."""
    return f"{template}.{name}"


def _label_layouts(labels: Mapping[str, Element], printed: Mapping[str, str]) -> dict[str, LabelLayout]:
    return {
        kind: LabelLayout(_point(label), None if label.text == printed.get(kind) else label.text)
        for kind, label in labels.items()
        if label.text.strip()
    }


def _comment(labels: Mapping[str, Element]) -> str:
    label = labels.get("comments")
    return "" if label is None else documentation(label.text)


def documentation(text: str) -> str:
    """The text of a label of comments, without the parts that are comments themselves."""
    return plain_text(_COMMENT.sub("", text))


def comments_in_label(span: Span) -> Iterator[ast.Comment]:
    """The parts of a label of comments that are comments themselves: there the exporter keeps those of the model."""
    for found in _COMMENT.finditer(span.text):
        start, end = (span.start + offset for offset in found.span(1))
        yield ast.Comment(Span(span.source, start, end), found.group(1), True)


def section(element: Element, *names: str) -> str | None:
    """The text of the children with certain names, None if there is none of them."""
    texts = [child.text for name in names for child in element.all(name)]
    return "\n".join(texts) if texts else None


def plain_text(text: str) -> str:
    """A comment without the blanks around it and at the ends of its lines, as documentation holds it."""
    return "\n".join(line.rstrip() for line in text.strip().splitlines())


def _leading_doc(span: Span) -> tuple[str, Span]:
    """The ``///`` lines at the start of the declarations that a blank line separates from the rest document the
    template; the span without them."""
    found = re.match(r"(?:[ \t]*\n)*((?:[ \t]*///(?!/)[^\n]*(?:\n|\Z))+)(?=[ \t]*(?:\n|\Z))", span.text)
    if found is None:
        return "", span
    lines = [line.strip()[3:].removeprefix(" ").rstrip() for line in found.group(1).splitlines()]
    return "\n".join(lines), Span(span.source, span.start + found.end(), span.end)


def _point(element: Element) -> Point | None:
    try:
        return Point(*(round(float(element.attributes[axis])) for axis in ("x", "y")))
    except (KeyError, ValueError, OverflowError):
        return None


def _shown(kind: str) -> str:
    return _SHOWN.get(kind, kind)


def _is_free(name: str) -> bool:
    return IDENTIFIER.fullmatch(name) is not None and name not in lexer().keywords


def _unused(wanted: str, used: set[str]) -> str:
    """The wanted name, or with a number the first that is not used."""
    if wanted not in used and _is_free(wanted):
        return wanted
    number = 2
    while f"{wanted}_{number}" in used:
        number += 1
    return f"{wanted}_{number}"
