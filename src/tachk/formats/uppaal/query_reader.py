"""The ``<queries>`` of a UPPAAL document: properties, expectations, and what is kept for the way back.

The comment of a query names its property where its first line is ``name: title`` or a single word; so properties that
were written as text keep their names in UPPAAL.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from tachk.base.span import Source, Span
from tachk.base.words import QueryKind
from tachk.formats.uppaal.query_asides import formula_place, heading
from tachk.formats.uppaal.template_reader import plain_text
from tachk.formats.uppaal.xml_text import Extract, Extracted
from tachk.formats.uppaal.xml_tree import Element
from tachk.syntax import ast
from tachk.syntax.parsing.parser import parse_query
from tachk.syntax.parsing.tables import lexer
from tachk.syntax.parsing.tokens import END
from tachk.syntax.picture_layout import Layout, QueryLayout
from tachk.syntax.printing.query_printer import print_query
from tachk.syntax.query_files import BrokenQuery, expectation_in

_NAMED = re.compile(r"(?P<name>[A-Za-z_]\w*)(?::[ \t]+(?P<title>[^\n\"]*[^\s\"]))?(?:\n|\Z)", re.ASCII)
_AUTOMATIC = re.compile(r"q[0-9]+")
_OUTCOMES = {"success": "holds", "failure": "fails"}
_EXPECT_LINE = re.compile(r"(?:\A|\n)(?:EXPECT:[ \t]*\S+|(?P<conditional>expect (?:holds|fails) if [^\n]+))\Z")
_HEADING = re.compile(r"\s*([=#*_~])\1")
"""The marks of headings in a list of queries; no formula begins like that."""
MEASURES = (QueryKind.SUPREMUM, QueryKind.INFIMUM, QueryKind.BOUNDS)


@dataclass(frozen=True, slots=True)
class Described:
    """The content of the comment of a query."""

    name: str
    title: str
    doc: str


class QueriesReader:
    """Reads the queries in two steps, as `TemplateReader` does templates.

    Attributes:
        broken: queries that cannot be read.
        headings: entries without a formula, as comments in their places.
        layouts: of all entries, in order.
        options: of the whole list.
    """

    def __init__(self, elements: Sequence[Element]) -> None:
        self.elements = [element for element in elements if element.name == "query"]
        self.options = _options(elements)
        self.broken: list[BrokenQuery] = []
        self.headings: list[ast.Comment] = []
        self.layouts: list[QueryLayout] = []

    def outline(self, extract: Extract) -> None:
        for number, element in enumerate(self.elements, 1):
            extract.mark(element, f"query {number}")
            for formula in element.all("formula"):
                extract.add(formula, f"query {number}")
            extract.end_line(element)

    def formulas(self, texts: Extracted) -> list[Span]:
        """The places of all formulas."""
        return [formula_place(texts.text(formula)) for element in self.elements for formula in element.all("formula")]

    def build(self, texts: Extracted) -> list[ast.PropertyDeclaration]:
        """The properties; `broken` and `layouts` are filled."""
        found: list[ast.PropertyDeclaration] = []
        described = [describe(_child_text(element, "comment")) for element in self.elements]
        taken = {d.name for d in described if d.name}
        used: set[str] = set()
        for number, (element, said) in enumerate(zip(self.elements, described, strict=True), 1):
            formula = element.first("formula")
            place = None if formula is None else formula_place(texts.text(formula))
            results = tuple(child.span.text for child in element.children if child.name in ("expect", "result"))
            query_layout = QueryLayout("", options=_options(element.children), results=results)
            comment = _child_text(element, "comment")
            if formula is None or place is None or _is_empty(place) or _HEADING.match(place.text):
                text = formula.text or None if formula is not None else None
                self.layouts.append(_with(query_layout, "", comment, text))
                heading_text = heading(text or "", plain_text(comment))
                if heading_text:
                    self.headings.append(ast.Comment(texts.tag(element), heading_text, True))
                continue
            if not said.name or said.name in used:
                name = _automatic_name(number, taken | used)
                said = Described(name, "", _described(comment))
            used.add(said.name)
            span = texts.text(formula)
            entry, diagnostics = parse_query(span.source, place.start, place.end)
            if entry is None or diagnostics:
                self.layouts.append(_with(query_layout, "", comment, formula.text))
                self.broken.append(BrokenQuery(said.name, formula.text.strip(), plain_text(comment), span, diagnostics))
                continue
            tag = texts.tag(element)
            expectation = (
                entry.expectation or expectation_in(formula.text) or expectation_in(comment) or conditional_in(comment)
            )
            if isinstance(entry.formula, ast.QueryFormula) and entry.formula.kind in MEASURES:
                expectation = None
            else:
                expectation = expectation or outcome(element.children)
            node = ast.PropertyDeclaration(
                Span(span.source, tag.start, span.end),
                ast.Identifier(tag, said.name),
                said.title,
                entry.formula,
                expectation,
                said.doc,
            )
            found.append(node)
            self.layouts.append(
                _with(
                    query_layout,
                    said.name,
                    None if comment == comment_of(node) else comment,
                    None if formula.text == print_query(node.formula) and not results else formula.text,
                )
            )
        return found


def comment_of(node: ast.PropertyDeclaration) -> str:
    """The comment from which `describe` gets back name, title and documentation of a property."""
    automatic = _AUTOMATIC.fullmatch(node.name.name) and not node.title
    head = "" if automatic else f"{node.name.name}: {node.title}" if node.title else node.name.name
    return "\n".join(part for part in (head, node.doc) if part)


def conditional_in(comment: str) -> ast.Expected | None:
    """The expectation that depends on constants in the last line of a comment: ``expect fails if N > 2 else holds``."""
    found = _EXPECT_LINE.search(plain_text(comment))
    if found is None or not found["conditional"]:
        return None
    entry, diagnostics = parse_query(Source("<comment>", f"E<> true {found['conditional']}"))
    return None if entry is None or diagnostics else entry.expectation


def describe(comment: str) -> Described:
    """Name, title and documentation that the comment of a query gives; the name is empty if it gives none."""
    text = _described(comment)
    found = _NAMED.match(text)
    if found is None or found["name"] in lexer().keywords:
        return Described("", "", text)
    return Described(found["name"], found["title"] or "", text[found.end() :])


def says(comment: str, node: ast.PropertyDeclaration) -> bool:
    """True if a comment gives the title and the documentation of a property."""
    said = describe(comment)
    named = (said.name, said.title, said.doc) == (node.name.name, node.title, node.doc)
    return named or (not node.title and node.doc == _described(comment))


def _described(comment: str) -> str:
    """A comment without the line that states an expectation."""
    return _EXPECT_LINE.sub("", plain_text(comment))


def without_properties(layout: Layout, document: ast.Document, names: Collection[str]) -> Layout:
    """The layout in which some queries are kept as texts, because the document is to lose them."""
    nodes = {item.name.name: item for item in document.items if isinstance(item, ast.PropertyDeclaration)}

    def reread(query: QueryLayout) -> QueryLayout:
        if query.name not in names:
            return query
        node = nodes[query.name]
        comment = comment_of(node) if query.comment is None else query.comment
        formula = print_query(node.formula) if query.formula is None else query.formula
        return QueryLayout("", comment, formula, query.options, query.results)

    return replace(layout, queries=tuple(reread(query) for query in layout.queries))


def _automatic_name(number: int, taken: set[str]) -> str:
    name = f"q{number}"
    while name in taken:
        number += 1
        name = f"q{number}"
    return name


def outcome(elements: Sequence[Element]) -> str | None:
    """The expectation that ``expect`` or ``result`` among some elements states; what is meant comes first."""
    for name in ("expect", "result"):
        for element in elements:
            stated = _OUTCOMES.get(element.attributes.get("outcome", ""))
            if element.name == name and stated and element.attributes.get("type", "quality") in ("quality", "symbolic"):
                return stated
    return None


def _is_empty(span: Span) -> bool:
    """True if a formula consists of blanks and comments."""
    return not span.text.strip() or lexer().cut(span.source, span.start, span.end).tokens[0].type == END


def _options(elements: Sequence[Element]) -> tuple[tuple[str, str], ...]:
    return tuple(
        (element.attributes.get("key", ""), element.attributes.get("value", ""))
        for element in elements
        if element.name == "option"
    )


def _child_text(element: Element, name: str) -> str:
    child = element.first(name)
    return "" if child is None else child.text


def _with(query_layout: QueryLayout, name: str, comment: str | None, formula: str | None) -> QueryLayout:
    return QueryLayout(name, comment, formula, query_layout.options, query_layout.results)
