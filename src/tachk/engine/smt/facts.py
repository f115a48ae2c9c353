"""Sets of zones that a run may be in, as hypotheses of an induction: z3 proves them, so they may come from anywhere.

They are explored by the plain Python of `tachk.meaning`, and stand and fall with the encoding, which knows no zones.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping, Sequence

import z3

from tachk.base.job import check_job
from tachk.engine.smt.frame import StateFrame
from tachk.engine.smt.relation import TransitionRelation
from tachk.engine.smt.terms import Formula, all_of, any_of, conj
from tachk.meaning import dbm, symbolic
from tachk.meaning.clock_constants import clock_constants
from tachk.meaning.dbm import INFINITY, Constraint, Zone, bound_value, is_strict
from tachk.meaning.discrete import prepare
from tachk.meaning.extrapolation import widen
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.run import DiscreteState

ZONES = 4000
"""So many are explored at most."""


def known_zones(network: Network, goals: Sequence[Expression], limit: int = ZONES) -> dict[DiscreteState, list[Zone]]:
    """The zones of all runs, widened so that there are finitely many; only some if there are more than the limit.

    Empty where something goes wrong, or where clocks are compared in a way that zones do not know.
    """
    model = prepare(network)
    passed: dict[DiscreteState, list[Zone]] = {}
    situations: dict[DiscreteState, symbolic.Situation] = {}
    waiting: deque[tuple[DiscreteState, Zone]] = deque()
    explored = 0

    def add(discrete: DiscreteState, zones: Sequence[Zone]) -> None:
        for zone in (wide for each in zones for wide in widen(constants, each)):
            known = passed.setdefault(discrete, [])
            if not any(dbm.includes(other, zone) for other in known):
                passed[discrete] = [*(other for other in known if not dbm.includes(zone, other)), zone]
                waiting.append((discrete, zone))

    try:
        constants = clock_constants(network, goals)
        start, zones = symbolic.initial_situation(model)
        situations[start.discrete] = start
        add(start.discrete, zones)
        while waiting and explored < limit:
            check_job()
            discrete, zone = waiting.popleft()
            if not any(zone is other for other in passed[discrete]):
                continue  # a larger one has come
            explored += 1
            here = situations[discrete]
            for move in here.moves:
                fired = symbolic.fire(here, [zone], move)
                if not fired or move.target is None:
                    continue
                if move.target not in situations:
                    situations[move.target] = symbolic.situation(model, move.target)
                add(move.target, symbolic.elapse(situations[move.target], fired))
    except (EvaluationFault, ValueError):
        return {}
    return passed


class ZonesAt:
    """Sets of zones as formulas about one frame, at the end of its delay."""

    def __init__(self, encoded: TransitionRelation, frame: StateFrame) -> None:
        self._encoded = encoded
        self._frame = frame
        self._known: dict[Constraint, Formula] = {}

    def inside(self, zones: Mapping[DiscreteState, Sequence[Zone]]) -> Formula:
        """The formula that the frame is in one of the zones."""
        return any_of(conj(self.is_state(state), self.in_some(of_state)) for state, of_state in zones.items())

    def is_state(self, discrete: DiscreteState) -> Formula:
        numbers = (*self._frame.locations, *self._frame.slots)
        values = (*discrete.locations, *discrete.values)
        return all_of(number.is_value(value) for number, value in zip(numbers, values, strict=True))

    def in_some(self, zones: Iterable[Zone]) -> Formula:
        return any_of(all_of(map(self._met, _relevant(zone))) for zone in zones)

    def _met(self, constraint: Constraint) -> Formula:
        if constraint not in self._known:
            i, j, raw = constraint
            difference = z3.simplify(self._encoded.clock(i) - self._encoded.clock(j))
            value = bound_value(raw)
            met = difference < value if is_strict(raw) else difference <= value
            self._known[constraint] = self._encoded.at(met, self._frame)
        return self._known[constraint]


def _relevant(zone: Zone) -> list[Constraint]:
    """Constraints of a zone from which the others follow, as far as a look at every third clock shows it."""
    size = range(zone.dimension)
    bounds = {(i, j): raw for i, j, raw in zone.constraints() if i != j and raw < INFINITY}
    for i, j in list(bounds):
        if any(
            (i, k) in bounds and (k, j) in bounds and _sum(bounds[i, k], bounds[k, j]) <= bounds[i, j] for k in size
        ):
            del bounds[i, j]
    return [(i, j, raw) for (i, j), raw in bounds.items()]


def _sum(left: int, right: int) -> int:
    return left + right - ((left | right) & 1)
