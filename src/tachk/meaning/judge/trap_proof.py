"""Traps in certificates: sets of states that no run leaves.

A trap is about one slot, the location of a process or a variable, and one clock or none. In all states of it a part of
the goal may be impossible; then it stays so. A certificate need not list a state that lies in traps in which, for each
disjunct of the goal and for each process whose code may be a run-time error, that is impossible. The proof of that does
not look at the states of the certificate, but at the model:

1. only the process of the location sets the clock,
2. from a pair of a location and a time in the trap each edge of the process leads to pairs in the trap, and so does
   time; or from a value of the variable each edge of the network leads to values in the trap,
3. nowhere in the trap the disjunct is true, or the code of the process is a run-time error.

All else is arbitrary: each synchronisation is possible, and other variables and clocks have whatever value helps. The
reference evaluator, with unknown numbers in the state, says what an edge does (`tachk.meaning.judge.leaves`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from itertools import islice, product
from typing import Any

from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.base.records import dataclass
from tachk.meaning.discrete import PreparedNetwork
from tachk.meaning.judge.behaviour import Behaviour, UpdateEffect
from tachk.meaning.judge.junctions import Part, PredicateAtom, Sets, atoms, part_of
from tachk.meaning.judge.leaves import FAULT, Case, IndivisibleError, Leaf, Unknown
from tachk.meaning.judge.trap import ALWAYS, Times, Trap, common, complement, times_of, union
from tachk.model.expressions import Expression
from tachk.model.run import Participant

MOST_EDGES = 20_000
MOST_LEAVES = 100_000
"""So many edges, and so many cases of them, are looked at; where there are more, nothing is a trap."""
MOST_VALUES = 4_096
"""The largest number of values of the slot of a trap."""
_MOST_DISJUNCTS = 256


@dataclass(frozen=True, slots=True)
class EdgeCase:
    """An edge in some states.

    Attributes:
        case: the values of slots right before its updates.
        guard: the constraints of clocks under which it is possible.
        effect: None: anything.
    """

    process: int
    source: int
    target: int
    case: Case
    guard: Sets
    effect: UpdateEffect | None


class TrapProof:
    """What is needed of a model and a goal to judge traps. Nothing is a trap if ``objection`` is not None."""

    def __init__(self, model: PreparedNetwork, goal: Expression) -> None:
        self.model = model
        self.behaviour = Behaviour(model)
        self.leaves = self.behaviour.leaves
        self.edges: list[EdgeCase] = []
        self.invariants: list[list[Sets]] = []
        self.errors: dict[int, list[tuple[int, Sets]]] = {}
        self.disjuncts: list[tuple[Part, ...]] = []
        self.objection: str | None = None
        self._fallible: set[tuple[int, int]] = set()
        self._left = MOST_LEAVES
        try:
            self._read_model()
            self._read_goal(goal)
        except (IndivisibleError, UnsupportedError) as error:
            self.objection = str(error)

    # ---- the model --------------------------------------------------------------------------------------------------

    def _counted(self, leaves: Iterable[Leaf]) -> Iterator[Leaf]:
        for leaf in leaves:
            self._left -= 1
            if self._left < 0:
                raise IndivisibleError
            yield leaf

    def _read_model(self) -> None:
        if self.model.network.has_hybrid_clocks:
            raise IndivisibleError("it has hybrid clocks")
        for process, each in enumerate(self.model.network.processes):
            self.invariants.append([self._invariant(process, number) for number in range(len(each.locations))])
        every = [p for of_process in self.model.instances for of_location in of_process for p in of_location]
        if len(every) > MOST_EDGES:
            raise IndivisibleError
        for participant in every:
            if self._is_possible(participant):
                self._read_edge(participant)

    def _invariant(self, process: int, location: int) -> Sets:
        """Where an invariant may hold; all of it where it may be an error."""
        found: Sets = frozenset()
        try:
            for leaf in self._counted(self.leaves.of(self.behaviour.limits(process, location), {})):
                if leaf.answer is FAULT:
                    raise IndivisibleError
                found |= leaf.answer[0]
        except IndivisibleError:
            self._fallible.add((process, location))
            self._may_fail(process, location, _ANYWHERE)
            return _ANYWHERE
        return found

    def _may_fail(self, process: int, location: int, guard: Sets) -> None:
        self.errors.setdefault(process, []).append((location, guard))

    def _is_possible(self, participant: Participant) -> bool:
        try:
            return self.behaviour.is_possible(participant)
        except IndivisibleError:
            return True

    def _read_edge(self, participant: Participant) -> None:
        edge, process = self.model.edge(participant), participant.process
        try:
            candidates = list(
                self._counted(self.behaviour.of(("offer", participant), self.behaviour.candidate(participant)))
            )
        except IndivisibleError:
            candidates = [Leaf({}, FAULT), Leaf({}, (_ANYWHERE, None))]
        for candidate in candidates:
            if candidate.answer is FAULT:
                self._may_fail(process, edge.source, _ANYWHERE)
                continue
            guard, channel = candidate.answer
            if not guard:
                continue
            if channel is FAULT or (process, edge.target) in self._fallible:
                self._may_fail(process, edge.source, guard)
            # The guard of a receiver is about what was there before the sender's updates.
            case = candidate.case if edge.begins else {}
            try:
                effects = list(self._counted(self.leaves.of(self.behaviour.effect(participant), case)))
            except IndivisibleError:
                effects = [Leaf(case, FAULT), Leaf(case, None)]
            for leaf in effects:
                if leaf.answer is FAULT:
                    self._may_fail(process, edge.source, guard)
                else:
                    self.edges.append(EdgeCase(process, edge.source, edge.target, leaf.case, guard, leaf.answer))

    # ---- the goal ---------------------------------------------------------------------------------------------------

    def _read_goal(self, goal: Expression) -> None:
        part = part_of(goal)
        if not self._has_no_error(part):
            part = PredicateAtom(goal, True, ())
            if not self._has_no_error(part):
                raise IndivisibleError("the condition of the query may be a run-time error")
        self.disjuncts = _disjuncts(part)

    def _has_no_error(self, part: Part) -> bool:
        for atom in atoms(part):
            for leaf in self._counted(self.behaviour.of(atom, atom.truth)):
                if leaf.answer is FAULT or any(certain != perhaps for certain, perhaps in leaf.answer):
                    return False
        return True

    # ---- traps ------------------------------------------------------------------------------------------------------

    def objection_to(self, trap: Trap) -> str | None:
        """The reason why something is no trap; None if it is one."""
        if self.objection is not None:
            return self.objection
        layout, processes = self.model.layout, self.leaves.processes
        if trap.slot >= len(self.leaves.ranges) or trap.clock >= self.model.dimension:
            return "there is no such slot or clock"
        if trap.clock > 0 and trap.slot >= processes:
            return "a clock goes with a process"
        if trap.clock == 0 and any((first, last) != ALWAYS[0] for _, first, last in trap.outside):
            return "it has times and no clock"
        values = self._values(trap.slot)
        if len(values) > MOST_VALUES or any(value not in values for value, _, _ in trap.outside):
            return "it has other values than the slot"
        if trap.slot >= processes:
            if layout.meta[trap.slot - processes]:
                return "the variable is set after each transition"
            return None if self._is_closed_for_variable(trap) else "an edge leads out of it"
        if trap.clock > 0 and not self._is_owned(trap):
            return "another process sets the clock"
        return None if self._is_closed_for_process(trap) else "an edge, or time, leads out of it"

    def _values(self, slot: int) -> range:
        if slot < self.leaves.processes:
            return range(len(self.invariants[slot]))
        low, high = self.model.layout.ranges[slot - self.leaves.processes]
        return range(low, high + 1)

    def _is_owned(self, trap: Trap) -> bool:
        return all(
            edge.process == trap.slot or (edge.effect is not None and trap.clock not in edge.effect.clocks)
            for edge in self.edges
        )

    def _is_closed_for_process(self, trap: Trap) -> bool:
        clock, limits = trap.clock, [times_of(sets, trap.clock) for sets in self.invariants[trap.slot]]
        outside = [trap.outside_at(location) for location in range(len(limits))]
        inside = [complement(times) for times in outside]
        for number, location in enumerate(self.model.network.processes[trap.slot].locations):
            later = union(((last + 1, last + 1),) for _, last in inside[number])
            left = common(common(limits[number], outside[number]), later)
            if left and not location.urgent and not location.committed:
                return False
        for edge in self.edges:
            if edge.process != trap.slot:
                continue
            before = common(common(inside[edge.source], limits[edge.source]), times_of(edge.guard, clock))
            entered = common(outside[edge.target], limits[edge.target])
            if before and common(_after(edge.effect, clock, before), entered):
                return False
        return True

    def _is_closed_for_variable(self, trap: Trap) -> bool:
        outside = {value for value, _, _ in trap.outside}
        for edge in self.edges:
            if edge.effect is not None and trap.slot not in edge.effect.slots:
                continue
            before = edge.case.get(trap.slot, self.leaves.ranges[trap.slot])
            if all(value in outside for value in before):
                continue
            if any(edge.effect is None or _may_be(edge.effect.slots[trap.slot], value) for value in outside):
                return False
        return True

    def clauses(self, traps: Sequence[Trap]) -> tuple[tuple[int, ...], ...]:
        """For each disjunct of the goal, and each process in which something may be a run-time error, the numbers of
        the traps in which that is impossible. None at all if one of these is impossible in no trap."""
        found = [
            tuple(number for number, trap in enumerate(traps) if not self._may_hold(disjunct, trap))
            for disjunct in self.disjuncts
        ]
        for process, places in self.errors.items():
            own = [number for number, trap in enumerate(traps) if trap.slot == process]
            found.append(tuple(number for number in own if not _may_fail_in(traps[number], places)))
        return tuple(dict.fromkeys(found)) if all(found) else ()

    def _may_hold(self, parts: tuple[Part, ...], trap: Trap) -> bool:
        """Whether a conjunction may be true in a trap."""

        @cache
        def of(atom: PredicateAtom) -> list[tuple[Any, Times]]:
            return [
                (leaf.case.get(trap.slot), times_of(perhaps, trap.clock))
                for leaf in self.behaviour.of(atom, atom.truth)
                for _, perhaps in leaf.answer
            ]

        def times(part: Part, value: int) -> Times:
            if isinstance(part, PredicateAtom):
                return union(times for values, times in of(part) if values is None or value in values)
            inner = [times(each, value) for each in part.parts]
            if not part.conjunctive:
                return union(inner)
            found = ALWAYS
            for each in inner:
                found = common(found, each)
            return found

        for value in self._values(trap.slot):
            left = complement(trap.outside_at(value))
            for part in parts:
                left = left and common(left, times(part, value))
            if left:
                return True
        return False


def _may_be(number: Any, value: int) -> bool:
    return value in number.values if isinstance(number, Unknown) else bool(number == value)


def _may_fail_in(trap: Trap, places: Iterable[tuple[int, Sets]]) -> bool:
    return any(common(complement(trap.outside_at(where)), times_of(guard, trap.clock)) for where, guard in places)


_ANYWHERE: Sets = frozenset([frozenset()])


def _disjuncts(part: Part) -> list[tuple[Part, ...]]:
    """A predicate as a disjunction of conjunctions, as far as these are not too many."""
    if isinstance(part, PredicateAtom):
        return [(part,)]
    inner = [_disjuncts(each) for each in part.parts]
    if not part.conjunctive:
        found = [each for disjuncts in inner for each in disjuncts]
    else:
        found = [sum(chosen, ()) for chosen in islice(product(*inner), _MOST_DISJUNCTS + 1)]
    return found if len(found) <= _MOST_DISJUNCTS else [(part,)]


def _after(effect: UpdateEffect | None, clock: int, before: Times) -> Times:
    if effect is None:
        return ALWAYS
    if clock not in effect.clocks:
        return before
    source, more = effect.clocks[clock]
    return ((2 * more, 2 * more),) if source == 0 and not isinstance(more, Unknown) else ALWAYS
