"""The behaviour of a network in many discrete states at once: `tachk.meaning.discrete` and `tachk.meaning.symbolic`
for arrays of states.

The rules are the same. An expression is evaluated by the reference evaluator, once for all states that agree in what it
reads. Nothing is said of clock values: invariants and guards are given as constraints.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from tachk.base.job import check_job
from tachk.base.records import dataclass
from tachk.base.words import Direction
from tachk.meaning.constraints import (
    FALSE,
    TRUE,
    Conjunction,
    Disjunction,
    alternatives,
    certain,
    complemented,
    conditional_constraints,
    conjunction,
)
from tachk.meaning.dbm import ClockValues
from tachk.meaning.discrete import PreparedNetwork, Priority, bind_selects, channel_named, may_receive
from tachk.model.evaluate import ClockChanges, Environment, clock_number, composed, evaluate, execute
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.run import Participant, Transition

T = TypeVar("T")
States = NDArray[np.signedinteger]
"""Discrete states as rows: locations, then slots. What is behind these has no meaning."""
Numbers = NDArray[np.int64]
Joint = tuple[Numbers, tuple[Participant, ...], Disjunction, int | None]
"""Rows, who acts together in them, the clock constraints of their guards, and the channel."""

StepCandidate = tuple[Disjunction, int | EvaluationFault | None]
"""The clock constraints of a guard, and the channel that the edge names."""
Effect = tuple[dict[int, int], ClockChanges]
"""The slots and clocks that updates write, with their new values."""
Memory = dict[tuple[tuple[int, ...], tuple[int, ...]], tuple[T | EvaluationFault, tuple[int, ...]]]
"""Answers where some columns have some contents, and the columns that these depend on."""

NEVER: Conjunction = ((0, 0, 0),)
"""The condition that no clock values satisfy."""


@dataclass(frozen=True, slots=True)
class MoveOfManyStates:
    """A transition from some discrete states, or a run-time error in it.

    Attributes:
        rows, targets: the numbers of the states, in ascending order, and of those after it.
        guard: the clock constraints of all guards, those that keep others out of a broadcast included.
        resets: what it sets clocks to.
        fault: what cannot be evaluated where the guard holds; then there are no targets.
    """

    rows: Numbers
    targets: Numbers
    transition: Transition
    guard: Disjunction
    resets: ClockValues = ()
    priority: Priority = (0, 0)
    fault: EvaluationFault | None = None


class ManyStates:
    """Discrete states, each once, with a number. They have a mark, which a transition does not change.

    Attributes:
        width: how many numbers a state has without the mark, which is behind them.
        low, high: the ranges of these numbers.
        moves: the transitions from those states that have been explored.
        invariants: the different conjunctions of clock constraints that invariants are.
        limits: of each state the number of its invariant.
        stands: of each state which clocks stand still, the reference clock among them.
        waits: of each state whether time may pass, as far as it has been explored.
        marked: of each state its mark.
        invalid: the numbers of states whose invariants cannot be evaluated, and of those in which clocks decide whether
            an urgent channel can be used, for which there is no answer here.
    """

    def __init__(self, model: PreparedNetwork) -> None:
        self.model = model
        self.processes = len(model.network.processes)
        ranges = [(0, len(p.locations) - 1) for p in model.network.processes] + [*model.layout.ranges, (0, 1)]
        self.width = len(ranges) - 1
        self.low, self.high = np.array(ranges, np.int64).T
        self._type = np.result_type(np.min_scalar_type(self.low.min()), np.min_scalar_type(self.high.max()))
        self._numbers: dict[bytes, int] = {}
        self._invariants: dict[Conjunction, int] = {NEVER: 0, (): 1}
        self._receiving: dict[int, list[tuple[int, list[tuple[int, list[Participant]]]]]] = {}
        self._guards: dict[Participant, Memory[StepCandidate]] = {}
        self._effects: dict[Participant, Memory[Effect]] = {}
        self.moves: list[MoveOfManyStates] = []
        self.invalid: list[int] = []
        self.states: States = np.zeros((0, len(ranges)), self._type)
        self._admitted = np.zeros((0, self.processes), bool)  # which processes the committed rule lets go
        self.limits, self.waits, self.stands = np.zeros(0, np.int64), np.zeros(0, bool), np.zeros((0, 0), bool)

    @property
    def invariants(self) -> list[Conjunction]:
        return list(self._invariants)

    @property
    def marked(self) -> NDArray[np.bool_]:
        found: NDArray[np.bool_] = self.states[:, -1] > 0
        return found

    def numbers(self, states: NDArray[np.signedinteger]) -> Numbers:
        """The numbers of discrete states, with the mark behind the slots; new ones get the next numbers."""
        known = self._numbers
        return np.array([known.setdefault(key, len(known)) for key in self._keys(states)], np.int64)

    def known(self, states: NDArray[np.signedinteger]) -> Numbers:
        """As `numbers`, but -1 for those that have none."""
        return np.array([self._numbers.get(key, -1) for key in self._keys(states)], np.int64)

    def _keys(self, states: NDArray[np.signedinteger]) -> Iterator[bytes]:
        keys = states.astype(self._type).tobytes()
        size = self._type.itemsize * states.shape[1]
        return (keys[n : n + size] for n in range(0, len(keys), size))

    def settle(self) -> Numbers:
        """Looks at the states that are new since the last time: what they say of time. Returns their numbers."""
        known, model = len(self.states), self.model
        new = np.frombuffer(b"".join(list(self._numbers)[known:]), self._type).reshape(-1, self.states.shape[1])
        self.states = np.concatenate((self.states, new))
        count = len(self.states)
        added = np.arange(known, count)
        stands = np.zeros((len(added), model.dimension), bool)
        stands[:, 0] = True
        self.stands = np.concatenate((self.stands.reshape(-1, model.dimension), stands))
        self.limits = np.concatenate((self.limits, np.ones(len(added), np.int64)))
        self.waits = np.concatenate((self.waits, np.ones(len(added), bool)))
        commitment = np.zeros((len(added), self.processes), np.int8)
        observes = np.zeros((len(added), self.processes), bool)
        for p, process in enumerate(model.network.processes):
            here = new[:, p].astype(np.int64)
            commitment[:, p] = np.array([location.commitment for location in process.locations])[here]
            observes[:, p] = np.array([location.observes for location in process.locations])[here]
            urgent = np.array([location.committed or location.urgent for location in process.locations])
            self.waits[known:] &= ~urgent[here]
            for number, location in enumerate(process.locations):
                special = location.rates or location.invariant is not None
                rows = known + np.flatnonzero(here == number) if special else added[:0]
                for clock, rate in location.rates:
                    for part, stopped in self.evaluated(rows, partial(_stopped, clock, rate)):
                        if isinstance(stopped, EvaluationFault):
                            self.invalid += part.tolist()
                        else:
                            self.stands[part] |= np.isin(np.arange(model.dimension), stopped)
                if location.invariant is not None:
                    required = rows[(self.limits[rows] > 0) & ~np.isin(rows, self.invalid)]
                    self._limit(required, partial(conditional_constraints, location.invariant))
        admitted = observes | (commitment >= commitment.max(axis=1, initial=0, keepdims=True))
        self._admitted = np.concatenate((self._admitted, admitted))
        return added

    def evaluated(
        self, rows: Numbers, question: Callable[[Environment], T]
    ) -> Iterator[tuple[Numbers, T | EvaluationFault]]:
        """Rows, in groups that agree in what answers a question, with the answer."""
        return self._evaluated(self.states, rows, question, {})

    def _evaluated(
        self, states: States, rows: Numbers, question: Callable[[Environment], T], memory: Memory[T]
    ) -> Iterator[tuple[Numbers, T | EvaluationFault]]:
        waiting: list[tuple[Numbers, tuple[int, ...]]] = [(rows, ())]
        while waiting:
            rows, columns = waiting.pop()
            for group in groups_of(states[np.ix_(rows, np.array(columns, np.int64))]) if len(rows) else ():
                first = rows[group[0]]
                key = columns, tuple(states[first, list(columns)].tolist())
                if key not in memory:
                    memory[key] = self._answer(states[first].tolist(), question, columns)
                answer, needed = memory[key]
                if needed == columns:
                    yield rows[group], answer
                else:
                    waiting.append((rows[group], needed))

    def _answer(
        self, row: list[int], question: Callable[[Environment], T], columns: tuple[int, ...]
    ) -> tuple[T | EvaluationFault, tuple[int, ...]]:
        """The answer in one state, and what of the state it depends on besides some numbers that are known."""
        read: set[int] = set()
        slots = Watched(row[self.processes :], self.processes, read)
        answer: T | EvaluationFault
        try:
            answer = question(Environment(self.model.layout, slots, Watched(row[: self.processes], 0, read)))
        except EvaluationFault as fault:
            answer = fault
        return answer, tuple(sorted(read.union(columns)))

    def _limit(self, rows: Numbers, invariant: Callable[[Environment], Disjunction]) -> None:
        """Adds an invariant to those of some states. Once one is false, later ones are not evaluated."""
        for part, parts in list(self.evaluated(rows, invariant)):
            if isinstance(parts, EvaluationFault):
                self.invalid += part.tolist()
                self.limits[part] = 1
                continue
            if len(parts) > 1:
                raise ValueError("an invariant cannot be a disjunction of clock constraints")
            before, inverse = np.unique(self.limits[part], return_inverse=True)
            known = self.invariants
            after = [tuple(sorted({*known[n], *parts[0]})) if parts else NEVER for n in before.tolist()]
            numbers = [self._invariants.setdefault(one, len(self._invariants)) for one in after]
            self.limits[part] = np.array(numbers, np.int64)[inverse]

    def truth(
        self, rows: Numbers, predicate: Expression, dead: bool, widely: bool
    ) -> list[tuple[Numbers, Disjunction]]:
        """The valuations at which a predicate holds in some states for certain, or (widely) may hold, for a given truth
        of ``deadlock``. Those at which it may hold may come in several parts for a state."""
        found = []
        for one, negated in alternatives(predicate) if widely else ((predicate, False),):

            def question(scratch: Environment, one: Expression = one, negated: bool = negated) -> Disjunction:
                scratch.deadlock = partial(bool, dead)
                return certain(one, scratch, negated, TRUE if widely else FALSE)

            for part, condition in self.evaluated(rows, question):
                if not isinstance(condition, EvaluationFault) and condition:
                    found.append((part, condition))
        return found

    # ---- who acts together -------------------------------------------------------------------------------------------

    def explore(self, rows: Numbers) -> None:
        """Finds all transitions that discrete states admit, in ascending order of their numbers."""
        for part, participants, guard, channel in self._joint(rows):
            check_job()
            priority = self.model.network.default_priority
            if channel is not None:
                type_, priority = self.model.channels[channel]
                if type_.urgent and not type_.broadcast:
                    self._forbid_waiting(part, guard)
            of_process = max(self.model.network.processes[p.process].priority for p in participants)
            pieces: dict[ClockValues, tuple[Numbers, States]] = {(): (part, self.states[part])}
            for participant in participants:
                pieces = self._updated(pieces, participant, Transition(participants), guard)
            for resets, (some, targets) in pieces.items():
                for n, is_meta in enumerate(self.model.layout.meta):
                    if is_meta:
                        targets[:, self.processes + n] = self.model.layout.initial[n]
                for participant in participants:
                    targets[:, participant.process] = self.model.edge(participant).target
                order, numbers = np.argsort(some), self.numbers(targets)
                move = MoveOfManyStates(
                    some[order], numbers[order], Transition(participants), guard, resets, (priority, of_process)
                )
                self.moves.append(move)

    def _forbid_waiting(self, rows: Numbers, guard: Disjunction) -> None:
        """An urgent channel can be used: by a sender alone, if it is a broadcast."""
        self.waits[rows] = False
        if guard != TRUE:
            self.invalid += rows.tolist()

    def _note(self, rows: Numbers, required: Disjunction, transition: Transition, fault: EvaluationFault) -> None:
        self.moves.append(MoveOfManyStates(np.sort(rows), rows[:0], transition, required, fault=fault))

    def _joint(self, rows: Numbers) -> Iterator[Joint]:
        for here, participant in self._initiators(rows):
            for part, guard, channel in self._candidates(here, (participant,), TRUE):
                if channel is None:
                    yield part, (participant,), guard, None
                    continue
                type_ = self.model.channels[channel][0]
                if type_.urgent and type_.broadcast:
                    self._forbid_waiting(part, guard)
                join = self._receivers if type_.broadcast else self._partners
                yield from join(part, 0, channel, (participant,), guard)

    def _initiators(self, rows: Numbers) -> Iterator[tuple[Numbers, Participant]]:
        for p, by_location in enumerate(self.model.instances):
            for location, participants in enumerate(by_location):
                here = rows[(self.states[rows, p] == location) & (self.limits[rows] > 0)]
                for participant in participants if len(here) else ():
                    synchronisation = self.model.edge(participant).synchronisation
                    if synchronisation is None:
                        yield here[self._admitted[here, p]], participant
                    elif synchronisation.direction is Direction.SEND:
                        yield here, participant

    def _candidates(
        self, rows: Numbers, participants: tuple[Participant, ...], required: Disjunction
    ) -> Iterator[tuple[Numbers, Disjunction, int | None]]:
        """The rows in which the guard of the last participant holds for some clocks, with its constraints and the
        channel that its edge names."""

        def candidate(scratch: Environment) -> StepCandidate:
            bind_selects(self.model, participants[-1], scratch)
            guard = conditional_constraints(self.model.edge(participants[-1]).guard, scratch)
            try:
                return guard, channel_named(self.model, participants[-1], scratch) if guard else None
            except EvaluationFault as fault:
                return guard, fault

        memory = self._guards.setdefault(participants[-1], {})
        for part, found in self._evaluated(self.states, rows, candidate, memory):
            guard, channel = (TRUE, found) if isinstance(found, EvaluationFault) else found
            if isinstance(channel, EvaluationFault):
                self._note(part, conjunction(required, guard), Transition(participants), channel)
            elif guard:
                yield part, guard, channel

    def _potential_receivers(self, channel: int) -> list[tuple[int, list[tuple[int, list[Participant]]]]]:
        """The processes that may receive on a channel, with the locations where they do and the edges."""
        if channel not in self._receiving:
            of_processes = [
                (
                    q,
                    [
                        (location, receiving)
                        for location, participants in enumerate(by_location)
                        if (receiving := [p for p in participants if may_receive(self.model, p, channel)])
                    ],
                )
                for q, by_location in enumerate(self.model.instances)
            ]
            self._receiving[channel] = [of_process for of_process in of_processes if of_process[1]]
        return self._receiving[channel]

    def _partners(
        self, rows: Numbers, _: int, channel: int, sender: tuple[Participant, ...], guard: Disjunction
    ) -> Iterator[Joint]:
        p = sender[0].process
        for q, by_location in self._potential_receivers(channel):
            free = rows[self._admitted[rows, p] | self._admitted[rows, q]]
            for location, receiving in by_location if q != p else ():
                for receiver in receiving:
                    here = free[self.states[free, q] == location]
                    for part, also, named in self._candidates(here, (*sender, receiver), guard):
                        if named == channel:
                            yield part, (*sender, receiver), conjunction(guard, also), channel

    def _receivers(
        self, rows: Numbers, place: int, channel: int, chosen: tuple[Participant, ...], guard: Disjunction
    ) -> Iterator[Joint]:
        """Each process that can receive a broadcast does, by one of its edges, from the receiver of that number on."""
        if place == len(self._potential_receivers(channel)) or not len(rows):
            joined = self._admitted[rows][:, [p.process for p in chosen]].any(axis=1)
            yield rows[joined], chosen, guard, channel
            return
        staying = [(rows, guard)]
        q, by_location = self._potential_receivers(channel)[place]
        for location, receiving in by_location if q != chosen[0].process else ():
            here = rows[self.states[rows, q] == location]
            for receiver in receiving:
                for part, also, named in self._candidates(here, (*chosen, receiver), guard):
                    if named != channel:
                        continue
                    joint = conjunction(guard, also)
                    yield from self._receivers(part, place + 1, channel, (*chosen, receiver), joint)
                    receives = np.zeros(len(self.states), bool)
                    receives[part] = True
                    denied = [(all_[receives[all_]], conjunction(out, complemented(also))) for all_, out in staying]
                    staying = [(all_[~receives[all_]], out) for all_, out in staying] + denied
                    staying = [(some, out) for some, out in staying if len(some) and out]
        for some, out in staying:
            yield from self._receivers(some, place + 1, channel, chosen, out)

    def _updated(
        self,
        pieces: dict[ClockValues, tuple[Numbers, States]],
        participant: Participant,
        transition: Transition,
        guard: Disjunction,
    ) -> dict[ClockValues, tuple[Numbers, States]]:
        """The rows after the updates of a participant, by the values to which clocks were set."""

        def effect(scratch: Environment) -> Effect:
            slots = scratch.values
            assert isinstance(slots, Watched)
            bind_selects(self.model, participant, scratch)
            execute(self.model.edge(participant).updates, scratch)
            return {n: list.__getitem__(slots, n) for n in slots.written}, dict(scratch.resets)

        after: dict[ClockValues, list[tuple[Numbers, States]]] = {}
        for before, (rows, states) in pieces.items():
            memory = self._effects.setdefault(participant, {})
            for part, found in self._evaluated(states, np.arange(len(rows)), effect, memory):
                if isinstance(found, EvaluationFault):
                    self._note(rows[part], guard, transition, found)
                    continue
                slots, resets = found
                changed = states[part]
                for n, value in slots.items():
                    changed[:, self.processes + n] = value
                earlier = {clock: (source, more) for clock, source, more in before}
                whole = {**earlier, **composed(earlier, resets)}
                key = tuple(sorted((clock, source, more) for clock, (source, more) in whole.items()))
                after.setdefault(key, []).append((rows[part], changed))
        return {
            key: (np.concatenate([r for r, _ in parts]), np.concatenate([s for _, s in parts]))
            for key, parts in after.items()
        }


def _stopped(clock: Expression, rate: Expression, scratch: Environment) -> list[int]:
    """A clock if it stands still. Raises EvaluationFault, and ValueError for a rate other than 0 and 1."""
    value = evaluate(rate, scratch)
    if value not in (0, 1):
        raise ValueError(f"a clock has the rate {value}; only 0 and 1 are possible")
    return [] if value else [clock_number(clock, scratch)]


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


def groups_of(table: States) -> list[Numbers]:
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
