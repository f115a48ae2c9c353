"""Operators of temporal formulas as other tools write them: which one is meant here."""

from __future__ import annotations

from collections.abc import Mapping

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.span import Span
from tachk.syntax.formulas.tokens import WORDS

_NEXT = "there is no next instant in dense time: F(0, d] p says that p comes within d, rise(p) that it begins"
_BEFORE = "there is no last instant in dense time: O(0, d] p says that p was there within d, rise(p) that it begins"

NO_INSTANT: Mapping[str, str] = {
    **dict.fromkeys(("X", "N", "next"), _NEXT),
    **dict.fromkeys(("Y", "Z", "prev", "previous", "yesterday"), _BEFORE),
}
"""Words about the instant beside this one, and what can be said in their place."""


def operator_word(word: str, span: Span, following: str) -> Diagnostic:
    """The diagnostic for a word that stands for an operator with a letter, and what follows it."""
    letter = WORDS[word.lower()]
    if letter == "W":
        help_ = "the operator is written W"
    elif following == "[":
        help_ = f"the operator is written {letter}, with the interval right behind it, as in {letter}[0, 5]"
    else:
        help_ = f"the operator is written {letter}; an interval can stand right behind it, as in {letter}[0, 5]"
    return _unknown(word, span, help_)


def operator_as_call(word: str, span: Span) -> Diagnostic | None:
    """The diagnostic for an operator that is written as a function, ``always(p)``; None where it is not one."""
    if word.lower() in WORDS:
        return operator_word(word, span, "(")
    # A letter is more likely the name of a process.
    return _unknown(word, span, NO_INSTANT[word]) if len(word) > 1 and word in NO_INSTANT else None


def _unknown(word: str, span: Span, help_: str) -> Diagnostic:
    return Diagnostic("E0104", f"unknown word '{word}'", span, help_)
