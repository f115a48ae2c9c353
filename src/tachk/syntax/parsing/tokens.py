"""Tokens and the lexer: a text is cut in one linear pass, comments go aside.

The terminals come from the grammar. Contextual keywords are decided afterwards, by `tachk.syntax.parsing.contextual`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.exact_numbers import is_huge
from tachk.base.job import check_job
from tachk.base.records import dataclass, field
from tachk.base.span import Source, Span
from tachk.syntax.ast import Comment
from tachk.syntax.parsing.grammar import Terminal

Match = Callable[[str, int, int], re.Match[str] | None]

END = "$END"
LARGEST_LITERAL = 2**31

_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_$#]*")

_OUTER = r"""
    (?P<BLANK>[ \t\r\n\f\v\ufeff\u00a0]+)
  | (?P<CONTINUATION>\\[ \t]*\r?\n)
  | (?P<COMMENT>//[^\n]*|/\*[\s\S]*?\*/)
  | (?P<OPEN_COMMENT>/\*)
  | (?P<OPEN_STRING>"[^"\n]*(?=\n|\Z))
"""


_SPELLING = {
    "≥": ">=",
    "≤": "<=",
    "≠": "!=",
    "⩾": ">=",
    "⩽": "<=",
    "∧": "&&",
    "∨": "||",
    "¬": "!",
    "⊕": "xor",
    "→": "->",
    "⇒": "imply",
    "⟶": "-->",
    "⟹": "imply",
    "⇝": "-->",
    "□": "[]",
    "◻": "[]",
    "◇": "<>",
    "◊": "<>",
    "“": '"',
    "”": '"',
    "„": '"',
    "−": "-",
    "–": "-",
    "—": "-",
    "×": "*",
    "·": "*",
    "÷": "/",
    "∞": "inf",
    "⊤": "true",
    "⊥": "false",
}
_BINDERS = {"A": "forall", "E": "exists"}


@dataclass(slots=True)
class Token:
    """One word of the text. ``type`` is the grammar's terminal; ``doc`` holds the ``///`` lines directly before it."""

    type: str
    text: str
    span: Span
    doc: str = ""


@dataclass(slots=True)
class Lexed:
    """Tokens (ended by one of type `END`), comments, and lexical errors.

    ``docs`` holds the ``///`` lines directly before a token by the token's offset, ``comments`` all others.
    """

    tokens: list[Token] = field(default_factory=list)
    docs: dict[int, list[Comment]] = field(default_factory=dict)
    comments: list[Comment] = field(default_factory=list)
    errors: list[Diagnostic] = field(default_factory=list)


class Lexer:
    """Cuts texts into the terminals of one grammar."""

    def __init__(self, terminals: Iterable[Terminal]) -> None:
        self.keywords: dict[str, str] = {}
        self.symbols: dict[str, str] = {}
        expressions: list[Terminal] = []
        for terminal in terminals:
            if terminal.text is None:
                expressions.append(terminal)
            elif _WORD.fullmatch(terminal.text):
                self.keywords[terminal.text] = terminal.name
            else:
                self.symbols[terminal.text] = terminal.name
        expressions.sort(key=lambda terminal: -terminal.priority)
        named = "|".join(f"(?P<{terminal.name}>{terminal.regexp})" for terminal in expressions)
        longest_first = sorted(self.symbols, key=len, reverse=True)
        symbols = "|".join(re.escape(symbol) for symbol in longest_first)
        self._pattern = re.compile(f"{_OUTER}|{named}|(?P<SYMBOL>{symbols})".replace("\n", ""), re.VERBOSE)

    def cut(self, source: Source, start: int = 0, end: int | None = None) -> Lexed:
        """The tokens of a part of a source; lexical errors are collected and passed over."""
        text = source.text
        stop = len(text) if end is None else end
        lexed = Lexed()
        docs: list[Comment] = []
        fresh = True
        match = self._pattern.match
        keywords, symbols = self.keywords, self.symbols
        position = start
        while position < stop:
            check_job()
            found = match(text, position, stop)
            if found is None:
                position = _unknown_characters(source, position, stop, match, lexed)
                continue
            kind = found.lastgroup
            after = found.end()
            if kind == "BLANK":
                breaks = text.count("\n", position, after)
                fresh = fresh or breaks > 0
                if docs and breaks > 1:
                    lexed.comments += docs
                    docs = []
            elif kind == "COMMENT":
                comment = Comment(Span(source, position, after), text[position:after].rstrip("\r"), fresh)
                fresh = False
                if comment.own_line and comment.text.startswith("///") and not comment.text.startswith("////"):
                    docs.append(comment)
                else:
                    lexed.comments += (*docs, comment)
                    docs = []
            elif kind == "OPEN_COMMENT":
                lexed.errors.append(_open_comment(Span(source, position, position + 2)))
                break
            elif kind == "OPEN_STRING":
                fresh = False
                _close_string(Span(source, position, after), lexed)
            elif kind != "CONTINUATION":
                word = found.group()
                fresh = False
                if kind == "NAME":
                    kind = keywords.get(word, "NAME")
                elif kind == "SYMBOL":
                    kind = symbols[word]
                elif kind in _TOO_LARGE and _TOO_LARGE[kind](word):
                    lexed.errors.append(_large_number(kind, Span(source, position, after)))
                    word = "0"
                assert kind is not None
                token = Token(kind, word, Span(source, position, after))
                if docs:
                    token.doc = "\n".join(_doc_line(comment.text) for comment in docs)
                    lexed.docs[position] = docs
                    docs = []
                lexed.tokens.append(token)
            position = after
        lexed.comments += docs
        lexed.tokens.append(Token(END, "", Span(source, stop, stop)))
        return lexed


def _doc_line(text: str) -> str:
    line = text[3:].rstrip()
    return line[1:] if line.startswith(" ") else line


def _open_comment(span: Span) -> Diagnostic:
    return Diagnostic("E0003", "this comment is never closed", span, "add */")


def _close_string(span: Span, lexed: Lexed) -> None:
    lexed.errors.append(Diagnostic("E0004", "this string is not closed on its line", span, 'add "'))
    lexed.tokens.append(Token("STRING", span.text + '"', span))


_TOO_LARGE: dict[str, Callable[[str], bool]] = {
    "INTEGER": lambda word: len(word) > 12 or int(word) > LARGEST_LITERAL,
    "FLOAT": is_huge,
}
"""Tests for literals that are too large to compute."""


def _large_number(kind: str, span: Span) -> Diagnostic:
    if kind == "FLOAT":
        return Diagnostic("E0005", "this number has too many digits", span, "at most 1000, and exponents up to 999")
    help = f"the largest integer is {LARGEST_LITERAL - 1}"
    return Diagnostic("E0005", "this number does not fit into 32 bits", span, help)


def _unknown_characters(source: Source, start: int, stop: int, match: Match, lexed: Lexed) -> int:
    """Report a run of characters that begin no token; return where it ends."""
    end = start + 1
    while end < stop and end - start < 200 and match(source.text, end, stop) is None:
        end += 1
    run = source.text[start:end]
    shown = run if len(run) <= 10 else run[:10] + "..."
    what = f"the character {shown!r}" if len(run) == 1 else f"the characters {shown!r}"
    help_ = _spelt(run) or _slashes(source.text, start)
    if len(lexed.errors) < 100:
        lexed.errors.append(Diagnostic("E0002", f"{what} cannot be used here", Span(source, start, end), help_))
    return end


def _slashes(text: str, place: int) -> str | None:
    """The help for ``/\\`` and ``\\/``, whose backslash is not a token."""
    if text[place] != "\\":
        return None
    if text[place - 1 : place] == "/":
        return "write && in place of /\\"
    return "write || in place of \\/" if text[place + 1 : place + 2] == "/" else None


def _spelt(run: str) -> str | None:
    """The help for characters of formulas and of word processors, which are written otherwise here."""
    if run.startswith("#"):
        return "a comment begins with //"
    if run == "~":
        return "write ! for 'not', --> for 'leads to'"
    if run[0] in "∀∃" and all(character in _SPELLING for character in run[1:]):
        path = "A" if run[0] == "∀" else "E"
        in_queries = path + "".join(_SPELLING[character] for character in run[1:])
        return (
            f"write {in_queries}" if run[1:] else f"write {path} in a path quantifier, {_BINDERS[path]} before a name"
        )
    if all(character in _SPELLING for character in run):
        return f"write {''.join(_SPELLING[character] for character in run)}"
    return None
