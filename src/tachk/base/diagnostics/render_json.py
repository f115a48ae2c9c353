"""Diagnostics as plain data for programs."""

from __future__ import annotations

from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.span import Span


def diagnostic_to_json(diagnostic: Diagnostic) -> dict[str, Any]:
    """A dictionary of strings, numbers and lists.

    Lines and columns count from 1, the end column is the one behind the last character. Places in UPPAAL's XML say
    also what they are about, by the names of the model (``names``) and as XPath (``path``).
    """
    return {
        "code": diagnostic.code,
        "severity": diagnostic.severity.value,
        "message": diagnostic.message,
        "help": diagnostic.help,
        "place": _place(diagnostic.span),
        "labels": [{"text": label.text, "place": _place(label.span)} for label in diagnostic.labels],
    }


def _place(span: Span) -> dict[str, Any]:
    place, passage = span.in_file, span.passage
    line, column = place.source.line_column(place.start)
    end_line, end_column = place.source.line_column(place.end)
    return {
        "file": place.source.name,
        "line": line,
        "column": column,
        "end_line": end_line,
        "end_column": end_column,
        **({} if passage is None else {"names": passage.names, "path": passage.path}),
    }
