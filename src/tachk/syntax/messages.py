"""What is said about a token that cannot stand where it stands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches

from tachk.diagnostics.diagnostic import Diagnostic, Label
from tachk.diagnostics.span import Span
from tachk.syntax.contextual import SPELLING
from tachk.syntax.tables import lexer, terminal_spelling
from tachk.syntax.tokens import END, Token


@dataclass(frozen=True, slots=True)
class Situation:
    """Attributes:
    tokens: the whole text.
    index: the token that does not fit.
    accepted: the terminals that would fit.
    supplied: the token that was put in because only it is missing.
    construct: the offset where the enclosing item, statement or clause begins, if it has begun.
    """

    tokens: Sequence[Token]
    index: int
    accepted: frozenset[str]
    supplied: Token | None
    construct: int | None


def explain(situation: Situation) -> Diagnostic:
    token = situation.tokens[situation.index]
    return Diagnostic("E0101", f"'{token.text}' does not fit here", token.span)
