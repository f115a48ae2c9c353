"""Times that people give."""

from __future__ import annotations

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import exact_number
from tachk.base.time_units import NANOSECONDS, length_of
from tachk.engine.simulation.simulator import LATEST_END, TimeBound, time_bound


def parsed_time_bound(written: str, time_unit: str, name: str = "--until") -> TimeBound:
    """A time up to which runs go on: a number of units of the model, or a duration such as ``3 min``.

    Args:
        time_unit: of the model; empty if it has none.
        name: what the time is called in messages.

    Raises UsageError.
    """
    number = written.strip().rstrip("abcdefghijklmnopqrstuvwxyz").strip()
    unit = written.strip()[len(number) :].strip()
    try:
        time = exact_number(number)
    except ValueError:
        raise UsageError(f"{name} {written[:40]}: expected a time", "for example 100, or 3 min") from None
    if unit:
        length = length_of(time_unit)
        if unit not in NANOSECONDS or length is None:
            raise UsageError(
                f"{name} {written}: {'the model has no time unit' if length is None else 'unknown unit'}",
                "give a number of time units of the model",
            )
        time = time * NANOSECONDS[unit] / length
    if not 0 < time <= LATEST_END:
        raise UsageError(f"{name} {written}: runs last more than 0 and at most {int(LATEST_END)} time units")
    return time_bound(time)
