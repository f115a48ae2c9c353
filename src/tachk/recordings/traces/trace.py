"""A recorded trace: columns of values over exact time.

Columns keep their values from the instant of one row to that of the next, or numbers move in straight lines; of
several rows for one instant the last one counts. What a row says and what lies between them: docs/monitoring.md.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import floor, lcm
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tachk import _core
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.traces.conventions import Interpolation
from tachk.recordings.traces.logs.dates import date_text

Ticks = NDArray[np.int64]
Values = NDArray[np.float64] | NDArray[np.uint8]
"""Numbers, or truth values as 0 and 1."""

LARGEST_TICK = 2**58
"""Later instants are refused, so that sums of instants and bounds of formulas fit into 64 bits."""


@dataclass(slots=True, eq=False)
class FloatTimes:
    """The times of rows in floating point, whole in units of ``10 ** -decimals``; monitors count them as they go.

    Attributes:
        first: the first time, in units.
        last: the last one, in units since the first.
        factor: how many ticks make a unit.
        checked: whether a monitor has looked at all of them, and at the values of the rows. Before, both are supposed
            to be in order.
    """

    numbers: NDArray[np.float64] = field(repr=False)
    decimals: int
    first: int
    last: int
    factor: int = 1
    checked: bool = False
    _ticks: Ticks | None = field(default=None, repr=False)

    def __len__(self) -> int:
        return len(self.numbers)

    def ticks(self) -> Ticks:
        """The ticks of all rows, counted once. Raises UsageError if the times have changed."""
        if self._ticks is None:
            ticks = np.empty(len(self.numbers), dtype=np.int64)
            if not _core.count_as(self.numbers, self.decimals, self.first, self.factor, ticks):
                raise changed_trace()
            self._ticks = ticks
        return self._ticks

    def refined(self, factor: int) -> FloatTimes:
        """The same in finer ticks."""
        return replace(self, factor=self.factor * factor, _ticks=None)


def changed_trace() -> UsageError:
    """The error for arrays that have changed since they were evaluated."""
    return UsageError(
        "the trace has been changed since it was evaluated, so that its verdict cannot be explained",
        "leave its arrays as they are while the report is in use, or give copies of them",
    )


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """Attributes:
    name: where it comes from, as messages print it.
    instants: of the rows, in ticks since the trace begins: not decreasing, the first is 0.
    columns: one value for each row; numbers as float64, truth values as uint8.
    end: in ticks; not before the last row. The trace includes it.
    ticks_per_unit: how many ticks make one unit of time.
    unit: ``ms``, ``s``, ...; empty if it is not given.
    origin: what the clock of the recording showed when the trace began, in units.
    interpolation: what numbers do between rows.
    texts: the columns that hold texts, as the places of these in ``labels``.
    labels: the texts.
    floating: the columns of numbers that may have a fraction, although none may have one here.
    packets: of a capture, the number of the packet of each row, 0 where there is none.
    dated: the clock counts seconds since 1970, and the times were dates.
    known_before: of a run of a model, the instant, in ticks, before which its values are known however it goes on; a
        formula is false on it only if no way to go on makes it true. None: the trace does not go on.
    calendar: the clock counts seconds since 1970, however the times were written.
    value_names: what a file calls the values of columns of numbers.
    notes: actions of its reader that matter for a verdict, such as rounding times.
    warnings: what is wrong with the file though it could be read, such as that it is cut off.
    """

    name: str
    instants: Ticks | FloatTimes
    columns: Mapping[str, Values]
    end: int
    ticks_per_unit: int = 1
    unit: str = ""
    origin: Fraction = Fraction(0)
    interpolation: Interpolation = Interpolation.CONSTANT
    texts: frozenset[str] = frozenset()
    labels: tuple[str, ...] = ()
    floating: frozenset[str] = frozenset()
    packets: Ticks | None = None
    dated: bool = False
    known_before: int | None = None
    calendar: bool = False
    value_names: Mapping[str, Mapping[int, str]] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        instants = self.instants
        if isinstance(instants, FloatTimes):
            first, last = 0, instants.last * instants.factor
        else:
            first, last = (instants[0], instants[-1]) if len(instants) else (-1, -1)
        if first != 0 or self.end < last:
            raise ValueError("a trace has rows, begins at 0 and ends with or after the last one")
        if any(len(values) != len(instants) for values in self.columns.values()):
            raise ValueError("every column has a value in every row")

    @property
    def rows(self) -> int:
        return len(self.instants)

    @property
    def times(self) -> Ticks:
        """The times of the rows, in ticks. Raises UsageError if floating-point times have changed."""
        return self.instants.ticks() if isinstance(self.instants, FloatTimes) else self.instants

    def clock(self, tick: int | Fraction) -> Fraction:
        """The time on the clock of the recording at a tick, in units."""
        return self.origin + Fraction(tick) / self.ticks_per_unit

    def packet(self, tick: int) -> int | None:
        """The number of the packet in the capture that was there at a tick; None if there was none."""
        if self.packets is None:
            return None
        row = int(self.times.searchsorted(tick, side="right")) - 1
        return int(self.packets[row]) or None if row >= 0 and self.times[row] == tick else None

    def moves(self, column: str) -> bool:
        """True if the values of a column lie on lines between the rows."""
        numbers = self.columns[column].dtype.kind == "f" and column not in self.texts
        return numbers and self.interpolation is Interpolation.LINEAR

    def value(self, column: str, tick: Fraction) -> float:
        """The value of a column at an instant from the first row on."""
        values = self.columns[column]
        row = int(self.times.searchsorted(int(tick), side="right")) - 1
        here = float(values[row])
        if row + 1 == self.rows or not self.moves(column):
            return here
        start, stop = int(self.times[row]), int(self.times[row + 1])
        there = float(values[int(self.times.searchsorted(stop, side="right")) - 1])
        return here + (there - here) * float((tick - start) / (stop - start))

    def refined(self, ticks_per_unit: int) -> Trace:
        """The same trace counted so finely that ``1 / ticks_per_unit`` is a whole number of ticks too.

        Raises UsageError if the times no longer fit.
        """
        wanted = lcm(self.ticks_per_unit, ticks_per_unit)
        factor = wanted // self.ticks_per_unit
        if self.end * factor > LARGEST_TICK:
            raise self._too_long(wanted)
        if factor == 1:
            return self
        instants = self.instants.refined(factor) if isinstance(self.instants, FloatTimes) else self.instants * factor
        known_before = None if self.known_before is None else self.known_before * factor
        return replace(self, instants=instants, end=self.end * factor, ticks_per_unit=wanted, known_before=known_before)

    def rounded(self, decimals: int) -> Trace:
        """The same trace with times of so many decimals, as its clock shows them.

        Raises UsageError where different times of neighbours would be the same.
        """
        scale = 10**decimals
        if scale % self.ticks_per_unit == 0:
            return self
        first = _nearest(self.origin * scale)
        shift = self.origin * scale - first
        step = Fraction(scale, self.ticks_per_unit)
        times = _rounded(self.times, step, shift)
        merged = np.flatnonzero((np.diff(times) == 0) & (np.diff(self.times) != 0))
        if len(merged):
            row = int(merged[0])
            raise UsageError(
                f"{self.name}: the times of rows {row} and {row + 1} differ, but with {decimals} decimals both are the "
                "same (rows are counted from 0)",
                f"allow more decimals, say {decimals + 3}",
            )
        end = _nearest(self.end * step + shift)
        notes = (*self.notes, rounding_note(decimals))
        known_before = None if self.known_before is None else floor(self.known_before * step + shift)
        counted = replace(self, instants=times, end=end, ticks_per_unit=scale, known_before=known_before)
        return replace(counted, origin=Fraction(first, scale), notes=notes)

    def _too_long(self, ticks: int) -> UsageError:
        message = f"{self.name} is too long to be counted in {ticks} ticks per unit of time"
        gaps = np.diff(self.times)
        if len(gaps) and int(gaps.max()) > self.end // 2:
            row = int(gaps.argmax())
            before, after = (self._clock_text(int(self.times[n])) for n in (row, row + 1))
            message += f": row {row} is at {before}, row {row + 1} at {after} (rows are counted from 0)"
            help = (
                "--decimals 3 rounds times to three decimals; or leave out what was recorded before the clock was set"
            )
        else:
            help = "times and bounds with fewer decimals, or a shorter trace, can be counted; --decimals 3 rounds times"
        return UsageError(message, help)

    def _clock_text(self, tick: int) -> str:
        clock = self.clock(tick)
        if self.dated or self.calendar:
            return date_text(clock)
        return f"{float(clock):.9g} {self.unit}".rstrip()


SHORTENING_NOTE = "times are printed binary numbers, each read as the shortest decimal number of its 64 bits"
"""The remark in reports on times such as 1764000000.0999999, which is how ``%.17g`` prints 1764000000.1."""


def rounding_note(decimals: int) -> str:
    """The remark in reports on rounded times."""
    return f"times are rounded to {decimals} {'decimal' if decimals == 1 else 'decimals'}"


def later_beginning(rows: int) -> str:
    """The remark in reports on a trace whose first rows do not give all columns a value."""
    which = "the first row is" if rows == 1 else f"the first {rows} rows are"
    return f"{which} left out: until then, some column that is read has no value"


def cut_off_warning(name: str, what: str) -> str:
    """The remark in reports on a file that ends before its end.

    Args:
        what: that is left out.
    """
    return f"{name} is cut off: {what}"


def _nearest(number: Fraction) -> int:
    return floor(number + Fraction(1, 2))


def _rounded(times: Ticks, step: Fraction, shift: Fraction) -> Ticks:
    """``times * step + shift``, each rounded to the nearest whole number, half up."""
    common = lcm(step.denominator, shift.denominator, 2)
    factor, offset = int(step * common), int(shift * common) + common // 2
    if len(times) and int(times[-1]) * factor + abs(offset) >= 2**63:
        return np.array([(int(time) * factor + offset) // common for time in times], dtype=np.int64)
    return (times * factor + offset) // common


class TraceSource(Protocol):
    """A trace that has been opened: its columns are known, its rows are not read yet."""

    @property
    def name(self) -> str:
        """What messages and reports call it."""
        ...

    @property
    def unit(self) -> str:
        """The unit of its times; empty if it does not say."""
        ...

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of everything but the time, in order."""
        ...

    def read(self, columns: Collection[str] | None = None) -> Trace:
        """The trace with these columns only, or all of them. What the others hold does not matter.

        Raises:
            InputError: something in the file is wrong.
            UsageError: a column is not there.
        """
        ...
