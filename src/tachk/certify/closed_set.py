"""The check that a set of symbolic states is closed, in plain Python, so that it can be read and believed.

The set is a list of elements (discrete state, zone). It is a proof that no reachable state satisfies a predicate if

1. some element contains the initial state and what it becomes by waiting,
2. of each element, every transition followed by any delay leads into elements of the discrete state reached,
3. no element has a valuation that satisfies the predicate, and nothing in one is a run-time error.

For ``A<>`` and ``-->`` elements have ranks (Wimmer, Herbreteau and van de Pol 2020). Each transition from a ranked
element leads to the goal or into elements of smaller ranks; time cannot pass for ever in it, and something stays
possible. So a run that begins in a ranked element meets the goal: it cannot descend for ever, and cannot end before.
For ``-->`` the elements of the rank 0 cover all reachable states, and ranked ones those where the goal is asked for.

By induction over the transitions every reachable state is then in some element (Wimmer and von Mutius 2020). Elements
may be larger than what is reachable, and how they were found does not matter. Zones are not extrapolated: successors
are those of `tachk.semantics.symbolic`, the meaning of the model, and nothing of an engine or a compiler is used.

All zones of one discrete state are worked on at once, as one array: entry ``[k, i, j]`` is the raw bound of zone k on
``x_i - x_j``, as in `tachk.semantics.dbm`. Where a state needs more than convex zones (priorities, clock guards on
urgent channels, stopped clocks, ``deadlock``) its zones are handed to the symbolic semantics one by one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import lru_cache

import numpy as np

from tachk.certify.certificate import Block, CertificateReader, MalformedCertificateError, Numbers
from tachk.model.connectives import negation
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.traversal import asks_deadlock
from tachk.records import dataclass
from tachk.semantics import dbm, symbolic
from tachk.semantics.avoidance import elapse_before
from tachk.semantics.constraints import TRUE, certain, compares_clocks, disjunctive
from tachk.semantics.dbm import (
    INFINITY,
    LESS_EQUAL_ZERO,
    Constraint,
    Federation,
    Zone,
    constrain_all,
    raw_bound,
    subtract_all,
    universe,
)
from tachk.semantics.discrete import (
    PreparedNetwork,
    environment,
    execute_updates,
    initial_discrete,
    is_urgent,
    may_delay,
    stopped_clocks,
)
from tachk.semantics.symbolic import intersections
from tachk.semantics.timed_trace import DiscreteState, Transition
from tachk.time_limit import check_time


@dataclass(frozen=True, slots=True)
class Objection:
    """Why a set is no proof.

    Attributes:
        discrete: the discrete state of the element that is wrong; None if the initial state is missing.
        zone: the number of its zone among those of the discrete state.
        transition: that leads out of the set, if one does.
    """

    reason: str
    discrete: DiscreteState | None = None
    zone: int = 0
    transition: Transition | None = None


_ANY_RANK = 1 << 62


class _Open(Exception):
    """The set is not closed: a reason and perhaps a transition."""


def check_closed(model: PreparedNetwork, predicate: Expression, certificate: CertificateReader) -> Objection | None:
    """What is wrong with a certificate that no reachable state satisfies the predicate; None if it is a proof.

    Raises MalformedCertificateError.
    """
    return _objection(_Check(model, certificate, bad=predicate))


def check_descent(
    model: PreparedNetwork, goal: Expression, begins: Expression | None, certificate: CertificateReader
) -> Objection | None:
    """What is wrong with a certificate that each run meets the goal: from the initial state, or from each reachable
    state that satisfies ``begins``; None if it is a proof.

    Raises MalformedCertificateError.
    """
    return _objection(_Check(model, certificate, goal=goal, begins=begins))


def _objection(check: _Check) -> Objection | None:
    if not check.contains_start():
        return Objection("the initial state is not in the set")
    for discrete, zones, ranks in check.elements():
        check_time()
        # Those of the rank 0 at once; if they are wrong, one by one, since each is checked by itself.
        try:
            if not ranks.any():
                check.state(discrete, zones, 0)
                continue
        except _Open:
            pass
        for number, rank in enumerate(ranks.tolist()):
            try:
                check.state(discrete, zones[number : number + 1], rank)
            except _Open as found:
                reason, *transition = found.args
                return Objection(reason, discrete, number, *transition)
    return None


class _Check:
    """A set with what it is about.

    Attributes:
        bad: what no element may satisfy.
        goal: what each run must meet; where it holds nothing is asked of ranked elements.
        begins: from where it must; None: from the initial state.
    """

    def __init__(
        self,
        model: PreparedNetwork,
        certificate: CertificateReader,
        bad: Expression | None = None,
        goal: Expression | None = None,
        begins: Expression | None = None,
    ) -> None:
        self.model = model
        self.bad = bad
        self.goal = goal
        self.begins = begins
        self.certificate = certificate
        predicates = [one for one in (bad, goal, begins) if one is not None]
        self.one_by_one = model.has_priorities or any(asks_deadlock(one) for one in predicates)
        self.one_by_one |= goal is not None and compares_clocks(goal)
        self.processes = len(model.network.processes)
        self.index: dict[tuple[bool, tuple[int, ...]], tuple[int, int]] = {}
        self.block = lru_cache(maxsize=64)(self._block)
        self._check_width()
        self.blocks = list(certificate.blocks())
        for number, block in enumerate(self.blocks):
            self._check_discretes(block)
            first = np.concatenate(([0], np.cumsum(block.zones)))
            for row, discrete in enumerate(map(tuple, block.discretes.tolist())):
                ranks = block.ranks[first[row] : first[row + 1]]
                key = bool(ranks.any()), discrete
                if key in self.index or (key[0] and not ranks.all()):
                    raise MalformedCertificateError("a discrete state occurs twice")
                self.index[key] = (number, row)

    def _check_width(self) -> None:
        header, layout = self.certificate.header, self.model.layout
        if header.width != self.processes + len(layout.initial) or len(header.clocks) != len(layout.clock_cells):
            raise MalformedCertificateError("it has other processes, variables or clocks than the model")

    def _check_discretes(self, block: Block) -> None:
        """Raises MalformedCertificateError for what is no discrete state of the model."""
        ranges = [(0, len(p.locations) - 1) for p in self.model.network.processes] + list(self.model.layout.ranges)
        low, high = np.array(ranges, np.int64).T
        if (block.discretes < low).any() or (block.discretes > high).any():
            raise MalformedCertificateError("a discrete state has a value out of its range")

    # ---- the elements ------------------------------------------------------------------------------------------------

    def _block(self, number: int) -> tuple[Numbers, Numbers, Numbers]:
        """The zones of a block, their ranks, and where those of each discrete state begin."""
        block = self.blocks[number]
        first = np.concatenate(([0], np.cumsum(block.zones)))
        return zones_of(block, self.model.dimension), block.ranks, first

    def elements(self) -> Iterator[tuple[DiscreteState, Numbers, Numbers]]:
        """Each discrete state with its zones and their ranks."""
        for key in self.index:
            _, numbers = key
            yield DiscreteState(numbers[: self.processes], numbers[self.processes :]), *self._at(key)

    def _at(self, key: tuple[bool, tuple[int, ...]]) -> tuple[Numbers, Numbers]:
        block, row = self.index[key]
        zones, ranks, first = self.block(block)
        return zones[first[row] : first[row + 1]], ranks[first[row] : first[row + 1]]

    def covers(self, discrete: DiscreteState, zones: Numbers, below: int) -> bool:
        """Whether each of the zones lies in one element, or else in several of them together.

        Args:
            below: 0: elements of the rank 0; else ranked ones with a smaller rank.
        """
        key = below > 0, discrete.locations + discrete.values
        if not len(zones):
            return True
        if key not in self.index:
            return False
        held, ranks = self._at(key)
        held = held[ranks < below] if below else held
        inside = np.all(zones[:, None] <= held[None], axis=(2, 3)).reshape(len(zones), len(held))
        rest = zones[~inside.any(axis=1)]
        return not len(rest) or (len(held) > 1 and not subtract_all(_zones(rest), _zones(held)))

    def contains_start(self) -> bool:
        rank = _ANY_RANK if self.goal is not None and self.begins is None else 0
        try:
            here = symbolic.situation(self.model, initial_discrete(self.model))
            start = intersections([dbm.origin(self.model.dimension)], [here.invariant] if here.invariant else [])
            return not start or self._is_awaited(here, start, rank)
        except (EvaluationFault, _Open):
            return False

    def _is_met(self, discrete: DiscreteState, rank: int) -> bool:
        """Whether nothing is asked of a ranked element, because it satisfies the goal. Raises EvaluationFault."""
        if rank == 0 or self.goal is None:
            return False
        return bool(disjunctive(self.goal, environment(self.model, discrete)))

    # ---- one discrete state ------------------------------------------------------------------------------------------

    def state(self, discrete: DiscreteState, zones: Numbers, rank: int) -> None:
        """Checks elements of one discrete state and one rank. Raises _Open."""
        model = self.model
        try:
            invariant = symbolic.invariant_constraints(model, discrete)
            if invariant is None:
                return None
            zones = constrain(zones, invariant)
            if self.one_by_one or stopped_clocks(model, discrete):
                return self._one_by_one(discrete, zones, rank)
            if self._is_met(discrete, rank):
                return None
            moves, faults = symbolic.guarded_transitions(model, discrete)
            urgent = [guard for transition, guard in moves if is_urgent(model, discrete, transition)]
            if any(guard != TRUE for guard in urgent):
                return self._one_by_one(discrete, zones, rank)
            if rank:
                self._check_ends(symbolic.situation(model, discrete), _zones(zones))
            elif self.begins is not None:
                self._check_beginnings(discrete, zones, invariant)
            self._check_predicate(discrete, zones)
            for asked, fault in faults:
                if any(len(constrain(zones, part)) for part in asked):
                    raise _Open(str(fault))
            for transition, guard in moves:
                for part in guard:
                    self._check_transition(discrete, transition, constrain(zones, part), rank)
        except EvaluationFault as fault:
            raise _Open(str(fault)) from None

    def _check_predicate(self, discrete: DiscreteState, zones: Numbers) -> None:
        if self.bad is None:
            return
        scratch = environment(self.model, discrete)
        try:
            bad = disjunctive(self.bad, scratch)
        except EvaluationFault:
            # Then the parts that can be evaluated have to deny it everywhere.
            bad = certain(self.bad, scratch)
            denied = certain(self.bad, scratch, negated=True)
            whole = universe(self.model.dimension)
            safe = [zone for part in denied if (zone := constrain_all(whole, part)) is not None]
            if subtract_all(_zones(zones), safe):
                raise _Open("in some state it cannot be evaluated whether it must not be reached") from None
        if any(len(constrain(zones, part)) for part in bad):
            raise _Open("some state of the zone is one that must not be reached")

    def _check_beginnings(self, discrete: DiscreteState, zones: Numbers, invariant: Iterable[Constraint]) -> None:
        """From where the goal must be met, and what that becomes by waiting, there are ranked elements."""
        assert self.begins is not None
        if self._is_met(discrete, _ANY_RANK):
            return
        for part in disjunctive(self.begins, environment(self.model, discrete)):
            begun = self._delayed(discrete, constrain(zones, part), invariant)
            if not self.covers(discrete, begun, _ANY_RANK):
                raise _Open("it is not shown that the goal is met from here")

    def _check_ends(self, here: symbolic.Situation, zones: Federation) -> None:
        """Time cannot pass for ever in ranked elements, and some transition stays possible."""
        goal = self._goal(here)
        running = [clock for clock in range(1, self.model.dimension) if clock not in here.stopped]
        for zone in self._waiting(here, subtract_all(zones, here.urgent)) if here.delays else []:
            if all(zone[clock, 0] >= INFINITY for clock in running):
                raise _Open("time can pass for ever, and the goal is not met")
        later = goal if here.stopped else symbolic.reaching(here, goal)
        if subtract_all(zones, [*here.alive, *later]):
            raise _Open("nothing can happen any more in some state, and the goal is not met")

    def _check_transition(self, discrete: DiscreteState, transition: Transition, zones: Numbers, rank: int) -> None:
        """Raises _Open if what a transition leads to from the zones, where its guard holds, is not in the set."""
        if not len(zones):
            return
        try:
            target, resets = execute_updates(self.model, discrete, transition)
            invariant = symbolic.invariant_constraints(self.model, target)
        except EvaluationFault as fault:
            raise _Open(str(fault), transition) from None
        if invariant is None or self._is_met(target, rank):
            return
        for clock, value in resets.items():
            zones = reset(zones, clock, value)
        zones = constrain(zones, invariant)
        if not self.covers(target, self._delayed(target, zones, invariant), rank):
            raise _Open("a successor is not in the set", transition)

    def _delayed(self, discrete: DiscreteState, zones: Numbers, invariant: Iterable[Constraint]) -> Numbers:
        """What is reached from the zones by waiting."""
        model = self.model
        if not len(zones) or not may_delay(model, discrete):
            return zones
        if stopped_clocks(model, discrete) or any(channel.urgent for channel, _ in model.channels):
            here = symbolic.situation(model, discrete)
            return _array(symbolic.elapse(here, _zones(zones)), model.dimension)
        waited = zones.copy()
        waited[:, 1:, 0] = INFINITY
        return constrain(waited, invariant)

    # ---- one zone after the other, by the symbolic semantics ---------------------------------------------------------

    def _one_by_one(self, discrete: DiscreteState, zones: Numbers, rank: int) -> None:
        here = symbolic.situation(self.model, discrete)
        parts = _zones(zones)
        if rank:
            parts = subtract_all(parts, self._goal(here))
            self._check_ends(here, parts)
        elif self.bad is not None and intersections(parts, self._perhaps(here, self.bad)):
            raise _Open("some state of the zone is one that must not be reached")
        elif self.begins is not None:
            begun = intersections(parts, self._perhaps(here, self.begins))
            if not self._is_awaited(here, begun, _ANY_RANK):
                raise _Open("it is not shown that the goal is met from here")
        for fault in here.faults:
            if intersections(parts, fault.domain):
                raise _Open(str(fault.fault))
        for move in here.moves:
            reached = symbolic.fire(here, parts, move)
            if reached and (move.target is None or move.fault is not None):
                raise _Open(str(move.fault), move.transition)
            if reached and move.target is not None:
                if not self._is_awaited(symbolic.situation(self.model, move.target), reached, rank):
                    raise _Open("a successor is not in the set", move.transition)

    def _is_awaited(self, there: symbolic.Situation, zones: Federation, below: int) -> bool:
        """Whether the set covers what zones become by waiting; below a rank, as far as the goal is not met before."""
        waited = self._waiting(there, zones) if below else symbolic.elapse(there, zones)
        return self.covers(there.discrete, _array(waited, self.model.dimension), below)

    def _waiting(self, here: symbolic.Situation, zones: Federation) -> Federation:
        """What is reached by waiting without the goal; more than that if clocks are stopped."""
        goal = self._goal(here)
        starts = subtract_all(zones, goal)
        return subtract_all(symbolic.elapse(here, starts), goal) if here.stopped else elapse_before(here, starts, goal)

    def _goal(self, here: symbolic.Situation) -> Federation:
        """Where nothing is asked of ranked elements; less, if clocks are stopped and it speaks of ``deadlock``."""
        if self.goal is None or (here.stopped and asks_deadlock(self.goal)):
            return []
        return symbolic.where(self.model, here, self.goal)

    def _perhaps(self, here: symbolic.Situation, predicate: Expression) -> Federation:
        """Where a predicate holds, or cannot be evaluated."""
        holds = symbolic.where(self.model, here, predicate)
        denied = symbolic.where(self.model, here, negation(predicate))
        return holds + subtract_all([here.invariant] if here.invariant else [], [*holds, *denied])


# ---- arrays of zones -------------------------------------------------------------------------------------------------


def zones_of(block: Block, dimension: int) -> Numbers:
    """The canonical zones of a block. Raises MalformedCertificateError if one is empty."""
    bounds = universes(len(block.constraints), dimension).reshape(-1, dimension * dimension)
    rows = np.repeat(np.arange(len(bounds)), block.constraints)
    np.minimum.at(bounds, (rows, block.places), block.bounds)
    zones = bounds.reshape(-1, dimension, dimension)
    for k in range(dimension):
        zones = np.minimum(zones, added(zones[:, :, k, None], zones[:, k, None, :]))
    if (np.einsum("kii->ki", zones) < LESS_EQUAL_ZERO).any():
        raise MalformedCertificateError("a zone is empty")
    return zones


def zone_at(certificate: CertificateReader, discrete: DiscreteState, number: int) -> Zone:
    """The zone of that number of a discrete state. Raises LookupError."""
    dimension = len(certificate.header.clocks) + 1
    for block in certificate.blocks():
        for row in np.flatnonzero((block.discretes == discrete.locations + discrete.values).all(axis=1)):
            return _zones(zones_of(block, dimension))[int(block.zones[:row].sum()) + number]
    raise LookupError("the certificate has no such state")


def universes(count: int, dimension: int) -> Numbers:
    """So many zones of all valuations without negative clocks."""
    zones = np.full((count, dimension, dimension), INFINITY, np.int64)
    zones[:, 0, :] = LESS_EQUAL_ZERO
    zones[:, np.arange(dimension), np.arange(dimension)] = LESS_EQUAL_ZERO
    return zones


def added(left: Numbers, right: Numbers) -> Numbers:
    """Sums of raw bounds."""
    sums = left + right - ((left | right) & 1)
    return np.where(sums > INFINITY // 2, INFINITY, sums)


def constrain(zones: Numbers, constraints: Iterable[Constraint]) -> Numbers:
    """The parts of the zones that satisfy all the constraints; zones of which nothing is left are left out."""
    for i, j, raw in constraints:
        if (zones[:, i, j] <= raw).all():
            continue
        bound = np.array(raw)
        zones = zones[added(zones[:, j, i], bound) >= LESS_EQUAL_ZERO]
        zones = np.minimum(zones, added(added(zones[:, :, i], bound)[:, :, None], zones[:, j, None, :]))
    return zones


def reset(zones: Numbers, clock: int, value: int) -> Numbers:
    result = zones.copy()
    result[:, clock, :] = added(zones[:, 0, :], np.array(raw_bound(value, False)))
    result[:, :, clock] = added(zones[:, :, 0], np.array(raw_bound(-value, False)))
    result[:, clock, clock] = LESS_EQUAL_ZERO
    return result


def _zones(zones: Numbers) -> list[Zone]:
    return [Zone(zone.shape[0], tuple(zone.ravel().tolist())) for zone in zones]


def _array(zones: Iterable[Zone], dimension: int) -> Numbers:
    return np.array([zone.bounds for zone in zones], np.int64).reshape(-1, dimension, dimension)
