"""What a stored run of families says: who wins from which size on, where tachk loses, how CPU time a state grows."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path

from bench.side_by_side import Row

NOTICED = 0.3
"""Less CPU time than this, in seconds, is not counted as a loss: the start of Python is most of it."""


@dataclass(frozen=True, slots=True)
class StoredRun:
    """A run of `python -m bench run` as its option --output has written it."""

    date: str
    machine: str
    commit: str
    seconds: float
    gigabytes: float | None
    repeat: int
    rows: tuple[Row, ...]

    def sizes(self, family: str) -> list[int]:
        return list(dict.fromkeys(row.size for row in self.rows if row.family == family))

    def of(self, family: str, size: int) -> dict[str, Row]:
        """The rows of one instance by kind of program: tachk, TChecker, TARZAN."""
        return {row.program.split()[0]: row for row in self.rows if (row.family, row.size) == (family, size)}

    def curve(self, family: str, program: str) -> list[tuple[int, Row]]:
        rows = ((size, self.of(family, size).get(program)) for size in self.sizes(family))
        return [(size, row) for size, row in rows if row is not None]

    def names(self) -> list[str]:
        """The programs with their versions."""
        return list(dict.fromkeys(row.program for row in self.rows))


def read(path: Path) -> StoredRun:
    told = json.loads(path.read_text(encoding="utf-8"))
    rows = tuple(Row(**dict(zip(told["columns"], row, strict=True))) for row in told.pop("rows"))
    del told["columns"]
    return StoredRun(**told, rows=rows)


def write(run: StoredRun, path: Path) -> None:
    """As JSON, a row a line, with CPU seconds to a thousandth."""
    head = {field.name: getattr(run, field.name) for field in fields(StoredRun) if field.name != "rows"}
    columns = [field.name for field in fields(Row)]
    values = [[getattr(row, column) for column in columns] for row in run.rows]
    lines = [json.dumps([round(value, 3) if isinstance(value, float) else value for value in row]) for row in values]
    start = json.dumps(head | {"columns": columns}, indent=1).rstrip("}\n")
    path.write_text(f'{start},\n "rows": [\n  ' + ",\n  ".join(lines) + "\n ]\n}\n", encoding="utf-8")


def best_peer(rows: dict[str, Row]) -> Row | None:
    """Of the other programs that have finished the fastest."""
    done = [row for name, row in rows.items() if name != "tachk" and row.finished]
    return min(done, key=lambda row: row.cpu_seconds, default=None)


def is_won(rows: dict[str, Row]) -> bool:
    """Whether tachk has finished, and no other program in less CPU time."""
    best = best_peer(rows)
    ours = rows.get("tachk")
    return ours is not None and ours.finished and (best is None or ours.cpu_seconds <= best.cpu_seconds)


def wins_from(run: StoredRun, family: str) -> int | None:
    """The smallest size from which on tachk wins; None if it does not win the largest one."""
    first = None
    for size in reversed(run.sizes(family)):
        if not is_won(run.of(family, size)):
            break
        first = size
    return first


@dataclass(frozen=True, slots=True)
class Loss:
    """An instance that another program decides in less CPU time.

    Attributes:
        factor: how many times as long tachk takes; infinite if it does not decide.
    """

    family: str
    size: int
    ours: Row
    best: Row

    @property
    def factor(self) -> float:
        return self.ours.cpu_seconds / max(self.best.cpu_seconds, 0.001) if self.ours.finished else math.inf


def undecided(run: StoredRun, families: Sequence[str]) -> list[Row]:
    """The rows in which tachk has not finished."""
    rows = (row for family in families for _, row in run.curve(family, "tachk"))
    return [row for row in rows if not row.finished]


def losses(run: StoredRun, families: Sequence[str]) -> list[Loss]:
    """Those in which tachk takes more than NOTICED seconds."""
    found = []
    for family in families:
        for size in run.sizes(family):
            rows = run.of(family, size)
            best, ours = best_peer(rows), rows.get("tachk")
            if best is None or ours is None or is_won(rows):
                continue
            if not ours.finished or ours.cpu_seconds > NOTICED:
                found.append(Loss(family, size, ours, best))
    return found


@dataclass(frozen=True, slots=True)
class Growth:
    """CPU time for each stored state at the largest size, and at the size with about a tenth of its states."""

    family: str
    large: Row
    small: Row

    @property
    def factor(self) -> float:
        return per_state(self.large) / per_state(self.small)


def per_state(row: Row) -> float:
    return row.cpu_seconds / row.stored


def growth(run: StoredRun, family: str) -> Growth | None:
    """None where no smaller size is measured."""
    done = [row for _, row in run.curve(family, "tachk") if row.finished and row.stored]
    if len(done) < 2:
        return None
    large = done[-1]
    smaller = [row for row in done[:-1] if row.stored < large.stored]
    if not smaller:
        return None
    return Growth(family, large, min(smaller, key=lambda row: abs(math.log(10 * row.stored / large.stored))))
