"""The check that a set of symbolic states is closed, in plain Python, so that it can be read and believed.

The set is a list of elements: a discrete state, a zone and a rank. It is a proof if

1. elements of the rank 0 contain the initial state and what it becomes by waiting,
2. of each of them, every transition followed by any delay leads into elements of the rank 0,
3. each state of them that satisfies a predicate is, with what it becomes by waiting, in ranked elements,
4. of each ranked element, every transition followed by any delay leads to the goal or into elements of smaller ranks,
5. in no ranked element can time pass for ever, and some transition stays possible,
6. nothing in an element is a run-time error.

A state need not be in an element if no run from it can meet the predicate or a run-time error: that is so if it lies in
one trap of each clause (`tachk.meaning.judge.trap_proof`).

By induction over the transitions every reachable state is then in some element of the rank 0, or comes after such a
state (Wimmer and von Mutius 2020), and a run that begins in a ranked element meets the goal: it cannot descend for
ever, and cannot end before (Wimmer, Herbreteau and van de Pol 2020). Without a goal nothing can be ranked, and the
predicate is never met. If no predicate is given, the initial state must be ranked. Elements may be larger than what is
reachable, and how they were found does not matter. All are looked at together, without extrapolation, and nothing of an
engine or compiler is used.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tachk.base.records import replace
from tachk.meaning.dbm import INFINITY, LESS_EQUAL_ZERO
from tachk.meaning.discrete import PreparedNetwork, initial_discrete
from tachk.meaning.judge import zone_arrays
from tachk.meaning.judge.arrangements import uncovered
from tachk.meaning.judge.certificate import CertificateReader, MalformedCertificateError, Numbers, Objection
from tachk.meaning.judge.trap import Trap
from tachk.meaning.judge.zone_arrays import Pieces, Truths, inside, joined, outside, released
from tachk.meaning.many_states import ManyStates, MoveOfManyStates
from tachk.model.expressions import Expression
from tachk.model.run import DiscreteState, Transition
from tachk.model.traversal import asks_deadlock


class ClosedSet:
    """A certificate that each run meets the goal (None: nothing does) from each reachable state on that satisfies
    ``begins``, or (None) from the initial state. Nothing need be said of a state that lies in one trap of each of the
    clauses, if there are any; it has to be proved before that they are traps. Raises MalformedCertificateError.

    Discrete states are those of the set, and others that are reached; their mark is whether elements are ranked.

    Attributes:
        sources: the elements, as far as the invariants allow them and without the goal.
        goals, ahead: where the goal is met, and what is there or later.
        domains: where the moves are possible; the origin is the number of the move.
        alive, perhaps_alive: from where a move is possible now or later, for certain or perhaps.
    """

    def __init__(
        self,
        model: PreparedNetwork,
        certificate: CertificateReader,
        goal: Expression | None,
        begins: Expression | None,
        clauses: Sequence[Sequence[Trap]] = (),
    ) -> None:
        self.model, self.goal, self.begins, self.clauses = model, goal, begins, clauses
        self.groups = certificate.header.groups
        self.found: tuple[int, Objection] | None = None
        self.asks_deadlock = any(asks_deadlock(one) for one in (goal, begins) if one is not None)
        self.states = ManyStates(model)
        self._read(certificate)
        initial = initial_discrete(model)
        self.start = self.states.numbers(np.array([[*initial.locations, *initial.values, begins is None]]))
        self._find_moves()
        self._find_pieces()

    def _read(self, certificate: CertificateReader) -> None:
        header, layout, dimension = certificate.header, self.model.layout, self.model.dimension
        if header.width != self.states.width or len(header.clocks) != len(layout.clock_slots):
            raise MalformedCertificateError("it has other processes, variables or clocks than the model")
        none = np.zeros(0, np.int64)
        parts = [(np.zeros((0, dimension, dimension), np.int64), none, none, none)]
        for block in certificate.columns():
            discretes = np.repeat(block.discretes(header.width), block.zones, axis=0)
            states = np.column_stack((discretes, (block.ranks > 0).astype(np.int32)))
            if (states < self.states.low).any() or (states > self.states.high).any():
                raise MalformedCertificateError("a discrete state has a value out of its range")
            table = zone_arrays.canonical(block.matrices(dimension))
            if (table[:, np.arange(dimension), np.arange(dimension)] < LESS_EQUAL_ZERO).any():
                raise MalformedCertificateError("a zone is empty")
            parts.append((table, block.shapes, self.states.numbers(states), block.ranks))
        table, shapes, rows, ranks = (np.concatenate(column) for column in zip(*parts, strict=True))
        elements = joined([Pieces(table, shapes, rows, np.arange(len(rows)))])
        self.elements, self.ranks = replace(elements, origin=np.arange(len(rows))), ranks[elements.origin]

    def _find_moves(self) -> None:
        """The transitions that are possible in the states of the set, and as far as it matters in reached ones."""
        states = self.states
        states.explore(states.settle())
        self.mirrored = np.full(len(states.states), -1)
        if self.begins is not None and self.goal is not None:
            for dead in (True, False):
                for rows, _ in states.truth(np.flatnonzero(~states.marked), self.begins, dead, widely=True):
                    self.mirrored[rows] = states.numbers(np.insert(states.states[rows, :-1], states.width, 1, axis=1))
        reached = states.settle()
        # Whether time may pass in a state that exchanges lead into the set depends on the moves there.
        exchanged = bool(self.groups) and any(type_.urgent for type_, _ in self.model.channels)
        states.explore(reached if self.asks_deadlock or exchanged else reached[:0])
        states.settle()
        self.invalid = np.isin(np.arange(len(states.states)), states.invalid)
        self.bounds = np.array([zone_arrays.bounds_of(each, self.model.dimension) for each in states.invariants])
        self.stops = states.waits & states.stands[:, 1:].any(axis=1)
        self.stands, pace = np.unique(states.stands | ~states.waits[:, None], axis=0, return_inverse=True)
        self.pace, self.passing = pace.ravel(), ~self.stands[:, :, None] & self.stands[:, None, :]

    def _find_pieces(self) -> None:
        none = self._anything(np.zeros(0, np.int64))
        self.goals = self.ahead = none
        needed = self.goal is not None or self.asks_deadlock or self.model.has_priorities
        self.domains = joined([none, *(self._domain(n) for n in range(len(self.states.moves)) if needed)])
        doubtful = self.invalid.copy()
        for move in self.states.moves:
            doubtful[move.rows[self.invalid[move.targets]] if move.fault is None else move.rows] = True
        self.alive = self._past(self.domains.take(~doubtful[self.domains.row]))
        wholly = np.union1d(np.flatnonzero(doubtful), self.domains.row[self.stops[self.domains.row]])
        self.perhaps_alive = joined([self.alive, self._anything(wholly)])
        if self.goal is not None:
            ranked = self._limited(self._anything(np.flatnonzero(self.states.marked)))
            self.goals = self._where(ranked, self.goal, False)
            moving = ~self.stops[self.goals.row]
            future = self.goals.take(moving).become(released, self.passing, self.pace[self.goals.row[moving]])
            self.ahead = joined([future, self.goals.take(~moving)])
        self.sources = joined([self._limited(self.elements).without(self.goals)])

    def objection(self) -> Objection | None:
        """The objection to the proof; None if it is one."""
        values = np.array([0, *self.model.layout.starts], dtype=np.int64)
        zone = 2 * (values[:, None] - values)[None] + LESS_EQUAL_ZERO
        start = self._limited(Pieces(zone, self.start * 0, self.start, self.start * 0))
        if self.invalid[self.start].any() or len(self._uncovered(start, self.begins is None).row):
            return Objection("the initial state is not in the set")
        self._object(self.elements.take(self.invalid[self.elements.row]), "it cannot be said what the state allows")
        if self.begins is not None:
            met = self._where(self.sources.take(~self.states.marked[self.sources.row]), self.begins, True)
            if self.goal is None:
                self._object(met, "some state of the zone is one that must not be reached")
            else:
                awaited = self._uncovered(replace(met, row=self.mirrored[met.row]), True)
                self._object(awaited, "it is not shown that the goal is met from here")
        self._check_ends(self.sources.take(self.states.marked[self.sources.row]))
        for move in self.states.moves:
            self._check_move(move)
        return self.found and self.found[1]

    def _object(self, wrong: Pieces, reason: str, transition: Transition | None = None) -> None:
        """Notes the first discrete state of which there is something wrong, and what was found first there."""
        if len(wrong.row):
            place = int(wrong.origin.min())
            row = int(self.elements.row[place])
            if self.found is None or row < self.found[0]:
                numbers, processes = self.states.states[row, :-1].tolist(), self.states.processes
                discrete = DiscreteState(tuple(numbers[:processes]), tuple(numbers[processes:]))
                first = int(np.searchsorted(self.elements.row, row))
                self.found = row, Objection(reason, discrete, place - first, transition)

    def _check_ends(self, pieces: Pieces) -> None:
        """Time cannot pass for ever in ranked elements, and some transition stays possible."""
        reached = self._waiting(pieces)
        unbounded = reached.table[reached.zone][:, :, 0] >= INFINITY
        endless = self.states.waits[reached.row] & (self.stands[self.pace[reached.row]] | unbounded).all(axis=1)
        self._object(reached.take(endless), "time can pass for ever, and the goal is not met")
        dead = pieces.without(self.alive).without(self._past(self.goals))
        self._object(dead, "nothing can happen any more in some state, and the goal is not met")

    def _check_move(self, move: MoveOfManyStates) -> None:
        """Checks that the successor is in the set and is not a run-time error."""
        for constraints in move.guard:
            pieces = self.sources.at(move.rows).within(constraints)
            if move.fault is not None:
                self._object(pieces, str(move.fault))
                continue
            if self.model.has_priorities:
                higher = np.array([other.priority > move.priority for other in self.states.moves])
                pieces = pieces.without(self.domains.take(higher[self.domains.origin]))
            pieces = pieces.assign(move.resets)
            target = move.targets[np.searchsorted(move.rows, pieces.row)]
            uncovered = self._uncovered(self._limited(replace(pieces, row=target)))
            self._object(uncovered, "a successor is not in the set", move.transition)

    def _uncovered(self, pieces: Pieces, begins: bool = False) -> Pieces:
        """The parts of the pieces after a delay that the set does not cover. They begin with any rank, or else come
        from an element and must be in elements of smaller ranks; those from the rank 0 must be in elements of the rank
        0."""

        def without(pieces: Pieces, origin: Numbers) -> Pieces:
            def counts(other: Numbers, place: Numbers) -> Truths:
                smaller: Truths = self.ranks[other] < np.maximum(self.ranks[origin[place]], 1)
                return smaller

            goal_rows = None if begins or self.goal is None else counts
            return pieces.beyond(self.elements, goal_rows).without(self.elements, goal_rows)

        there = (pieces.row >= 0) & ~self.invalid[pieces.row]
        waited = self._waiting(pieces.take(there))
        if self.groups:
            states = self.states.states[waited.row].astype(np.int64)
            left = uncovered(self.groups, states, waited, self.states.known, without)
        else:
            left = without(waited, np.arange(len(self.elements.row)))
        return joined([self._not_lost(left) if self.clauses else left, pieces.take(~there)])

    def _not_lost(self, pieces: Pieces) -> Pieces:
        """The pieces of which some state lies outside of all traps of a clause."""
        numbered = replace(pieces, origin=np.arange(len(pieces.row)))
        found = np.zeros(len(pieces.row), bool)
        for clause in self.clauses:
            some = numbered.take(~found)
            for trap in clause:  # most lie in one of them
                some = some.take(np.isin(some.origin, self._outside(some, [trap])))
            found[self._outside(some, clause)] = True
        return pieces.take(found)

    def _outside(self, pieces: Pieces, traps: Sequence[Trap]) -> Numbers:
        """The origins of the pieces of which some state lies outside of all of the traps."""
        if not traps or not len(pieces.row):
            return np.unique(pieces.origin)
        found, values = pieces.origin[:0], self.states.states[pieces.row, traps[0].slot]
        for value in np.unique(values).tolist():
            for interval in traps[0].outside_at(value):
                some = pieces.take((values == value) & ~np.isin(pieces.origin, found))
                found = np.union1d(found, self._outside(some.within(traps[0].constraints(interval)), traps[1:]))
        return found

    def _limited(self, pieces: Pieces) -> Pieces:
        """The parts that the invariants allow."""
        return pieces.become(inside, self.bounds, self.states.limits[pieces.row])

    def _anything(self, rows: Numbers) -> Pieces:
        everywhere = zone_arrays.canonical(zone_arrays.bounds_of((), self.model.dimension)[None])
        return Pieces(everywhere, rows * 0, rows, rows * 0)

    def _waiting(self, pieces: Pieces, behind: int = 0) -> Pieces:
        """The pieces after a delay that avoids the goal. The first ``behind`` zones of the goal in each discrete state
        are done: a piece that begins behind a zone is not hindered by it, and any other must stay before it. Where
        clocks are stopped the result is larger."""
        pieces = pieces if behind else pieces.without(self.goals)
        goal = np.searchsorted(self.ahead.row, pieces.row) + behind
        some = goal < np.searchsorted(self.ahead.row, pieces.row, "right")
        free, starts, zone = pieces.take(~some), pieces.take(some), self.ahead.zone[goal[some]]
        reached = self._limited(free.become(released, self.passing, self.pace[free.row]))
        if not some.any():
            return reached
        after = self._waiting(starts.become(inside, self.ahead.table, zone), behind + 1)
        before = self._waiting(starts.become(outside, self.ahead.table, zone), behind + 1)
        zone = self.ahead.zone[np.searchsorted(self.ahead.row, before.row) + behind]
        return joined([reached, after, before.become(outside, self.ahead.table, zone)])

    def _past(self, pieces: Pieces) -> Pieces:
        """From where they are reached by waiting; where clocks are stopped it is perhaps less."""
        runs = self.states.waits[pieces.row] & ~self.stops[pieces.row]
        lower = np.zeros((1, self.model.dimension, self.model.dimension), bool)
        lower[0, 0, 1:] = True
        return joined([pieces.take(runs).become(released, lower), pieces.take(~runs)])

    def _domain(self, number: int) -> Pieces:
        """The pieces in which a move is possible."""
        move = self.states.moves[number]
        rows, targets = move.rows[: len(move.targets)], move.targets
        pieces = replace(self._anything(rows), origin=rows * 0 + number)
        limits = zone_arrays.before_assigning(move.resets, self.bounds)
        pieces = pieces.become(inside, limits, self.states.limits[targets])
        return joined([self._limited(pieces.within(each)) for each in move.guard])

    def _where(self, pieces: Pieces, predicate: Expression, widely: bool) -> Pieces:
        """The parts where a predicate holds for certain, or (widely) where it may hold."""
        alive, dead = (self.perhaps_alive, self.alive) if widely else (self.alive, self.perhaps_alive)
        parts = [pieces.take(slice(0))]
        for is_dead in (True, False) if asks_deadlock(predicate) else (True,):
            for rows, condition in self.states.truth(np.unique(pieces.row), predicate, is_dead, widely):
                some = pieces.at(rows)
                if asks_deadlock(predicate):
                    some = some.without(dead) if is_dead else some.meeting(alive)
                parts += [some.within(constraints) for constraints in condition]
        return joined(parts)
