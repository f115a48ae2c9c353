"""The cache of the grammar's tables."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tachk.base.span import Source
from tachk.syntax.parsing import compile_grammar, tables
from tachk.syntax.parsing.driver import drive

pytestmark = pytest.mark.drawn


@pytest.fixture
def cache_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "tachk"


def build() -> object:
    """The tables, made or loaded anew."""
    return tables.grammar.__wrapped__()


def test_the_second_run_loads_what_the_first_one_stored(cache_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    build()
    (stored,) = cache_folder.iterdir()
    assert stored.name.startswith("grammar-")
    monkeypatch.setattr(compile_grammar, "compile_grammar", lambda *_: pytest.fail("the tables were computed again"))
    assert build() is not None


def test_the_tables_of_another_grammar_are_not_taken(cache_folder: Path) -> None:
    tables.cached_grammar('start: "a"', ("start",))
    (stored,) = cache_folder.iterdir()
    other = tables._cache_path(f'{tables._FORMAT}\nstart\nstart: "b"')
    assert other is not None
    stored.rename(Path(other))
    assert tables.cached_grammar('start: "b"', ("start",)).terminals[0].text == "b"


def test_what_is_stored_is_the_grammar_that_was_computed(cache_folder: Path) -> None:
    text = 'start: "a" [_more] | /b+/ start\n_more: "c" "d"*'
    computed, loaded = (tables.cached_grammar(text, ("start",)) for _ in range(2))
    assert loaded is not computed
    assert loaded._replace(rows={state: loaded.rows[state] for state in computed.rows}) == computed


def test_other_versions_of_python_use_other_files(cache_folder: Path) -> None:
    assert sys.version in tables._FORMAT


@pytest.mark.parametrize("content", [b"", b"nonsense", b"\x80\x04N.", b"\0\0\0\0N"])
def test_a_damaged_cache_is_replaced(cache_folder: Path, content: bytes) -> None:
    build()
    (stored,) = cache_folder.iterdir()
    good = stored.read_bytes()
    stored.write_bytes(content)
    build()
    assert len(stored.read_bytes()) > len(good) // 2


def test_a_cache_that_cannot_be_written_does_no_harm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked))
    assert build() is not None


def test_every_start_symbol_works() -> None:
    end = tables.lexer().cut(Source("t", "")).tokens
    for start in tables.STARTS:
        _, errors = drive(start, end)
        assert (errors == ()) == (start not in ("query", "expression", "formula_fragment"))
