"""The words of temporal formulas, which are ordinary names everywhere else.

``F G O H`` are operators where an operand may begin and something that begins an operand or an interval follows; ``U W
S`` where an operand has ended. So ``S == 3`` and ``P.F`` name what they name. A name in backticks is never an operator.
"""

from __future__ import annotations

from itertools import pairwise

from tachk.base.records import replace
from tachk.syntax.parsing.tokens import END, Token

PREFIX = frozenset("FGOH")
INFIX = frozenset("UWS")
EDGES = frozenset({"rise", "fall", "change"})
INFINITE = frozenset({"inf", "infinity", "oo"})

BOXES = {"[]": "G", "<>": "F"}
"""Signs that tools for LTL use for two of them; before an operand they have no other meaning."""

WORDS = {
    **dict.fromkeys(("always", "globally", "alw", "g_", "always_", "globally_", "alw_"), "G"),
    **dict.fromkeys(("eventually", "finally", "future", "ev", "f_", "eventually_", "finally_", "ev_"), "F"),
    **dict.fromkeys(("once", "o_", "once_"), "O"),
    **dict.fromkeys(("historically", "h_", "hist", "historically_", "hist_"), "H"),
    **dict.fromkeys(("until", "u_", "until_"), "U"),
    **dict.fromkeys(("since", "s_", "since_"), "S"),
    **dict.fromkeys(("unless", "weak_until"), "W"),
}
"""Spellings of the operators in other tools."""


TEMPORAL = frozenset({"FORMULA_PREFIX", "FORMULA_INFIX", "EDGE", "IMPLIES"})
"""The tokens that only a temporal formula has."""

SENTENCE_WORDS = frozenset(
    {
        *("whenever", "globally", "always", "never", "initially", "eventually", "after", "before", "between", "while"),
        *("must", "within", "delay", "becomes", "stays", "occurs", "holds", "if", "once"),
    }
)
"""Words by which a sentence is known that lacks its full stop."""

ORDINARY = frozenset(
    {
        *(
            "assign",
            "bool",
            "broadcast",
            "chan",
            "clock",
            "commit",
            "const",
            "do",
            "else",
            "for",
            "guard",
            "if",
            "init",
        ),
        *("int", "meta", "process", "return", "scalar", "select", "state", "struct", "sync", "system", "trans"),
        *("typedef", "urgent", "void", "while"),
    }
)
"""Keywords of models that have no meaning in a formula: where an operand begins they are the names of columns."""

_ENDS_OPERAND = frozenset({"NAME", "QUOTED", "INTEGER", "FLOAT", "STRING", "TRUE", "FALSE"})
_BEGINS_OPERAND = frozenset(
    {*("NAME", "QUOTED", "INTEGER", "FLOAT", "TRUE", "FALSE", "NOT", "FORALL", "EXISTS", "STRING")}
)
_OPENING = frozenset("([{")
_CLOSING = frozenset(")]}")


def resolve_formula(tokens: list[Token]) -> list[Token]:
    """The tokens of one formula with its words marked; those given stay as they are."""
    return _Marker([replace(token) for token in tokens]).run()


def is_temporal(marked: list[Token]) -> bool:
    """True if marked tokens hold anything that only a temporal formula has."""
    return any(token.type in TEMPORAL for token in marked)


def is_sentence(tokens: list[Token]) -> bool:
    """True if a text is to be read as a sentence: it ends with a full stop, which is not the point of a number."""
    if len(tokens) < 2 or tokens[-1].text != "." or tokens[-1].type == "STRING":
        return False
    number = tokens[-2].type == "INTEGER" and tokens[-2].span.end == tokens[-1].span.start
    return not number or any(token.text.lower() in SENTENCE_WORDS for token in tokens)


def lacks_full_stop(tokens: list[Token]) -> bool:
    """True if a text that does not end with a full stop can only be meant as a sentence: words follow one another."""
    first = tokens[0].text if tokens else ""
    if len(tokens) > 1 and (first in PREFIX or first.lower() in WORDS) and tokens[1].text in ("(", "["):
        return False  # an operator, perhaps in the words of other tools
    texts = {token.text.lower() for token in tokens}
    if "then" in texts and not texts & {"must", "shall", "should", "will"}:
        return False  # an implication: sentences have no such word
    words = [_is_word(token) for token in tokens]
    known = any(word and token.text.lower() in SENTENCE_WORDS for word, token in zip(words, tokens, strict=True))
    return (known and sum(words) > 3) and any(
        first and second and not {tokens[place].text, tokens[place + 1].text} & (PREFIX | INFIX)
        for place, (first, second) in enumerate(pairwise(words))
    )


def _is_word(token: Token) -> bool:
    return (
        token.type != "QUOTED" and token.text[:1].isalpha() and token.type not in ("AND", "OR", "NOT", "IMPLY", "XOR")
    )


def _join_numbers(tokens: list[Token]) -> None:
    """Make one number each of ``5.`` and ``.5``, as C and Python have them."""
    place = 1
    while place < len(tokens):
        first, second = tokens[place - 1 : place + 1]
        if first.span.end == second.span.start:
            behind = tokens[place + 1] if place + 1 < len(tokens) else None
            ends = behind is None or behind.span.start > second.span.end or behind.type not in ("NAME", "INTEGER")
            if first.type == "INTEGER" and second.text == "." and ends:
                tokens[place - 1 : place + 1] = [Token("FLOAT", f"{first.text}.0", first.span.to(second.span))]
                continue
            begins = place < 2 or tokens[place - 2].type not in _ENDS_OPERAND | {"QUOTED"}
            begins = begins and (place < 2 or tokens[place - 2].text not in _CLOSING)
            if first.text == "." and second.type == "INTEGER" and begins:
                tokens[place - 1 : place + 1] = [Token("FLOAT", f"0.{second.text}", first.span.to(second.span))]
                continue
        place += 1


class _Marker:
    """One pass over the tokens of a formula, which marks them in place."""

    def __init__(self, tokens: list[Token]) -> None:
        self.tokens = tokens
        self.ended = False  # whether the token before ends an operand

    def run(self) -> list[Token]:
        tokens = self.tokens
        _join_numbers(tokens)
        place = 0
        while place < len(tokens):
            place = self.mark(place)
        for token in tokens:
            if token.type == "QUOTED":
                token.text = token.text[1:-1]
        return tokens

    def mark(self, place: int) -> int:
        """Mark the token at a place; the place to go on at."""
        token = self.tokens[place]
        following = self.text(place + 1)
        if token.text in ORDINARY and token.type != "QUOTED" and (not self.ended or self.after_dot(place)):
            token.type = "NAME"
        letter = None if self.ended else BOXES.get(token.text + following)
        if letter is not None and token.span.end == self.tokens[place + 1].span.start:
            self.tokens[place : place + 2] = [
                Token("FORMULA_PREFIX", letter, token.span.to(self.tokens[place + 1].span))
            ]
            return self.interval(place + 1)
        if token.text == "->":
            token.type = "IMPLIES"
        elif token.type in ("FORALL", "EXISTS") and following == "(":
            return self.behind_binder(place + 1)
        elif token.type == "NAME" and not self.after_dot(place):
            if self.ended:
                if token.text in INFIX:
                    token.type = "FORMULA_INFIX"
                    return self.interval(place + 1)
            elif token.text in PREFIX and self.begins_operand(place + 1):
                token.type = "FORMULA_PREFIX"
                return self.interval(place + 1)
            elif token.text in EDGES and following == "(":
                token.type = "EDGE"
            elif token.text == "deadlock":
                token.type = "DEADLOCK"
            elif token.text == "sum" and following == "(" and self.text(place + 3) == ":":
                token.type = "SUM"
                return self.behind_binder(place + 1)
        self.ended = token.type in _ENDS_OPERAND or token.text in (")", "]", "'") or token.type == "DEADLOCK"
        return place + 1

    def text(self, place: int) -> str:
        return self.tokens[place].text if place < len(self.tokens) else ""

    def after_dot(self, place: int) -> bool:
        return place > 0 and self.tokens[place - 1].text == "."

    def begins_operand(self, place: int) -> bool:
        if place >= len(self.tokens):
            return False
        token = self.tokens[place]
        if token.text in ORDINARY:
            return True
        if token.type == "NAME" and token.text in INFIX:
            # In `F U q` the letter F is a name, in `F U` it is an operator.
            return not self.begins_operand(place + 1) and self.text(place + 1) != "["
        return token.type in _BEGINS_OPERAND or token.text in ("(", "[", "!")

    def behind_binder(self, place: int) -> int:
        """The place behind the parentheses of a quantifier, where its body begins."""
        self.ended = False
        depth = 0
        for end in range(place, len(self.tokens)):
            text = self.tokens[end].text
            depth += (text in _OPENING) - (text in _CLOSING)
            if depth == 0:
                return end + 1
        return place

    def interval(self, place: int) -> int:
        """Mark an interval that begins at a place, if one does; the place behind it."""
        self.ended = False
        opening = self.text(place)
        if opening not in ("[", "("):
            return place
        depth, comma, end = 0, False, place
        while end < len(self.tokens):
            text = self.tokens[end].text
            depth += (text in _OPENING) - (text in _CLOSING)
            comma = comma or (depth == 1 and text == ",")
            if depth == 0 or self.tokens[end].type == END:
                break
            end += 1
        if opening == "(" and not comma:
            return place  # a parenthesised operand
        self.tokens[place].type = "INTERVAL_OPEN"
        if end < len(self.tokens) and depth == 0:
            self.tokens[end].type = "INTERVAL_CLOSE"
            self.bounds(place + 1, end)
            return end + 1
        return place + 1

    def bounds(self, first: int, end: int) -> None:
        """Mark units and ``inf`` among the tokens of an interval."""
        for place in range(first, end):
            token, before, behind = self.tokens[place], self.tokens[place - 1], self.tokens[place + 1]
            at_end = behind.type == "INTERVAL_CLOSE" or behind.text in (",", ":")
            if token.type != "NAME" or not at_end:
                continue
            if before.text == "," and token.text in INFINITE and behind.type == "INTERVAL_CLOSE":
                token.type = "INFINITY"
            elif before.type in _ENDS_OPERAND or (before.text in (")", "]") and before.type != "INTERVAL_OPEN"):
                token.type = "UNIT"
