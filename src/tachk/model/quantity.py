"""Numbers as people read them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction

_UNIT = re.compile(r"\s*(\d+(?:\.\d+)?)?\s*(\S.*?)?\s*")


def decimal(value: Fraction, most_digits: int = 9) -> str:
    """A decimal number where a short one is exact, a fraction otherwise: ``2.5``, ``7/3``."""
    for digits in range(most_digits + 1):
        scaled = value * 10**digits
        if scaled.denominator == 1:
            text = f"{abs(scaled.numerator):0{digits + 1}}"
            sign = "-" if value < 0 else ""
            return sign + (f"{text[:-digits]}.{text[-digits:]}" if digits else text)
    return str(value)


def shortened(value: Fraction) -> str:
    """A number as its nearest double is written; one that is too large for a double with its first digits."""
    try:
        return repr(float(value))
    except OverflowError:
        return f"{(Decimal(value.numerator) / Decimal(value.denominator)).normalize():.17g}"


def duration(value: Fraction, time_unit: str) -> str:
    """A time in the model's unit: 15 with the unit ``10 ms`` is ``150 ms``."""
    match = _UNIT.fullmatch(time_unit)
    assert match is not None
    factor, unit = match.groups()
    number = decimal(value * Fraction(factor or 1))
    return f"{number} {unit}" if unit else number


def seconds(value: float) -> str:
    """A measured time: ``0.8 ms``, ``12.3 s``, ``3 min 20 s``."""
    if value < 1:
        return f"{value * 1000:.1f} ms"
    if value < 120:
        return f"{value:.1f} s"
    return f"{int(value) // 60} min {int(value) % 60} s"


def grouped(value: int) -> str:
    """A count with groups of three digits."""
    return f"{value:,}"


def bytes_(value: int) -> str:
    """A size: ``12 kB``, ``3.4 MB``."""
    for factor, unit in ((10**9, "GB"), (10**6, "MB"), (10**3, "kB")):
        if value >= factor:
            return f"{value / factor:.1f} {unit}"
    return f"{value} B"


def ranges(numbers: Sequence[int]) -> str:
    """``4, 6..9``."""
    found: list[list[int]] = []
    for number in numbers:
        if found and number == found[-1][-1] + 1:
            found[-1].append(number)
        else:
            found.append([number])
    return ", ".join(str(one[0]) if len(one) == 1 else f"{one[0]}..{one[-1]}" for one in found)
