"""Proofs that a clock, or a difference of two clocks, grows without limit where a path ends.

There are two reasons. Time may pass for ever in the last state of the path. Or the path goes through a loop that takes
at least one time unit and resets no clock that counts, and that can be taken any number of times before the rest of the
path: then every number is exceeded.

The loop is found on zones that are widened by the largest constants (`tachk.meaning.extrapolation.widen`). Whatever
path through widened zones exists, a run takes its transitions, since a widened zone holds only valuations that behave
as some true one does. Let a part S of a widened zone that the first part of the path reaches lie inside what a loop
leads to from S. Then every valuation of S is reached from one of S by the loop, and so by any number of loops in a row.
What clocks show that nothing compares does not count.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial, reduce
from itertools import chain, islice

from tachk.base.job import check_job
from tachk.base.records import dataclass, replace
from tachk.meaning import dbm, symbolic
from tachk.meaning.clock_constants import ClockConstants, clock_constants
from tachk.meaning.dbm import INFINITY, Federation, Zone
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.extrapolation import widen
from tachk.meaning.symbolic import Move, Situation
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.run import DiscreteState, Transition
from tachk.transform.extension import with_clock

MOST_STEPS = 20_000
"""Transitions that are followed in search of a loop, once for each zone."""

MOST_GUESSES = 200
"""Loops that are tried although the path has not come back to the same zones: a longer path will."""


def grows_without_limit(
    network: Network, path: Sequence[Transition], where: Expression, grows: Expression, less: Expression | None = None
) -> bool:
    """True if a clock, or by how much it exceeds another one, has no largest value where a predicate holds behind
    paths through the same states as the given one; False also where this is not found out.

    Args:
        grows, less: clocks that do not depend on the state.
    """
    model = prepare(with_clock(network).network)
    numbers = tuple(0 if clock is None else _number(model, clock) for clock in (grows, less))
    try:
        return _grows(model, path, where, numbers)
    except (EvaluationFault, ValueError, _OutOfSteps):
        return False


def _grows(model: PreparedNetwork, path: Sequence[Transition], where: Expression, numbers: tuple[int, ...]) -> bool:
    walk = _PathWalk(model, clock_constants(model.network, [where]))
    reached = walk.along(path)
    if reached is None or any(state.here.stopped for state in reached):
        return False
    if any(source for state in reached if state.move is not None for _, source, _ in state.move.resets):
        return False  # a clock that is set to another one does not begin anew
    x, y = numbers
    if any(zone[x, y] >= INFINITY for zone in walk.ending(reached[-1], where)):
        return True

    def goes_on(state: _ReachedZone, rest: Sequence[Transition]) -> bool:
        states = walk.along(rest, state)
        return states is not None and bool(walk.ending(states[-1], where))

    begin = _last_reset(reached, x)
    end = len(path) if y == 0 else _last_reset(reached, y) - 1
    seen = [walk.seen(state) for state in reached[begin : end + 1]]
    others = (pair for pair in _returns([discrete for discrete, _ in seen]) if seen[pair[0]] != seen[pair[1]])
    pairs = ((begin + first, begin + behind) for first, behind in chain(_returns(seen), islice(others, MOST_GUESSES)))
    return any(
        walk.loops(reached[first], path[first:behind], partial(goes_on, rest=path[first:])) for first, behind in pairs
    )


def _returns(seen: Sequence[object]) -> Iterator[tuple[int, int]]:
    """Pairs of places of a path with the same content: an earlier and a later one. The nearest repetition comes first,
    and the end of the path before its beginning, as clocks that nothing resets have passed all constants there."""
    places: dict[object, list[int]] = {}
    for number, what in enumerate(seen):
        places.setdefault(what, []).append(number)
    for rounds in range(1, len(seen)):
        for numbers in places.values():
            yield from zip(reversed(numbers[:-rounds]), reversed(numbers[rounds:]), strict=True)


@dataclass(frozen=True, slots=True)
class _ReachedZone:
    """A state on a path: the valuations there, and the move that led there."""

    here: Situation
    zones: Federation
    move: Move | None = None


class _OutOfSteps(Exception):
    pass


class _PathWalk:
    """Goes along paths. The last clock of the model is spare."""

    def __init__(self, model: PreparedNetwork, constants: ClockConstants) -> None:
        self.model = model
        self.spare = model.dimension - 1
        self.constants = replace(constants, maximum=(*constants.maximum[:-1], 1))
        self.unread = frozenset(range(1, self.spare)) - constants.compared
        self.situations: dict[DiscreteState, Situation] = {}
        self.steps = 0

    def along(self, path: Iterable[Transition], start: _ReachedZone | None = None) -> list[_ReachedZone] | None:
        """The states of a path from the initial one on, or from another one; None if it cannot be taken."""
        reached = [start or _ReachedZone(*symbolic.initial_situation(self.model))]
        for transition in path:
            following = self._after(reached[-1], transition)
            if following is None:
                return None
            reached.append(following)
        return reached

    def ending(self, state: _ReachedZone, where: Expression) -> Federation:
        """The valuations for which a predicate holds."""
        return symbolic.intersections(state.zones, symbolic.where(self.model, state.here, where))

    def seen(self, state: _ReachedZone) -> tuple[DiscreteState, tuple[tuple[int, ...], ...]]:
        """The state on which the rest of the path may depend. If it comes back to the same, it is probably a loop."""
        zones = self._widened(dbm.reset(zone, self.spare, 0) for zone in state.zones)
        return state.here.discrete, tuple(zone.bounds for zone in zones)

    def loops(self, start: _ReachedZone, path: Sequence[Transition], goes_on: Callable[[_ReachedZone], bool]) -> bool:
        """True if the path can be taken again and again from there, each time in at least one time unit, before the run
        goes on: from all valuations, or from those that remain when what the path does not lead to is left out until
        nothing changes."""
        for zone in self._widened(self._timed(start.here, start.zones)):
            left: Zone | None = zone
            while left is not None:
                again = self._behind(replace(start, zones=[left]), path)
                if any(dbm.includes(other, left) for other in again):
                    return left is zone or goes_on(replace(start, zones=[left]))
                left = next(iter(symbolic.intersections([left], again)), None)
        return False

    def _behind(self, start: _ReachedZone, path: Sequence[Transition]) -> Federation:
        """The valuations to which the path leads in at least one time unit, with the spare clock at 0."""
        state: _ReachedZone | None = start
        for transition in path:
            state = None if state is None else self._after(state, transition)
            if state is not None:
                state = replace(state, zones=self._widened(state.zones))
        if state is None:
            return []
        later = (dbm.constrain(z, (0, self.spare, dbm.raw_bound(-1, False))) for z in state.zones)
        return self._widened(self._timed(state.here, (z for z in later if z is not None)))

    def _timed(self, here: Situation, zones: Iterable[Zone]) -> Federation:
        """The valuations with the spare clock set to 0, and what follows by letting time pass."""
        return symbolic.elapse(here, [dbm.reset(zone, self.spare, 0) for zone in zones])

    def _widened(self, zones: Iterable[Zone]) -> Federation:
        """The zones, widened by the constants, with the clocks that nothing reads free."""
        return [reduce(dbm.free, self.unread, wide) for zone in zones for wide in widen(self.constants, zone)]

    def _after(self, state: _ReachedZone, transition: Transition) -> _ReachedZone | None:
        check_job()
        self.steps += len(state.zones)
        if self.steps > MOST_STEPS:
            raise _OutOfSteps
        move = next((move for move in state.here.moves if move.transition == transition), None)
        fired = [] if move is None else symbolic.fire(state.here, state.zones, move)
        if move is None or move.target is None or not fired:
            return None
        if move.target not in self.situations:
            self.situations[move.target] = symbolic.situation(self.model, move.target)
        there = self.situations[move.target]
        return _ReachedZone(there, dbm.without_covered(symbolic.elapse(there, fired)), move)


def _last_reset(reached: Sequence[_ReachedZone], clock: int) -> int:
    """The number of the state from which on the clock is not set any more."""
    resets = (
        number
        for number, state in enumerate(reached)
        if state.move is not None and any(clock == each for each, *_ in state.move.resets)
    )
    return max(resets, default=0)


def _number(model: PreparedNetwork, clock: Expression) -> int:
    """The number of a clock that does not depend on the state."""
    from tachk.meaning.discrete import environment, initial_discrete
    from tachk.model.evaluate import clock_number

    return clock_number(clock, environment(model, initial_discrete(model)))
