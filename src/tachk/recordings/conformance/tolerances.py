"""How exact recorded times are taken to be, and the least tolerance with which a recording is a run."""

from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.time_units import SPELLINGS, length_of
from tachk.recordings.conformance.conform import Conformance

_DURATION = re.compile(r"\s*(\d{1,20}(?:\.\d{1,20})?)\s*([a-zµμ]*)\s*", re.IGNORECASE)
LARGEST = 2**14
"""Units of the model up to which the least tolerance is looked for."""


def duration(text: str, time_unit: str) -> Fraction:
    """A duration such as ``5ms`` in units of the model; without a unit it is in these. Raises UsageError."""
    found = _DURATION.fullmatch(text)
    unit = "" if found is None else SPELLINGS.get(found[2].lower(), found[2])
    length = length_of(unit) if unit else None
    if found is None or (unit and length is None):
        raise UsageError(f"`{text}` is no duration", "write a number and a unit, such as 5ms")
    if length is None:
        return Fraction(found[1])
    own = length_of(time_unit) if time_unit else None
    if own is None:
        raise UsageError("the model does not say how long its time unit is", f"leave out the unit: {found[1]}")
    return Fraction(found[1]) * length / own


def least(ask: Callable[[Fraction], Conformance]) -> Conformance:
    """What is found with the least whole tolerance that does not refute; what is found with the largest one, if all
    refute or one is undecided. A larger tolerance allows all that a smaller one does."""
    found = ask(Fraction(0))
    low, high = 0, 0
    while found.accepted is False and high < LARGEST:
        low, high = high, max(2 * high, 1)
        found = ask(Fraction(high))
    if not found.accepted:
        return found
    while high - low > 1:
        middle = (low + high) // 2
        tried = ask(Fraction(middle))
        if tried.accepted:
            high, found = middle, tried
        else:
            low = middle
    return found
