"""The place where the parser stopped: the text, the token that does not fit, and those that would."""

from __future__ import annotations

from collections.abc import Sequence

from tachk.base.records import dataclass
from tachk.syntax.parsing.tokens import END, Token

CLOSES = {")": "(", "]": "[", "}": "{"}

_SYMBOLIC = frozenset({"QUANTIFIER", "SUP", "INF", "BOUNDS"})
"""The first tokens of queries that are not temporal formulas."""


@dataclass(frozen=True, slots=True)
class ParseSituation:
    """Attributes:
    tokens: the whole text.
    index: the token that does not fit.
    accepted: the terminals that would fit.
    supplied: the token that was put in because only it is missing.
    construct: the offset where the enclosing item, statement or clause begins, if it has begun.
    start: the start symbol of the grammar, such as ``document`` or ``query``.
    """

    tokens: Sequence[Token]
    index: int
    accepted: frozenset[str]
    supplied: Token | None
    construct: int | None
    start: str

    @property
    def token(self) -> Token:
        return self.tokens[self.index]


def query_start(situation: ParseSituation) -> int | None:
    """The index where the query begins in which the token stands."""
    if situation.start == "query":
        return 0
    item = item_start(situation)
    if situation.tokens[item].type != "PROPERTY":
        return None
    return next((i + 1 for i in range(item, situation.index) if situation.tokens[i].text == ":"), None)


def is_formula(situation: ParseSituation) -> bool:
    """True if the token stands in a temporal formula, or in a text that would be one if it had an operator."""
    if situation.start == "formula_fragment":
        return True
    begin = query_start(situation)
    if begin is None or begin >= len(situation.tokens):
        return False
    tokens = until_end(situation.tokens, begin)
    return bool(tokens) and tokens[0].type not in _SYMBOLIC and all(token.text != "-->" for token in tokens)


def item_start(situation: ParseSituation) -> int:
    """The index of the first token of the item of the document in which the token stands."""
    depth = start = 0
    for index, token in enumerate(situation.tokens[: situation.index]):
        depth += (token.text in CLOSES.values()) - (token.text in CLOSES)
        if depth <= 0 and token.text in (";", "}"):
            start = index + 1
            depth = 0
    return start


def until_end(tokens: Sequence[Token], begin: int) -> list[Token]:
    """The tokens of a query."""
    found = []
    for token in tokens[begin:]:
        if token.type in (END, "EXPECT") or token.text == ";":
            break
        found.append(token)
    return found
