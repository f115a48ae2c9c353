"""Temporal formulas as RTAMT, Breach, MATLAB, ltl2ba and others write them: which spelling means the same here."""

from __future__ import annotations

from collections.abc import Sequence

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.span import Span
from tachk.syntax.formulas.tokens import PREFIX
from tachk.syntax.parsing.situation import ParseSituation, query_start
from tachk.syntax.parsing.tokens import Token

_NEXT = "there is no next instant in dense time: F(0, d] p says that p comes within d, rise(p) that it begins"
_BEFORE = "there is no last instant in dense time: O(0, d] p says that p was there within d, rise(p) that it begins"
_RELEASE = "for `p R q` write `q W (p && q)`: q holds up to the instant at which p does, that one included"
_SAME = "write `p == q` for conditions, and `(p -> q) && (q -> p)` for formulas"
_BOUNDS = {
    "<=": "[0, {0}]",
    "<": "[0, {0})",
    ">=": "[{0}, inf)",
    ">": "({0}, inf)",
    **dict.fromkeys(("=", "=="), "[{0}, {0}]"),
}

_INFIX = {
    **dict.fromkeys(("R", "V", "release", "releases"), _RELEASE),
    **dict.fromkeys(("iff", "equiv", "xnor"), _SAME),
    **dict.fromkeys(("implies", "then"), "write -> for 'implies'"),
}
"""Words between two operands."""

_PREFIX = {
    **dict.fromkeys(("X", "N", "next"), _NEXT),
    **dict.fromkeys(("Y", "Z", "prev", "previous", "yesterday"), _BEFORE),
}
"""Words in front of an operand."""

_SIGNS = {"<->": _SAME, "<=>": _SAME}


def foreign_formula(situation: ParseSituation) -> Diagnostic | None:
    """The diagnostic for a formula in the words of another tool; None where it is not one."""
    begin = 0 if situation.start == "formula_fragment" else query_start(situation)
    if begin is None:
        return None
    tokens = situation.tokens
    for place in range(begin, min(situation.index + 1, len(tokens))):
        found = (
            _sign(tokens[place : place + 2])
            or _underscore(tokens[place : place + 2])
            or _comparison(tokens[max(place - 1, 0) : place + 4])
        )
        if found is not None:
            return found
    return _word(situation) or _number(situation)


def _touch(first: Token, second: Token) -> bool:
    return first.span.end == second.span.start


def _sign(tokens: Sequence[Token]) -> Diagnostic | None:
    if len(tokens) < 2 or not _touch(*tokens):
        return None
    text = tokens[0].text + tokens[1].text
    if text not in _SIGNS:
        return None
    return Diagnostic("E0101", f"'{text}' is not an operator", tokens[0].span.to(tokens[1].span), _SIGNS[text])


def _underscore(tokens: Sequence[Token]) -> Diagnostic | None:
    """``[]_[0, 5] p``."""
    if len(tokens) < 2 or tokens[0].type != "FORMULA_PREFIX" or tokens[1].text != "_":
        return None
    span = tokens[0].span.to(tokens[1].span)
    letter = tokens[0].text
    mend = f"the operator is written {letter}, with the interval right behind it, as in {letter}[0, 5]"
    return Diagnostic("E0104", f"unknown word '{span.text}'", span, mend)


def _comparison(tokens: Sequence[Token]) -> Diagnostic | None:
    """``F[<=5] p``, ``F{<=5} p``, ``F<=5 p``."""
    if len(tokens) < 3 or tokens[0].text not in PREFIX | {"U", "S"}:
        return None
    inside = tokens[1].text in ("[", "{")
    sign, bound = tokens[2 if inside else 1], tokens[3] if inside and len(tokens) > 3 else tokens[2]
    if sign.text not in _BOUNDS or bound.type not in ("INTEGER", "FLOAT", "NAME"):
        return None
    if not inside and tokens[0].type == "NAME" and not _touch(tokens[0], sign):
        return None
    span = (tokens[1] if inside else sign).span.to(bound.span)
    interval = _BOUNDS[sign.text].format(bound.text)
    return Diagnostic("E0130", "an interval has two bounds", span, f"write {tokens[0].text}{interval}")


def _word(situation: ParseSituation) -> Diagnostic | None:
    tokens, index = situation.tokens, situation.index
    if situation.start != "formula_fragment" and not any(token.type == "FORMULA" for token in tokens):
        return None
    if situation.token.type == "NAME" and situation.token.text in _INFIX:
        return _unknown(situation.token, _INFIX[situation.token.text])
    if index and tokens[index - 1].type == "NAME" and tokens[index - 1].text in _PREFIX:
        return _unknown(tokens[index - 1], _PREFIX[tokens[index - 1].text])
    return None


def _unknown(token: Token, help_: str) -> Diagnostic:
    return Diagnostic("E0104", f"unknown word '{token.text}'", token.span, help_)


def _number(situation: ParseSituation) -> Diagnostic | None:
    """``.5`` and ``5.``, which models do not know."""
    tokens, index = situation.tokens, situation.index
    if situation.token.text == "." and index + 1 < len(tokens) and tokens[index + 1].type == "INTEGER":
        span = situation.token.span.to(tokens[index + 1].span)
        return Diagnostic("E0101", "a digit stands before the point of a number", span, f"write 0{span.text}")
    return None


def trailing_point(situation: ParseSituation) -> Diagnostic | None:
    """``double d = 5.;``."""
    tokens, index = situation.tokens, situation.index
    if index < 2 or tokens[index - 1].text != "." or tokens[index - 2].type != "INTEGER":
        return None
    if not _touch(tokens[index - 2], tokens[index - 1]):
        return None
    span = Span(tokens[index - 2].span.source, tokens[index - 2].span.start, tokens[index - 1].span.end)
    return Diagnostic("E0101", "a digit stands behind the point of a number", span, f"write {span.text}0")
