"""What elaboration may still say about a text with syntax errors.

The parser passes over what it cannot read, so a declaration may be missing from the tree. Items that hold a syntax
error are therefore not judged further, and a complaint about a name that such an item mentions is dropped: the item may
have declared it. So is the complaint that there is no system line. Everything else the user can mend in the same round.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterable, Sequence

from tachk.base.diagnostics.diagnostic import Diagnostic, Severity
from tachk.base.span import Span
from tachk.syntax import ast

NO_SYSTEM_LINE = "E0410"


def beyond_damage(
    syntax: Sequence[Diagnostic], semantic: Iterable[Diagnostic], items: Sequence[ast.Item]
) -> tuple[Diagnostic, ...]:
    """The errors among ``semantic`` that the errors in ``syntax`` cannot have caused."""
    damaged = [_damaged_range(error.span, items) for error in syntax if error.severity is Severity.ERROR]
    mentioned = {word for span in damaged for word in re.findall(r"\w+", span.text)}
    return tuple(
        diagnostic
        for diagnostic in semantic
        if diagnostic.severity is Severity.ERROR
        and diagnostic.code != NO_SYSTEM_LINE
        and not any(_overlap(span, diagnostic.span) for span in damaged)
        and not mentioned & set(re.findall(r"`(\w+)", diagnostic.message))
    )


def _damaged_range(error: Span, items: Sequence[ast.Item]) -> Span:
    """The item around an error, or the text between its neighbours."""
    spans = sorted((i.span for i in items if i.span.source is error.source), key=lambda span: span.start)
    before = bisect_right(spans, error.start, key=lambda span: span.start)
    if before and error.start <= spans[before - 1].end:
        return spans[before - 1]
    start = spans[before - 1].end if before else 0
    end = spans[before].start if before < len(spans) else len(error.source.text)
    return Span(error.source, start, end)


def _overlap(one: Span, other: Span) -> bool:
    return one.source is other.source and one.start <= other.end and other.start <= one.end
