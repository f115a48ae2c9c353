"""Spellings of other tools whose meaning is plain enough to suggest the right one."""

from __future__ import annotations

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.span import Span
from tachk.base.time_units import SPELLINGS
from tachk.syntax.parsing.contextual import PATHS
from tachk.syntax.parsing.situation import ParseSituation, is_formula, item_start, query_start
from tachk.syntax.parsing.tokens import END, Token

_TEMPLATE_WORDS = ("template", "automaton", "module", "proctype", "class")
_PATHS = ("[]", "<>")
_OPERATORS = {
    "=>": "write imply for 'implies', >= for 'at least'",
    "=<": "write <=",
    "<>": "write != for 'differs from'",
    "=!": "write !=",
}


def foreign_word(situation: ParseSituation) -> Diagnostic | None:
    """The diagnostic for a text that says something in the words of another tool; None where it does not."""
    if situation.start == "formula_fragment":
        return _query_for_a_formula(situation) or _operator(situation) or _capitals(situation)
    return (
        _operator(situation)
        or _bare_query(situation)
        or _negation(situation)
        or _capitals(situation)
        or _leads_to(situation)
        or _end(situation)
        or _template(situation)
        or _arrow(situation)
        or _unit(situation)
        or _arguments(situation)
    )


def _pair(situation: ParseSituation, place: int) -> str:
    """Two tokens that touch, as one text."""
    tokens = situation.tokens
    if not 0 <= place < len(tokens) - 1 or tokens[place].span.end != tokens[place + 1].span.start:
        return ""
    return tokens[place].text + tokens[place + 1].text


def _query_for_a_formula(situation: ParseSituation) -> Diagnostic | None:
    tokens, index = situation.tokens, situation.index
    for place in (index, index - 1):
        letter = {"[]": "G", "<>": "F"}.get(_pair(situation, place))
        if letter and place and tokens[place - 1].text in ("A", "E"):
            path = tokens[place - 1].span.to(tokens[place + 1].span)
            return Diagnostic(
                "E0101",
                f"'{path.text}' begins a query about all runs of a model; a formula is wanted",
                path,
                f"a formula speaks about one run: write {letter} in place of {path.text}",
            )
    if situation.token.text == ";":
        mend = "leave it out: in a file each formula has a line of its own, elsewhere && joins them"
        return Diagnostic("E0101", "';' does not fit here", situation.token.span, mend)
    return None


def _operator(situation: ParseSituation) -> Diagnostic | None:
    place = situation.index - 1
    pair = _pair(situation, place)
    if pair not in _OPERATORS or (pair == "<>" and situation.tokens[place - 1].text in ("A", "E")):
        return None
    mend = _OPERATORS[pair]
    if pair == "=>" and is_formula(situation):
        mend = "write -> for 'implies', >= for 'at least'"
    span = situation.tokens[place].span.to(situation.token.span)
    return Diagnostic("E0101", f"'{pair}' is not an operator", span, mend)


def _bare_query(situation: ParseSituation) -> Diagnostic | None:
    """A query that stands in a model without ``property name :``."""
    if situation.start != "document":
        return None
    tokens, first = situation.tokens, item_start(situation)
    begins = tokens[first].text in ("A", "E") and _pair(situation, first + 1) in _PATHS
    if not begins and tokens[first].text not in PATHS:
        return None
    last = first
    while tokens[last + 1].type != END and tokens[last + 1].text != ";" and _same_line(tokens[last], tokens[last + 1]):
        last += 1
    query = tokens[first].span.to(tokens[last].span)
    return Diagnostic("E0101", "a query of a model needs a name", query, f"write `property name : {query.text};`")


def _same_line(one: Token, other: Token) -> bool:
    return "\n" not in one.span.source.text[one.span.end : other.span.start]


def _negation(situation: ParseSituation) -> Diagnostic | None:
    """``A[] no deadlock``."""
    before = situation.tokens[situation.index - 1] if situation.index else situation.token
    if before.type != "NAME" or before.text not in ("no", "never") or query_start(situation) is None:
        return None
    mend = "write not" if before.text == "no" else "write `A[] not ...`"
    return Diagnostic("E0104", f"unknown word '{before.text}'", before.span, mend)


def _capitals(situation: ParseSituation) -> Diagnostic | None:
    """``p AND q``, ``NOT p``."""
    tokens, index = situation.tokens, situation.index
    for token in tokens[max(index - 1, 0) : index + 1]:
        if token.type == "NAME" and token.text in ("AND", "OR", "NOT", "IMPLY", "XOR"):
            return Diagnostic("E0104", f"unknown word '{token.text}'", token.span, f"write {token.text.lower()}")
    return None


def _leads_to(situation: ParseSituation) -> Diagnostic | None:
    """``p leads to q``."""
    token = situation.token
    if query_start(situation) is None or token.text not in ("leads", "leads_to", "leadsto"):
        return None
    following = situation.tokens[situation.index + 1]
    span = token.span.to(following.span) if following.text == "to" else token.span
    return Diagnostic("E0104", f"unknown word '{token.text}'", span, "write -->")


def _end(situation: ParseSituation) -> Diagnostic | None:
    """``A[] p;`` as a query by itself."""
    if situation.start != "query" or situation.token.text != ";":
        return None
    return Diagnostic("E0101", "';' does not fit here", situation.token.span, "remove it: a query ends without one")


def _template(situation: ParseSituation) -> Diagnostic | None:
    first = item_start(situation)
    words = situation.tokens[first : first + 3]
    if len(words) < 3 or words[0].text not in _TEMPLATE_WORDS or words[1].type != "NAME" or words[2].text not in "({":
        return None
    return Diagnostic(
        "E0104",
        f"unknown word '{words[0].text}'",
        words[0].span,
        f"a template is written `process {words[1].text}() {{ ... }}`",
    )


def _arrow(situation: ParseSituation) -> Diagnostic | None:
    """``A -> B`` inside the braces of A."""
    tokens, index = situation.tokens, situation.index
    if "TO" not in situation.accepted or index + 2 >= len(tokens):
        return None
    place = index if tokens[index].text == "->" else index + 1
    if tokens[place].text != "->" or tokens[place + 1].type != "NAME":
        return None
    span = tokens[index].span.to(tokens[place + 1].span)
    target = tokens[place + 1].text
    return Diagnostic(
        "E0101",
        f"'{span.text}' does not fit here: inside a location an edge begins with `to`",
        span,
        f"write `to {target}`",
    )


def _unit(situation: ParseSituation) -> Diagnostic | None:
    """``x <= 5 s``."""
    token = situation.token
    before = situation.tokens[situation.index - 1] if situation.index else token
    if token.type != "NAME" or token.text not in SPELLINGS or before.type not in ("INTEGER", "FLOAT"):
        return None
    return Diagnostic(
        "E0101",
        f"the unit '{token.text}' does not fit here: clocks count in the model's unit of time",
        Span(token.span.source, before.span.start, token.span.end),
        "leave the unit out; a line such as `time_unit = 1 ms;` says how long one unit is, and formulas take units",
    )


def _arguments(situation: ParseSituation) -> Diagnostic | None:
    """``system P(1, 2);``."""
    tokens, index = situation.tokens, situation.index
    if (
        tokens[item_start(situation)].type != "SYSTEM"
        or situation.token.text != "("
        or tokens[index - 1].type != "NAME"
    ):
        return None
    name = tokens[index - 1].text
    if tokens[index + 1].text == ")":
        mend = f"write `{name}` without parentheses"
    else:
        mend = f"name the process first: `{name}1 = {name}(...);`, and then `system {name}1;`"
    return Diagnostic(
        "E0101", "the system line takes names of processes, without arguments", situation.token.span, mend
    )
