"""Source texts and character ranges in them.

A span is two offsets and the source they belong to; lines and columns are looked up only when a message is printed.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Source:
    """A named piece of text: a file, a command-line argument, a label of an XML document.

    Attributes:
        name: what messages print in front of the line number, usually a path as the user gave it.
        text: the whole text.
    """

    name: str
    text: str = field(repr=False)
    _line_starts: list[int] = field(init=False, repr=False, compare=False, default_factory=list)

    def line_column(self, offset: int) -> tuple[int, int]:
        """The one-based line and column of a character offset."""
        starts = self._starts()
        line = bisect_right(starts, offset) - 1
        return line + 1, offset - starts[line] + 1

    def line(self, number: int) -> str:
        """The text of a one-based line, without its line break."""
        starts = self._starts()
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

    def __str__(self) -> str:
        line, column = self.source.line_column(self.start)
        return f"{self.source.name}:{line}:{column}"


NOWHERE = Span(Source("<built>", ""), 0, 0)
"""The place of things that no text describes, such as a network built by a script."""
