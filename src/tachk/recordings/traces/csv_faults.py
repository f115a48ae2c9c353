"""Messages about cells and rows of comma-separated values that cannot be read."""

from __future__ import annotations

import re

FINEST = "at most 18 digits in all, those behind the point included; --decimals 9 rounds times to nine decimals"
"""The finest resolution of times."""

_WHOLE = "at most 18 digits: leave out the rows with such a time, or count times from the beginning of the recording"

_DECIMAL_COMMA = re.compile(r"\s*[-+]?\d+,\d+\s*")
_GROUPED = re.compile(r'"\s*([-+]?\d{1,3}(?:,\d{3})+(?:\.\d*)?)\s*"')
_DATE = re.compile(r"\s*\d+[-/.:]\d+[-/.:]\d+")
_HALF_VALUE = re.compile(rb"[-+]?(\d+\.?\d*e[-+]?)?|t|tr|tru|f|fa|fal|fals|n|na|nu|nul|i|[-+]?in", re.IGNORECASE)


def is_half_value(text: bytes) -> bool:
    """True if it is what a number or a word begins with."""
    return _HALF_VALUE.fullmatch(text) is not None


def fault_message(
    kind: str, value: str, column: str, is_time: bool, cells: tuple[int, int], finest: str
) -> tuple[str, str, str | None]:
    """The code of a fault, what it is, and how to mend it.

    Args:
        kind: the name of a `_core.CsvFaultKind`.
        value: of the cell of this column.
        cells: of the row, and of the header.
        finest: what helps against a time that is too fine.
    """
    message: dict[str, tuple[str, str, str | None]] = {
        "NOT_A_NUMBER": (
            "E0911",
            f"{value!r} in column {column!r} is not a number",
            _advice_on_a_cell(value, is_time),
        ),
        "NOT_FINITE": (
            "E0911",
            f"the value {value!r} of column {column!r} is larger than any number of 64 bits",
            "write inf where it is infinite",
        ),
        "MIXED_COLUMN": (
            "E0911",
            f"column {column!r} has truth values and the number {value!r}",
            "a column holds either numbers, or true and false (or 1 and 0)",
        ),
        "MISSING_TIME": ("E0912", "this row has no time", None),
        "DECREASING_TIME": (
            "E0913",
            f"the time {value} lies before that of the row above",
            "sort the rows by time; of several rows with the same time, the last one counts",
        ),
        "TOO_FEW_CELLS": ("E0914", f"this row has {cells[0]} cells, the header has {cells[1]}", None),
        "TOO_MANY_CELLS": ("E0914", f"this row has more cells than the {cells[1]} of the header", None),
        "TIME_TOO_LARGE": (
            "E0915",
            f"the time {value} is too large to be counted as finely as the trace needs",
            _WHOLE if len(value.partition(".")[0].strip(" +-")) > 18 else FINEST,
        ),
        "TIME_MERGED": (
            "E0915",
            f"rounded, the time {value} is the same as that of the row above, which is another one",
            "give more --decimals, or write times alike that should be equal",
        ),
        "TIME_TOO_FINE": ("E0915", f"the time {value} has too many digits to be counted exactly", finest),
        "OPEN_QUOTE": ("E0911", "this quotation mark is not closed in its line", None),
        "LINE_TOO_LONG": ("E0911", "this line has more than 16 million characters", "is it a text file?"),
    }
    return message[kind]


def _advice_on_a_cell(value: str, is_time: bool) -> str:
    if (grouped := _GROUPED.fullmatch(value)) is not None:
        return f"numbers are written without separators of thousands: {grouped[1].replace(',', '')}"
    if _DECIMAL_COMMA.fullmatch(value.strip('"')):
        point = value.strip().strip('"').replace(",", ".")
        comma = "a decimal comma stands in all numbers of a file, between semicolons or tabs"
        return f"numbers have a decimal point: {point}; {comma}"
    if is_time and _DATE.match(value):
        return "dates are written as 2026-03-01T12:00:00.25Z, and then all times are dates"
    if is_time:
        return "times are numbers such as 0.25 or 2e3"
    return "cells hold numbers such as -1.5 or 2e3, true or false, or nothing where the value stays"
