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

This module looks at one discrete state after the other, by the symbolic semantics. `tachk.certify.sweep` looks at all
of them together first, and settles nearly all of those without rank.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from tachk.certify.certificate import CertificateReader, MalformedCertificateError, starts
from tachk.certify.elements import read_elements
from tachk.certify.sweep import Sweep
from tachk.certify.zone_arrays import as_zones, zones_of
from tachk.model.connectives import negation
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.traversal import asks_deadlock
from tachk.records import dataclass
from tachk.semantics import dbm, symbolic
from tachk.semantics.avoidance import elapse_before
from tachk.semantics.dbm import INFINITY, Federation, Zone, subtract_all
from tachk.semantics.discrete import PreparedNetwork, initial_discrete
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
    for discrete, zones, ranks in check.doubtful():
        check_time()
        for number, (zone, rank) in enumerate(zip(zones, ranks, strict=True)):
            try:
                check.element(discrete, zone, rank)
            except EvaluationFault as fault:
                return Objection(str(fault), discrete, number)
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
        self.processes = len(model.network.processes)
        self.situation = lru_cache(maxsize=4096)(lambda discrete: symbolic.situation(model, discrete))
        self._check_width()
        self.sets = read_elements(model, certificate.header.width, certificate.columns())

    def _check_width(self) -> None:
        header, layout = self.certificate.header, self.model.layout
        if header.width != self.processes + len(layout.initial) or len(header.clocks) != len(layout.clock_cells):
            raise MalformedCertificateError("it has other processes, variables or clocks than the model")

    # ---- the elements ------------------------------------------------------------------------------------------------

    def doubtful(self) -> Iterator[tuple[DiscreteState, list[Zone], list[int]]]:
        """The discrete states that a look at all of them together has not settled, each with its zones and ranks."""
        avoided = [one for one in (self.bad, self.begins) if one is not None]
        stops = any(location.rates for process in self.model.network.processes for location in process.locations)
        for ranked, elements in enumerate(self.sets):
            rows = list(range(len(elements.states)))
            if not stops and not ranked and len(rows):
                rows = np.flatnonzero(~Sweep(self.model, avoided, elements).fine).tolist()
            for row in rows:
                numbers = elements.states[row].tolist()
                mine = slice(elements.first[row], elements.first[row + 1])
                discrete = DiscreteState(tuple(numbers[: self.processes]), tuple(numbers[self.processes :]))
                yield discrete, as_zones(elements.zones[elements.shapes[mine]]), elements.ranks[mine].tolist()

    def covers(self, discrete: DiscreteState, zones: Federation, below: int) -> bool:
        """Whether each of the zones lies in one element, or else in several of them together.

        Args:
            below: 0: elements of the rank 0; else ranked ones with a smaller rank.
        """
        elements = self.sets[below > 0]
        row = int(elements.find(np.array([discrete.locations + discrete.values], np.int64))[0])
        if row < 0:
            return not zones
        mine = slice(elements.first[row], elements.first[row + 1])
        counts = elements.ranks[mine] < below if below else slice(None)
        held = as_zones(elements.zones[elements.shapes[mine][counts]])
        rest = [zone for zone in zones if not any(dbm.includes(one, zone) for one in held)]
        return not rest or (len(held) > 1 and not subtract_all(rest, held))

    def contains_start(self) -> bool:
        rank = _ANY_RANK if self.goal is not None and self.begins is None else 0
        try:
            here = symbolic.situation(self.model, initial_discrete(self.model))
            start = intersections([dbm.origin(self.model.dimension)], [here.invariant] if here.invariant else [])
            return not start or self._is_awaited(here, start, rank)
        except (EvaluationFault, _Open):
            return False

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

    def element(self, discrete: DiscreteState, zone: Zone, rank: int) -> None:
        """Raises _Open, and EvaluationFault for invariants that go wrong."""
        here = self.situation(discrete)
        parts = intersections([zone], [here.invariant] if here.invariant else [])
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
                if not self._is_awaited(self.situation(move.target), reached, rank):
                    raise _Open("a successor is not in the set", move.transition)

    def _is_awaited(self, there: symbolic.Situation, zones: Federation, below: int) -> bool:
        """Whether the set covers what zones become by waiting; below a rank, as far as the goal is not met before."""
        waited = self._waiting(there, zones) if below else symbolic.elapse(there, zones)
        return self.covers(there.discrete, waited, below)

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


def zone_at(certificate: CertificateReader, discrete: DiscreteState, number: int) -> Zone:
    """The zone of that number of a discrete state. Raises LookupError."""
    dimension = len(certificate.header.clocks) + 1
    for block in certificate.blocks():
        for row in np.flatnonzero((block.discretes == discrete.locations + discrete.values).all(axis=1)):
            zone, first = int(block.zones[:row].sum()) + number, starts(block.constraints)
            mine = slice(first[zone], first[zone + 1])
            constraints = block.constraints[zone : zone + 1]
            return as_zones(zones_of(constraints, block.places[mine], block.bounds[mine], dimension))[0]
    raise LookupError("the certificate has no such state")
