"""The LALR tables of grammar/sentences.lark and its phrases."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache

from tachk.base.resources import grammar_text
from tachk.syntax.parsing.grammar import Grammar
from tachk.syntax.parsing.lalr import Tables
from tachk.syntax.parsing.tables import cached_grammar
from tachk.syntax.sentences.build import SentenceBuilder

START = "sentence"

_WORD = re.compile(r"\w+|[^\w\s]")


@dataclass(frozen=True, slots=True)
class Phrase:
    """Attributes:
    terminal: its name in the tables.
    words: in lower case; a sign is a word.
    """

    terminal: str
    words: tuple[str, ...]

    @property
    def text(self) -> str:
        return " ".join(self.words)


@cache
def _grammar() -> Grammar:
    return cached_grammar(grammar_text("sentences"), (START,))


@cache
def sentence_tables() -> Tables:
    return Tables(_grammar(), SentenceBuilder())


@cache
def phrases() -> tuple[Phrase, ...]:
    """Every phrase of the grammar, longer ones first."""
    found = [
        Phrase(terminal.name, tuple(_WORD.findall(terminal.text)))
        for terminal in _grammar().terminals
        if terminal.text is not None
    ]
    return tuple(sorted(found, key=lambda phrase: (-len(phrase.words), phrase.words)))


@cache
def opening_words() -> frozenset[str]:
    """Every word with which a phrase begins."""
    return frozenset(phrase.words[0] for phrase in phrases())


@cache
def spelling(terminal: str) -> str:
    """The name of a terminal in messages."""
    named = {
        "CONDITION": "a condition",
        "DURATION": "a duration",
        "FULL_STOP": "a full stop",
        "LABEL": "a name with a colon",
    }
    if terminal in named:
        return named[terminal]
    return next(f"'{phrase.text}'" for phrase in phrases() if phrase.terminal == terminal)
