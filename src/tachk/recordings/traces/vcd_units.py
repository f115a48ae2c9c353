"""The unit of time that a run of a model had before it became a value change dump.

A dump counts its time in seconds or smaller parts of them. Bounds without unit are meant in the unit of the model, and
times of a model without unit are no seconds: a comment of the dump says it.
"""

from __future__ import annotations

from fractions import Fraction

from tachk.base.time_units import NANOSECONDS

_BEGIN = "times of tachk: "
_NO_UNIT = "no unit"


def time_comment(unit: str) -> str:
    """The time unit of the model in the dump of a run; empty: the model has none, and the dump takes seconds."""
    return _BEGIN + (unit or _NO_UNIT)


def stated_scale(comments: list[str], scale: tuple[str, int]) -> tuple[str, int]:
    """The unit of times, and how many ticks it has.

    Args:
        scale: those of the dump, without regard to its comments.
    """
    lines = [line.strip() for text in comments for line in text.splitlines()]
    stated = next((line.removeprefix(_BEGIN) for line in lines if line.startswith(_BEGIN)), None)
    if stated is None or stated not in (*NANOSECONDS, _NO_UNIT):
        return scale
    unit, ticks = scale
    count = Fraction(NANOSECONDS.get(stated, NANOSECONDS["s"]), NANOSECONDS[unit]) * ticks
    return ("" if stated == _NO_UNIT else stated, int(count)) if count.denominator == 1 else scale
