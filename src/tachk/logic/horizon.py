"""The horizon of a formula: how far it looks ahead."""

from __future__ import annotations

from fractions import Fraction

from tachk.syntax.formula import (
    Always,
    And,
    Atom,
    Change,
    Duration,
    Eventually,
    Fall,
    Formula,
    Historically,
    Implies,
    Interval,
    Not,
    Once,
    Or,
    Rise,
    Since,
    TruthConstant,
    Until,
    WeakUntil,
    operands,
)


def horizon(formula: Formula) -> Fraction | None:
    """The time after which the value at an instant is decided whatever the run does; None: there is no such time.

    Exact for bounds that are numbers in one unit; operators on the past give back what they look behind.

    Raises:
        ValueError: a bound is not a number in the unit of the model or the trace.
    """
    inside = [horizon(part) for part in operands(formula)]
    if any(reach is None for reach in inside):
        return None
    ahead = max((reach for reach in inside if reach is not None), default=Fraction(0))
    match formula:
        case WeakUntil():
            return None
        case Eventually(interval=interval) | Always(interval=interval) | Until(interval=interval):
            upper = _upper(interval)
            return None if upper is None else upper + ahead
        case Once(interval=interval) | Historically(interval=interval):
            return max(Fraction(0), ahead - _number(interval.lower))
        case TruthConstant() | Atom() | Not() | And() | Or() | Implies() | Rise() | Fall() | Change() | Since():
            return ahead


def _upper(interval: Interval) -> Fraction | None:
    return None if interval.upper is None else _number(interval.upper)


def _number(duration: Duration) -> Fraction:
    if (duration.unit and duration.value != 0) or not isinstance(duration.value, Fraction):
        raise ValueError("a bound is not a number yet")
    return duration.value
