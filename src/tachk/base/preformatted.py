"""Text in a notebook."""

from __future__ import annotations

from html import escape


def preformatted(text: str) -> str:
    """HTML that shows a text with its lines and columns."""
    return f'<pre style="line-height: 1.25">{escape(text)}</pre>'
