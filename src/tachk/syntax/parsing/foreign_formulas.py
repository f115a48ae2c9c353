"""Temporal formulas as RTAMT, Breach, MATLAB, ltl2ba and others write them: which spelling means the same here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.span import Span
from tachk.syntax.formulas.foreign_operators import NO_INSTANT
from tachk.syntax.formulas.tokens import EDGES, PREFIX
from tachk.syntax.parsing.contextual import PATHS
from tachk.syntax.parsing.situation import ParseSituation, is_formula, query_start
from tachk.syntax.parsing.tokens import Token

_RELEASE = "for `p R q` write `q W (p && q)`: q holds up to the instant at which p does, that one included"
_SAME = "write `p == q` for conditions, and `(p -> q) && (q -> p)` for formulas"
_BOUNDS = {
    "<=": "[0, {0}]",
    "<": "[0, {0})",
    ">=": "[{0}, inf)",
    ">": "({0}, inf)",
    **dict.fromkeys(("=", "=="), "[{0}, {0}]"),
}

_RESPONSE = "for `p leads to q` write `G (p -> F[0, 5] q)`, or without [0, 5] where no bound is meant"
_AFTER = "for `q after p` write `G (p -> F[0, 5] q)` if q must follow p, or `!q W p` if q must not come without it"
_CONDITION = "for `if p then q` write `p -> q`, and `G (p -> q)` for every instant"

_INFIX = {
    **dict.fromkeys(("R", "V", "release", "releases"), _RELEASE),
    **dict.fromkeys(("iff", "equiv", "xnor"), _SAME),
    **dict.fromkeys(("implies", "then"), "write -> for 'implies'"),
    **dict.fromkeys(("before", "precedes"), "for `p before q` write `!q W p`: q is false until p is true"),
    **dict.fromkeys(("triggers", "causes", "followed"), _RESPONSE),
    "after": _AFTER,
    **dict.fromkeys(("if", "when", "whenever", "while"), "for `q if p` write `p -> q`, and `G (p -> q)` for always"),
    "weak": "the operator is written W",
}
"""Words between two operands of a formula."""

_LEADS_TO = dict.fromkeys(("leads", "leadsto"), _RESPONSE)
"""Queries have an operator of their own for it."""

_INFIX_OF_CONDITIONS = {
    **dict.fromkeys(("iff", "equiv", "xnor"), "write `p == q`"),
    **dict.fromkeys(("implies", "then"), "write imply for 'implies'"),
}
"""The same in a query, whose operands are conditions."""

_NEVER = dict.fromkeys(("never", "no"), "write ! in front of what must not be, as in G !p")
_CONDITIONAL = {
    **dict.fromkeys(("if", "when", "whenever", "upon"), _CONDITION),
    "after": _AFTER,
    "before": "for `before q, p` write `p W q`: p is true until q is",
    "while": "for `while p, q` write `G (p -> q)`",
}
"""Words that begin an English sentence; here they are names where a formula could go on."""

_SIGNS = {"<->": _SAME, "<=>": _SAME, "==>": "write -> for 'implies'"}
_SIGNS_OF_CONDITIONS = {
    **dict.fromkeys(("<->", "<=>"), "write `p == q`"),
    "==>": "write imply for 'implies'",
}


def foreign_formula(situation: ParseSituation) -> Diagnostic | None:
    """The diagnostic for a formula in the words of another tool; None where it is not one."""
    begin = 0 if situation.start == "formula_fragment" else query_start(situation)
    if begin is None:
        return None
    tokens = situation.tokens
    signs = _SIGNS if is_formula(situation) else _SIGNS_OF_CONDITIONS
    for place in range(begin, min(situation.index + 1, len(tokens))):
        found = (
            _sign(tokens[place : place + 2], signs)
            or _underscore(tokens[place : place + 2])
            or _comparison(tokens[max(place - 1, 0) : place + 5])
        )
        if found is not None:
            return found
    return _word(situation) or _braces(situation) or _path(situation) or _number(situation)


def _touch(first: Token, second: Token) -> bool:
    return first.span.end == second.span.start


def _sign(tokens: Sequence[Token], meanings: Mapping[str, str]) -> Diagnostic | None:
    if len(tokens) < 2 or not _touch(*tokens):
        return None
    text = tokens[0].text + tokens[1].text
    if text not in meanings:
        return None
    return Diagnostic("E0101", f"'{text}' is not an operator", tokens[0].span.to(tokens[1].span), meanings[text])


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
    closing = tokens[4] if inside and len(tokens) > 4 and tokens[4].text in ("]", "}") else bound
    span = tokens[0].span.to(closing.span)
    interval = _BOUNDS[sign.text].format(bound.text)
    return Diagnostic("E0130", "an interval has two bounds", span, f"write {tokens[0].text}{interval}")


def _word(situation: ParseSituation) -> Diagnostic | None:
    token, formula = situation.token, is_formula(situation)
    alone = situation.start == "formula_fragment"
    infix = {**_INFIX, **(_LEADS_TO if alone else {})} if formula else _INFIX_OF_CONDITIONS
    if token.text in infix and token.type != "QUOTED":
        return _unknown(token, infix[token.text])
    before = situation.tokens[situation.index - 1] if situation.index else token
    if not formula or before.type != "NAME" or situation.tokens[situation.index - 2].text == ".":
        return None
    if before.text in EDGES:
        message = f"'{before.text}' wants parentheses around its operand"
        return Diagnostic("E0101", message, before.span, f"as in {before.text}(p)")
    prefix = {**NO_INSTANT, **_NEVER, **_CONDITIONAL} if alone else NO_INSTANT
    return _unknown(before, prefix[before.text]) if before.text in prefix else None


def _braces(situation: ParseSituation) -> Diagnostic | None:
    """``{p} -> {q}``."""
    token = situation.token
    if token.text not in ("{", "}"):
        return None
    return Diagnostic("E0101", "braces do not group conditions", token.span, "write ( and ) in place of { and }")


def _path(situation: ParseSituation) -> Diagnostic | None:
    """``AG p`` and ``p --> q``, which are about all runs, where a formula about one run is wanted."""
    tokens, index = situation.tokens, situation.index
    if situation.start != "formula_fragment":
        return None
    before = tokens[index - 1] if index else situation.token
    message = "is about all runs of a model; a formula is wanted"
    if before.text in PATHS:
        help_ = f"a formula speaks about one run: write {before.text[1]} in place of {before.text}"
        return Diagnostic("E0101", f"'{before.text}' {message}", before.span, help_)
    if situation.token.text == "-->":
        return Diagnostic("E0101", f"'-->' {message}", situation.token.span, "write `G (p -> F q)` for `p --> q`")
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
