"""Text in a notebook."""

from __future__ import annotations


def preformatted(text: str) -> str:
    """HTML that shows a text with its lines and columns."""
    from html import escape  # no program that shows nothing loads it

    return f'<pre style="line-height: 1.25">{escape(text)}</pre>'
