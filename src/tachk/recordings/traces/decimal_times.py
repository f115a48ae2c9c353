"""Times that are written as decimal numbers, and were binary ones: how finely they are counted.

Programs that add 0.1 again and again write 0.30000000000000004. Where a time is such a number, all of them are, and are
rounded to nine decimals, or to as many more as keep different times of neighbours different. Otherwise times are exact.

Programs that print 1764000000.1 with 17 digits write 1764000000.0999999. If all times of so many digits are what
floating-point numbers of 64 bits print as, each is read as the shortest decimal number of its own.
`_core.CsvReader` does the same.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from fractions import Fraction
from typing import TypeVar

from tachk.base.diagnostics.diagnostic import InputError, UsageError

USUAL_DECIMALS = 9
"""Times in floating point that are not short decimal numbers are rounded to at least so many decimals."""

MOST_DECIMALS = 18

_NEARLY_SHORT = re.compile(r"(0{6}|9{6})\d{1,3}$")

_ALWAYS_SHORTEST = 2**52
"""Numbers with so many decimals as they have, and fewer units, belong to different floating-point numbers."""

_COMPARED = 19
"""Digits of a time that are compared with those of its floating-point number."""

_MANY = 40
"""Digits, so many that rounding shows in none that is compared."""

_MORE = 3
"""Further decimals where neighbours are close, so that their distances are right to a thousandth."""

Counted = TypeVar("Counted")


def fewest_decimals(count: Callable[[int], Counted | None]) -> Counted | None:
    """Times counted in the fewest decimals that keep neighbours apart, and some more if they fit.

    Args:
        count: counts with a number of decimals; None if different neighbours become equal; raises if the ticks do not
            fit.

    Returns None where no number of decimals is enough.
    """
    for decimals in range(USUAL_DECIMALS, MOST_DECIMALS + 1):
        counted = count(decimals)
        if counted is not None:
            break
    else:
        return None
    if decimals > USUAL_DECIMALS:
        with suppress(InputError, UsageError):
            counted = count(min(decimals + _MORE, MOST_DECIMALS)) or counted
    return counted


def is_binary(text: str) -> bool:
    """True if a decimal number, as it is written, was a binary one: it has more than fifteen digits, or is a short one
    but for errors of rounding, as 7.19999999999999 is."""
    mantissa, _, exponent = text.strip().lower().lstrip("+-").partition("e")
    whole, _, fraction = mantissa.partition(".")
    decimals = len(fraction.rstrip("0")) - (int(exponent) if exponent else 0)
    digits = (whole + fraction).strip("0")
    return decimals > USUAL_DECIMALS and (
        len(digits) > 15 or (len(digits) > 12 and _NEARLY_SHORT.search(digits) is not None)
    )


def shortest(text: str, time: Fraction) -> tuple[Fraction, bool] | None:
    """The shortest decimal number of the floating-point number that a time was printed from, if it is printed so with
    as many digits; None if it has so many digits, and is not printed so; else the time as it is.

    Also whether that number was a binary one.

    Args:
        time: what the text says.
    """
    mantissa = text.strip().lower().lstrip("+-").partition("e")[0]
    digits = mantissa.replace(".", "").strip("0")
    if time.denominator == 1 or len(digits) < 16 or int(digits[:_COMPARED]) < _ALWAYS_SHORTEST:
        return time, is_binary(text)
    precision = len(digits) - 1 if len(digits) <= _COMPARED else _MANY
    printed = f"{abs(float(time)):.{precision}e}".partition("e")[0].replace(".", "")
    if printed[:_COMPARED] != digits[:_COMPARED]:
        return None
    short = repr(float(time))
    return Fraction(short), is_binary(short)


def rounded(time: Fraction, decimals: int) -> Fraction:
    """To the nearest number of so many decimals, half away from zero."""
    scale = 10**decimals
    whole = (2 * abs(time.numerator) * scale + time.denominator) // (2 * time.denominator)
    return Fraction(whole if time >= 0 else -whole, scale)


def separated(times: Sequence[Fraction], binary: Sequence[bool]) -> tuple[list[Fraction], int | None] | None:
    """The times, rounded if any of them was a binary number, and to how many decimals.

    None where no number of decimals keeps neighbours apart.
    """
    if not any(binary):
        return list(times), None

    def count(decimals: int) -> tuple[list[Fraction], int | None] | None:
        found = [rounded(time, decimals) for time in times]
        rows = zip(times, times[1:], found, found[1:], strict=False)
        return None if any(a != b and first >= second for a, b, first, second in rows) else (found, decimals)

    return fewest_decimals(count)
