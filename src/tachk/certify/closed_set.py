"""The check that a set of symbolic states is closed, in plain Python, so that it can be read and believed.

The set is a list of elements (discrete state, zone). It is a proof that no reachable state satisfies a predicate if

1. some element contains the initial state and what it becomes by waiting,
2. of each element, every transition followed by any delay leads into elements of the discrete state reached,
3. no element has a valuation that satisfies the predicate, and nothing in one is a run-time error.

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
from tachk.model.expressions import Deadlock, Expression
from tachk.model.fault import EvaluationFault
from tachk.model.traversal import walk
from tachk.records import dataclass
from tachk.semantics import symbolic
from tachk.semantics.constraints import TRUE, certain, disjunctive
from tachk.semantics.dbm import (
    INFINITY,
    LESS_EQUAL_ZERO,
    Constraint,
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
    is_urgent,
    may_delay,
    stopped_clocks,
)
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


class _Open(Exception):
    """The set is not closed: a reason and perhaps a transition."""


def check_closed(model: PreparedNetwork, predicate: Expression, certificate: CertificateReader) -> Objection | None:
    """What is wrong with a certificate that no reachable state satisfies the predicate; None if it is a proof.

    Raises MalformedCertificateError.
    """
    check = _Check(model, predicate, certificate)
    if not check.contains_start():
        return Objection("the initial state is not in the set")
    for discrete, zones in check.elements():
        check_time()
        try:
            check.state(discrete, zones)
        except _Open:
            return _objection(check, discrete, zones)
    return None


def _objection(check: _Check, discrete: DiscreteState, zones: Numbers) -> Objection:
    """The first zone of a discrete state that is wrong by itself, since each is checked by itself."""
    for number in range(len(zones)):
        try:
            check.state(discrete, zones[number : number + 1])
        except _Open as found:
            reason, *transition = found.args
            return Objection(reason, discrete, number, *transition)
    raise AssertionError("zones are wrong together that are right one by one")


class _Check:
    """A set with what it is about."""

    def __init__(self, model: PreparedNetwork, predicate: Expression, certificate: CertificateReader) -> None:
        self.model = model
        self.predicate = predicate
        self.certificate = certificate
        self.asks_deadlock = any(isinstance(part, Deadlock) for part in walk(predicate))
        self.processes = len(model.network.processes)
        self.index: dict[tuple[int, ...], tuple[int, int]] = {}
        self.block = lru_cache(maxsize=64)(self._block)
        self._check_width()
        for number, block in enumerate(certificate.blocks()):
            self._check_discretes(block)
            for row, discrete in enumerate(map(tuple, block.discretes.tolist())):
                if discrete in self.index:
                    raise MalformedCertificateError("a discrete state occurs twice")
                self.index[discrete] = (number, row)

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

    def _block(self, number: int) -> tuple[Numbers, Numbers]:
        """The zones of a block, and where those of each discrete state begin."""
        block = self.certificate.block(number)
        return zones_of(block, self.model.dimension), np.concatenate(([0], np.cumsum(block.zones)))

    def elements(self) -> Iterator[tuple[DiscreteState, Numbers]]:
        """Each discrete state with its zones."""
        for key in self.index:
            yield DiscreteState(key[: self.processes], key[self.processes :]), self.zones_at(key)

    def zones_at(self, key: tuple[int, ...]) -> Numbers:
        block, row = self.index[key]
        zones, first = self.block(block)
        return zones[first[row] : first[row + 1]]

    def covers(self, discrete: DiscreteState, zones: Numbers) -> bool:
        """Whether each of the zones lies in one element, or else in several of them together."""
        key = discrete.locations + discrete.values
        if not len(zones):
            return True
        if key not in self.index:
            return False
        held = self.zones_at(key)
        inside = np.all(zones[:, None] <= held[None], axis=(2, 3)).reshape(len(zones), len(held))
        rest = zones[~inside.any(axis=1)]
        return not len(rest) or (len(held) > 1 and not subtract_all(_zones(rest), _zones(held)))

    def contains_start(self) -> bool:
        try:
            start, zones = symbolic.initial_situation(self.model)
        except EvaluationFault:
            return False
        return self.covers(start.discrete, _array(zones, self.model.dimension))

    # ---- one discrete state ------------------------------------------------------------------------------------------

    def state(self, discrete: DiscreteState, zones: Numbers) -> None:
        """Checks the elements of a discrete state. Raises _Open."""
        model = self.model
        try:
            invariant = symbolic.invariant_constraints(model, discrete)
            if invariant is None:
                return None
            zones = constrain(zones, invariant)
            if model.has_priorities or self.asks_deadlock or stopped_clocks(model, discrete):
                return self._one_by_one(discrete, zones)
            moves, faults = symbolic.guarded_transitions(model, discrete)
            urgent = [guard for transition, guard in moves if is_urgent(model, discrete, transition)]
            if any(guard != TRUE for guard in urgent):
                return self._one_by_one(discrete, zones)
            self._check_predicate(discrete, zones)
            for asked, fault in faults:
                if any(len(constrain(zones, part)) for part in asked):
                    raise _Open(str(fault))
            for transition, guard in moves:
                for part in guard:
                    self._check_transition(discrete, transition, constrain(zones, part))
        except EvaluationFault as fault:
            raise _Open(str(fault)) from None

    def _check_predicate(self, discrete: DiscreteState, zones: Numbers) -> None:
        scratch = environment(self.model, discrete)
        try:
            bad = disjunctive(self.predicate, scratch)
        except EvaluationFault:
            # Then the parts that can be evaluated have to deny it everywhere.
            bad = certain(self.predicate, scratch)
            denied = certain(self.predicate, scratch, negated=True)
            whole = universe(self.model.dimension)
            safe = [zone for part in denied if (zone := constrain_all(whole, part)) is not None]
            if subtract_all(_zones(zones), safe):
                raise _Open("in some state it cannot be evaluated whether it must not be reached") from None
        if any(len(constrain(zones, part)) for part in bad):
            raise _Open("some state of the zone is one that must not be reached")

    def _check_transition(self, discrete: DiscreteState, transition: Transition, zones: Numbers) -> None:
        """Raises _Open if what a transition leads to from the zones, where its guard holds, is not in the set."""
        if not len(zones):
            return
        try:
            target, resets = execute_updates(self.model, discrete, transition)
            invariant = symbolic.invariant_constraints(self.model, target)
        except EvaluationFault as fault:
            raise _Open(str(fault), transition) from None
        if invariant is None:
            return
        for clock, value in resets.items():
            zones = reset(zones, clock, value)
        zones = constrain(zones, invariant)
        if not self.covers(target, self._delayed(target, zones, invariant)):
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

    def _one_by_one(self, discrete: DiscreteState, zones: Numbers) -> None:
        here = symbolic.situation(self.model, discrete)
        bad = symbolic.where(self.model, here, self.predicate)
        for zone in _zones(zones):
            if symbolic.intersections([zone], bad):
                raise _Open("some state of the zone is one that must not be reached")
            for fault in here.faults:
                if symbolic.intersections([zone], fault.domain):
                    raise _Open(str(fault.fault))
            for move in here.moves:
                reached = symbolic.fire(here, [zone], move)
                if move.target is None or move.fault is not None:
                    if reached:
                        raise _Open(str(move.fault), move.transition)
                    continue
                there = symbolic.situation(self.model, move.target)
                if not self.covers(move.target, _array(symbolic.elapse(there, reached), self.model.dimension)):
                    raise _Open("a successor is not in the set", move.transition)


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
