"""Texts that mean numbers: what the same cells of a CSV file hold.

Some formats know texts and numbers apart, and yet writers put numbers and truth values down as texts. A column whose
texts all read as these holds them, unless a formula compares it with a text: then its texts are texts.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection
from typing import Any, Final

import numpy as np

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import replace
from tachk.recordings.traces.trace import Trace, later_beginning

_MISSING: Final = ("", "nan", "-nan", "na", "null")
_WORDS: Final = {"true": True, "false": False}
_NUMBER: Final = re.compile(r"[-+]?((\d+\.?\d*|\.\d+)(e[-+]?\d+)?|inf(inity)?)", re.IGNORECASE | re.ASCII)

Cell = float | bool | None
"""A number, a truth value, or None for a text that says that there is no value."""


def cell_of(text: str) -> Cell:
    """The content of a text. Raises ValueError for one that is neither a number nor a truth value."""
    word = text.strip().lower()
    if word in _MISSING:
        return None
    if word in _WORDS:
        return _WORDS[word]
    if _NUMBER.fullmatch(word) and (math.isfinite(number := float(word)) or "inf" in word):
        return number
    raise ValueError(text)


def is_cell(text: str) -> bool:
    """True if a text reads as a number, as a truth value, or as no value."""
    try:
        cell_of(text)
    except ValueError:
        return False
    return True


def plain_cell(value: Any) -> Any:
    """A number or a truth value in place of a text that says one, NaN in place of one that says that there is none."""
    if not isinstance(value, str) or not is_cell(value):
        return value
    cell = cell_of(value)
    return math.nan if cell is None else cell


def number_columns(trace: Trace, columns: Collection[str]) -> frozenset[str]:
    """Those of some columns whose texts all read as numbers, truth values or no value, some of them as a value."""
    return frozenset(column for column in columns if _reads_as_numbers(_texts(trace, column)))


def _reads_as_numbers(texts: Collection[str]) -> bool:
    return all(is_cell(text) for text in texts) and any(cell_of(text) is not None for text in texts)


def _texts(trace: Trace, column: str) -> list[str]:
    return [trace.labels[int(number)] for number in np.unique(trace.columns[column])]


def with_numbers(trace: Trace, columns: Collection[str]) -> Trace:
    """The trace with numbers and truth values in place of the texts of some columns. It begins when all of these have a
    value; then a text that says that there is none means that the value stays.

    Raises UsageError for a column that has truth values and other numbers than 0 and 1.
    """
    held: dict[str, Any] = {}
    begin = 0
    for column in sorted(columns):
        numbers, is_known = _read(trace, column)
        first = int(is_known.argmax())
        last = np.maximum.accumulate(np.where(is_known, np.arange(len(numbers)), first))
        held[column] = numbers[last]
        begin = max(begin, first)
    held = {name: _narrowed(held[name][begin:]) if name in held else v[begin:] for name, v in trace.columns.items()}
    texts = trace.texts.difference(columns)
    if begin == 0:
        return replace(trace, columns=held, texts=texts)
    times = trace.times[begin:]
    gone = int(times[0])
    return replace(
        trace,
        columns=held,
        texts=texts,
        instants=times - gone,
        end=trace.end - gone,
        origin=trace.clock(gone),
        packets=None if trace.packets is None else trace.packets[begin:],
        known_before=None if trace.known_before is None else trace.known_before - gone,
        notes=(*trace.notes, later_beginning(begin)),
    )


def _read(trace: Trace, column: str) -> tuple[np.ndarray[Any, np.dtype[np.float64]], Any]:
    """The numbers of a column, and where there are some."""
    cells = [cell_of(label) if is_cell(label) else None for label in trace.labels]
    used = [cells[int(number)] for number in np.unique(trace.columns[column])]
    numbers = [cell for cell in used if not isinstance(cell, bool) and cell not in (None, 0, 1)]
    if numbers and any(isinstance(cell, bool) for cell in used):
        raise mixed_column(trace.name, column, numbers[0])
    places = trace.columns[column].astype(np.int64)
    table = np.array([math.nan if cell is None else float(cell) for cell in cells])
    known = np.array([cell is not None for cell in cells])
    return table[places], known[places]


def mixed_column(name: str, column: str, number: object) -> UsageError:
    """The error about a column that has truth values and another number than 0 and 1."""
    return UsageError(
        f"{name}: column {column!r} has truth values and the number {number}",
        "a column holds either numbers, or true and false (or 1 and 0)",
    )


def _narrowed(numbers: Any) -> Any:
    return numbers.astype(np.uint8) if bool(((numbers == 0) | (numbers == 1)).all()) else numbers
