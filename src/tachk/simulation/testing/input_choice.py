"""The choice of the next input: which one, and when."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from math import ceil, floor
from random import Random
from typing import Protocol

from tachk.base.records import dataclass, replace
from tachk.engine.state_estimate import EstimateLimitError, Window
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.events import Cell, RecordedEvent
from tachk.simulation.testing.followed_system import AllowedEvent, AllowedNext, FollowedSystem

_PAUSE = 4
"""So many random inputs follow half of the time where the destination is another one."""
_PURSUIT = 30
"""At most so many inputs are on the way to one destination."""
_WAITS = 0.15
"""How often no input is chosen although one is possible, so that the system is also left alone."""


@dataclass(frozen=True, slots=True)
class PlannedInput:
    """An input that is sent at a moment, in units of the model since its start, if nothing is seen before."""

    name: str
    cells: Mapping[str, Cell]
    moment: Fraction


class InputChoice(Protocol):
    """The inputs of a test."""

    def next_input(self, system: FollowedSystem, allowed: AllowedNext, now: Fraction) -> PlannedInput | None:
        """The next input, if nothing is seen before; None for none in the time that was looked ahead."""

    def is_sent(self) -> None:
        """Takes note that the planned input was sent."""


class RandomInputs:
    """Inputs that the environment may send, at moments at which the system can receive them whatever state it is in.

    Moments at boundaries are likelier than others, since faults of timing show there. Now and then the system is left
    alone.
    """

    def __init__(self, seed: int, longest: int, uncertainty: TimestampUncertainty) -> None:
        """Args:
        longest: the latest moment is so long behind the present one.
        """
        self._random = Random(seed)
        self._longest = longest
        self._uncertainty = uncertainty

    def next_input(self, system: FollowedSystem, allowed: AllowedNext, now: Fraction) -> PlannedInput | None:
        last = now + self._longest
        inputs = [
            (event, windows)
            for event in allowed.events
            if event.is_input and (windows := list(_moments(event, now, last, self._uncertainty)))
        ]
        if not inputs or (self._random.random() < _WAITS and not must_act(allowed)):
            return None
        event, windows = self._random.choice(inputs)
        low, high = self._random.choice(windows)
        return PlannedInput(event.name, event.cells, _moment(self._random, low, high, event.boundaries))

    def is_sent(self) -> None:
        pass


class Destination(Protocol):
    """Where inputs lead.

    Attributes:
        rest: so many random inputs follow where no run there was found, or after a pursuit.
    """

    rest: int

    def is_new(self, system: FollowedSystem) -> bool:
        """Whether it is another place than at the input before."""

    def lead(self, system: FollowedSystem) -> AllowedEvent | None:
        """The first event of a run there; None if none is found near. Raises EstimateLimitError."""


class UncoveredEdges:
    """The edges of the system that were not taken yet."""

    rest = 20

    def __init__(self) -> None:
        self._covered = frozenset[int]()

    def is_new(self, system: FollowedSystem) -> bool:
        before, self._covered = self._covered, system.covered
        return before != self._covered

    def lead(self, system: FollowedSystem) -> AllowedEvent | None:
        return system.lead(self._covered)


class GuidedInputs:
    """Inputs on the way to a destination, as soon as they are possible; then random ones for a while. Where no run
    there is found near, or the system does not go there, they are random.
    """

    def __init__(
        self, destination: Destination, seed: int, others: InputChoice, uncertainty: TimestampUncertainty
    ) -> None:
        self._destination = destination
        self._random = Random(seed)
        self._others = others
        self._uncertainty = uncertainty
        self._left = _PURSUIT

    def next_input(self, system: FollowedSystem, allowed: AllowedNext, now: Fraction) -> PlannedInput | None:
        if self._destination.is_new(system):
            self._left = self._random.choice((_PURSUIT, -_PAUSE))
        if self._left > 0:
            lead = None
            with suppress(EstimateLimitError):
                lead = self._destination.lead(system)
            planned = None if lead is None else planned_towards(lead, allowed, now, self._uncertainty)
            if planned is not None or (lead is not None and not must_act(allowed)):
                return planned
            if lead is None:
                self._left = -self._destination.rest
        return self._others.next_input(system, allowed, now)

    def is_sent(self) -> None:
        """Half of the time what follows is a pursuit again."""
        if self._left > 0:
            self._left -= 1
            if self._left == 0:
                self._left = -self._destination.rest
        else:
            self._left += 1
            if self._left == 0:
                self._left = _PURSUIT


class NotReceivedError(Exception):
    """The system may not be ready for an input that a script sends now."""


class ScriptedInputs:
    """The inputs of another test, at the same times."""

    def __init__(self, inputs: Sequence[RecordedEvent], uncertainty: TimestampUncertainty) -> None:
        self._inputs = inputs
        self._uncertainty = uncertainty
        self._sent = 0

    def next_input(self, system: FollowedSystem, allowed: AllowedNext, now: Fraction) -> PlannedInput | None:
        """Raises NotReceivedError where the next input may find no receiver: what follows would say nothing."""
        if self._sent == len(self._inputs):
            return None
        event = self._inputs[self._sent]
        moment = max(event.time, now)
        if moment > _known_until(allowed, self._uncertainty):
            return None  # what may be blocked by then is not known yet
        if not system.is_always_received(event):
            events = (each for each in allowed.events if (each.name, each.cells) == (event.name, dict(event.cells)))
            if not any(any(_moments(each, moment, moment, self._uncertainty)) for each in events):
                raise NotReceivedError(f"the system may not be ready for `{event.name}` when the test has to send it")
        return PlannedInput(event.name, event.cells, moment)

    def is_sent(self) -> None:
        self._sent += 1


def planned_towards(
    lead: AllowedEvent, allowed: AllowedNext, first: Fraction, uncertainty: TimestampUncertainty
) -> PlannedInput | None:
    """The first moment, from `first` on, at which an input that leads on is possible and received for sure; None to
    wait for an output."""
    for event in allowed.events:
        if lead.is_input and (event.name, event.cells) == (lead.name, lead.cells):
            wanted = replace(event, windows=lead.windows)
            last = min(Fraction(max(high for _, high in lead.windows)), _known_until(allowed, uncertainty))
            moments = _moments(wanted, first, last, uncertainty)
            found = [PlannedInput(event.name, event.cells, low) for low, _ in moments]
            return found[0] if found else None
    return None


def _known_until(allowed: AllowedNext, uncertainty: TimestampUncertainty) -> Fraction:
    """An input that is sent later may be blocked, for all that is known."""
    end = Fraction(allowed.silent_until)
    return end if allowed.bounded else end - uncertainty.largest - 1


def must_act(allowed: AllowedNext) -> bool:
    """Whether the environment may have to end the silence, since nothing else can."""
    ends = {event.is_input for event in allowed.events if event.windows[-1][1] >= allowed.silent_until}
    return allowed.bounded and ends == {True}


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
    event: AllowedEvent, first: Fraction, last: Fraction, uncertainty: TimestampUncertainty
) -> Iterator[tuple[Fraction, Fraction]]:
    """The intervals of moments at which the event can be sent and is received for sure."""
    for low, high in event.windows:
        yield from _without(max(Fraction(low), first), min(Fraction(high), last), event.blocked, uncertainty)


def _without(
    low: Fraction, high: Fraction, blocked: tuple[Window, ...], uncertainty: TimestampUncertainty
) -> Iterator[tuple[Fraction, Fraction]]:
    """What is left of an interval where an input does not happen in any of the blocked."""
    if low > high:
        return
    earlier, later = uncertainty.around(is_output=False)
    for begin, end in blocked:
        before, behind = begin - later, end + earlier
        if low <= behind and before <= high:  # the borders of blocked are rounded outwards
            yield from _without(low, min(high, before - 1), blocked, uncertainty)
            yield from _without(max(low, behind + 1), high, blocked, uncertainty)
            return
    yield low, high
