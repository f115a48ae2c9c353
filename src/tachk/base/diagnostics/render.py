"""Diagnostics as text for people.

The full form points with carets at the place in the source line; the one-line form is for editors and grep.
"""

from __future__ import annotations

from collections.abc import Callable
from unicodedata import east_asian_width

from tachk.base.diagnostics.diagnostic import Diagnostic, Severity
from tachk.base.span import NOWHERE, Span

WIDEST = 100
"""Columns of a source line that are shown; of a longer line, the part around the carets."""

TAB = "    "

_RESET = "\x1b[0m"
_BOLD = "\x1b[1m"
_BLUE = "\x1b[34m"
_CYAN = "\x1b[36m"
_BY_SEVERITY = {Severity.ERROR: "\x1b[1;31m", Severity.WARNING: "\x1b[1;33m"}


def render(diagnostic: Diagnostic, colour: bool = False) -> str:
    """The full form, without a trailing line break.

    ``file:line:column: error[E0101]: message``, the source line, carets under the range, other places, ``help:``.
    """
    paint = _paint if colour else _plain
    severity = diagnostic.severity
    tint = _BY_SEVERITY[severity]
    lines = [
        paint(f"{_place(diagnostic.span)}: ", _BOLD)
        + paint(f"{severity.value}[{diagnostic.code}]", tint)
        + paint(f": {diagnostic.message}", _BOLD)
    ]
    lines += _snippet(diagnostic.span, "", "^", tint, paint)
    shown = lines[1:2]
    for label in diagnostic.labels:
        if label.span.source is not diagnostic.span.source:
            lines.append(paint(f"  --> {_place(label.span)}", _BLUE))
        snippet = _snippet(label.span, label.text, "-", _BLUE, paint)
        lines += snippet[1:] if snippet[:1] == shown else snippet
        shown = snippet[:1]
    passage = diagnostic.span.passage
    if passage is not None:
        lines.append(paint("in: ", _CYAN) + f"{passage.names} ({passage.path})")
    if diagnostic.help:
        lines.append(paint("help: ", _CYAN) + diagnostic.help)
    return "\n".join(lines)


def _paint(text: str, code: str) -> str:
    return f"{code}{text}{_RESET}"


def _plain(text: str, _: str) -> str:
    return text


def _place(span: Span) -> str:
    return span.source.name if span.source is NOWHERE.source else str(span)


def _snippet(span: Span, text: str, mark: str, tint: str, paint: Callable[[str, str], str]) -> list[str]:
    """The first line of a span with its range marked; nothing where there is no text."""
    span = span.in_file
    source = span.source
    if not source.text:
        return []
    number, column = source.line_column(span.start)
    line = source.line(number)
    first = column - 1
    last = min(first + max(span.end - span.start, 1), max(len(line), first + 1))
    line, first, last = _clip(line, first, last)
    gutter = f"{number:>5} | "
    under = _width(line[:first])
    marks = mark * max(_width(line[first:last]), 1)
    pointer = " " * 5 + " | " + " " * under
    note = f" {text}" if text else ""
    return [paint(gutter, _BLUE) + _shown(line), paint(pointer, _BLUE) + paint(marks + note, tint)]


def _clip(line: str, first: int, last: int) -> tuple[str, int, int]:
    """A part of at most `WIDEST` characters of a line that contains the start of the range."""
    if len(line) <= WIDEST:
        return line, first, last
    begin = max(0, min(first - WIDEST // 3, len(line) - WIDEST))
    end = min(len(line), begin + WIDEST)
    head = "..." if begin else ""
    tail = "..." if end < len(line) else ""
    shift = len(head) - begin
    return head + line[begin:end] + tail, first + shift, min(last, end) + shift


def _shown(line: str) -> str:
    return "".join(TAB if c == "\t" else c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in line)


def _width(text: str) -> int:
    """Columns on a terminal."""
    return sum(len(TAB) if c == "\t" else 2 if east_asian_width(c) in "WF" else 1 for c in text)
