"""JSON lines as columns, read by the core: files without anything unusual, which is nearly all.

The core gives up on a line with a fault, on times that were binary numbers, and on columns of values of several kinds:
`trace_jsonl.JsonRecording` reads the file then. Whatever the core reads, that one reads as the same trace.
"""

from __future__ import annotations

import codecs
from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tachk import _core
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import check_job
from tachk.recordings.traces.csv_beginning import ByteStream
from tachk.recordings.traces.logs.sparse import ColumnChanges, SparseRecording
from tachk.recordings.traces.trace import Trace, rounding_note
from tachk.recordings.traces.trace_csv import PIECE

_FARTHEST = 2**61
"""Times that are nearer to 0 are as far from each other as can be counted."""


@dataclass(frozen=True, slots=True, eq=False)
class JsonTable:
    """Attributes:
    exact: with times as they are written.
    warnings: as of a `Trace`.
    decimals: times are rounded to so many; None: they are as they are.
    """

    exact: SparseRecording
    warnings: tuple[str, ...] = ()
    decimals: int | None = None

    @property
    def name(self) -> str:
        return self.exact.name

    @property
    def unit(self) -> str:
        return self.exact.unit

    @property
    def columns(self) -> tuple[str, ...]:
        return self.exact.columns

    def read(self, columns: Collection[str] | None = None) -> Trace:
        if self.decimals is None or self.decimals >= self.exact.decimals:
            return replace(self.exact.read(columns), warnings=self.warnings)
        step = 10 ** (self.exact.decimals - self.decimals)
        times = self.exact.times
        rounded = np.sign(times) * ((2 * np.abs(times) + step) // (2 * step))
        gaps = np.diff(times)
        if bool(((np.diff(rounded) == 0) & (gaps != 0)).any()):
            raise merged_times(self.name, Fraction(int(gaps[gaps > 0].min()), 10**self.exact.decimals))
        notes = (rounding_note(self.decimals),) if bool((rounded * step != times).any()) else ()
        trace = replace(self.exact, times=rounded, decimals=self.decimals).read(columns)
        return replace(trace, notes=notes, warnings=self.warnings)


def merged_times(name: str, closest: Fraction) -> UsageError:
    """The error about times that are the same when they are rounded.

    Args:
        closest: the least distance of two times.
    """
    return UsageError(
        f"{name}: two times differ by {float(closest):.3g}, too little to be counted apart",
        "give other --decimals, or write times alike that should be equal",
    )


def read_table(
    stream: ByteStream, name: str, time: str, unit: str, dated: bool, bare: Callable[[str], str]
) -> SparseRecording | None:
    """The lines of a stream; None where the core gives up on one.

    Args:
        time: the name of the time in each line.
        dated: times are dates.
        bare: the name of a column without units.
    """
    reader = _core.JsonReader(time.encode(), dated)
    piece = stream.read1(PIECE).removeprefix(codecs.BOM_UTF8)
    while piece:
        check_job()
        if not reader.feed(piece):
            return None
        piece = stream.read1(PIECE)
    if not reader.finish():
        return None
    times, decimals, columns = reader.take()
    if len(times) == 0 or max(abs(int(times[0])), abs(int(times[-1]))) > _FARTHEST:
        return None
    changes: dict[str, ColumnChanges] = {}
    try:
        for called, kind, rows, values, labels in columns:
            changes[bare(called.decode())] = ColumnChanges(rows, _values(kind, values, labels))
    except UnicodeDecodeError:
        return None
    if len(changes) < len(columns) or bare(time) in changes:
        return None
    return SparseRecording(name, unit, times, changes, dated, decimals)


def _values(kind: _core.JsonKind, values: NDArray[np.float64], labels: list[bytes]) -> NDArray[Any]:
    if kind is _core.JsonKind.TRUTH:
        return values.astype(bool)
    if kind is not _core.JsonKind.TEXT:
        return values
    words = np.empty(len(labels), dtype=object)
    words[:] = [label.decode() for label in labels]
    found: NDArray[Any] = words[values.astype(np.int64)]
    return found
