"""A run of a part of a network that goes on for ever or ends, as one of the whole network.

The part takes its steps when it took them. The other processes do nothing as long as they can: they receive the
broadcasts that they have to, and move where they let no more time pass. No search is needed for it: whatever they do
when they must, is right where they are unobtrusive (`tachk.transform.liveness_slice`), and no answer but an attempt
elsewhere. The judge decides about the run.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import islice
from math import lcm
from typing import assert_never

from tachk.base.job import check_job
from tachk.base.records import replace
from tachk.meaning.discrete import PreparedNetwork, initiators, may_delay, stopped_clocks
from tachk.meaning.repetition import observable_clocks
from tachk.meaning.step import (
    StepError,
    begun_by,
    deadlocked,
    delay,
    fire,
    initial_state,
    is_open,
    is_possible,
    possible,
    relevant_moments,
    satisfies_invariant,
)
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.run import Ending, TimedState, TimedStep, TimedTrace, Transition
from tachk.transform.transformation import Transformation

MOST_STEPS = 200
"""The limit on steps of a run. Where those left out have many periods, it is long until all of them end together."""


def accompanied(
    model: PreparedNetwork, part: Transformation, run: TimedTrace, goals: Sequence[Expression]
) -> TimedTrace | None:
    """The run of a part as one of the whole network, which is to be replayed; None if none was found.

    Args:
        model: the original of the part.
        goals: the predicates that a loop must not tell from each other in any two rounds.
    """
    try:
        return _Accompanied(model, part, goals).along(run)
    except (StepError, EvaluationFault):
        return None


class _Accompanied:
    """A run of the whole network, as far as it is known."""

    def __init__(self, model: PreparedNetwork, part: Transformation, goals: Sequence[Expression]) -> None:
        self.model, self.part, self.goals = model, part, goals
        self.left_out = {number for number, process in enumerate(part.network.processes) if not process.edges}
        self.initial = self.state = initial_state(model)
        self.steps: list[TimedStep] = []
        self.waited = Fraction(0)

    def along(self, run: TimedTrace) -> TimedTrace | None:
        """Raises StepError, EvaluationFault."""
        match run.ending:
            case Ending.PERIODIC:
                stem, loop = run.steps[: run.loop_start], run.steps[run.loop_start :]
                self.follow(stem)
                return self.repeated(self.rounds(loop))
            case Ending.IDLE:
                self.follow(run.steps)
                return self.repeated(self.at_rest()) or self.ended(Ending.IDLE)
            case Ending.STUCK:
                self.follow(run.steps)
                self.exhaust()
                return self.ended(Ending.STUCK)
            case Ending.OPEN | Ending.RECURRENT:
                return None
            case never:
                assert_never(never)

    def follow(self, steps: Sequence[TimedStep]) -> None:
        """The part takes some steps."""
        for step in steps:
            self.wait(step.delay)
            if step.transition is None:
                continue
            while (taken := self.as_it_is(step.transition)) is None:
                self.make_way()
            self.take(taken)

    def as_it_is(self, wanted: Transition) -> Transition | None:
        """The transition of the whole network, if it is enabled."""
        try:
            transition = self.part.in_original(self.model, self.state, wanted)
            fire(self.model, self.state, transition)
        except StepError:
            return None
        return transition

    def take(self, transition: Transition) -> None:
        check_job()
        if len(self.steps) >= MOST_STEPS:
            raise StepError("the run is too long")
        self.state = fire(self.model, self.state, transition)
        self.steps.append(TimedStep(self.waited, transition, self.state))
        self.waited = Fraction(0)

    def wait(self, duration: Fraction) -> None:
        """Time passes; those left out move when they must."""
        while duration > 0:
            passed = self.longest_delay(duration)
            self.pass_time(passed)
            duration -= passed
            if duration > 0:
                self.make_way()

    def pass_time(self, duration: Fraction) -> None:
        self.state = delay(self.model, self.state, duration)
        self.waited += duration

    def longest_delay(self, most: Fraction | None) -> Fraction:
        """The last moment that time can reach, of those that matter, up to a duration."""
        if not may_delay(self.model, self.state.discrete):
            return Fraction(0)
        moments = relevant_moments(self.model, self.state, most, self.goals)
        for moment in reversed(moments if most is None else [*moments, most]):
            try:
                delay(self.model, self.state, moment)
            except StepError:
                continue
            return moment
        return Fraction(0)

    def make_way(self) -> None:
        """Someone who lets no more time pass, and is not of the part, moves: to where time can pass, if possible.
        Raises StepError."""
        moves = list(self.moves_of(self.hindering()))
        if not moves:
            raise StepError("those who let no more time pass cannot move")
        self.take(next(filter(self.rests_behind, moves), moves[0]))

    def hindering(self) -> set[int]:
        """The processes that are left out and keep time from passing, or others from moving."""
        finest = lcm(*(value.denominator for value in self.state.clocks))
        stopped = stopped_clocks(self.model, self.state.discrete)
        soon = Fraction(1, 2 * finest)
        clocks = tuple(v if n in stopped else v + soon for n, v in enumerate(self.state.clocks, start=1))
        later = replace(self.state, clocks=clocks)
        locations = self.model.current(self.state.discrete)
        return {
            number
            for number in self.left_out
            if locations[number].urgent
            or locations[number].committed
            or not satisfies_invariant(self.model, later, number)
        }

    def moves_of(self, processes: set[int]) -> Iterator[Transition]:
        for first in initiators(self.model, self.state.discrete):
            if first.process in processes and is_open(self.model, self.state, first):
                for transition in begun_by(self.model, self.state, first):
                    if is_possible(self.model, self.state, transition):
                        yield transition

    def rests_behind(self, transition: Transition) -> bool:
        """True if the process that moves may stay for ever where it comes to."""
        first = transition.participants[0]
        process = self.model.network.processes[first.process]
        location = process.locations[process.edges[first.edge].target]
        return location.invariant is None and not location.urgent and not location.committed

    def rounds(self, loop: Sequence[TimedStep]) -> Iterator[None]:
        """The part goes through its loop again and again."""
        while True:
            yield
            self.follow(loop)

    def at_rest(self) -> Iterator[None]:
        """The part has taken all its steps. Goes on, before each step of another process, until time can pass for
        ever without one."""
        while not self.may_idle():
            yield
            self.pass_time(self.longest_delay(None))
            self.make_way()

    def may_idle(self) -> bool:
        """True if time can pass for ever."""
        last = relevant_moments(self.model, self.state, None, self.goals)[-1]
        return may_delay(self.model, self.state.discrete) and self.longest_delay(None) == last

    def repeated(self, times: Iterator[None]) -> TimedTrace | None:
        """The run up to the first of some times at which all is as it was at one before; None if they end."""
        past: list[int] = []
        for _ in times:
            if self.waited:
                continue
            for start in past:
                if self.is_loop(start):
                    return self.ended(Ending.PERIODIC, start)
            past.append(len(self.steps))
        return None

    def is_loop(self, start: int) -> bool:
        before = self.steps[start - 1].state if start else self.initial
        if before.discrete != self.state.discrete or start == len(self.steps):
            return False
        states: list[TimedState] = [before, *(step.state for step in islice(self.steps, start, None))]
        seen = observable_clocks(self.model, (state.discrete for state in states), self.goals)
        pairs = zip(before.clocks, self.state.clocks, strict=True)
        return all(seen.same(clock, *values) for clock, values in enumerate(pairs, start=1))

    def exhaust(self) -> None:
        """Everybody does what is possible until nothing is any more."""
        while not deadlocked(self.model, self.state):
            for moment in relevant_moments(self.model, self.state, None):
                later = delay(self.model, self.state, moment)
                ways = possible(self.model, later)
                if ways:
                    self.pass_time(moment)
                    self.take(ways[0][0])
                    break

    def ended(self, ending: Ending, loop_start: int | None = None) -> TimedTrace:
        steps = tuple(self.steps)
        if self.waited:
            steps = (*steps, TimedStep(self.waited, None, self.state))
        return TimedTrace(self.initial, steps, ending, loop_start)
