"""The units of time: what models, formulas, sentences and traces may measure in."""

from __future__ import annotations

from fractions import Fraction

NANOSECONDS = {
    "ns": 1,
    "us": 10**3,
    "ms": 10**6,
    "s": 10**9,
    "min": 60 * 10**9,
    "h": 3600 * 10**9,
    "d": 24 * 3600 * 10**9,
}
"""The length of each unit."""

UNITS = tuple(NANOSECONDS)

SPELLINGS = {
    **dict.fromkeys(("ns", "nsec", "nsecs", "nanosecond", "nanoseconds"), "ns"),
    **dict.fromkeys(("us", "µs", "μs", "usec", "usecs", "microsecond", "microseconds"), "us"),
    **dict.fromkeys(("ms", "msec", "msecs", "millisecond", "milliseconds"), "ms"),
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), "s"),
    **dict.fromkeys(("min", "mins", "minute", "minutes"), "min"),
    **dict.fromkeys(("h", "hr", "hrs", "hour", "hours"), "h"),
    **dict.fromkeys(("d", "day", "days"), "d"),
}
"""The units as prose and the headers of traces spell them, in lower case."""


def usual_decimals(unit: str) -> int:
    """The decimals of a time in this unit that distinguish nanoseconds, at most 9; 9 for what is not a unit."""
    length = length_of(unit)
    return 9 if length is None else next((n for n in range(9) if length <= 10**n), 9)


def unit_in_text(unit: str) -> tuple[Fraction, str]:
    """How many of a unit are one unit of a model, and the name of that unit: 500 and ``ms`` for ``500 ms``; 1 and an
    empty name for an empty text. Raises ValueError, or ZeroDivisionError, where the first word is no number."""
    amount, _, name = unit.strip().rpartition(" ")
    return Fraction(amount or 1), name


def length_of(unit: str) -> Fraction | None:
    """The nanoseconds of ``1 ms``, ``10 us`` or ``s``; None for another text."""
    try:
        amount, name = unit_in_text(unit)
    except (ValueError, ZeroDivisionError):
        return None
    length = amount * NANOSECONDS.get(name, 0)
    return length if length > 0 else None
