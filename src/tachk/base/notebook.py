"""What a notebook shows of results: a table, and what explains it folded below. All texts are escaped.

`html` is imported where something is shown: no program that shows nothing loads it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

_COLOURS = {
    "holds": "green",
    "true": "green",
    "fails": "firebrick",
    "false": "firebrick",
    "unknown": "darkorange",
    "undetermined": "darkorange",
}
"""Of cells that begin with such a word: in light and dark notebooks they can be read."""


def preformatted(text: str) -> str:
    """HTML that shows a text with its lines and columns."""
    from html import escape

    return f'<pre style="line-height: 1.25">{escape(text)}</pre>'


def html_table(columns: Sequence[str], rows: Iterable[Sequence[object]], caption: str = "") -> str:
    """A table: numbers at the right, answers in their colours, None as a dash."""
    from html import escape

    head = "".join(f"<th>{escape(name)}</th>" for name in columns)
    body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>\n" for row in rows)
    title = f"<caption>{escape(caption)}</caption>\n" if caption else ""
    return f"<table>\n{title}<thead><tr>{head}</tr></thead>\n<tbody>\n{body}</tbody>\n</table>"


def _cell(value: object) -> str:
    from html import escape

    text = "–" if value is None else str(value)
    word = text.split(" ", 1)[0].rstrip(",;:")
    style = "text-align: right" if isinstance(value, int | float) else "text-align: left"
    if word in _COLOURS:
        style += f"; color: {_COLOURS[word]}"
    return f'<td style="{style}">{escape(text)}</td>'


def folded(title: str, text: str, is_open: bool = False) -> str:
    """A text of several lines behind its title."""
    from html import escape

    opened = "<details open>" if is_open else "<details>"
    return f"{opened}\n<summary>{escape(title)}</summary>\n{preformatted(text)}\n</details>"
