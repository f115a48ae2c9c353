"""The behaviour of the parts of a model in all discrete states, in cases: locations, edges with select values, and two
of them one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property, partial
from typing import Any

from tachk.base.records import dataclass
from tachk.base.words import Direction
from tachk.meaning.constraints import conditional_constraints
from tachk.meaning.discrete import PreparedNetwork, bind_selects, channel_named, may_receive
from tachk.meaning.judge.junctions import Sets, sets
from tachk.meaning.judge.leaves import FAULT, IndivisibleError, Leaf, Leaves, Unknown
from tachk.model.evaluate import Environment, clock_number, evaluate, execute
from tachk.model.fault import EvaluationFault
from tachk.model.network import Location
from tachk.model.run import Participant

Question = Callable[[Environment], Any]
StepCandidate = tuple[Sets, Any]
"""The clock constraints of a guard, and the channel or FAULT."""


@dataclass(frozen=True, slots=True)
class UpdateEffect:
    """The effect of updates, apart from slots that stay as they are.

    Attributes:
        slots: by slot, the new number, known or not.
        clocks: by clock, the clock whose value it gets (0: none), and how much more.
    """

    slots: Mapping[int, Any]
    clocks: Mapping[int, tuple[int, Any]]


class Behaviour:
    """A model in cases. The answers about the whole of a part of it are cached."""

    def __init__(self, model: PreparedNetwork) -> None:
        self.model = model
        self.leaves = Leaves(model)
        self._known: dict[Any, list[Leaf]] = {}
        self._receivable: dict[Participant, frozenset[int]] = {}

    def of(self, key: Any, question: Question) -> list[Leaf]:
        """The cases of a question that has a name."""
        if key not in self._known:
            self._known[key] = list(self.leaves.of(question, {}))
        return self._known[key]

    def limits(self, process: int, location: int) -> Question:
        """For a location the clock constraints of the invariant, and the rates of clocks."""
        return partial(_limits, self.model.network.processes[process].locations[location])

    def candidate(self, participant: Participant) -> Question:
        """For an edge an `StepCandidate`."""
        return partial(_candidate, self.model, participant)

    def effect(self, participant: Participant) -> Question:
        """For an edge the `UpdateEffect` of its updates."""
        return partial(self._effect, participant)

    def _effect(self, participant: Participant, scratch: Environment) -> UpdateEffect:
        before, first = list(scratch.values), self.leaves.processes
        bind_selects(self.model, participant, scratch)
        execute(self.model.edge(participant).updates, scratch)
        pairs = zip(before, scratch.values, strict=True)
        slots = {first + index: new for index, (old, new) in enumerate(pairs) if name_of(old) != name_of(new)}
        if not self.leaves.constants.keys().isdisjoint(slots):
            raise IndivisibleError("a constant is written")
        return UpdateEffect(slots, dict(scratch.resets))

    def is_possible(self, participant: Participant) -> bool:
        """True if an edge is part of anything: it is not if its guard is false everywhere, or if no other process is
        ever at the other end of its channel. Where its evaluation may be an error, it is."""
        synchronisation, process = self.model.edge(participant).synchronisation, participant.process
        if synchronisation is not None and synchronisation.direction is Direction.RECEIVE:
            channels = self.receives(participant)
            return any(not self._senders[channel] <= {process} for channel in channels) and self._is_tried(participant)
        if synchronisation is None or self._may_fail(participant):
            return self._is_tried(participant)
        return any(
            self.model.channels[channel][0].broadcast or not self._receivers[channel] <= {process}
            for channel in self._names(participant)
        )

    def _is_tried(self, participant: Participant) -> bool:
        return any(leaf.answer is FAULT or leaf.answer[0] for leaf in self._candidates(participant))

    def _may_fail(self, participant: Participant) -> bool:
        return any(leaf.answer is FAULT or leaf.answer[1] is FAULT for leaf in self._candidates(participant))

    def _candidates(self, participant: Participant) -> list[Leaf]:
        return self.of(("offer", participant), self.candidate(participant))

    def _names(self, participant: Participant) -> set[int]:
        answers = (leaf.answer for leaf in self._candidates(participant) if leaf.answer is not FAULT and leaf.answer[0])
        return {channel for _, channel in answers if channel is not FAULT}

    @cached_property
    def _senders(self) -> list[set[int]]:
        """For each channel the processes that send along it in some state."""
        found: list[set[int]] = [set() for _ in self.model.channels]
        for participant in self._all_participants():
            synchronisation = self.model.edge(participant).synchronisation
            if synchronisation is not None and synchronisation.direction is Direction.SEND:
                for channel in self._names(participant):
                    found[channel].add(participant.process)
        return found

    @cached_property
    def _receivers(self) -> list[set[int]]:
        found: list[set[int]] = [set() for _ in self.model.channels]
        for participant in self._all_participants():
            for channel in self.receives(participant):
                found[channel].add(participant.process)
        return found

    def _all_participants(self) -> Iterator[Participant]:
        return (one for by_location in self.model.instances for of_location in by_location for one in of_location)

    def receives(self, participant: Participant) -> frozenset[int]:
        if participant not in self._receivable:
            channels = range(len(self.model.channels))
            self._receivable[participant] = frozenset(c for c in channels if may_receive(self.model, participant, c))
        return self._receivable[participant]

    def broadcasts(self, participant: Participant) -> frozenset[int]:
        return frozenset(c for c in self.receives(participant) if self.model.channels[c][0].broadcast)

    def commute(self, one: Participant, other: Participant) -> bool:
        reads, writes = self._touched(one)
        others_reads, others_writes = self._touched(other)
        both = writes.keys() & others_writes.keys()
        return (
            reads.isdisjoint(others_writes)
            and others_reads.isdisjoint(writes)
            and all(len(writes[each] | others_writes[each]) == 1 for each in both)
        )

    def _touched(self, participant: Participant) -> tuple[set[Any], dict[Any, set[Any]]]:
        """The slots that updates depend on, and what they write: of each slot or clock the names of its new values,
        one if that is always the same number."""
        reads: set[Any] = set()
        writes: dict[Any, set[Any]] = {}
        for leaf in self.of(("effect", participant), self.effect(participant)):
            reads.update(leaf.case)
            if leaf.answer is FAULT:
                continue
            effect = leaf.answer
            numbers = [(slot, 0, value) for slot, value in effect.slots.items()]
            numbers += [(("clock", clock), source, more) for clock, (source, more) in effect.clocks.items()]
            for place, source, value in numbers:
                writes.setdefault(place, set()).add((source, name_of(value)))
                if source != 0:
                    reads.add(("clock", source))
                if isinstance(value, Unknown):
                    reads.add(value.slot)
                    writes[place].add(("number of", participant))
        return reads, writes


def name_of(value: Any) -> Any:
    """The common value of two numbers that are the same."""
    return ("slot", value.slot) if isinstance(value, Unknown) else ("number", int(value))


def _limits(location: Location, scratch: Environment) -> Any:
    """The clock constraints of an invariant, and the rates of clocks."""
    rates = frozenset((clock_number(clock, scratch), int(evaluate(rate, scratch))) for clock, rate in location.rates)
    return sets(conditional_constraints(location.invariant, scratch)), rates


def _candidate(model: PreparedNetwork, participant: Participant, scratch: Environment) -> StepCandidate:
    """The valuations at which the guard of an edge holds, and the channel that it names there, which may be an
    error."""
    bind_selects(model, participant, scratch)
    guard = conditional_constraints(model.edge(participant).guard, scratch)
    try:
        return sets(guard), channel_named(model, participant, scratch) if guard else None
    except EvaluationFault:
        return sets(guard), FAULT
