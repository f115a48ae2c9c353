"""Networks with processes, variables and clocks behind those of another one, whose runs are those of the other."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from tachk.base.records import dataclass, replace
from tachk.model.expressions import Expression, Reference, Variable, VariableKind
from tachk.model.network import Location, Network, Process
from tachk.model.run import DiscreteState, TimedState, TimedStep, TimedTrace
from tachk.model.types import ClockType
from tachk.model.variable_layout import variable_layout
from tachk.transform.transformation import Exactness, Transformation


@dataclass(frozen=True, slots=True)
class Extension(Transformation):
    """The added parts only watch, or keep something from happening: a run without them is a run of the original."""

    def lift(self, run: TimedTrace) -> TimedTrace:
        """The run without the additions; it ends, and goes round, as it does."""
        if self.network is self.original:
            return run
        layout, processes = variable_layout(self.original), len(self.original.processes)
        slots, clocks = len(layout.initial), len(layout.clock_slots)

        def own(state: TimedState) -> TimedState:
            discrete = DiscreteState(state.discrete.locations[:processes], state.discrete.values[:slots])
            return TimedState(discrete, state.clocks[:clocks], state.time)

        steps: list[TimedStep] = []
        waited = Fraction(0)
        loop_start, due = run.loop_start, run.due
        for number, (step, before) in enumerate(zip(run.steps, run.states, strict=False)):
            if run.due is not None and number == run.due.steps:
                due = replace(run.due, steps=len(steps))
            if number == run.loop_start:
                if waited:
                    steps.append(TimedStep(waited, None, own(before)))
                    waited = Fraction(0)
                loop_start = len(steps)
            waited += step.delay
            transition = None if step.transition is None else self.lift_transition(step.transition)
            if transition is not None:
                steps.append(TimedStep(waited, transition, own(step.state)))
                waited = Fraction(0)
        if run.due is not None and run.due.steps == len(run.steps):
            due = replace(run.due, steps=len(steps))
        if waited:
            steps.append(TimedStep(waited, None, own(run.steps[-1].state)))
        return TimedTrace(own(run.initial), tuple(steps), run.ending, loop_start, due)


@dataclass(frozen=True, slots=True)
class Clocked(Extension):
    """``clock``: nothing sets it, so that it shows the time since the start of the run."""

    clock: Expression


def with_clock(network: Network, invariant: Callable[[Expression], Expression] | None = None) -> Clocked:
    """The network with one more process, which has a clock and does nothing.

    Args:
        invariant: from the clock to a condition; time ends where it does. None: time goes on.
    """
    clock = Variable("timer.time", ClockType(), VariableKind.LOCAL, (0,))
    place = Location("running", None if invariant is None else invariant(Reference(clock)))
    timer = Process("timer", "timer", (place,), (), variables=(clock,))
    exactness = Exactness.SAME_ANSWERS if invariant is None else Exactness.REACHABLE
    return Clocked(network, with_process(network, timer), exactness, Reference(clock))


def with_process(network: Network, process: Process) -> Network:
    """The network with one more process, the last one."""
    return replace(network, processes=(*network.processes, process))
