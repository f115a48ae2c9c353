"""Proofs that a clock, or a difference of two clocks, grows without limit where a path ends.

There are two reasons. Time may pass for ever in the last state of the path. Or the path goes through a loop that takes
at least one time unit and resets no clock that counts, and that can be taken any number of times before the rest of the
path: then every number is exceeded.

The loop is found on zones that are widened by the largest constants (`tachk.engines.reference.widen`). Whatever path
through widened zones exists, a run takes its transitions, since a widened zone holds only valuations that behave as
some true one does. Let a widened zone S be reached by the first part of the path, and let S lie inside what a loop
leads to from S. Then every valuation of S is reached from one of S by the loop, and so by any number of loops in a row.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from tachk.engines.reference import widen
from tachk.model.expressions import Expression, Variable, VariableKind
from tachk.model.fault import EvaluationFault
from tachk.model.network import Location, Network, Process
from tachk.model.types import ClockType
from tachk.semantics import dbm, symbolic
from tachk.semantics.clock_constants import ClockConstants, clock_constants
from tachk.semantics.dbm import INFINITY, Federation, Zone
from tachk.semantics.discrete import PreparedNetwork, prepare
from tachk.semantics.symbolic import Move, Situation
from tachk.semantics.timed_trace import DiscreteState, Transition

MOST_STEPS = 20_000
"""Transitions that are followed in search of a loop."""


def grows_without_limit(
    network: Network, path: Sequence[Transition], where: Expression, grows: Expression, less: Expression | None = None
) -> bool:
    """Whether a clock, or by how much it exceeds another one, has no largest value where a predicate holds behind
    paths through the same states as the given one; False also where this is not found out.

    Args:
        grows, less: clocks that do not depend on the state.
    """
    timed = _with_a_clock(network)
    model = prepare(timed)
    numbers = tuple(0 if clock is None else _number(model, clock) for clock in (grows, less))
    try:
        return _grows(model, path, where, numbers)
    except (EvaluationFault, ValueError, _OutOfSteps):
        return False


def _grows(model: PreparedNetwork, path: Sequence[Transition], where: Expression, numbers: tuple[int, ...]) -> bool:
    walk = _Walk(model, clock_constants(model.network, [where]))
    reached = walk.along(path)
    if reached is None or any(state.here.stopped for state in reached):
        return False
    x, y = numbers
    last = reached[-1]
    here = symbolic.intersections(last.zones, symbolic.where(model, last.here, where))
    if any(zone[x, y] >= INFINITY for zone in here):
        return True
    begin = _last_reset(reached, x)
    end = len(path) if y == 0 else _last_reset(reached, y) - 1
    return any(
        reached[first].here.discrete == reached[behind].here.discrete and walk.loops(reached[first], path[first:behind])
        for first in range(begin, end)
        for behind in range(first + 1, end + 1)
    )


@dataclass(frozen=True, slots=True)
class _Reached:
    """A state on a path: the valuations there, and the move that led there."""

    here: Situation
    zones: Federation
    move: Move | None = None


class _OutOfSteps(Exception):
    pass


class _Walk:
    """Goes along paths. The last clock of the model belongs to nobody."""

    def __init__(self, model: PreparedNetwork, constants: ClockConstants) -> None:
        self.model = model
        self.spare = model.dimension - 1
        self.constants = replace(constants, maximum=(*constants.maximum[:-1], 1))
        self.situations: dict[DiscreteState, Situation] = {}
        self.steps = 0

    def along(self, path: Iterable[Transition]) -> list[_Reached] | None:
        """The states of a path from the initial one on; None if it cannot be taken."""
        start, zones = symbolic.initial_situation(self.model)
        reached = [_Reached(start, zones)]
        for transition in path:
            following = self._after(reached[-1], transition)
            if following is None:
                return None
            reached.append(following)
        return reached

    def loops(self, start: _Reached, path: Sequence[Transition]) -> bool:
        """Whether the path can be taken again and again from there, each time in at least one time unit."""
        begun = self._widened(self._timed(start.here, start.zones))
        for zone in begun:
            state: _Reached | None = replace(start, zones=[zone])
            for transition in path:
                state = None if state is None else self._after(state, transition)
                if state is not None:
                    state = replace(state, zones=self._widened(state.zones))
            if state is None:
                continue
            later = (dbm.constrain(z, (0, self.spare, dbm.raw_bound(-1, False))) for z in state.zones)
            again = self._widened(self._timed(state.here, (z for z in later if z is not None)))
            if any(dbm.includes(other, zone) for other in again):
                return True
        return False

    def _timed(self, here: Situation, zones: Iterable[Zone]) -> Federation:
        """The valuations with the spare clock set to 0, and what follows by letting time pass."""
        return symbolic.elapse(here, [dbm.reset(zone, self.spare, 0) for zone in zones])

    def _widened(self, zones: Iterable[Zone]) -> Federation:
        return [wide for zone in zones for wide in widen(self.constants, zone)]

    def _after(self, state: _Reached, transition: Transition) -> _Reached | None:
        self.steps += 1
        if self.steps > MOST_STEPS:
            raise _OutOfSteps
        move = next((move for move in state.here.moves if move.transition == transition), None)
        fired = [] if move is None else symbolic.fire(state.here, state.zones, move)
        if move is None or move.target is None or not fired:
            return None
        if move.target not in self.situations:
            self.situations[move.target] = symbolic.situation(self.model, move.target)
        there = self.situations[move.target]
        return _Reached(there, symbolic.elapse(there, fired), move)


def _last_reset(reached: Sequence[_Reached], clock: int) -> int:
    """The number of the state from which on the clock is not set any more."""
    resets = (
        number
        for number, state in enumerate(reached)
        if state.move is not None and any(clock == each for each, _ in state.move.resets)
    )
    return max(resets, default=0)


def _with_a_clock(network: Network) -> Network:
    """The network with one more clock, behind all others."""
    clock = Variable("spare", ClockType(), VariableKind.LOCAL, (0,))
    idle = Process("", "", (Location("idle"),), (), variables=(clock,))
    return replace(network, processes=(*network.processes, idle))


def _number(model: PreparedNetwork, clock: Expression) -> int:
    """The number of a clock that does not depend on the state."""
    from tachk.model.evaluate import clock_number
    from tachk.semantics.discrete import environment, initial_discrete

    return clock_number(clock, environment(model, initial_discrete(model)))
