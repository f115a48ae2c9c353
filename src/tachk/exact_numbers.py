"""Numbers as people and files write them, exactly."""

from __future__ import annotations

import re
from fractions import Fraction

_HUGE_EXPONENT = re.compile(r"e[+-]?0*[1-9]\d{3}", re.IGNORECASE)
_MOST_CHARACTERS = 1000


def exact_number(text: str) -> Fraction:
    """What a decimal number or a fraction is worth.

    Raises ValueError for what is neither, and for a number of so many digits that nobody means it: to work it out would
    take all the time and memory there is.
    """
    if is_huge(text):
        raise ValueError("a number of too many digits")
    try:
        return Fraction(text)
    except ZeroDivisionError:
        raise ValueError("a division by zero") from None


def is_huge(text: str) -> bool:
    """Whether a number has an exponent of four digits, or more than a thousand digits."""
    return len(text) > _MOST_CHARACTERS or _HUGE_EXPONENT.search(text) is not None
