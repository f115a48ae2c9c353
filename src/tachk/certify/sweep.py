"""A quick way through most of a certificate: the elements of the rank 0 of all discrete states together.

What is found in order here need not be looked at again. What is out of the ordinary is left to whoever looks at one
discrete state after the other (`tachk.certify.closed_set`): urgent channels under a clock guard, run-time errors, and
all that seems wrong.

The rules are those of `tachk.semantics`, written for sets of discrete states, which are rows of an array: locations,
then cells. An expression is evaluated by the reference evaluator, once for all rows that agree in what it reads.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from tachk.certify.certificate import Numbers, ragged
from tachk.certify.elements import Elements, States
from tachk.certify.zone_arrays import including, reached_from, upper_bounds, within
from tachk.model.evaluate import Environment, execute
from tachk.model.expressions import Binary, Expression, Unary
from tachk.model.fault import EvaluationFault
from tachk.model.traversal import asks_deadlock
from tachk.operators import BinaryOperator, UnaryOperator
from tachk.semantics.constraints import (
    TRUE,
    Conjunction,
    Disjunction,
    conditional_constraints,
    conjunction,
    disjunctive,
)
from tachk.semantics.dbm import complement, constrain_all, down, intersect, undo_reset, universe
from tachk.semantics.discrete import PreparedNetwork, bind_selects, channel_named, may_hear
from tachk.semantics.timed_trace import Participant
from tachk.time_limit import check_time
from tachk.words import Direction

T = TypeVar("T")
Truths = NDArray[np.bool_]
Resets = tuple[tuple[int, int], ...]
Pieces = dict[Resets, tuple[Numbers, States]]
"""Rows with what has become of their discrete states, by what clocks have been set to."""
_MISSING, _FAULTY = -1, -2
"""In place of the number of a row, or of an invariant."""


class Watched(list[int]):
    """A part of a row that notes which of its numbers are read before they are written, and which are written."""

    def __init__(self, numbers: list[int], first: int, read: set[int]) -> None:
        super().__init__(numbers)
        self.first, self.read, self.written = first, read, set[int]()

    def _positions(self, key: int | slice) -> Iterable[int]:
        return range(*key.indices(len(self))) if isinstance(key, slice) else (key,)

    def __getitem__(self, key):  # type: ignore[no-untyped-def]
        self.read.update(self.first + n for n in self._positions(key) if n not in self.written)
        return super().__getitem__(key)

    def __iter__(self) -> Iterator[int]:
        return (self[n] for n in range(len(self)))

    def __setitem__(self, key, value) -> None:  # type: ignore[no-untyped-def]
        self.written.update(self._positions(key))
        super().__setitem__(key, value)


class Sweep:
    """Attributes:
    fine: of each discrete state whether nothing is wrong with its elements.
    """

    def __init__(self, model: PreparedNetwork, avoided: Iterable[Expression], elements: Elements) -> None:
        self.model, self.elements, self.zones = model, elements, elements.zones
        self.states, self.shapes, self.first = elements.states, elements.shapes, elements.first
        self.counts = np.diff(self.first)
        self.processes = len(model.network.processes)
        self.fine = np.ones(len(self.states), bool)
        self.conjunctions: dict[Conjunction, int] = {}
        self.bounds = upper_bounds((), model.dimension)
        self.hearing: dict[int, list[tuple[int, list[tuple[int, list[Participant]]]]]] = {}
        self._note_locations()
        self.limits = self._limits(self.states)
        self.fine[self.limits == _FAULTY] = False
        self._cut_elements()
        self.alive = np.zeros(len(self.shapes), bool)
        parts = [part for predicate in avoided for part in alternatives(predicate)]
        self.asks_deadlock = any(asks_deadlock(part) for part, _ in parts)
        for part, negated in parts:
            self._look_for(part, negated, dead=False)
        for rows, participants, guard in list(self._transitions()):
            check_time()
            self._follow(rows, participants, guard)
        for part, negated in parts if self.asks_deadlock else ():
            self._look_for(part, negated, dead=True)

    # ---- discrete states ---------------------------------------------------------------------------------------------

    def _by_reads(
        self, states: Numbers, rows: Numbers, evaluate: Callable[[Environment], T]
    ) -> Iterator[tuple[Numbers, T | None]]:
        """The rows in groups that agree in what the evaluation reads, with what it gives; None for a run-time error."""
        waiting: list[tuple[Numbers, list[int]]] = [(rows, [])]
        while waiting:
            rows, columns = waiting.pop()
            for group in groups_of(states[np.ix_(rows, np.array(columns, np.int64))]) if len(rows) else ():
                row = states[rows[group[0]]].tolist()
                read: set[int] = set()
                cells = Watched(row[self.processes :], self.processes, read)
                scratch = Environment(self.model.layout, cells, Watched(row[: self.processes], 0, read))
                try:
                    result = evaluate(scratch)
                except EvaluationFault:
                    result = None
                if read <= set(columns):
                    yield rows[group], result
                else:
                    waiting.append((rows[group], sorted(read.union(columns))))

    def _note_locations(self) -> None:
        """Where time may pass, as far as locations say, and which processes are in committed ones."""
        self.committed = np.zeros((len(self.states), self.processes), bool)
        self.waits: Truths = np.ones(len(self.states), bool)
        for p, process in enumerate(self.model.network.processes):
            committed = np.array([location.committed for location in process.locations])
            urgent = np.array([location.urgent for location in process.locations])
            self.committed[:, p] = committed[self.states[:, p]]
            self.waits &= ~(committed | urgent)[self.states[:, p]]
        self.free = np.count_nonzero(self.committed, axis=1) == 0

    def _limits(self, states: Numbers) -> Numbers:
        """Of each discrete state the number of its invariant; _MISSING if no clocks can satisfy it."""
        found = np.full(len(states), self._number(()), np.int64)
        for p, process in enumerate(self.model.network.processes):
            for number, location in enumerate(process.locations):
                if location.invariant is None:
                    continue
                rows = np.flatnonzero((states[:, p] == number) & (found >= 0))
                for part, parts in list(
                    self._by_reads(states, rows, lambda s, i=location.invariant: conditional_constraints(i, s))  # type: ignore[misc]
                ):
                    if parts is None or len(parts) > 1:
                        found[part] = _FAULTY
                    elif not parts:
                        found[part] = _MISSING
                    else:
                        before, inverse = np.unique(found[part], return_inverse=True)
                        known = list(self.conjunctions)
                        found[part] = np.array([self._number(known[n] + parts[0]) for n in before.tolist()])[inverse]
        return found

    def _number(self, constraints: Conjunction) -> int:
        return self.conjunctions.setdefault(tuple(sorted(set(constraints))), len(self.conjunctions))

    # ---- transitions -------------------------------------------------------------------------------------------------

    def _transitions(self) -> Iterator[tuple[Numbers, tuple[Participant, ...], Disjunction]]:
        """Which participants can take part together in which rows, with the clock constraints of their guards."""
        for rows, participant in self._initiators():
            for part, guard, channel in self._offers(rows, participant):
                if channel is None:
                    yield part, (participant,), guard
                    continue
                type_ = self.model.channels[channel][0]
                join = self._receivers if type_.broadcast else self._partners
                for joint in join(part, 0, channel, (participant,), guard):
                    if type_.urgent:
                        self._forbid_waiting(joint[0], joint[2])
                    yield joint

    def _initiators(self) -> Iterator[tuple[Numbers, Participant]]:
        for p, by_location in enumerate(self.model.instances):
            for location, participants in enumerate(by_location):
                here = np.flatnonzero((self.states[:, p] == location) & (self.limits >= 0))
                for participant in participants if len(here) else ():
                    synchronisation = self.model.edge(participant).synchronisation
                    if synchronisation is None:
                        yield here[self.free[here] | self.committed[here, p]], participant
                    elif synchronisation.direction is Direction.SEND:
                        yield here, participant

    def _forbid_waiting(self, rows: Numbers, guard: Disjunction) -> None:
        if guard == TRUE:
            self.waits[rows] = False
        else:
            self.fine[rows] = False

    def _offers(self, rows: Numbers, participant: Participant) -> Iterator[tuple[Numbers, Disjunction, int | None]]:
        """The rows in which the guard of an edge holds for some clocks, with its constraints and the channel named."""

        def offer(scratch: Environment) -> tuple[Disjunction, int | None]:
            bind_selects(self.model, participant, scratch)
            guard = conditional_constraints(self.model.edge(participant).guard, scratch)
            return guard, channel_named(self.model, participant, scratch) if guard else None

        for part, found in self._by_reads(self.states, rows, offer):
            if found is None:
                self.fine[part] = False
            elif found[0]:
                yield part, *found

    def _hearing(self, channel: int) -> list[tuple[int, list[tuple[int, list[Participant]]]]]:
        """The processes that may hear a channel, with the locations where they do and the edges."""
        if channel not in self.hearing:
            of_processes = [
                (
                    q,
                    [
                        (location, hearing)
                        for location, participants in enumerate(by_location)
                        if (hearing := [p for p in participants if may_hear(self.model, p, channel)])
                    ],
                )
                for q, by_location in enumerate(self.model.instances)
            ]
            self.hearing[channel] = [of_process for of_process in of_processes if of_process[1]]
        return self.hearing[channel]

    def _partners(
        self, rows: Numbers, _: int, channel: int, sender: tuple[Participant, ...], guard: Disjunction
    ) -> Iterator[tuple[Numbers, tuple[Participant, ...], Disjunction]]:
        p = sender[0].process
        for q, by_location in self._hearing(channel):
            free = rows[self.free[rows] | self.committed[rows, p] | self.committed[rows, q]]
            for location, hearing in by_location if q != p else ():
                for receiver in hearing:
                    for part, also, named in self._offers(free[self.states[free, q] == location], receiver):
                        if named == channel:
                            yield part, (*sender, receiver), conjunction(guard, also)

    def _receivers(
        self, rows: Numbers, listener: int, channel: int, chosen: tuple[Participant, ...], guard: Disjunction
    ) -> Iterator[tuple[Numbers, tuple[Participant, ...], Disjunction]]:
        """Each process that can hear a broadcast does, by one of its edges, from the listener of that number on."""
        if listener == len(self._hearing(channel)) or not len(rows):
            joined = np.count_nonzero(self.committed[rows][:, [p.process for p in chosen]], axis=1) > 0
            yield rows[self.free[rows] | joined], chosen, guard
            return
        staying = [(rows, guard)]
        q, by_location = self._hearing(channel)[listener]
        for location, hearing in by_location if q != chosen[0].process else ():
            here = rows[self.states[rows, q] == location]
            for receiver in hearing:
                for part, also, named in self._offers(here, receiver):
                    if named != channel:
                        continue
                    joint = conjunction(guard, also)
                    yield from self._receivers(part, listener + 1, channel, (*chosen, receiver), joint)
                    hears = np.zeros(len(self.states), bool)
                    hears[part] = True
                    denied = [(all_[hears[all_]], conjunction(out, complemented(also))) for all_, out in staying]
                    staying = [(all_[~hears[all_]], out) for all_, out in staying] + denied
                    staying = [(some, out) for some, out in staying if len(some) and out]
        for some, out in staying:
            yield from self._receivers(some, listener + 1, channel, chosen, out)

    # ---- zones -------------------------------------------------------------------------------------------------------

    def _cut_elements(self) -> None:
        """The zones of the elements within the invariants: ``sources`` has them, ``source`` the place of each there."""
        keys = self.shapes * len(self.conjunctions) + np.repeat(np.maximum(self.limits, 0), self.counts)
        found, inverse = np.unique(keys, return_inverse=True)
        shapes, limits = np.divmod(found, len(self.conjunctions))
        left, self.sources = reached_from(self.zones[shapes], (), {}, self._bounds(limits), np.zeros(len(found), bool))
        self.source = _places(len(found), left)[inverse]

    def _bounds(self, limits: Numbers) -> Numbers:
        if len(self.bounds) < len(self.conjunctions):
            self.bounds = upper_bounds(self.conjunctions, self.model.dimension)
        return self.bounds[limits]

    def _elements(self, rows: Numbers) -> tuple[Numbers, Numbers, Numbers]:
        """The elements of some rows that are not empty, their sources, and the places of these among the rows."""
        places = np.repeat(np.arange(len(rows)), self.counts[rows])
        elements = ragged(self.first, rows)
        some = self.source[elements] >= 0
        return elements[some], self.source[elements[some]], places[some]

    def _look_for(self, predicate: Expression, negated: bool, dead: bool) -> None:
        """Rows with valuations that satisfy a predicate, or where it cannot be evaluated, are not fine.

        Args:
            dead: what ``deadlock`` is; true: in those elements that are not known to be alive.
        """
        rows = np.flatnonzero(self.limits >= 0)

        def truth(scratch: Environment) -> Disjunction:
            scratch.deadlock = lambda: dead
            return disjunctive(predicate, scratch, negated)

        for part, parts in self._by_reads(self.states, rows, truth):
            if parts is None:
                self.fine[part] = False
            for constraints in parts or ():
                elements, sources, places = self._elements(part)
                if dead:
                    doubtful = ~self.alive[elements]
                    sources, places = sources[doubtful], places[doubtful]
                found, inverse = np.unique(sources, return_inverse=True)
                left, _ = within(self.sources[found], constraints)
                self.fine[part[places[np.isin(inverse, left)]]] = False

    def _follow(self, rows: Numbers, participants: tuple[Participant, ...], guard: Disjunction) -> None:
        """Rows from which a transition leads out of the set are not fine."""
        pieces: Pieces = {(): (rows[self.fine[rows]], self.states[rows[self.fine[rows]]])}
        for participant in participants:
            pieces = self._updated(pieces, participant)
        for resets, (part, targets) in pieces.items():
            for n, (initial, is_meta) in enumerate(zip(self.model.layout.initial, self.model.layout.meta, strict=True)):
                if is_meta:
                    targets[:, self.processes + n] = initial
            for participant in participants:
                targets[:, participant.process] = self.model.edge(participant).target
            there = self.elements.find(targets)
            limits, waits = self.limits[there], self.waits[there]
            lost = np.flatnonzero(there == _MISSING)
            if len(lost):
                limits[lost], waits[lost] = self._limits(targets[lost]), False
            self.fine[part[limits == _FAULTY]] = False
            for constraints in guard:
                self._cover(part, constraints, dict(resets), there, limits, waits)
                if self.asks_deadlock:
                    self._enliven(part, constraints, dict(resets), limits)

    def _updated(self, pieces: Pieces, participant: Participant) -> Pieces:
        """What the updates of a participant make of rows; those where they are a run-time error are not fine."""

        def effect(scratch: Environment) -> tuple[dict[int, int], dict[int, int]]:
            cells = scratch.values
            assert isinstance(cells, Watched)
            bind_selects(self.model, participant, scratch)
            execute(self.model.edge(participant).updates, scratch)
            return {n: list.__getitem__(cells, n) for n in cells.written}, dict(scratch.resets)

        after: dict[Resets, list[tuple[Numbers, States]]] = {}
        for before, (rows, states) in pieces.items():
            for part, found in self._by_reads(states, np.arange(len(rows)), effect):
                if found is None:
                    self.fine[rows[part]] = False
                    continue
                cells, resets = found
                changed = states[part]
                for n, value in cells.items():
                    changed[:, self.processes + n] = value
                key = tuple(sorted({**dict(before), **resets}.items()))
                after.setdefault(key, []).append((rows[part], changed))
        return {
            key: (np.concatenate([r for r, _ in parts]), np.concatenate([s for _, s in parts]))
            for key, parts in after.items()
        }

    def _enliven(self, rows: Numbers, guard: Conjunction, resets: dict[int, int], limits: Numbers) -> None:
        """Elements are alive if a transition is possible from all of their valuations, now or later."""
        known = list(self.conjunctions)
        for group in groups_of(np.column_stack((self.limits[rows], limits, self.waits[rows]))):
            row, limit = rows[group[0]], limits[group[0]]
            if limit < 0:
                continue
            free = universe(self.model.dimension)
            domain = constrain_all(free, (*known[self.limits[row]], *guard))
            target = constrain_all(free, known[limit])
            before = target and undo_reset(target, tuple(resets.items()))
            domain = intersect(domain, before) if domain and before else None
            if domain is not None:
                past = np.reshape((down(domain) if self.waits[row] else domain).bounds, (1, *self.zones.shape[1:]))
                elements, sources, _ = self._elements(rows[group])
                alive = including(past, np.zeros(len(sources), np.int64), self.sources, sources)
                self.alive[elements[alive]] = True

    def _cover(
        self, rows: Numbers, guard: Conjunction, resets: dict[int, int], there: Numbers, limits: Numbers, waits: Truths
    ) -> None:
        _, sources, places = self._elements(rows)
        possible = limits[places] >= 0
        sources, places = sources[possible], places[possible]
        known = len(self.conjunctions)
        keys, inverse = np.unique((sources * known + limits[places]) * 2 + waits[places], return_inverse=True)
        chosen, of_target = np.divmod(keys, 2 * known)
        left, reached = reached_from(
            self.sources[chosen], guard, resets, self._bounds(of_target // 2), of_target % 2 == 1
        )
        result = _places(len(keys), left)[inverse]
        some = result >= 0
        self._include(reached, result[some], rows[places[some]], there[places[some]])

    def _include(self, reached: Numbers, numbers: Numbers, rows: Numbers, there: Numbers) -> None:
        """Rows with a reached zone that is in no zone of the row ``there`` are not fine."""
        self.fine[rows[there == _MISSING]] = False
        numbers, rows, there = numbers[there >= 0], rows[there >= 0], there[there >= 0]
        element = self.first[there]
        while len(rows):
            inside = including(self.zones, self.shapes[element], reached, numbers)
            last = ~inside & (element + 1 == self.first[there + 1])
            self.fine[rows[last]] = False
            more = ~inside & ~last
            numbers, rows, there, element = numbers[more], rows[more], there[more], element[more] + 1


def complemented(condition: Disjunction) -> Disjunction:
    """Where a condition does not hold."""
    denied = TRUE
    for constraints in condition:
        denied = conjunction(denied, [(complement(constraint),) for constraint in constraints])
    return denied


def alternatives(predicate: Expression, negated: bool = False) -> Iterator[tuple[Expression, bool]]:
    """Predicates, or (True) their negations, of which one is true, or a run-time error, wherever the given one is."""
    match predicate:
        case Unary(UnaryOperator.NOT, operand):
            yield from alternatives(operand, not negated)
        case Binary(BinaryOperator.AND, left, right) if negated:
            yield from (*alternatives(left, True), *alternatives(right, True))
        case Binary(BinaryOperator.OR | BinaryOperator.IMPLY as operator, left, right) if not negated:
            yield from alternatives(left, operator is BinaryOperator.IMPLY)
            yield from alternatives(right)
        case _:
            yield predicate, negated


def _places(count: int, chosen: Numbers) -> Numbers:
    """Of so many numbers the place of each among the chosen ones, _MISSING for the others."""
    places = np.full(count, _MISSING, np.int64)
    places[chosen] = np.arange(len(chosen))
    return places


def groups_of(table: Numbers) -> list[Numbers]:
    """The numbers of the rows of a table, those of equal rows together."""
    number = np.zeros(len(table), np.int64)
    span = 1
    for column in table.T:
        low = int(column.min())
        width = int(column.max()) - low + 1
        if span * width > 1 << 62:
            number = np.unique(number, return_inverse=True)[1]
            span = int(number.max()) + 1
        number, span = number * width + (column.astype(np.int64) - low), span * width
    order = np.argsort(number, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(number[order])) + 1)
