"""What a notebook shows of results: a table, and what explains it folded below. All texts are escaped.

`html` is imported where something is shown: no program that shows nothing loads it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

_GOOD, _BAD, _OPEN = "#1f883d", "#d1242f", "#bf8700"
ANSWER_COLOURS = {
    "holds": _GOOD,
    "true": _GOOD,
    "fails": _BAD,
    "false": _BAD,
    "unknown": _OPEN,
    "undetermined": _OPEN,
}
"""Of what begins with such a word: they can be read on white and on black."""


PRE = "line-height: 1.25; font-family: monospace; white-space: pre; overflow-x: auto"
"""The style of a text with columns: a notebook's own may have another font and break lines."""
CAPTION = "caption-side: top; text-align: left; white-space: nowrap"
_CELL, _NUMBER = "text-align: left", "text-align: right; white-space: nowrap"


def preformatted(text: str) -> str:
    """HTML that shows a text with its lines and columns."""
    from html import escape

    return f'<pre style="{PRE}">{escape(text)}</pre>'


def html_table(columns: Sequence[str], rows: Iterable[Sequence[object]], caption: str = "") -> str:
    """A table: numbers at the right, answers in their colours, None as a dash."""
    from html import escape

    cells = [[(_text(value), _is_number(value)) for value in row] for row in rows]
    numbers = [all(row[place][1] for row in cells) for place in range(len(columns))]
    head = "".join(
        f'<th style="{_NUMBER if right else _CELL}">{escape(name)}</th>'
        for name, right in zip(columns, numbers, strict=True)
    )
    body = "".join(f"<tr>{''.join(_cell(*each) for each in row)}</tr>\n" for row in cells)
    title = f'<caption style="{CAPTION}">{escape(caption)}</caption>\n' if caption else ""
    return f"<table>\n{title}<thead><tr>{head}</tr></thead>\n<tbody>\n{body}</tbody>\n</table>"


def _text(value: object) -> str:
    return "–" if value is None else str(value)


def _is_number(value: object) -> bool:
    """Also where it is written with separators, and where there is none."""
    return value is None or _text(value).replace(",", "").replace(".", "").lstrip("-").isdigit()


def _cell(text: str, is_number: bool) -> str:
    from html import escape

    style = _NUMBER if is_number else _CELL
    word = text.split(" ", 1)[0].rstrip(",;:").lower()
    if word in ANSWER_COLOURS:
        style += f"; color: {ANSWER_COLOURS[word]}"
    return f'<td style="{style}">{escape(text)}</td>'


def folded(title: str, text: str, is_open: bool = False) -> str:
    """A text of several lines behind its title."""
    from html import escape

    opened = "<details open>" if is_open else "<details>"
    return f"{opened}\n<summary>{escape(title)}</summary>\n{preformatted(text)}\n</details>"
