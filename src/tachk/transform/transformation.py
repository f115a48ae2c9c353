"""Transformations: a network with something more or less, and the way back for its runs and its run-time errors.

Each transformation is a module of this package that makes one from a network. They compose: what is found in the last
network goes back through all of them.
"""

from __future__ import annotations

from enum import Flag, auto
from fractions import Fraction

from tachk.base.records import dataclass, replace
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.step import StepError, begun_by, delay, fire, initial_state, is_possible, possible_receivers
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.run import Ending, Participant, RunTimeFault, TimedState, TimedStep, TimedTrace, Transition


class Exactness(Flag):
    """The answers about a transformed network, or of a search that sees only a part, that are also answers about the
    original network."""

    NOTHING = 0
    REACHABLE = auto()
    """A state that is reached is reachable in the original."""
    UNREACHABLE = auto()
    """A state that is not reached is unreachable in the original: the network or the search over-approximates."""
    RUN = auto()
    """A run that was found, which avoids something for ever or ends without it, is one of the original."""
    NO_RUN = auto()
    """If no such run is found, the original has none."""
    ERRORS = auto()
    """A run-time error, or a limit that was hit, would end every further search of the original, too."""
    SAME_STATES = REACHABLE | UNREACHABLE
    INFINITE_RUNS = RUN | NO_RUN
    SAME_ANSWERS = SAME_STATES | INFINITE_RUNS
    EVERYTHING = SAME_ANSWERS | ERRORS


@dataclass(frozen=True, slots=True)
class Transformation:
    """A network made from another one.

    Processes and edges of the original keep their numbers, or `lift_transition` gives them back; what is added comes
    behind them.

    Attributes:
        original: what it was made from.
        network: what was made of it.
        exactness: which answers about it can be believed.
    """

    original: Network
    network: Network
    exactness: Exactness

    def then(self, second: Transformation) -> Composition:
        """This transformation and another one of its network."""
        return Composition(self.original, second.network, self.exactness & second.exactness, self, second)

    def lift(self, run: TimedTrace) -> TimedTrace | None:
        """A run of the original in which the same processes do the same at the same times; None if none was found.

        Processes that are frozen in the network receive what they have to.
        """
        if self.network is self.original:
            return run
        if run.ending is not Ending.OPEN:
            return None
        try:
            return self._taken_again(prepare(self.original), run)
        except (StepError, EvaluationFault):
            return None

    def _taken_again(self, model: PreparedNetwork, run: TimedTrace) -> TimedTrace:
        """Raises StepError, and EvaluationFault where a process that is frozen meets a run-time error."""
        state = initial = initial_state(model)
        steps: list[TimedStep] = []
        waited = Fraction(0)
        for step in run.steps:
            state, waited = delay(model, state, step.delay), waited + step.delay
            lifted = None if step.transition is None else self.lift_transition(step.transition)
            if lifted is not None:
                transition = self.in_original(model, state, lifted)
                state = fire(model, state, transition)
                steps.append(TimedStep(waited, transition, state))
                waited = Fraction(0)
        if waited:
            steps.append(TimedStep(waited, None, state))
        return TimedTrace(initial, tuple(steps))

    def in_original(self, model: PreparedNetwork, state: TimedState, wanted: Transition) -> Transition:
        """The transition of the original in which the processes that act take part as wanted. Raises StepError."""
        if all(map(self._acts, possible_receivers(model, state.discrete, wanted.participants[0]))):
            return wanted

        def acting(transition: Transition) -> tuple[Participant, ...]:
            return tuple(participant for participant in transition.participants if self._acts(participant.process))

        candidates = [t for t in begun_by(model, state, wanted.participants[0]) if acting(t) == wanted.participants]
        if len(candidates) == 1:  # whether it is possible shows when it is taken
            return candidates[0]
        for transition in candidates:
            if is_possible(model, state, transition):
                return transition
        raise StepError("no transition of the original network is the one of the transformed network")

    def _acts(self, process: int) -> bool:
        """True if a process of the original is there in the network, and not frozen."""
        return bool(self.network.processes[process].edges)

    def lift_transition(self, transition: Transition) -> Transition | None:
        """A transition as one of the original, without those that only receive there; None for what was added."""
        count = len(self.original.processes)
        own = tuple(participant for participant in transition.participants if participant.process < count)
        if len(own) == len(transition.participants):
            return transition
        return Transition(own) if own else None

    def lift_fault(self, fault: RunTimeFault) -> RunTimeFault:
        """A run-time error as one of the original."""
        lifted = (self.lift_transition(transition) for transition in fault.path)
        path = tuple(transition for transition in lifted if transition is not None)
        failed = None if fault.transition is None else self.lift_transition(fault.transition)
        return replace(fault, path=path, transition=failed, run=None if fault.run is None else self.lift(fault.run))


@dataclass(frozen=True, slots=True)
class Composition(Transformation):
    """A transformation of the network of another one."""

    first: Transformation
    second: Transformation

    def lift(self, run: TimedTrace) -> TimedTrace | None:
        between = self.second.lift(run)
        return None if between is None else self.first.lift(between)

    def lift_transition(self, transition: Transition) -> Transition | None:
        between = self.second.lift_transition(transition)
        return None if between is None else self.first.lift_transition(between)


def unchanged(network: Network) -> Transformation:
    """The network as it is."""
    return Transformation(network, network, Exactness.SAME_ANSWERS)


def reduced(network: Network, rest: Network, exactness: Exactness) -> Transformation:
    """A network of which less may be left, under the same numbers."""
    return unchanged(network) if rest == network else Transformation(network, rest, exactness)
