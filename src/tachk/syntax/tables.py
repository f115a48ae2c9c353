"""The LALR tables of the grammar, built once by lark and kept in a per-user cache between runs.

Building costs half a second, loading a few milliseconds. A cache that is missing, unreadable, foreign or outdated only
costs the time to build again.
"""

from __future__ import annotations

import hashlib
import io
import os
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import lark
from lark.lexer import Lexer as LarkLexer

from tachk.resources import grammar_text
from tachk.syntax.build import Builder
from tachk.syntax.lalr import Tables
from tachk.syntax.tokens import Lexer

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


class _NoLexer(LarkLexer):
    """Tokens are cut by `tachk.syntax.tokens` and fed to the parser one by one."""

    def __init__(self, lexer_conf: Any) -> None:
        pass

    def lex(self, *_: Any) -> Iterator[Any]:
        return iter(())


@cache
def parser_tables() -> lark.Lark:
    """The parser of the whole grammar, one start symbol for each kind of text."""
    return cached_parser("\n".join(grammar_text(name) for name in GRAMMAR_FILES), STARTS, Builder())


def cached_parser(grammar: str, starts: Sequence[str], builder: Any) -> lark.Lark:
    """The LALR parser of a grammar whose rules call the methods of a builder, from the cache where it is there."""
    path = _cache_path(grammar, starts)
    if path is not None:
        with suppress(Exception):
            # Whatever is wrong with a cache file must not stand in the user's way.
            return _load(path, builder)
    built = lark.Lark(
        grammar,
        parser="lalr",
        lexer=_NoLexer,
        start=list(starts),
        keep_all_tokens=True,
        maybe_placeholders=True,
        transformer=builder,
    )
    if path is not None:
        with suppress(OSError):
            _store(built, path)
    return built


@cache
def tables() -> Tables:
    """The tables of the whole grammar in the form in which they are run."""
    return Tables(parser_tables().parse_interactive("", start=STARTS[0]).parser_state.parse_conf)


@cache
def lexer() -> Lexer:
    """The lexer for the grammar's terminals."""
    return Lexer({terminal.name: terminal for terminal in parser_tables().terminals})


def terminal_spelling() -> dict[str, str]:
    """The spelling of every keyword and symbol, by terminal."""
    cutter = lexer()
    return {name: text for text, name in (*cutter.keywords.items(), *cutter.symbols.items())}


def _cache_path(grammar: str, starts: Sequence[str]) -> Path | None:
    """Where the tables of a grammar are kept, or None where there is no home directory."""
    what = f"{grammar}{tuple(starts)}{lark.__version__}{sys.version_info[:2]}"
    name = hashlib.sha256(what.encode()).hexdigest()[:20]
    root = os.environ.get("XDG_CACHE_HOME")
    try:
        folder = Path(root) if root else Path.home() / ".cache"
    except RuntimeError:
        return None
    return folder / "tachk" / f"grammar-{name}.bin"


def _load(path: Path, builder: Any) -> lark.Lark:
    """Tables from the cache. `lark.Lark.load` cannot take a transformer, the method behind it can."""
    return lark.Lark.__new__(lark.Lark)._load(io.BytesIO(path.read_bytes()), transformer=builder)


def _store(tables: lark.Lark, path: Path) -> None:
    """Write the tables beside their place and move them there, so that no reader sees half a file."""
    path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=path.name)
    try:
        with os.fdopen(handle, "wb") as stream:
            tables.save(stream)
        os.replace(temporary, path)
    except BaseException:
        with suppress(OSError):
            os.unlink(temporary)
        raise
