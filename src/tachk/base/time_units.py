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


def length_of(unit: str) -> Fraction | None:
    """The nanoseconds of ``1 ms``, ``10 us`` or ``s``; None for another text."""
    amount, _, name = unit.strip().rpartition(" ")
    if name not in NANOSECONDS:
        return None
    try:
        length = Fraction(amount or 1) * NANOSECONDS[name]
    except (ValueError, ZeroDivisionError):
        return None
    return length if length > 0 else None
