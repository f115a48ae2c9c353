"""Durations with units, as models write them: ``5 ms``."""

from __future__ import annotations

from fractions import Fraction

from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.span import Span
from tachk.base.time_units import NANOSECONDS, length_of
from tachk.frontend.context import Context


def units_of(amount: int, unit: str, span: Span, context: Context) -> Fraction | None:
    """A duration in time units of the model; without a unit it is in these. None after a report."""
    if not unit:
        return Fraction(amount)
    length = NANOSECONDS.get(unit)
    own = length_of(context.time_unit) if context.time_unit else None
    if length is None:
        help_ = did_you_mean(unit, NANOSECONDS) or f"one of {', '.join(NANOSECONDS)}"
        context.error("E0453", span, f"`{unit}` is not a unit of time", help_)
    elif own is None:
        help_ = "write `time_unit = 1 ms;`, or leave out the unit"
        context.error("E0453", span, "the model does not say how long its time unit is", help_)
    else:
        return amount * length / own
    return None
