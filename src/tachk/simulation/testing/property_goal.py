"""Tests that lead a system to a state that decides a property."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from fractions import Fraction

from tachk.base.records import dataclass
from tachk.engine.state_estimate import EstimateLimitError
from tachk.model.query import Query
from tachk.model.run import TimedTrace
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.events import RecordedEvent
from tachk.simulation.testing.followed_system import AllowedEvent, AllowedNext, FollowedSystem
from tachk.simulation.testing.input_choice import InputChoice, PlannedInput, must_act, planned_towards

_PURSUIT = 30
"""At most so many inputs are on the way to the goal; then random ones follow for a while."""
_REST = 10
"""So many random inputs follow where the system may have reached the goal, or no way to it was found."""


@dataclass(frozen=True, slots=True)
class PropertyGoal:
    """A state that decides a property: for ``A[]`` and formulas one that violates it, for ``E<>`` one that it wants.

    Attributes:
        query: it has a `target`.
        run: of the model to such a state, as `tachk verify` finds one; None: it is not known whether there is one.
    """

    query: Query
    run: TimedTrace | None


class InputsTowardsTarget:
    """Inputs on the way to a state that decides a query: first those of a run that leads there, at its times, as long
    as the environment may send them; then those that a search near finds from the states in which the system may be.

    Where it finds none, and for a while behind the goal, they are random.
    """

    def __init__(self, others: InputChoice, uncertainty: TimestampUncertainty, inputs: Sequence[RecordedEvent]) -> None:
        """Args:
        inputs: of a run that leads to the goal.
        """
        self._others = others
        self._uncertainty = uncertainty
        self._inputs = list(inputs)
        self._left = _PURSUIT

    def next_input(self, system: FollowedSystem, allowed: AllowedNext, now: Fraction) -> PlannedInput | None:
        if self._left <= 0:
            return self._others.next_input(system, allowed, now)
        if self._inputs:
            planned = self._of_run(allowed, now)
            if planned is not None or not must_act(allowed):
                return planned
            self._inputs.clear()
        lead = None
        with suppress(EstimateLimitError):
            lead = system.lead_to_target()
        if lead is None:
            self._left = -_REST
            return self._others.next_input(system, allowed, now)
        planned = planned_towards(lead, allowed, now, self._uncertainty)
        if planned is None and must_act(allowed):
            return self._others.next_input(system, allowed, now)
        return planned

    def _of_run(self, allowed: AllowedNext, now: Fraction) -> PlannedInput | None:
        """The next input of the run, at its time or as soon as possible behind it. None to wait for an output that the
        run has before; if the time of the input is over, the run is given up."""
        event = self._inputs[0]
        wanted = [each for each in allowed.events if (each.name, each.cells) == (event.name, dict(event.cells))]
        for each in wanted:
            lead = AllowedEvent(each.name, each.cells, each.is_input, each.windows)
            planned = planned_towards(lead, allowed, max(now, event.time), self._uncertainty)
            if planned is not None:
                return planned
        if now > event.time + self._uncertainty.late:
            self._inputs.clear()
        return None

    def is_sent(self) -> None:
        """Half of the time what follows is a pursuit again."""
        if self._left <= 0:
            self._left += 1
            if self._left == 0:
                self._left = _PURSUIT
        elif self._inputs:
            del self._inputs[0]
        else:
            self._left -= 1
            if self._left == 0:
                self._left = -_REST
