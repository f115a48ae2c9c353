"""Events as JSON lines, as programs exchange them with a test."""

from __future__ import annotations

import json
from collections.abc import Mapping
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.conformance.events import Cell
from tachk.simulation.testing.system_adapter import SeenOutput

READY, EVENT, TIME, UNTIL = "ready", "event", "time", "until"
_SHOWN = 80
_EXPONENT = 100


def event_line(name: str, cells: Mapping[str, Cell], time: Fraction | None = None) -> str:
    """``{"event": "press"}``, with a line end; the time where the program has a clock that is driven."""
    row: dict[str, object] = {} if time is None else {TIME: number(time)}
    return json.dumps({**row, EVENT: name, **cells}) + "\n"


def until_line(time: Fraction) -> str:
    return json.dumps({UNTIL: number(time)}) + "\n"


def number(time: Fraction) -> int | float:
    """A time as JSON has it."""
    return time.numerator if time.denominator == 1 else float(time)


def read_line(line: bytes) -> tuple[str | None, Mapping[str, Cell], Fraction | None]:
    """The name of an event, None where the line only says the time; its cells; its time if it says one.

    Raises UsageError for a line that is none of that.
    """
    try:
        row = json.loads(line, parse_float=_decimal, parse_constant=_no_number)
    except (ValueError, RecursionError):
        raise _rejection(line, "is not JSON") from None
    if not isinstance(row, dict):
        raise _rejection(line, "is not a JSON object")
    name, time = row.pop(EVENT, None), row.pop(TIME, None)
    if name is not None and not isinstance(name, str):
        raise _rejection(line, f"has an `{EVENT}` that is not a text")
    if name is None and time is None:
        raise _rejection(line, f"has neither `{EVENT}` nor `{TIME}`")
    if time is not None and (isinstance(time, bool) or not isinstance(time, int | Fraction)):
        raise _rejection(line, f"has a `{TIME}` that is not a number")
    cells: dict[str, Cell] = {}
    for column, cell in row.items():
        if isinstance(cell, bool):
            cells[column] = int(cell)
        elif isinstance(cell, int | str):
            cells[column] = cell
        elif cell is not None:
            raise _rejection(line, f"has a `{column}` that is neither a whole number nor a text")
    return name, cells, None if time is None else Fraction(time)


def line_output(line: bytes, moment: Fraction) -> SeenOutput:
    """The output that a program without a clock of its own writes. Raises UsageError for a line that is no event."""
    name, cells, _ = read_line(line)
    if name is None:
        raise UsageError(
            f"a line of the program has no `{EVENT}`: {line.decode('utf-8', 'replace').strip()}",
            "a program that answers with times has a clock that is driven: --adapter driven:COMMAND",
        )
    return SeenOutput(moment, name, cells)


def _decimal(text: str) -> Fraction:
    """Raises ValueError for a number too large, or too near 0, to be a time: `1e999999999` would fill the memory."""
    _, _, exponent = text.lower().partition("e")
    if abs(int(exponent or 0)) > _EXPONENT:
        raise ValueError(text)
    return Fraction(text)


def _no_number(constant: str) -> None:
    raise ValueError(constant)


def _rejection(line: bytes, why: str) -> UsageError:
    text = line.decode("utf-8", "replace").rstrip()
    shown = text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."
    return UsageError(
        f"a line of the program {why}: {shown}",
        'write each event on a line of its own, such as {"event": "light", "on": 1}, and anything else on stderr',
    )
