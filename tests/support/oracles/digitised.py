"""Explicit-state explorers over sampled clock values: oracles that know nothing of zones.

`explore_regions` visits one point of every reachable region. Regions are bisimilar (Alur and Dill 1994; with
comparisons of clocks, Bouyer, Dufourd, Fleury and Petit 2004), so replacing a state by another point of its region,
with evenly spread fractional parts, loses nothing: exact, strict bounds included.

`explore_grid` lets time pass in steps of one size and never moves a point. All it reaches is truly reachable. If all
bounds are weak and all clocks run, steps of 1 reach every location (Henzinger, Manna and Pnueli 1992).
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import floor

from tachk.engine.options import Limits
from tachk.engine.outcome import GoalOutcome, Outcome, Statistics, Status
from tachk.meaning.clock_constants import clock_constants, interval
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.step import StepError, delay, initial_state, satisfies, successors
from tachk.model.expressions import Assign, Expression
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.run import RunTimeFault, TimedState, Transition
from tachk.model.traversal import walk, with_bodies
from tachk.model.types import ClockType
from tachk.model.variable_layout import variable_layout

Clocks = tuple[Fraction, ...]


def explore_regions(network: Network, goals: Sequence[Expression], limits: Limits = Limits()) -> Outcome:
    """Exact. Raises ValueError for networks with stopwatches, and if the initial state violates an invariant."""
    return _explore(network, goals, limits, *region_steps(network, goals))


def region_steps(
    network: Network, predicates: Sequence[Expression]
) -> tuple[Callable[[Clocks], Clocks], Callable[[Clocks], Fraction | None]]:
    """What takes a point to the one that stands for its region, and the delay from there into the next region (None
    where no region comes after it). Raises ValueError for networks with stopwatches."""
    if any(location.rates for process in network.processes for location in process.locations):
        raise ValueError("regions are not a bisimulation where clocks stop")
    constants = clock_constants(network, predicates)
    if constants.diagonals:
        # Behind a gap this wide nothing can be told apart, also after one of the clocks is set to a constant.
        width = 2 * max(*constants.maximum, _largest_reset(network)) + 1
        return lambda clocks: _spread(_narrowed(clocks, width)), _next_region
    maximum = constants.maximum[1:]
    return (
        lambda clocks: _spread(_capped(clocks, maximum)),
        lambda clocks: _next_region(tuple(v for v, m in zip(clocks, maximum, strict=True) if v <= m)),
    )


def explore_grid(network: Network, goals: Sequence[Expression], step: Fraction, limits: Limits = Limits()) -> Outcome:
    """Reaches a part of what is reachable, perhaps all. Comparisons between clocks need limits, as time goes on for
    ever."""
    constants = clock_constants(network, goals)
    if constants.diagonals:  # no clock can be capped
        return _explore(network, goals, limits, lambda clocks: clocks, lambda _: step)
    return _explore(network, goals, limits, lambda clocks: _capped(clocks, constants.maximum[1:]), lambda _: step)


def _largest_reset(network: Network) -> int:
    updates = [update for process in network.processes for edge in process.edges for update in edge.updates]
    inside = (e for expression in with_bodies(updates) for e in walk(expression))
    resets = (e for e in inside if isinstance(e, Assign) and isinstance(e.type, ClockType))
    return max((interval(e.value)[1] for e in resets), default=0) + max(variable_layout(network).starts, default=0)


def _capped(clocks: Clocks, maximum: Sequence[int]) -> Clocks:
    """Clocks above their largest constant all count as one more than it."""
    return tuple(v if v <= m else Fraction(m + 1) for v, m in zip(clocks, maximum, strict=True))


def _narrowed(clocks: Clocks, width: int) -> Clocks:
    """Shrinks every gap between neighbouring values, 0 included, to at most ``width + 1``, by whole units."""
    shift: dict[Fraction, int] = {Fraction(0): 0}
    below, total = Fraction(0), 0
    for value in sorted(set(clocks)):
        total += max(0, floor(value - below) - width)
        shift[value] = total
        below = value
    return tuple(v - shift[v] for v in clocks)


def _spread(clocks: Clocks) -> Clocks:
    """The point of the same region whose fractional parts are evenly spread."""
    fractions = sorted({v % 1 for v in clocks if v % 1})
    rank = {f: Fraction(r, len(fractions) + 1) for r, f in enumerate(fractions, start=1)}
    return tuple(floor(v) + rank.get(v % 1, Fraction(0)) for v in clocks)


def _next_region(clocks: Clocks) -> Fraction | None:
    """A delay into the next region, judged by the clocks whose value still matters; None if there is no next one."""
    if not clocks:
        return None
    to_go = 1 - max(v % 1 for v in clocks)
    return to_go / 2 if any(v % 1 == 0 for v in clocks) else to_go


@dataclass(slots=True)
class _States:
    """The states that were found.

    Attributes:
        found: of each goal that was reached, the path to it.
        waiting: states whose successors are not computed yet, each with the path to it.
        most: how many states there may be.
    """

    model: PreparedNetwork
    goals: Sequence[Expression]
    normalised: Callable[[Clocks], Clocks]
    next_delay: Callable[[Clocks], Fraction | None]
    most: int | None
    found: dict[int, tuple[Transition, ...]] = field(default_factory=dict)
    passed: set[TimedState] = field(default_factory=set)
    waiting: deque[tuple[TimedState, tuple[Transition, ...]]] = field(default_factory=deque)

    @property
    def too_many(self) -> bool:
        return self.most is not None and len(self.passed) > self.most

    @property
    def open(self) -> bool:
        """Whether something is left to find and somewhere to look."""
        return bool(self.waiting) and len(self.found) < len(self.goals)

    def add(self, state: TimedState, path: tuple[Transition, ...]) -> None:
        """A state that is reached on a path, and all to which time leads from there."""
        following: TimedState | None = state
        while following is not None and not self.too_many:
            state = replace(following, clocks=self.normalised(following.clocks), time=Fraction(0))
            if state in self.passed:
                return
            self.passed.add(state)
            self.waiting.append((state, path))
            for number, goal in enumerate(self.goals):
                if number not in self.found and satisfies(self.model, state, goal):
                    self.found[number] = path
            following = delayed(self.model, state, self.next_delay(state.clocks))


def _explore(
    network: Network,
    goals: Sequence[Expression],
    limits: Limits,
    normalised: Callable[[Clocks], Clocks],
    next_delay: Callable[[Clocks], Fraction | None],
) -> Outcome:
    model = prepare(network)
    started = time.monotonic()
    states = _States(model, goals, normalised, next_delay, limits.states)
    explored = transitions = 0
    reason, fault = "", None
    path: tuple[Transition, ...] = ()
    try:
        try:
            states.add(initial_state(model), ())
        except StepError as error:
            raise ValueError(str(error)) from error
        while states.open:
            state, path = states.waiting.popleft()
            explored += 1
            for transition, after in successors(model, state):
                transitions += 1
                states.add(after, (*path, transition))
            if states.too_many:
                reason = "state limit"
                break
            if limits.seconds is not None and time.monotonic() - started > limits.seconds:
                reason = "time limit"
                break
    except EvaluationFault as error:
        fault = RunTimeFault(error.kind, error.span, path, None)
        reason = "run-time error"
    found = states.found
    if len(found) == len(goals) and fault is None:
        reason = ""
    otherwise = GoalOutcome(Status.UNDECIDED if reason else Status.UNREACHABLE)
    return Outcome(
        tuple(GoalOutcome(Status.REACHED, found[g]) if g in found else otherwise for g in range(len(goals))),
        Statistics(explored, len(states.passed), transitions, time.monotonic() - started),
        reason,
        fault,
    )


def delayed(model: PreparedNetwork, state: TimedState, duration: Fraction | None) -> TimedState | None:
    """The state after a delay; None where there is none to take or it cannot pass."""
    if duration is None:
        return None
    try:
        return delay(model, state, duration)
    except StepError:
        return None
