"""Colours for models and formulas in the pages: Pygments learns the language from the parser's own words."""

from __future__ import annotations

import re
from typing import ClassVar

from pygments.lexer import RegexLexer, words
from pygments.lexers import LEXERS
from pygments.token import Comment, Keyword, Name, Number, Operator, Punctuation, String, Text

from docs.site_build.grammar_notation import InOrder, Maybe, OneOf, Part, Repeated, Word, read_rules
from tachk.base.resources import grammar_text
from tachk.syntax.parsing.contextual import CONTEXTUAL_KEYWORDS

__all__ = ["ModelLexer"]  # Pygments looks here for the lexers of a module

_TYPES = ("int", "bool", "clock", "chan", "void", "scalar", "struct", "const", "urgent", "broadcast", "meta", "hybrid")


def keywords() -> tuple[str, ...]:
    """The words of the language of models, those that are keywords in some places included."""
    found = {
        word
        for name in ("expression", "tachk", "query")
        for rule in read_rules(grammar_text(name))
        for word in _words(rule.body)
    }
    return tuple(sorted(found | CONTEXTUAL_KEYWORDS))


def _words(part: Part) -> list[str]:
    if isinstance(part, Word):
        return [part.text] if part.text.isidentifier() else []
    if isinstance(part, InOrder | OneOf):
        return [word for each in part.parts for word in _words(each)]
    return _words(part.part) if isinstance(part, Maybe | Repeated) else []


class ModelLexer(RegexLexer):
    """Models, queries and formulas of tachk, and UPPAAL's text."""

    name = "tachk"
    aliases = ("ta", "stl", "xta")
    filenames = ("*.ta", "*.xta", "*.stl", "*.q")
    flags = re.MULTILINE
    tokens: ClassVar = {
        "root": [
            (r"///.*$", String.Doc),
            (r"//.*$", Comment.Single),
            (r"/\*(?:.|\n)*?\*/", Comment.Multiline),
            (r'"[^"\n]*"', String),
            (r"`[^`\n]+`", Name),
            (r"[AE](?:\[\]|<>)", Keyword.Pseudo),
            (words(_TYPES, prefix=r"\b", suffix=r"\b"), Keyword.Type),
            (words(keywords(), prefix=r"\b", suffix=r"\b"), Keyword),
            (r"\d+(?:\.\d+)?(?:[eE][+-]?\d+)?", Number),
            (r"[A-Za-z_][\w$#]*", Name),
            (r"[-+*/%&|^<>=!?:]+", Operator),
            (r"[\[\]{}(),;.']", Punctuation),
            (r"\s+", Text),
            (r".", Text),
        ]
    }


def register() -> None:
    """Makes the languages known to Pygments, by the names in fences."""
    LEXERS["ModelLexer"] = (__name__, ModelLexer.name, ModelLexer.aliases, ModelLexer.filenames, ())
