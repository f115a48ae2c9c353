"""The text of a sentence as a row of words, numbers, signs and bracketed groups.

A group, such as ``(i < 3, j)`` or ``"p and q"``, is one piece: no phrase begins inside it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.span import Source, Span

_PIECE = re.compile(
    r"""
    (?P<blank>(?:\s|\ufeff|\\[ \t]*\r?\n|//[^\n]*|/\*[\s\S]*?(?:\*/|\Z))+)
  | (?P<number>[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?(?=[^0-9.]|\.(?![0-9])|\Z))
  | (?P<word>[^\W\d][\w$\#]*)
  | (?P<quote>["“„`])
  | (?P<opening>[(\[{])
  | (?P<sign>.)
    """,
    re.VERBOSE | re.DOTALL,
)
_CLOSING = {"(": ")", "[": "]", "{": "}"}
_END_QUOTES = {'"': '"', "`": "`", "“": "”", "„": "“”"}

LONGEST = 200
"""Pieces of a sentence; more is not a sentence."""


@dataclass(frozen=True, slots=True)
class Piece:
    """Attributes:
    kind: ``word``, ``number``, ``quote`` (with its quotes), ``group`` (with its brackets), ``sign``, or ``stop`` for a
        full stop that ends a sentence.
    """

    kind: str
    span: Span

    @property
    def text(self) -> str:
        return self.span.text


def cut(span: Span) -> tuple[tuple[Piece, ...], tuple[Diagnostic, ...]]:
    """The pieces of a text, and what is not closed in it."""
    source = span.source
    pieces: list[Piece] = []
    position = span.start
    while position < span.end:
        found = _PIECE.match(source.text, position, span.end)
        assert found is not None, "the last alternative takes any character"
        kind, end = str(found.lastgroup), found.end()
        if kind == "quote":
            closing = _end_of_quote(source, position, span.end)
            if closing is None:
                return (), (_unclosed("E0004", source, position, "this quotation is never closed"),)
            end = closing
        elif kind == "opening":
            closing = _end_of_group(source, position, span.end)
            if closing is None:
                return (), (_unclosed("E0113", source, position, f"this '{found.group()}' is never closed"),)
            kind, end = "group", closing
        elif found.group() == "." and _ends_sentence(source, position, span):
            kind = "stop"
        if kind != "blank":
            pieces.append(Piece(kind, Span(source, position, end)))
        position = end
    if len(pieces) > LONGEST:
        too_long = Span(source, pieces[LONGEST].span.start, pieces[LONGEST].span.end)
        return (), (Diagnostic("E0111", f"a sentence has at most {LONGEST} words", too_long),)
    return tuple(pieces), ()


def _ends_sentence(source: Source, position: int, span: Span) -> bool:
    """True if a point is not part of ``P.location``."""
    after = position + 1
    return after >= span.end or not (source.text[after].isalnum() or source.text[after] in "_`")


def _end_of_quote(source: Source, start: int, stop: int) -> int | None:
    ends = _END_QUOTES[source.text[start]]
    return next((at + 1 for at in range(start + 1, stop) if source.text[at] in ends), None)


def _end_of_group(source: Source, start: int, stop: int) -> int | None:
    """The offset behind the bracket that closes the one at ``start``."""
    expected: list[str] = []
    position = start
    while position < stop:
        found = _PIECE.match(source.text, position, stop)
        assert found is not None
        position = found.end()
        text = found.group()
        if found.lastgroup == "quote":
            closing = _end_of_quote(source, found.start(), stop)
            if closing is None:
                return None
            position = closing
        elif found.lastgroup == "opening":
            expected.append(_CLOSING[text])
        elif text in (")", "]", "}"):
            if expected.pop() != text:
                return None
            if not expected:
                return position
    return None


def _unclosed(code: str, source: Source, position: int, message: str) -> Diagnostic:
    return Diagnostic(code, message, Span(source, position, position + 1))
