"""Numbers as people and files write them, exactly."""

from __future__ import annotations

import re
from fractions import Fraction

DIGITS = r"\d{1,1000}"
"""A whole number without a sign, as a pattern: one of more digits nobody means, and Python makes none of it."""

_HUGE_EXPONENT = re.compile(r"e[+-]?0*[1-9]\d{3}", re.IGNORECASE)
_MOST_CHARACTERS = 1000
_WHOLE = re.compile(DIGITS)


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


def is_whole(text: str) -> bool:
    """Whether a text is a whole number without a sign, as `DIGITS` has it."""
    return _WHOLE.fullmatch(text) is not None


def is_huge(text: str) -> bool:
    """Whether a number has an exponent of four digits, or more than a thousand digits."""
    return len(text) > _MOST_CHARACTERS or _HUGE_EXPONENT.search(text) is not None
