"""Source texts and character ranges in them.

A span is two offsets and the source they belong to; lines and columns are looked up only when a message is printed.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

from tachk.base.records import dataclass, field


@dataclass(frozen=True, slots=True)
class Passage:
    """The part of a file to which a span belongs, where line and column alone say little.

    Attributes:
        names: in the terms of the model, such as ``Train, edge Appr -> Cross, guard``.
        path: in the terms of the file, such as the XPath ``/nta/template[1]/transition[3]/label[2]``.
    """

    names: str
    path: str


@dataclass(frozen=True, slots=True)
class Origin:
    """The places in a file of a text that was extracted from it.

    The text is cut into runs. A run is either taken over character by character, or is one character that the file
    writes otherwise, such as ``&lt;``.

    Attributes:
        source: the file.
        starts: the offset in the text at which each run begins, ascending, the first one 0.
        places: the first and the last offset (exclusive) of each run in the file.
        passages: the offset in the text from which each passage reaches to the next, ascending.
    """

    source: Source
    starts: Sequence[int]
    places: Sequence[tuple[int, int]]
    passages: Sequence[tuple[int, Passage]] = ()

    def begin(self, offset: int) -> int:
        """The offset in the file of a character of the text."""
        run = max(bisect_right(self.starts, offset) - 1, 0)
        first, last = self.places[run]
        return min(first + offset - self.starts[run], last)

    def end(self, offset: int) -> int:
        """The offset in the file behind the character of the text that ends at an offset."""
        run = max(bisect_right(self.starts, offset - 1) - 1, 0)
        first, last = self.places[run]
        whole = run + 1 < len(self.starts) and self.starts[run + 1] == offset
        return last if whole else min(first + offset - self.starts[run], last)

    def passage(self, offset: int) -> Passage | None:
        """The passage that holds a character of the text."""
        place = bisect_right(self.passages, offset, key=lambda entry: entry[0]) - 1
        return self.passages[place][1] if place >= 0 else None


@dataclass(frozen=True, slots=True)
class Source:
    """A named piece of text: a file, a command-line argument, the text within an XML document.

    Attributes:
        name: what messages print in front of the line number, usually a path as the user gave it.
        text: the whole text.
        origin: where the text comes from, if it is not the text of the file itself.
        first_line: the number that the first line of the text has in the file, where only a part of it is held.
    """

    name: str
    text: str = field(repr=False)
    origin: Origin | None = field(default=None, repr=False, compare=False)
    first_line: int = 1
    _line_starts: list[int] = field(init=False, repr=False, compare=False, default_factory=list)

    def line_column(self, offset: int) -> tuple[int, int]:
        """The one-based line and column of a character offset."""
        starts = self._starts()
        line = bisect_right(starts, offset) - 1
        return line + self.first_line, offset - starts[line] + 1

    def line(self, number: int) -> str:
        """The text of a one-based line, without its line break."""
        starts = self._starts()
        number -= self.first_line - 1
        end = starts[number] if number < len(starts) else len(self.text)
        return self.text[starts[number - 1] : end].rstrip("\r\n")

    def _starts(self) -> list[int]:
        if not self._line_starts:
            self._line_starts.append(0)
            self._line_starts.extend(i + 1 for i, c in enumerate(self.text) if c == "\n")
        return self._line_starts


@dataclass(frozen=True, slots=True)
class Span:
    """The half-open range ``[start, end)`` of characters of a source."""

    source: Source
    start: int
    end: int

    @property
    def text(self) -> str:
        return self.source.text[self.start : self.end]

    def to(self, other: Span) -> Span:
        """The range from the start of this span to the end of another one of the same source."""
        return Span(self.source, min(self.start, other.start), max(self.end, other.end))

    @property
    def in_file(self) -> Span:
        """The range in the file that people see, which is another one if the text was extracted from it."""
        origin = self.source.origin
        if origin is None:
            return self
        start = origin.begin(self.start)
        end = origin.end(self.end) if self.end > self.start else start
        return Span(origin.source, start, max(start, end))

    @property
    def passage(self) -> Passage | None:
        """The part of the file, for files in which line and column alone say little."""
        origin = self.source.origin
        return None if origin is None else origin.passage(self.start)

    def __str__(self) -> str:
        place = self.in_file
        line, column = place.source.line_column(place.start)
        return f"{place.source.name}:{line}:{column}"


NOWHERE = Span(Source("<built>", ""), 0, 0)
"""The place of things that no text describes, such as a network built by a script."""
