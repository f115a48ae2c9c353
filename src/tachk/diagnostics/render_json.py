"""Diagnostics as plain data for programs."""

from __future__ import annotations

from typing import Any

from tachk.diagnostics.diagnostic import Diagnostic
from tachk.diagnostics.span import Span


def diagnostic_to_json(diagnostic: Diagnostic) -> dict[str, Any]:
    """A dictionary of strings, numbers and lists.

    Lines and columns count from 1, the end column is the one behind the last character.
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
    line, column = span.source.line_column(span.start)
    end_line, end_column = span.source.line_column(span.end)
    return {
        "file": span.source.name,
        "line": line,
        "column": column,
        "end_line": end_line,
        "end_column": end_column,
    }
