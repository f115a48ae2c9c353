"""The texts in a picture: how a label is written, where it is broken into lines, and how much room it takes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from tachk.syntax import ast
from tachk.syntax.edge_clauses import edge_clauses
from tachk.syntax.picture_layout import LabelLayout, Point
from tachk.syntax.printing.expression_printer import print_clause, print_expression

Size = tuple[int, int]
"""Width and height, in UPPAAL's coordinates."""

LINE_HEIGHT = 15
"""From one line of a label to its next, in UPPAAL's coordinates."""

LABEL_GAP = 2
"""Between two labels of one stack, so that labels of one line are the usual 17 apart."""

_LONGEST_LINE = 36
_WIDEST_COMMENT, _HIGHEST_COMMENT = 380, 2
_BREAK = re.compile(r"(?:,|&&|\|\||\bimply|\bor|\band) ")
_WIDTHS = {
    **dict.fromkeys("ijl'|!.,:;I ", 4.2),
    **dict.fromkeys('frt()[]{}-"/\\', 5.2),
    **dict.fromkeys("mwMW@%", 11.6),
    **dict.fromkeys("+<>=~^#", 10.0),
    **dict.fromkeys("ABCDEFGHJKLNOPQRSTUVXYZ&", 8.6),
}


def location_labels(location: ast.LocationDeclaration) -> dict[str, str]:
    """The texts of the labels of a location that stand together, by their kinds, from top to bottom."""
    labels = {}
    if location.invariant is not None:
        labels["invariant"] = print_expression(location.invariant)
    if location.exponential_rate is not None:
        labels["exponentialrate"] = print_expression(location.exponential_rate)
    return labels


def edge_labels(edge: ast.EdgeDeclaration) -> dict[str, str]:
    """The texts of the labels of an edge that stand together, by their kinds, from top to bottom."""
    labels = {clause.kind.label: print_clause(clause) for clause in edge_clauses(edge)}
    if _is_short(edge.doc):
        labels["comments"] = edge.doc
    return labels


def _is_short(comment: str) -> bool:
    """True if the comment on an edge can stand with its labels; a long one has to find room elsewhere."""
    return 0 < text_width(comment) <= _WIDEST_COMMENT and comment.count("\n") < _HIGHEST_COMMENT


def line_broken(labels: Mapping[str, str]) -> dict[str, str]:
    """Labels with line breaks where they are long; comments stay as they are."""
    return {kind: text if kind == "comments" else wrap(text) for kind, text in labels.items()}


def wrap(text: str) -> str:
    """The text with line breaks instead of blanks after some of its commas and connectives, where it is long.

    Only blanks outside brackets and strings are replaced, so the text still reads as the same expression.
    """
    lines: list[str] = []
    line = ""
    for piece in _pieces(text):
        if line and len(line) + len(piece.rstrip()) > _LONGEST_LINE:
            lines.append(line.rstrip())
            line = ""
        line += piece
    return "\n".join((*lines, line))


def _pieces(text: str) -> Iterator[str]:
    """The text cut after the commas and connectives that are in no brackets and in no string."""
    depth = 0
    quoted = False
    start = 0
    at = 0
    while at < len(text):
        letter = text[at]
        if letter == '"':
            quoted = not quoted
        elif not quoted and letter in "([{":
            depth += 1
        elif not quoted and letter in ")]}":
            depth -= 1
        elif depth == 0 and not quoted and (found := _BREAK.match(text, at)):
            yield text[start : found.end()]
            start = at = found.end()
            continue
        at += 1
    yield text[start:]


def text_width(text: str) -> int:
    """The width of the longest line, in UPPAAL's coordinates: an upper estimate for a sans-serif font of size 12."""
    return max((round(sum(_WIDTHS.get(letter, 7.5) for letter in line)) for line in text.split("\n")), default=0)


def text_height(text: str) -> int:
    return LINE_HEIGHT * (text.count("\n") + 1) + LABEL_GAP


def stack_size(labels: Mapping[str, str]) -> Size:
    """Width and height of labels one below the other."""
    if not labels:
        return 0, 0
    return max(map(text_width, labels.values())), sum(map(text_height, labels.values()))


def text_size(text: str) -> Size:
    return text_width(text), text_height(text)


def label_stack(texts: Mapping[str, str], corner: Point) -> dict[str, LabelLayout]:
    """Labels one below the other; a text that is broken into lines is kept with its breaks."""
    stack = {}
    top = corner.y
    for kind, wrapped in line_broken(texts).items():
        stack[kind] = LabelLayout(Point(corner.x, top), wrapped if wrapped != texts[kind] else None)
        top += text_height(wrapped)
    return stack
