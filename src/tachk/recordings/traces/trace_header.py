"""The names of the columns of a trace: the column of times and its unit."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import lru_cache

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.diagnostics.suggestion import closest
from tachk.base.time_units import SPELLINGS, UNITS

TIME_NAMES = ("time", "t", "timestamp")
"""The default names of a time column, in this order."""

_OPENING = re.compile(r"[\[(]")


@dataclass(frozen=True, slots=True)
class TraceHeader:
    """Attributes:
    names: of all columns without their units, in order; empty for a column that has none.
    time: the number of the time column.
    unit: of the time; empty if nothing says it.
    """

    names: tuple[str, ...]
    time: int
    unit: str

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of everything but the time."""
        return tuple(name for number, name in enumerate(self.names) if name and number != self.time)

    def numbers(self, columns: Collection[str] | None, trace: str) -> dict[str, int]:
        """The places of the wanted columns, in the order of the trace. Raises UsageError for one that is not there."""
        wanted = self.columns if columns is None else columns
        missing = next((name for name in wanted if name not in self.columns), None)
        if missing is not None:
            raise no_such_column(missing, self.columns, trace)
        return {name: i for i, name in enumerate(self.names) if name in wanted and i != self.time}


def read_header(cells: Sequence[str], time: str | None, unit: str | None, trace: str) -> TraceHeader:
    """Makes sense of the names of the columns.

    Args:
        time: the name of the time column; None: one of `TIME_NAMES`, in upper or lower case.
        unit: of the time; None: what stands in brackets behind its name.
        trace: for messages.

    Raises:
        UsageError: there is no such time column, a name stands twice, or the unit is missing or given twice.
    """
    parts = [name_and_unit(cell) for cell in cells]
    names = tuple(name for name, _ in parts)
    seen: set[str] = set()
    for name in filter(None, names):
        if name in seen:
            raise UsageError(f"{trace} has two columns {name!r}", "rename one of them")
        seen.add(name)
    place = _time_column(names, tuple(cells), time, trace)
    return TraceHeader(names, place, agreed_unit(known_unit(parts[place][1]), unit, trace))


def agreed_unit(own: str, given: str | None, trace: str) -> str:
    """The unit of the times of a trace that says ``own`` (empty: nothing), where the user gives ``given``.

    Raises UsageError where the two contradict each other, or the given one is not known.
    """
    unit = own if given is None else known_unit(given)
    if own and unit != own:
        raise UsageError(f"the times of {trace} are in {own}, not in {unit or 'no unit'}", "leave the unit out")
    return unit


def known_unit(unit: str) -> str:
    """The unit in its usual spelling; empty stays empty. Raises UsageError for one that is not known."""
    if unit and unit.lower() not in SPELLINGS:
        raise UsageError(f"{unit!r} is not a unit of time", f"known are {', '.join(UNITS)}")
    return SPELLINGS.get(unit.lower(), "")


def no_such_column(name: str, columns: Sequence[str], trace: str) -> UsageError:
    """The error about a column that is not there."""
    close = closest(name, columns)
    known = ", ".join(columns[:20]) + (", ..." if len(columns) > 20 else "")
    return UsageError(
        f"{trace} has no column {name!r}", f"did you mean {close!r}?" if close else f"it has: {known or 'none'}"
    )


def name_and_unit(cell: str) -> tuple[str, str]:
    """``speed [km/h]`` as name and unit; a name that ends in a bracket without a space is a name: ``a[0]``."""
    text = cell.strip()
    inner = text[:-1]
    opening = _OPENING.search(inner, max(inner.rfind("]"), inner.rfind(")")) + 1)
    if not text.endswith(("]", ")")) or opening is None:
        return text, ""
    name, unit = inner[: opening.start()].rstrip(), inner[opening.end() :].strip()
    attached = not inner[len(name) :].startswith((" ", "\t")) and name.lower() not in TIME_NAMES
    return (text, "") if not name or attached else (name, unit)


@lru_cache(maxsize=4096)
def without_unit(name: str) -> str:
    """The name of a column, or of a part of it, without the unit behind it."""
    return name_and_unit(name)[0]


def _time_column(names: tuple[str, ...], cells: tuple[str, ...], time: str | None, trace: str) -> int:
    if time is not None:
        for place, (name, cell) in enumerate(zip(names, cells, strict=True)):
            if time in (name, cell.strip()):
                return place
        raise no_such_column(time, [name for name in names if name], trace)
    lower = [name.lower() for name in names]
    for candidate in TIME_NAMES:
        if candidate in lower:
            return lower.index(candidate)
    if len(names) == 1 and len(names[0].split()) > 1:
        raise UsageError(f"{trace} has one column only", "cells are separated by commas, semicolons or tabs")
    raise UsageError(
        f"{trace} has no column {', '.join(TIME_NAMES[:-1])} or {TIME_NAMES[-1]}",
        f"say which column is the time, for example --time {next(filter(None, names), 'NAME')}",
    )
