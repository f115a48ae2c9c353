"""The LALR tables of the grammar, computed once and kept in a per-user cache between runs.

Computing costs half a second, loading a few milliseconds. A cache that is missing, unreadable, foreign or outdated only
costs the time to compute again.
"""

from __future__ import annotations

import marshal
import os
import sys
import zlib
from collections.abc import Sequence
from contextlib import suppress
from functools import cache

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

_FORMAT = " ".join(
    (sys.version, *(f"{each.__module__}.{each.__name__}{each._fields}" for each in (Grammar, GrammarRule, Terminal)))
)
"""The format of the cache: versions with other classes, and of Python, use other files."""
_CHECKSUM_BYTES = 4


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


def make_rows() -> None:
    """Makes the rows of all states now, not when a text needs them: for a process of which copies are made."""
    lexer()
    rows = grammar().rows
    for state in rows.stored if isinstance(rows, _StoredRows) else rows:
        _ = tables().rows[state], tables().gotos[state]


@cache
def lexer() -> Lexer:
    """The lexer for the grammar's terminals."""
    return Lexer(grammar().terminals)


def terminal_spelling() -> dict[str, str]:
    """The spelling of every keyword and symbol, by terminal."""
    cutter = lexer()
    return {name: text for text, name in (*cutter.keywords.items(), *cutter.symbols.items())}


def _cache_path(key: str) -> str | None:
    """The file for the tables of a grammar; None if there is no home directory."""
    folder = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    if folder.startswith("~"):
        return None
    return os.path.join(folder, "tachk", f"grammar-{zlib.crc32(key.encode()):08x}.bin")


class _StoredRows(dict[int, dict[str, int]]):
    """Rows of tables, each read when it is needed: most texts need few."""

    def __init__(self, stored: dict[int, bytes]) -> None:
        self.stored = stored

    def __missing__(self, state: int) -> dict[str, int]:
        row: dict[str, int] = marshal.loads(self.stored[state])
        self[state] = row
        return row


def _load(path: str, key: str) -> Grammar:
    with open(path, "rb") as file:
        content = file.read()
    checksum, plain = content[:_CHECKSUM_BYTES], content[_CHECKSUM_BYTES:]
    if checksum != _checksum(plain):  # `marshal` may crash where the content is not its own
        raise ValueError("damaged")
    stored, terminals, rules, rows, starts, ends = marshal.loads(plain)
    if stored != key:
        raise ValueError("the tables of another grammar")
    return Grammar(
        tuple(map(Terminal._make, terminals)), tuple(map(GrammarRule._make, rules)), _StoredRows(rows), starts, ends
    )


def _checksum(plain: bytes) -> bytes:
    return zlib.crc32(plain).to_bytes(_CHECKSUM_BYTES, "big")


def _store(grammar: Grammar, path: str, key: str) -> None:
    """Write the tables beside their place and move them there, so that no reader sees half a file."""
    import tempfile  # takes hashlib with it

    rows = {state: marshal.dumps(row) for state, row in grammar.rows.items()}
    plain = marshal.dumps(
        (key, [*map(tuple, grammar.terminals)], [*map(tuple, grammar.rules)], rows, grammar.starts, grammar.ends)
    )
    folder, name = os.path.split(path)
    os.makedirs(folder, 0o700, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=folder, prefix=name)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(_checksum(plain) + plain)
        os.replace(temporary, path)
    except BaseException:
        with suppress(OSError):
            os.unlink(temporary)
        raise
