"""UPPAAL's XML to a document and its picture.

Read is what UPPAAL 3.x to 5.x write (DTD 1.0 to 1.6, or none) and what people and programs write by hand. The behaviour
becomes a `Document`, with every place leading back to the file; everything else becomes the `Layout`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.span import Source, Span
from tachk.formats.uppaal.query_reader import QueriesReader
from tachk.formats.uppaal.template_reader import TemplateReader, section
from tachk.formats.uppaal.xml_text import Extract, Extracted
from tachk.formats.uppaal.xml_tree import Element, parse_xml
from tachk.syntax import ast
from tachk.syntax.parsing.parser import comments_within, parse_declarations, parse_system
from tachk.syntax.picture_layout import Layout, TemplateLayout
from tachk.syntax.query_files import BrokenQuery, expectation_in

_DTD = re.compile(r"DTD Flat System (\d+\.\d+)")
_READ_SEPARATELY = {"declaration", "template", "instantiation", "system", "queries"}


@dataclass(frozen=True, slots=True)
class XmlModel:
    """Attributes:
    broken: queries that cannot be read; they are not part of the document, and harm nothing else.
    diagnostics: about everything else.
    headings: entries of the list of queries without a formula, as comments in their places.
    charts: the names of the message sequence charts.
    """

    document: ast.Document
    layout: Layout
    broken: tuple[BrokenQuery, ...]
    diagnostics: tuple[Diagnostic, ...]
    charts: frozenset[str] = frozenset()
    headings: tuple[ast.Comment, ...] = ()


def parse_uppaal_xml(source: Source) -> XmlModel:
    """Reads a model.

    Raises:
        InputError: the text is not well-formed XML, exceeds a limit, or is not a UPPAAL model.
    """
    tree = parse_xml(source)
    if tree.root.name != "nta":
        raise InputError(
            [
                Diagnostic(
                    "E0123",
                    f"this is not a UPPAAL model: its root is <{tree.root.name}>, not <nta>",
                    tree.root.tag,
                    "save it with UPPAAL 4 or later" if "ysis" in tree.public_id else None,
                )
            ]
        )
    found = _DTD.search(tree.public_id)
    return _NtaReader(source, tree.root, found.group(1) if found else "").read()


class _NtaReader:
    """Reads the parts of one ``<nta>`` element."""

    def __init__(self, file: Source, root: Element, dtd: str) -> None:
        self.root = root
        self.dtd = dtd
        self.diagnostics: list[Diagnostic] = []
        self.extract = Extract(file)
        self.templates = [TemplateReader(element, self.extract) for element in root.all("template")]
        self.queries = QueriesReader([q for element in root.all("queries") for q in element.children])

    def read(self) -> XmlModel:
        for element in self.root.all("declaration"):
            self.extract.add(element, "global declarations")
        for template in self.templates:
            template.outline()
        for name in ("instantiation", "system"):
            for element in self.root.all(name):
                self.extract.add(element, "system declarations")
        self.queries.outline(self.extract)
        texts = self.extract.finish()

        items: list[ast.Item] = []
        for element in self.root.all("declaration"):
            items += self._parsed(parse_declarations, texts.text(element))
        pictures: dict[str, TemplateLayout] = {}
        for template in self.templates:
            node, picture = template.build(texts)
            self.diagnostics += template.diagnostics
            items.append(node)
            pictures[node.name.name] = picture
        for element in self.root.all("instantiation"):
            items += self._parsed(parse_declarations, texts.text(element))
        for element in self.root.all("system"):
            items += self._parsed(parse_system, texts.text(element))
        items += self.queries.build(texts)
        layout = Layout(
            pictures,
            self.dtd,
            self.queries.options,
            tuple(self.queries.layouts),
            self._extra(),
            section(self.root, "declaration"),
            section(self.root, "instantiation", "system"),
        )
        whole = Span(texts.source, 0, len(texts.source.text))
        document = ast.Document(whole, tuple(items), self._comments(texts, items))
        names = (element.first("name") for element in self.root.all("lsc"))
        charts = frozenset(name.text.strip() for name in names if name is not None)
        broken, headings = tuple(self.queries.broken), tuple(self.queries.headings)
        return XmlModel(document, layout, broken, _one_legacy_warning(self.diagnostics), charts, headings)

    def _parsed(self, parse: Callable[[Span], tuple[Any, tuple[Diagnostic, ...]]], span: Span) -> Any:
        items, diagnostics = parse(span)
        self.diagnostics += diagnostics
        return items

    def _extra(self) -> tuple[str, ...]:
        """Elements that are kept as they are."""
        extra = [element for element in self.root.children if element.name not in _READ_SEPARATELY]
        for element in extra:
            if element.name == "lsc":
                message = "tachk keeps message sequence charts but does not check them"
                self.diagnostics.append(Diagnostic("W0123", message, element.tag))
        return tuple(element.span.text for element in extra)

    def _comments(self, texts: Extracted, items: Iterable[ast.Item]) -> tuple[ast.Comment, ...]:
        """The comments of all sections and labels, but for those in blocks that are kept as text."""
        raw = [item.span for item in items if isinstance(item, ast.GanttDeclaration | ast.ForeignImport)]
        spans = [texts.text(e) for name in _READ_SEPARATELY for e in self.root.all(name) if e.name in _SECTIONS]
        spans += [span for template in self.templates for span in template.code(texts)]
        spans += self.queries.formulas(texts)
        found = [comment for span in spans if "/" in span.text for comment in comments_within(span)]
        found = [_undocumenting(c) for c in found if expectation_in(c.text) is None]  # the property says that
        found += (comment for template in self.templates for comment in template.comments(texts))
        found.sort(key=lambda comment: comment.span.start)
        return tuple(c for c in found if not any(span.start <= c.span.start < span.end for span in raw))


_SECTIONS = {"declaration", "instantiation", "system"}


def _undocumenting(comment: ast.Comment) -> ast.Comment:
    """The comment with two slashes: three would document what comes next in the text, which is never meant."""
    return replace(comment, text=comment.text[1:]) if comment.text.startswith("///") else comment


def _one_legacy_warning(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """The diagnostics; that labels are in the syntax of UPPAAL 3.x is said once."""
    reported: list[Diagnostic] = []
    for diagnostic in diagnostics:
        if diagnostic.code != "W0101" or all(other.code != "W0101" for other in reported):
            reported.append(diagnostic)
    return tuple(reported)
