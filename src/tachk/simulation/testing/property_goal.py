"""Tests that lead a system to a state that decides a property."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from tachk.base.records import dataclass
from tachk.model.query import Query
from tachk.model.run import TimedTrace
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.events import RecordedEvent
from tachk.simulation.testing.followed_system import AllowedEvent, AllowedNext, FollowedSystem
from tachk.simulation.testing.input_choice import InputChoice, PlannedInput, must_act, planned_towards


@dataclass(frozen=True, slots=True)
class PropertyGoal:
    """A state that decides a property: for ``A[]`` and formulas one that violates it, for ``E<>`` one that it wants.

    Attributes:
        query: it has a `target`.
        run: of the model to such a state, as `tachk verify` finds one; None: it is not known whether there is one.
    """

    query: Query
    run: TimedTrace | None


class DecidingStates:
    """The states that decide the query of the network."""

    rest = 10

    def is_new(self, system: FollowedSystem) -> bool:
        return False

    def lead(self, system: FollowedSystem) -> AllowedEvent | None:
        return system.lead_to_target()


class InputsOfRun:
    """The inputs of a run of the model, at its times, as long as the environment may send them; then others."""

    def __init__(self, inputs: Sequence[RecordedEvent], others: InputChoice, uncertainty: TimestampUncertainty) -> None:
        self._inputs = list(inputs)
        self._others = others
        self._uncertainty = uncertainty

    def next_input(self, system: FollowedSystem, allowed: AllowedNext, now: Fraction) -> PlannedInput | None:
        if self._inputs:
            planned = self._of_run(allowed, now)
            if planned is not None or not must_act(allowed):
                return planned
            self._inputs.clear()
        return self._others.next_input(system, allowed, now)

    def _of_run(self, allowed: AllowedNext, now: Fraction) -> PlannedInput | None:
        """The next input of the run, at its time or as soon as possible behind it. None to wait for an output that the
        run has before; if the time of the input is over, the run is given up."""
        event = self._inputs[0]
        wanted = [each for each in allowed.events if (each.name, each.cells) == (event.name, dict(event.cells))]
        for each in wanted:
            planned = planned_towards(each, allowed, max(now, event.time), self._uncertainty)
            if planned is not None:
                return planned
        if now > event.time + self._uncertainty.late:
            self._inputs.clear()
        return None

    def is_sent(self) -> None:
        if self._inputs:
            del self._inputs[0]
        else:
            self._others.is_sent()
