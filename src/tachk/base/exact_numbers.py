"""Numbers as people and files write them, exactly."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fractions import Fraction

DIGITS = r"\d{1,1000}"
"""A whole number without a sign, as a pattern: more digits are a mistake, and Python refuses them."""

_HUGE_EXPONENT = r"[eE][+-]?0*[1-9]\d{3}"
_MOST_CHARACTERS = 1000


def exact_number(text: str) -> Fraction:
    """The value of a decimal number or a fraction.

    Raises ValueError for another text, and for a number with a mistaken number of digits: to work it out would
    take all the time and memory there is.
    """
    from fractions import Fraction  # the start of the program needs none

    if is_huge(text):
        raise ValueError("a number of too many digits")
    try:
        return Fraction(text)
    except ZeroDivisionError:
        raise ValueError("a division by zero") from None


def is_whole(text: str) -> bool:
    """True if a text is a whole number without a sign, as `DIGITS` has it."""
    return text.isdecimal() and len(text) <= _MOST_CHARACTERS


def is_huge(text: str) -> bool:
    """True if a number has an exponent of four digits, or more than a thousand digits."""
    return len(text) > _MOST_CHARACTERS or re.search(_HUGE_EXPONENT, text) is not None
