"""The choice of the next input: which one, and when."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import ceil, floor
from random import Random

from tachk.base.records import dataclass
from tachk.engine.state_estimate import Window
from tachk.simulation.testing.followed_system import AllowedEvent, AllowedNext

_WAITS = 0.15
"""How often no input is chosen although one is possible, so that the system is also left alone."""


@dataclass(frozen=True, slots=True)
class PlannedInput:
    """An input that is sent at a moment, in units of the model since its start, if nothing is seen before."""

    event: AllowedEvent
    moment: Fraction


def random_input(
    random: Random, allowed: AllowedNext, now: Fraction, longest: int, tolerance: Fraction, late: Fraction
) -> PlannedInput | None:
    """An input that the environment may send, at a moment at which the system can receive it whatever state it is in.

    Moments at boundaries are likelier than others, since faults of timing show there. None where there is
    no such input, or to leave the system alone.

    Args:
        longest: the latest moment is so long behind the present one.
        tolerance, late: an input that is sent at t happens in [t - tolerance, t + late].
    """
    inputs = [
        (event, windows)
        for event in allowed.events
        if event.is_input and (windows := list(_moments(event, now, now + longest, tolerance, late)))
    ]
    if not inputs or random.random() < _WAITS:
        return None
    event, windows = random.choice(inputs)
    low, high = random.choice(windows)
    return PlannedInput(event, _moment(random, low, high, event.boundaries))


def _moment(random: Random, low: Fraction, high: Fraction, boundaries: Sequence[int]) -> Fraction:
    """A moment of an interval: as likely its beginning, a boundary, a whole one, or any."""
    inside = [each for each in boundaries if low <= each <= high]
    match random.randrange(4):
        case 0:
            return low
        case 1 if inside:
            return Fraction(random.choice(inside))
        case 2 if ceil(low) <= floor(high):
            return Fraction(random.randint(ceil(low), floor(high)))
        case _:
            return low + (high - low) * random.randrange(1001) / 1000


def _moments(
    event: AllowedEvent, first: Fraction, last: Fraction, tolerance: Fraction, late: Fraction
) -> Iterator[tuple[Fraction, Fraction]]:
    """The intervals of moments at which the event can be sent and is received for sure."""
    for low, high in event.windows:
        yield from _without(max(Fraction(low), first), min(Fraction(high), last), event.blocked, tolerance, late)


def _without(
    low: Fraction, high: Fraction, blocked: tuple[Window, ...], tolerance: Fraction, late: Fraction
) -> Iterator[tuple[Fraction, Fraction]]:
    """What is left of an interval where an input does not happen in any of the blocked."""
    if low > high:
        return
    for begin, end in blocked:
        before, behind = begin - late, end + tolerance
        if low <= behind and before <= high:  # the borders of blocked are rounded outwards
            yield from _without(low, min(high, before - 1), blocked, tolerance, late)
            yield from _without(max(low, behind + 1), high, blocked, tolerance, late)
            return
    yield low, high
