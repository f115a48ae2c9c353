"""The text within an XML document, joined to one source whose places lead back to the file.

Labels and sections follow one another in the order of the syntax tree, each ended by a line break; so spans of one
model can be compared, and comments find their places as in a model written as text.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from tachk.base.job import check_job
from tachk.base.span import Origin, Passage, Source, Span
from tachk.formats.uppaal.xml_tree import Element


@dataclass(slots=True)
class Extract:
    """Collects text."""

    file: Source
    parts: list[str] = field(default_factory=list)
    length: int = 0
    starts: list[int] = field(default_factory=list)
    places: list[tuple[int, int]] = field(default_factory=list)
    passages: list[tuple[int, Passage]] = field(default_factory=list)
    tags: dict[int, tuple[int, int]] = field(default_factory=dict)
    texts: dict[int, tuple[int, int]] = field(default_factory=dict)

    def mark(self, element: Element, names: str) -> None:
        """Gives an element a place, of one blank that stands for its opening tag."""
        self.passages.append((self.length, Passage(names, element.path)))
        tag = element.tag
        self.tags[id(element)] = self.length, self.length + 1
        self._append(" ", tag.start, tag.end)

    def add(self, element: Element, names: str) -> None:
        """Gives an element a place and takes in its text."""
        self.mark(element, names)
        start = self.length
        for text, first, last in element.runs:
            self._append(text, first, last)
        self.texts[id(element)] = start, self.length
        self.end_line(element)

    def end_line(self, element: Element) -> None:
        """Ends the line, unless it is ended."""
        if self.parts and not self.parts[-1].endswith("\n"):
            self._append("\n", element.span.end, element.span.end)

    def finish(self) -> Extracted:
        origin = Origin(self.file, self.starts or [0], self.places or [(0, 0)], self.passages)
        return Extracted(Source(self.file.name, "".join(self.parts), origin), self.tags, self.texts)

    def _append(self, text: str, first: int, last: int) -> None:
        check_job()
        self.starts.append(self.length)
        self.places.append((first, last))
        self.parts.append(text)
        self.length += len(text)


@dataclass(frozen=True, slots=True)
class Extracted:
    """The joined text. Elements are found by identity, so they must be alive."""

    source: Source
    _tags: dict[int, tuple[int, int]]
    _texts: dict[int, tuple[int, int]]

    def tag(self, element: Element) -> Span:
        """The place of an element that was marked or added."""
        return Span(self.source, *self._tags[id(element)])

    def text(self, element: Element) -> Span:
        """The text of an element that was added."""
        return Span(self.source, *self._texts[id(element)])

    def trimmed(self, element: Element) -> Span:
        """The text of an element without the blanks around it; its tag if there is nothing else."""
        span = self.text(element)
        text = span.text
        left = len(text) - len(text.lstrip())
        inner = text.strip()
        return Span(self.source, span.start + left, span.start + left + len(inner)) if inner else self.tag(element)
