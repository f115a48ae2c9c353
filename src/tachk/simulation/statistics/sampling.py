"""Samples of runs of a network: does something happen, or how large does a value become?"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from tachk.analysis.fold import fold, known_values
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import check_job
from tachk.base.operators import BinaryOperator
from tachk.base.seeds import DEFAULT_SEED
from tachk.base.span import Span
from tachk.engine.compiler.features import check_simulated
from tachk.engine.compiler.lower import lower_simulation
from tachk.engine.compiler.program import Chances, Program
from tachk.engine.simulation.simulator import LATEST_END, TICKS_PER_UNIT, SimulationEnding, time_bound
from tachk.engine.simulation.trials import Reach, TrialAnswer, TrialQuestion, Trials, Trier
from tachk.model.connectives import both, either, negation
from tachk.model.expressions import (
    BOOL,
    Binary,
    Constant,
    Expression,
    Field,
    Index,
    Reference,
    Variable,
    VariableKind,
)
from tachk.model.fault import RuntimeErrorKind
from tachk.model.network import Network
from tachk.model.statistical import ExpectedValue, Path, RunBound, Scale
from tachk.model.types import ClockType

_BATCH = 4096
"""The number of runs that are drawn between two checks for Ctrl-C."""


@dataclass(frozen=True, slots=True)
class RunSource:
    """The source of random runs.

    Attributes:
        first: the number of the first run; with the seed it determines the runs.
        most_steps: after which a run is given up, and counts as unknown.
    """

    seed: int = DEFAULT_SEED
    first: int = 0
    threads: int = 1
    most_steps: int | None = None


@dataclass(slots=True)
class SampledRuns:
    """The results of the runs so far.

    Attributes:
        ticks_per_unit: how finely their times are counted.
        hits: on how many the goal is reached.
        unknown: how many ended before that was known.
        endings: how many ended how, before the goal was reached.
        times: the moments at which the goal was reached, in ticks.
        values: what was measured on each run; not a number where a run is unknown.
    """

    ticks_per_unit: int = TICKS_PER_UNIT
    runs: int = 0
    hits: int = 0
    unknown: int = 0
    transitions: int = 0
    endings: Counter[SimulationEnding] = field(default_factory=Counter)
    times: list[NDArray[np.int64]] = field(default_factory=list, repr=False)
    values: list[NDArray[np.float64]] = field(default_factory=list, repr=False)
    fault: tuple[RuntimeErrorKind, Span] | None = None

    def add(self, trials: Trials) -> None:
        known = trials.answers != TrialAnswer.UNKNOWN
        hit = trials.answers == TrialAnswer.YES
        self.runs += len(trials.answers)
        self.hits += int(hit.sum())
        self.unknown += int((~known).sum())
        self.transitions += trials.transitions
        self.endings.update(trials.endings)
        self.times.append(trials.ends[hit])
        self.values.append(np.where(known, trials.measured, np.nan))
        self.fault = self.fault or trials.fault

    @property
    def all_times(self) -> NDArray[np.float64]:
        """The moments at which the goal was reached, in units of time, in the order of the runs."""
        return np.concatenate([np.empty(0, dtype=np.int64), *self.times]) / self.ticks_per_unit

    @property
    def all_values(self) -> NDArray[np.float64]:
        return np.concatenate([np.empty(0), *self.values])


class Sampler:
    """Draws runs for one question, one after the other."""

    def __init__(self, trials: Callable[[range], Trials], first: int, ticks_per_unit: int) -> None:
        """Args:
        trials: draws the runs of these numbers.
        first: the number of the first run.
        """
        self._trials = trials
        self._first = first
        self.sample = SampledRuns(ticks_per_unit)

    def draw(self, runs: int) -> Trials:
        """So many more runs, at most 4096. Raises StoppedError."""
        check_job()
        first = self._first + self.sample.runs
        trials = self._trials(range(first, first + runs))
        self.sample.add(trials)
        return trials

    def draw_up_to(self, runs: int) -> SampledRuns:
        """So many runs in all."""
        while self.sample.runs < runs:
            self.draw(min(_BATCH, runs - self.sample.runs))
        return self.sample


def _sampler_of(program: Program, chances: Chances, question: TrialQuestion, source: RunSource) -> Sampler:
    trier = Trier(program, chances)

    def trials(numbers: range) -> Trials:
        return trier.trials(question, source.seed, numbers, source.threads, source.most_steps)

    return Sampler(trials, source.first, question.reach.ticks_per_unit)


def path_sampler(network: Network, path: Path, source: RunSource) -> Sampler:
    """The runs on which ``<> p`` or ``p U q`` is evaluated; for ``[] p`` a hit is that p becomes false. Raises as
    `lowered_path`."""
    network, path = with_elapsed_time(network, path)
    program, chances = lowered_path(network, path)
    return _sampler_of(program, chances, trial_question(network, path, program), source)


def with_elapsed_time(network: Network, path: Path) -> tuple[Network, Path]:
    """The same question with a clock that is never reset, where the predicate counts from a moment on."""
    if path.since == 0:
        return network, path
    clock = Variable("time since the start", ClockType(), VariableKind.GLOBAL, (0,))
    begun = Binary(BinaryOperator.GREATER_EQUAL, Reference(clock), Constant(path.since), BOOL)
    predicate = either(negation(begun), path.predicate) if path.always else both(begun, path.predicate)
    return replace(network, variables=(*network.variables, clock)), replace(path, predicate=predicate, since=0)


def lowered_path(network: Network, path: Path) -> tuple[Program, Chances]:
    """The program of a network with the goals of a path.

    Raises UnsupportedError for what is not simulated, and InputError for a wrong initial value.
    """
    check_simulated(network)
    predicates = [negation(path.predicate) if path.always else path.predicate]
    lost = _lost(path)
    if lost is not None:
        predicates.append(lost)
    return lower_simulation(network, (), predicates)


def _lost(path: Path) -> Expression | None:
    """The condition from which the predicate counts no more."""
    before, beyond = path.before, path.bound.beyond
    if before is None:
        return beyond
    return negation(before) if beyond is None else either(negation(before), beyond)


def trial_question(network: Network, path: Path, program: Program) -> TrialQuestion:
    return TrialQuestion(reach_of(path.bound, network, program), 0, -1 if _lost(path) is None else 1)


def value_sampler(network: Network, question: ExpectedValue, source: RunSource) -> tuple[Sampler, int]:
    """Runs on which the largest or least value of an expression is measured, and the largest value that a clock is set
    to. Raises as `lowered_path`."""
    check_simulated(network)
    is_clock = isinstance(question.value.type, ClockType)
    beyond = question.bound.beyond
    program, chances = lower_simulation(
        network, () if is_clock else (question.value,), [] if beyond is None else [beyond]
    )
    measured = TrialQuestion(
        reach_of(question.bound, network, program),
        goal=-1 if beyond is None else 0,
        observed=-1 if is_clock else 0,
        clock=clock_number(question.value, network, program) if is_clock else 0,
        largest=question.largest,
    )
    return _sampler_of(program, chances, measured, source), program.largest_reset


def reach_of(bound: RunBound, network: Network, program: Program) -> Reach:
    """A bound in ticks and numbers of the program. Raises UsageError for times that are too long."""
    if bound.beyond is not None:
        return Reach()
    if bound.scale is Scale.STEPS:
        return Reach(steps=int(bound.limit))
    if bound.limit > LATEST_END:
        raise UsageError(f"runs last at most {int(LATEST_END)} time units")
    limit = time_bound(bound.limit)
    if bound.clock is None:
        return Reach(until=limit.ticks, ticks_per_unit=limit.ticks_per_unit)
    number = clock_number(bound.clock, network, program)
    return Reach(clock=number, value=limit.ticks, ticks_per_unit=limit.ticks_per_unit)


def clock_number(clock: Expression, network: Network, program: Program) -> int:
    """The number of a clock that an expression names. Raises UsageError where that depends on the state."""
    name = place_name(clock, network)
    if name not in program.clock_names:
        raise UsageError(
            f"{clock.span.text} is not the name of one clock", "differences and sums of clocks are not measured"
        )
    return program.clock_names.index(name) + 1


def place_name(place: Expression, network: Network) -> str | None:
    """The name of a place as a program has it; None where it depends on the state."""
    match place:
        case Reference(variable):
            return variable.name
        case Index(base, index):
            inner, value = place_name(base, network), fold(index, known_values(network, []))
            return f"{inner}[{value.value}]" if inner is not None and isinstance(value, Constant) else None
        case Field(base, name):
            inner = place_name(base, network)
            return None if inner is None else f"{inner}.{name}"
        case _:
            return None


def endings_text(endings: Iterable[tuple[SimulationEnding, int]]) -> Sequence[str]:
    """The warning about runs that ended before their bound."""
    return [
        f"{count} {'run' if count == 1 else 'runs'} {ending.what_happened}"
        for ending, count in endings
        if ending is not SimulationEnding.HORIZON
    ]
