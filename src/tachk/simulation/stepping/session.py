"""A run under way, with its past and the steps taken back."""

from __future__ import annotations

from fractions import Fraction
from random import Random

from tachk.base.records import dataclass
from tachk.meaning.run_view import RunNames
from tachk.meaning.step import delay, fire
from tachk.model.run import TimedState, TimedStep, TimedTrace
from tachk.simulation.stepping.enabled import DelayWindow, EnabledSteps, EnabledTransition, enabled_steps
from tachk.simulation.stepping.replaying import StepRejection, beginning, replay_submitted
from tachk.simulation.stepping.submitted import SubmittedRun


class NotPossibleError(ValueError):
    """The request cannot be carried out; the message says why."""


@dataclass(frozen=True, slots=True)
class Session:
    """Attributes:
    steps: of the run, those that were taken back included.
    position: after how many of them the run is.
    """

    names: RunNames
    initial: TimedState
    steps: tuple[TimedStep, ...] = ()
    position: int = 0

    @staticmethod
    def begin(names: RunNames) -> Session:
        """Raises InputError if there is no initial state."""
        return Session(names, beginning(names.model))

    @property
    def state(self) -> TimedState:
        return self.steps[self.position - 1].state if self.position else self.initial

    @property
    def trace(self) -> TimedTrace:
        """The run up to here."""
        return TimedTrace(self.initial, self.steps[: self.position])

    def enabled(self) -> EnabledSteps:
        return enabled_steps(self.names, self.state)

    def wait(self, waited: Fraction) -> Session:
        """Lets time pass. Raises StepError."""
        return self._followed(TimedStep(waited, None, delay(self.names.model, self.state, waited)))

    def take(self, choice: EnabledTransition, waited: Fraction | None = None) -> Session:
        """Takes a transition after a delay; without one, as soon as it is enabled. Raises NotPossibleError."""
        if waited is None:
            waited = choice.windows[0].some
        elif not any(waited in window for window in choice.windows):
            possible_delays = " or ".join(map(str, choice.windows))
            raise NotPossibleError(f"this is possible after a delay in {possible_delays}")
        later = delay(self.names.model, self.state, waited)
        return self._followed(TimedStep(waited, choice.transition, fire(self.names.model, later, choice.transition)))

    def random(self, random: Random) -> Session:
        """Takes one of the transitions, each as likely, at a moment of its windows. Raises NotPossibleError."""
        enabled = self.enabled().transitions
        if not enabled:
            raise NotPossibleError("nothing can happen any more")
        choice = random.choice(enabled)
        return self.take(choice, _moment(random.choice(choice.windows), random))

    def at(self, position: int) -> Session:
        """After so many steps. Raises NotPossibleError."""
        if not 0 <= position <= len(self.steps):
            known = f"there are the steps 0 to {len(self.steps)}"
            raise NotPossibleError(known if self.steps else "no step has been taken yet")
        return Session(self.names, self.initial, self.steps, position)

    def loaded(self, submitted: SubmittedRun) -> tuple[Session, StepRejection | None]:
        """Another run in place of this one, as far as it is one."""
        replayed = replay_submitted(self.names, submitted)
        steps = replayed.trace.steps
        return Session(self.names, self.initial, steps, len(steps)), replayed.refusal

    def _followed(self, step: TimedStep) -> Session:
        """The steps that were taken back are forgotten, unless this is the first of them."""
        ahead = self.steps[self.position :]
        if not ahead or ahead[0] != step:
            ahead = (step,)
        return Session(self.names, self.initial, self.steps[: self.position] + ahead, self.position + 1)


_GRID = 1000


def _moment(window: DelayWindow, random: Random) -> Fraction:
    """A delay of the window: its ends, and tenths between them; of endless ones within the first ten units.

    Tenths of tenths would have one digit more at each step: where the window has thousandths of a unit, it is one.
    """
    last = window.first + 10 if window.last is None else window.last
    length = last - window.first
    share = Fraction(random.randint(0 if window.first_belongs else 1, 10 if window.last_belongs else 9), 10)
    moment = window.first + share * length
    rounded = Fraction(round(moment * _GRID), _GRID)
    return rounded if rounded in window else moment
