"""XML to a tree of elements that know their places, for files from strangers.

The parser is expat, which the standard library brings. No document type is fetched, an entity beyond the five of XML
is refused by name, and depth and number of elements are limited; the size of a file is limited where it is read.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from xml.parsers import expat

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.job import check_job
from tachk.base.span import Source, Span

DEEPEST = 64
"""Levels of elements. UPPAAL's format needs six."""

MOST_ELEMENTS = 1_000_000

_TAG = re.compile(r"""<(?:"[^"]*"|'[^']*'|[^<>"'])*>""")
_ENCODING = "utf-8"
_NUMBERED = frozenset({"template", "lsc", "location", "branchpoint", "transition", "label", "nail", "query"})
_ONLY_FIVE = "XML itself knows &lt; &gt; &amp; &quot; and &apos;, and characters by number"


@dataclass(slots=True)
class Element:
    """Attributes:
    path: UPPAAL's form of XPath, such as ``/nta/template[1]/location[2]``.
    runs: the text directly within the element: each piece with its place in the file.
    span: from the opening to the closing tag.
    """

    name: str
    attributes: dict[str, str]
    path: str
    span: Span
    children: list[Element] = field(default_factory=list)
    runs: list[tuple[str, int, int]] = field(default_factory=list)

    @property
    def text(self) -> str:
        return "".join(text for text, _, _ in self.runs)

    @property
    def tag(self) -> Span:
        """The opening tag."""
        found = _TAG.match(self.span.source.text, self.span.start)
        return Span(self.span.source, self.span.start, found.end() if found else self.span.end)

    def all(self, name: str) -> Iterator[Element]:
        return (child for child in self.children if child.name == name)

    def first(self, name: str) -> Element | None:
        return next(self.all(name), None)


@dataclass(frozen=True, slots=True)
class Tree:
    """Attributes:
    public_id: of the document type, empty if the file names none.
    """

    root: Element
    public_id: str


def parse_xml(source: Source) -> Tree:
    """The elements of a file.

    Raises:
        InputError: E0120, not well-formed; E0121, it defines or uses an entity; E0122, too deep or too many elements.
    """
    return _ExpatReader(source).read()


class _ExpatReader:
    """One pass of expat over a text."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.parser = parser = expat.ParserCreate(_ENCODING)
        parser.buffer_text = False
        parser.SetParamEntityParsing(expat.XML_PARAM_ENTITY_PARSING_NEVER)
        parser.StartDoctypeDeclHandler = self.doctype
        parser.EntityDeclHandler = self.entity_declared
        parser.ExternalEntityRefHandler = self.external_entity
        parser.SkippedEntityHandler = self.entity_skipped
        parser.StartElementHandler = self.start
        parser.EndElementHandler = self.end
        parser.CharacterDataHandler = self.characters
        self.offsets = _Offsets(source.text)
        self.open: list[Element] = []
        self.counts: list[Counter[str]] = []
        self.root: Element | None = None
        self.elements = 0
        self.public_id = ""

    def read(self) -> Tree:
        try:
            self.parser.Parse(self.source.text.encode(_ENCODING, "surrogatepass"), True)
        except expat.ExpatError as error:
            raise self.as_input_error(error) from None
        assert self.root is not None, "a well-formed document has an element"
        return Tree(self.root, self.public_id)

    def here(self) -> int:
        return self.offsets.character(self.parser.CurrentByteIndex)

    def place(self, length: int = 1) -> Span:
        start = min(self.here(), len(self.source.text))
        return Span(self.source, start, min(start + length, len(self.source.text)))

    def as_input_error(self, error: expat.ExpatError) -> InputError:
        what = expat.ErrorString(error.code)
        start = min(self.offsets.character(max(self.parser.ErrorByteIndex, 0)), len(self.source.text))
        message = f"this is not well-formed XML: {what}"
        place = Span(self.source, start, start + 1)
        if error.code == expat.errors.codes[expat.errors.XML_ERROR_TAG_MISMATCH] and self.open:
            message = f"this is not well-formed XML: <{self.open[-1].name}> is not closed"
        elif error.code == expat.errors.codes[expat.errors.XML_ERROR_UNDEFINED_ENTITY]:
            return _refuse(
                "E0121", "this entity is not defined in XML", Span(self.source, start, start + 1), _ONLY_FIVE
            )
        help_ = "in XML, `<` is written &lt; and `&` is written &amp;" if "invalid token" in what else None
        return _refuse("E0120", message, place, help_)

    def doctype(self, _name: str, _system: str | None, public: str | None, _internal: bool) -> None:
        self.public_id = public or ""

    def entity_declared(self, name: str, *_: object) -> None:
        raise _refuse("E0121", f"this file defines the entity `{name}`", self.place(), "write out what it stands for")

    def external_entity(self, context: str | None, *_: object) -> int:
        raise _refuse("E0121", f"this file refers to the external entity `{context}`", self.place(), _ONLY_FIVE)

    def entity_skipped(self, name: str, is_parameter: bool) -> None:
        if not is_parameter:
            raise _refuse("E0121", f"the entity `{name}` is not defined in XML", self.place(len(name) + 2), _ONLY_FIVE)

    def start(self, name: str, attributes: dict[str, str]) -> None:
        check_job()
        self.elements += 1
        if len(self.open) >= DEEPEST or self.elements > MOST_ELEMENTS:
            what = f"elements are nested more than {DEEPEST} levels deep"
            if self.elements > MOST_ELEMENTS:
                what = f"there are more than {MOST_ELEMENTS} elements"
            raise _refuse("E0122", what, self.place(), None)
        start = self.here()
        parent = self.open[-1] if self.open else None
        path = f"/{name}"
        if parent is not None:
            self.counts[-1][name] += 1
            number = self.counts[-1][name]
            path = f"{parent.path}/{name}"
            if name in _NUMBERED or number > 1:
                path += f"[{number}]"
        element = Element(name, attributes, path, Span(self.source, start, start))
        if parent is None:
            self.root = element
        else:
            parent.children.append(element)
        self.open.append(element)
        self.counts.append(Counter())

    def end(self, _name: str) -> None:
        element = self.open.pop()
        self.counts.pop()
        start, here = element.span.start, self.here()
        text = self.source.text
        tag = element.tag
        end = tag.end if text.startswith("/>", tag.end - 2) else text.find(">", here) + 1
        element.span = Span(self.source, start, end)

    def characters(self, data: str) -> None:
        if not self.open:
            return
        start = self.here()
        end = start + len(data)
        if len(data) == 1:  # what the file writes otherwise comes alone
            text = self.source.text
            if text.startswith("&", start):
                end = text.find(";", start) + 1
            elif text.startswith("\r\n", start):
                end = start + 2
        self.open[-1].runs.append((data, start, end))


class _Offsets:
    """From offsets in the encoded text, looked up in ascending order, to offsets in the text."""

    def __init__(self, text: str) -> None:
        self.encoded = None if text.isascii() else text.encode(_ENCODING, "surrogatepass")
        self.byte = 0
        self.position = 0

    def character(self, byte: int) -> int:
        if self.encoded is None:
            return byte
        if byte < self.byte:
            self.byte = self.position = 0
        self.position += len(self.encoded[self.byte : byte].decode(_ENCODING, "replace"))
        self.byte = byte
        return self.position


def _refuse(code: str, message: str, span: Span, help: str | None) -> InputError:
    return InputError([Diagnostic(code, message, span, help)])
