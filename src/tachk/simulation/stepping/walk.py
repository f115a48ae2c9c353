"""Walking through a model in scripts, step by step: `tachk.step`."""

from __future__ import annotations

import os
from fractions import Fraction
from random import Random

from tachk.base.arguments import checked_arguments
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import exact_number
from tachk.base.notebook import html_table
from tachk.base.records import dataclass
from tachk.base.seeds import DEFAULT_SEED
from tachk.meaning.run_view import Snapshot
from tachk.meaning.step import StepError
from tachk.model.fault import EvaluationFault
from tachk.model.quantity import decimal
from tachk.simulation.stepping.enabled import DelayWindow, EnabledTransition
from tachk.simulation.stepping.library import HasNetwork, Replay, names_of_runs
from tachk.simulation.stepping.reasons import why_no_delay
from tachk.simulation.stepping.run_file import step_line
from tachk.simulation.stepping.session import NotPossibleError, Session


@dataclass(frozen=True, slots=True)
class PossibleStep:
    """A transition that can be taken next.

    Attributes:
        text: such as ``"press!  User: Idle -> Idle & Lamp: Off -> Low"``.
        delays: after which delays from now it is possible; ``2.5 in choice.delays[0]`` asks for one.
    """

    text: str
    delays: tuple[DelayWindow, ...]

    def __str__(self) -> str:
        return f"{self.text}, after a delay in {' or '.join(map(str, self.delays))}"

    def __repr__(self) -> str:
        return f"<{self}>"


@dataclass(frozen=True, slots=True)
class Walk:
    """A run under way. Each step gives another `Walk`, so an earlier one can be gone on with in another way.

    Attributes:
        session: the run in numbers.
    """

    session: Session

    @property
    def state(self) -> Snapshot:
        """The locations, variables, clocks and the time, by name."""
        return self.session.names.timed_snapshot(self.session.state)

    @property
    def run(self) -> Replay:
        """The run up to here: its states, its rows, its text for a file, its columns for `tachk.monitor`."""
        return Replay(self.session.names, self.session.trace, None)

    @property
    def choices(self) -> tuple[PossibleStep, ...]:
        """The transitions that can be taken next; empty in a deadlock.

        Raises UsageError where an invariant cannot be evaluated.
        """
        return tuple(PossibleStep(self._text(each), each.windows) for each in self._enabled())

    @property
    def delays(self) -> DelayWindow:
        """How long time can pass with no transition, such as [0, 5].

        Raises UsageError where an invariant cannot be evaluated.
        """
        try:
            return self.session.enabled().delays
        except EvaluationFault as fault:
            raise _run_time_error(fault) from None

    @checked_arguments
    def take(self, choice: int | str | PossibleStep, after: float | str | Fraction | None = None) -> Walk:
        """Takes a transition.

        Args:
            choice: one of `choices`, or its index there, or its text, or a part of the text that no other has.
            after: after this delay; None: as soon as it is possible. A text such as ``"7/3"`` is exact.

        Raises:
            UsageError: there is no such choice, or it is not possible then.
        """
        waited = None if after is None else _exact(after)
        try:
            return Walk(self.session.take(self._chosen(choice), waited))
        except (NotPossibleError, StepError) as error:
            raise UsageError(str(error)) from None
        except EvaluationFault as fault:
            raise _run_time_error(fault) from None

    @checked_arguments
    def delay(self, time: float | str | Fraction) -> Walk:
        """Lets time pass: so many time units of the model. Raises UsageError where an invariant forbids it."""
        waited = _exact(time)
        try:
            return Walk(self.session.wait(waited))
        except StepError:
            reason = why_no_delay(self.session.names, self.session.state, waited)
            places = "; ".join(f"{label.span}: {label.text}" for label in reason.labels)
            raise UsageError(reason.message, places or None) from None
        except EvaluationFault as fault:
            raise _run_time_error(fault) from None

    @checked_arguments
    def random(self, steps: int = 1, seed: int = DEFAULT_SEED) -> Walk:
        """Takes random transitions, fewer than ``steps`` where nothing can happen any more.

        Args:
            seed: the same seed gives the same steps.
        """
        random, session = Random(seed), self.session
        for _ in range(steps):
            try:
                session = session.random(random)
            except NotPossibleError:
                break
            except EvaluationFault as fault:
                raise _run_time_error(fault) from None
        return Walk(session)

    def __len__(self) -> int:
        """The number of steps."""
        return self.session.position

    def __bool__(self) -> bool:
        """True, also before the first step."""
        return True

    def __repr__(self) -> str:
        steps, places = len(self), ", ".join(f"{process}.{place}" for process, place in self.state.locations)
        time = decimal(self.session.state.time)
        return f"<Walk after {steps} {'step' if steps == 1 else 'steps'}, at time {time}: {places}>"

    def _repr_html_(self) -> str:
        rows = [(each.text, " or ".join(map(str, each.delays))) for each in self.choices]
        return html_table(("possible", "after a delay in"), rows, f"{self!r}"[1:-1])

    def _enabled(self) -> tuple[EnabledTransition, ...]:
        try:
            return self.session.enabled().transitions
        except EvaluationFault as fault:
            raise _run_time_error(fault) from None

    def _text(self, enabled: EnabledTransition) -> str:
        return step_line(self.session.names, self.session.state.discrete, "", enabled.transition).strip()

    def _chosen(self, choice: int | str | PossibleStep) -> EnabledTransition:
        enabled = self._enabled()
        texts = [self._text(each) for each in enabled]
        if isinstance(choice, int):
            found = [choice % len(enabled)] if -len(enabled) <= choice < len(enabled) else []
        else:
            wanted = choice if isinstance(choice, str) else choice.text
            found = [n for n, text in enumerate(texts) if text == wanted]
            found = found or [n for n, text in enumerate(texts) if wanted in text]
        if len(found) != 1:
            shown = choice.text if isinstance(choice, PossibleStep) else choice
            problem = "fits several choices" if found else "is not possible in this state"
            known = [texts[n] for n in found] if found else texts
            raise UsageError(f"{shown!r} {problem}", f"choices: {'; '.join(known) or 'none'}")
        return enabled[found[0]]


def _exact(time: float | str | Fraction) -> Fraction:
    try:
        return exact_number(str(time))
    except ValueError:
        raise UsageError(f"{time!r} is not a number of time units, such as 2.5 or '7/3'") from None


def _run_time_error(fault: EvaluationFault) -> UsageError:
    return UsageError(f"a run-time error of the model: {fault} ({fault.span})")


@checked_arguments
def step(model: HasNetwork | str | os.PathLike[str]) -> Walk:
    """Begins to walk through a model, in its initial state.

    Args:
        model: such as `tachk.load` gives it, or the path of one.

    Raises:
        InputError: there is no initial state.
        UsageError: its updates draw random numbers.
        UnsupportedError: it has hybrid clocks.
    """
    return Walk(Session.begin(names_of_runs(model)))
