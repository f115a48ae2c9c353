"""The file of the finished cells: an SQLite database, for which a campaign that was stopped at any moment is as
good as one that was not.

Its table ``rows`` has a column for each constant that varies and the columns of the job, so that other programs can
read it while the campaign runs::

    select LOSSES, SLICE, answer from rows where property = 'ECFS'
"""

from __future__ import annotations

import json
import os
import sqlite3
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.model.grid import Values
from tachk.verify.campaign.job import COLUMNS, Row

_FORMAT = "tachk sweep 1"
_PATIENCE = 10.0
_ANOTHER = "give another file, or delete this one"
_KINDS: Mapping[str, Any] = {"TEXT": str | None, "INTEGER": int | None, "REAL": float | None}
"""The Python types of SQLite's types."""


@dataclass(frozen=True, slots=True)
class Store:
    """The finished cells of one campaign. Each `add` is one transaction: a killed program loses no finished cell."""

    _database: sqlite3.Connection
    _names: tuple[str, ...]
    _path: str | os.PathLike[str] | None = None

    def finished(self) -> set[Values]:
        """The cells that are finished."""
        return set(self.times())

    def times(self) -> dict[Values, float]:
        """The cells that are finished, each with what it took. Raises UsageError where the file is damaged."""
        found = self._database.execute("select cell, seconds from cells")
        return {self._cell(key, seconds): seconds for key, seconds in found}

    def _cell(self, key: object, seconds: object) -> Values:
        try:
            values = json.loads(key) if isinstance(key, str) else None
        except (ValueError, RecursionError):
            values = None
        if (
            not isinstance(values, list)
            or len(values) != len(self._names)
            or not all(type(value) in (int, str) for value in values)
            or not isinstance(seconds, float)
        ):
            raise UsageError(f"{self._path}: a cell in this file is damaged", _ANOTHER)
        return tuple(values)

    def add(self, values: Values, rows: Sequence[Row], seconds: float) -> None:
        """Stores the answers for a cell. One that is finished already, by a program that shares the file, stays.

        Args:
            seconds: what it took the process that computed it, in wall-clock time.
        """
        marks = ", ".join("?" * (1 + len(self._names) + len(COLUMNS)))
        key = _key(values)
        with _transaction(self._database):
            added = self._database.execute("insert or ignore into cells values (?, ?)", (key, seconds))
            if added.rowcount:
                self._database.executemany(
                    f"insert into rows values ({marks})",
                    [(key, *values, *(row[column] for column in COLUMNS)) for row in rows],
                )

    def rows(self, cells: Iterable[Values]) -> Iterator[Row]:
        """The rows of the cells that are finished, in the order of ``cells``; constants come first."""
        names = (*self._names, *COLUMNS)
        quoted = ", ".join(f'"{name}"' for name in names)
        for values in cells:
            found = self._database.execute(f"select {quoted} from rows where cell = ? order by rowid", (_key(values),))
            for row in found:
                record = dict(zip(names, row, strict=True))
                if not all(isinstance(record[name], _KINDS[kind]) for name, kind in COLUMNS.items()):
                    raise UsageError(f"{self._path}: a row in this file is damaged", _ANOTHER)
                yield record


@contextmanager
def opened(path: str | os.PathLike[str] | None, names: tuple[str, ...], parts: Mapping[str, str]) -> Iterator[Store]:
    """The file of a campaign, made if it does not exist.

    Args:
        path: None for a store in memory.
        names: of the constants that vary.
        parts: what must be the same as when the file was made.

    Raises UsageError where the file belongs to another campaign, is none, or cannot be written.
    """
    database = None
    try:
        database = sqlite3.connect(path or ":memory:", timeout=_PATIENCE, isolation_level=None)
        # With a write-ahead log a transaction of a killed program counts whole or not at all, and needs no fsync.
        database.execute("pragma journal_mode = wal")
        database.execute("pragma synchronous = normal")
        with _transaction(database):
            _prepare(database, path, names, parts)
        yield Store(database, names, path)
    except (sqlite3.DatabaseError, UnicodeDecodeError) as error:  # the latter where a name in it is not a text
        advice = _ANOTHER if "not a database" in str(error) else "can the file be written?"
        raise UsageError(f"{path}: {error}", advice) from None
    finally:
        if database is not None:
            database.close()


@contextmanager
def _transaction(database: sqlite3.Connection) -> Iterator[None]:
    database.execute("begin immediate")
    try:
        yield
    except BaseException:
        database.execute("rollback")
        raise
    database.execute("commit")


def _prepare(
    database: sqlite3.Connection, path: str | os.PathLike[str] | None, names: Sequence[str], parts: Mapping[str, str]
) -> None:
    wanted = {"format": _FORMAT, **parts}
    tables = {name for (name,) in database.execute("select name from sqlite_master where type = 'table'")}
    if tables:
        if "campaign" not in tables:
            raise UsageError(f"{path} is not a file of a sweep", _ANOTHER)
        known = dict(database.execute("select part, value from campaign"))
        for part, value in wanted.items():
            if known.get(part) != value:
                other = _difference(part, known.get(part), value)
                raise UsageError(f"{path} belongs to another sweep: {other}", _ANOTHER)
        return
    columns = [f'"{name}"' for name in names] + [f'"{name}" {kind}' for name, kind in COLUMNS.items()]
    database.execute("create table campaign (part text primary key, value text not null)")
    database.execute("create table cells (cell text primary key, seconds real not null)")
    database.execute(f"create table rows (cell text not null, {', '.join(columns)})")
    database.execute("create index rows_of_cell on rows (cell)")
    database.executemany("insert into campaign values (?, ?)", wanted.items())


def _difference(part: str, before: str | None, now: str) -> str:
    if len(now) == 64:
        return f"the {part} has changed"
    return f"{part} was {before}, now it is {now}"


def _key(values: Values) -> str:
    return json.dumps(values)
