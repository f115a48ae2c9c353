"""Conditions that early versions of UPPAAL grouped in another way.

Until about version 4.0 the words ``not``, ``and``, ``or`` and ``imply`` bound weaker than every symbol, even than
assignments; since then they bind as ``!``, ``&&`` and ``||`` do. Which version an old text was written for cannot be
seen, so what changed its meaning is pointed out.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.span import Span
from tachk.syntax.parsing.tokens import END, Token

_PAIRS = {"(": ")", "[": "]"}
_BINARY = frozenset(
    {
        *("<", "<=", "==", "!=", ">=", ">", "<?", ">?", "<<", ">>", "+", "-", "*", "/", "%", "&", "|", "^"),
        *("&&", "||", "?", "=", ":=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>="),
    }
)
_WORDS = frozenset({"and", "or", "imply"})
_SEPARATORS = frozenset({",", ";", "{", "}", ":"})


def regrouped(tokens: Sequence[Token]) -> tuple[Diagnostic, ...]:
    """One warning for each such condition."""
    return tuple(
        Diagnostic("W0102", f"early versions of UPPAAL group this as {grouping}", span, "add parentheses")
        for span, grouping in (*_negations(tokens), *_mixtures(tokens))
    )


def _negations(tokens: Sequence[Token]) -> Iterator[tuple[Span, str]]:
    for index, token in enumerate(tokens):
        if token.type == "NOT" and (index == 0 or tokens[index - 1].type != "NOT"):
            end = _end_of_operand(tokens, index)
            if tokens[end].text in _BINARY:
                operator = tokens[end].text
                yield token.span.to(tokens[end].span), f"`not (a {operator} b)`, today it is `(not a) {operator} b`"


def _end_of_operand(tokens: Sequence[Token], index: int) -> int:
    """The index behind the operand of the prefix operator at an index."""
    while tokens[index].type == "NOT" or tokens[index].text in ("!", "-", "+", "++", "--"):
        index += 1
    if tokens[index].text not in _PAIRS:
        index += 1
    while tokens[index].text in ("(", "[", ".", "'", "++", "--"):
        if tokens[index].text in _PAIRS:
            index = _closing(tokens, index)
        elif tokens[index].text == ".":
            index += 1
        index += 1
    return index


def _closing(tokens: Sequence[Token], index: int) -> int:
    depth = 0
    while tokens[index].type != END:
        depth += (tokens[index].text in _PAIRS) - (tokens[index].text in _PAIRS.values())
        if depth == 0:
            return index
        index += 1
    return index - 1


def _mixtures(tokens: Sequence[Token]) -> Iterator[tuple[Span, str]]:
    """Words beside symbols that bind weaker than ``&&``, between the same brackets."""
    levels: list[list[Token]] = [[]]
    assigned = False
    for token in tokens:
        text = token.text
        if token.type == "ASSIGN" or text == ";":
            assigned = token.type == "ASSIGN"
        if text in _PAIRS:
            levels.append([])
        elif text in _PAIRS.values() or text in _SEPARATORS or token.type == END:
            yield from _mixture(levels[-1])
            if text in _PAIRS.values() and len(levels) > 1:
                levels.pop()
            else:
                levels[-1] = []
        elif text in _WORDS or text in ("||", "?") or (assigned and token.type == "EQUALS"):
            levels[-1].append(token)


def _mixture(operators: Sequence[Token]) -> Iterator[tuple[Span, str]]:
    words = {token.text for token in operators} & _WORDS
    symbols = {token.text for token in operators} - _WORDS
    if (symbols == {"||"} and words - {"or"}) or (symbols - {"||"} and words):
        word, symbol = sorted(words)[0], sorted(symbols)[-1]
        yield operators[0].span.to(operators[-1].span), f"if `{word}` bound weaker than `{symbol}`"
