"""Texts to temporal formulas."""

from __future__ import annotations

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.span import Source, Span
from tachk.syntax.formula import Formula
from tachk.syntax.formulas.tokens import resolve_formula
from tachk.syntax.parsing.depth import bracket_errors, nesting_errors
from tachk.syntax.parsing.driver import drive
from tachk.syntax.parsing.tables import lexer

Diagnostics = tuple[Diagnostic, ...]


def parse_formula(source: Source | Span) -> tuple[Formula | None, Diagnostics]:
    """Read a formula, or the part of a text that holds one; a condition without temporal operators is one too.

    Returns:
        The formula, every node with its place in the source, and what is wrong; None where anything is.
    """
    where = source if isinstance(source, Span) else Span(source, 0, len(source.text))
    lexed = lexer().cut(where.source, where.start, where.end)
    errors = bracket_errors(lexed.tokens)
    if errors or lexed.errors:
        return None, (*lexed.errors, *errors)
    *tokens, end = lexed.tokens
    formula, found = drive("formula_fragment", [*resolve_formula(tokens), end])
    if found:
        return None, found
    errors = nesting_errors(lexed.tokens, formula)
    return (None, errors) if errors else (formula, ())
