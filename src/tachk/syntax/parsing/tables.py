"""The LALR tables of the grammar, computed once and kept in a per-user cache between runs.

Computing costs half a second, loading a few milliseconds. A cache that is missing, unreadable, foreign or outdated only
costs the time to compute again.
"""

from __future__ import annotations

import os
import pickle
import zlib
from collections.abc import Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path

from tachk.base.resources import grammar_text
from tachk.syntax.building.build import Builder
from tachk.syntax.parsing.grammar import Grammar, GrammarRule, Terminal
from tachk.syntax.parsing.lalr import Tables
from tachk.syntax.parsing.tokens import Lexer

GRAMMAR_FILES = ("expression", "stl", "query", "tachk")

STARTS = (
    "document",
    "query",
    "expression",
    "formula_fragment",
    "declarations_fragment",
    "parameters_fragment",
    "select_fragment",
    "constraint_fragment",
    "rate_fragment",
    "synchronisation_fragment",
    "assignment_fragment",
)

_FORMAT = " ".join(f"{each.__module__}.{each.__name__}{each._fields}" for each in (Grammar, GrammarRule, Terminal))
"""The format of the cache: versions with other classes use other files."""


@cache
def grammar() -> Grammar:
    """The whole grammar, one start symbol for each kind of text."""
    return cached_grammar("\n".join(grammar_text(name) for name in GRAMMAR_FILES), STARTS)


def cached_grammar(text: str, starts: Sequence[str]) -> Grammar:
    """The tables of a grammar, from the cache where they are there."""
    key = f"{_FORMAT}\n{' '.join(starts)}\n{text}"
    path = _cache_path(key)
    if path is not None:
        with suppress(Exception):
            # A damaged cache file is ignored.
            return _load(path, key)
    from tachk.syntax.parsing.compile_grammar import compile_grammar

    compiled = compile_grammar(text, starts)
    if path is not None:
        with suppress(OSError):
            _store(compiled, path, key)
    return compiled


@cache
def tables() -> Tables:
    """The tables of the whole grammar in the form in which they are run."""
    return Tables(grammar(), Builder())


@cache
def lexer() -> Lexer:
    """The lexer for the grammar's terminals."""
    return Lexer(grammar().terminals)


def terminal_spelling() -> dict[str, str]:
    """The spelling of every keyword and symbol, by terminal."""
    cutter = lexer()
    return {name: text for text, name in (*cutter.keywords.items(), *cutter.symbols.items())}


def _cache_path(key: str) -> Path | None:
    """The file for the tables of a grammar; None if there is no home directory."""
    root = os.environ.get("XDG_CACHE_HOME")
    try:
        folder = Path(root) if root else Path.home() / ".cache"
    except RuntimeError:
        return None
    return folder / "tachk" / f"grammar-{zlib.crc32(key.encode()):08x}.bin"


def _load(path: Path, key: str) -> Grammar:
    stored, *parts = pickle.loads(path.read_bytes())
    if stored != key:
        raise ValueError("the tables of another grammar")
    (grammar,) = parts
    if not isinstance(grammar, Grammar):
        raise TypeError("no tables")
    return grammar


def _store(grammar: Grammar, path: Path, key: str) -> None:
    """Write the tables beside their place and move them there, so that no reader sees half a file."""
    import tempfile  # takes hashlib with it

    path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=path.name)
    try:
        with os.fdopen(handle, "wb") as stream:
            pickle.dump((key, grammar), stream, pickle.HIGHEST_PROTOCOL)
        os.replace(temporary, path)
    except BaseException:
        with suppress(OSError):
            os.unlink(temporary)
        raise
