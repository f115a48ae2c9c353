"""The proof that permutations map a model, and the predicates of a query, onto itself.

Such a permutation acts on processes, slots, clocks, channels and some numbers in slots. It is an automorphism if what
is possible in the image of a state is the image of what is possible in the state: the same transitions, delays,
run-time errors and truth of predicates, with everything exchanged (Ip and Dill 1996; Hendriks et al. 2003). That is
shown here for all states at once:

1. corresponding processes have locations of the same kind with corresponding invariants and rates,
2. each edge with select values has one in the process that it comes to whose guard, channel and updates are the image
   of its own, in each case into which `tachk.meaning.judge.leaves` divides the states,
3. where receivers of a broadcast change their order, it does not matter whose updates come first,
4. slots that are exchanged have the same range, channels the same type and priority, and what always has its initial
   value has the image of it,
5. each predicate is true in the image of a state exactly if it is true in the state.

In 2 one inclusion is enough: an exchange that is repeated often enough changes nothing. Initial values need not
correspond. Nothing of how exchanges were found is used.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import pairwise, product
from typing import Any

from tachk.meaning.discrete import PreparedNetwork
from tachk.meaning.judge.behaviour import Behaviour, Question, name_of
from tachk.meaning.judge.junctions import Junction, Part, PredicateAtom, Sets, atoms, part_of
from tachk.meaning.judge.leaves import FAULT, Case, IndivisibleError, Leaf, Unknown, Values, content
from tachk.meaning.judge.transpositions import MalformedGroupError, StatePermutation, SymmetryGroup, group_element
from tachk.model.expressions import Expression, LocationTest, Reference, Variable
from tachk.model.run import Participant
from tachk.model.traversal import (
    process_expressions,
    walk,
    with_bodies,
    written_variables,
)
from tachk.model.types import slot_count


class Automorphisms:
    """The proof that permutations are automorphisms of a model and some predicates."""

    def __init__(self, model: PreparedNetwork, predicates: Sequence[Expression]) -> None:
        self.model, self.predicates = model, predicates
        self.behaviour = Behaviour(model)
        self.leaves = self.behaviour.leaves
        self._predicate_parts: list[Part] = []
        self._supports: dict[Part, frozenset[int]] = {}

    @property
    def constants(self) -> Mapping[int, int]:
        """The slots of which nothing is said but for these values, which nothing changes."""
        return self.leaves.constants

    def objection(self, group: SymmetryGroup) -> str | None:
        """The reason why not every permutation of a group is an automorphism, or None. Raises MalformedGroupError."""
        group.check()
        if self.model.network.has_hybrid_clocks or written_variables(self.predicates):
            return "the model or the query is of a kind for which exchanges are not proved"
        try:
            self._evaluate_without_error()
            for places in group.generators():
                reason = self._objection(group_element(group, places))
                if reason is not None:
                    return reason
        except IndivisibleError as error:
            return str(error)
        return None

    def _evaluate_without_error(self) -> None:
        """Invariants are looked at one after the other as long as they hold, so that an error in one would show an
        order; and a predicate that is an error is neither true nor false."""
        for process in range(self.leaves.processes):
            for number in range(len(self.model.network.processes[process].locations)):
                leaves = self.behaviour.of((process, number), self.behaviour.limits(process, number))
                if any(leaf.answer is FAULT for leaf in leaves):
                    raise IndivisibleError("an invariant or a rate may be a run-time error")
        self._predicate_parts = [self._decomposed(predicate) for predicate in self.predicates]
        if not all(map(self._has_no_error, self._predicate_parts)):
            raise IndivisibleError("the condition of the query may be a run-time error")

    def _decomposed(self, predicate: Expression) -> Part:
        part = part_of(predicate)
        return part if self._has_no_error(part) else PredicateAtom(predicate, True, ())

    def _has_no_error(self, part: Part) -> bool:
        leaves = (leaf for atom in atoms(part) for leaf in self.behaviour.of(atom, atom.truth))
        return not any(leaf.answer is FAULT or any(some != all_ for some, all_ in leaf.answer) for leaf in leaves)

    # ---- one exchange -----------------------------------------------------------------------------------------------

    def _objection(self, given: StatePermutation) -> str | None:
        self._check_places(given)
        whole = self.with_own_slots(given)
        return (
            self._of_slots(whole)
            or next(filter(None, (self._of_process(p, whole) for p in range(self.leaves.processes))), None)
            or self._of_broadcasts(whole)
            or self._of_predicates(whole)
        )

    def _check_places(self, given: StatePermutation) -> None:
        layout, processes = self.model.layout, self.leaves.processes
        pinned = {processes + slot for slot in (*layout.clock_slots, *layout.channel_slots)}
        slots, last = {*given.slots, *given.values}, len(self.leaves.ranges)
        if any(slot >= last or slot in pinned for slot in slots) or any(slot < processes for slot in given.values):
            raise MalformedGroupError("it has numbers of slots that are none")
        if any((slot < processes) != (image < processes) for slot, image in given.slots.items()):
            raise MalformedGroupError("a process becomes a variable")
        if any(not 0 < clock <= len(layout.clock_slots) for clock in given.clocks):
            raise MalformedGroupError("it has numbers of clocks that are none")
        if any(channel >= len(layout.channel_slots) for channel in given.channels):
            raise MalformedGroupError("it has numbers of channels that are none")

    def with_own_slots(self, given: StatePermutation) -> StatePermutation:
        """An exchange with the slots that hold the numbers of clocks and channels, which go with these."""
        layout, first = self.model.layout, self.leaves.processes
        slots, values = dict(given.slots), dict(given.values)
        for moved, own, number in ((given.clocks, layout.clock_slots, 1), (given.channels, layout.channel_slots, 0)):
            for one, image in moved.items():
                slots[first + own[one - number]] = first + own[image - number]
                values[first + own[one - number]] = {one: image}
        return StatePermutation(slots, given.clocks, given.channels, values)

    def _of_slots(self, whole: StatePermutation) -> str | None:
        layout, leaves, first = self.model.layout, self.leaves, self.leaves.processes
        for slot in {*whole.slots, *whole.values}:
            image, values = whole.slot(slot), whole.values.get(slot, {})
            if slot < first:
                continue
            if slot in leaves.constants or image in leaves.constants:
                begins = whole.value(slot, layout.initial[slot - first]) if slot in leaves.constants else None
                if leaves.constants.get(image) != begins:
                    return f"the values of {layout.names[image - first]} distinguish them"
                continue
            (low, high), of_image = layout.ranges[slot - first], layout.ranges[image - first]
            if (low, high) != of_image or any((low <= one <= high) != (low <= v <= high) for one, v in values.items()):
                return f"the range of {layout.names[image - first]} distinguishes them"
            if layout.meta[slot - first] != layout.meta[image - first]:
                return f"{layout.names[image - first]} is declared differently"
            begins = whole.value(slot, layout.initial[slot - first])
            if layout.meta[slot - first] and layout.initial[image - first] != begins:
                return f"{layout.names[image - first]} begins with another value"
        for channel, image in whole.channels.items():
            if self.model.channels[channel] != self.model.channels[image]:
                return "channels have different types or priorities"
        return None

    def _of_process(self, process: int, whole: StatePermutation) -> str | None:
        image = whole.slot(process)
        one, other = self.model.network.processes[process], self.model.network.processes[image]
        if image == process and not self._mentions(process_expressions(one), whole):
            return None
        if len(one.locations) != len(other.locations) or one.priority != other.priority:
            return f"{one.name} and {other.name} have different locations or priorities"
        for number, (location, its_image) in enumerate(zip(one.locations, other.locations, strict=True)):
            kinds = {(each.urgent, each.committed, each.observes) for each in (location, its_image)}
            questions = self.behaviour.limits(process, number), self.behaviour.limits(image, number)
            same = self._corresponds((process, number), *questions, whole, _is_image_of_limits)
            if len(kinds) > 1 or not same:
                return f"{one.name} and {other.name} differ in the location {location.name}"
            for participant in filter(self.behaviour.is_possible, self.model.instances[process][number]):
                candidates = self.model.instances[image][number]
                nearest = sorted(candidates, key=partial(_distance, participant))
                if not any(self._becomes(participant, candidate, whole) for candidate in nearest):
                    return f"{one.name} and {other.name} differ in an edge from {location.name}"
        return None

    def _mentions(self, expressions: Iterable[Expression], whole: StatePermutation) -> bool:
        """True if something that is exchanged is mentioned."""
        for node in (node for expression in with_bodies(expressions) for node in walk(expression)):
            if isinstance(node, LocationTest) and node.process in whole.slots:
                return True
            if isinstance(node, Reference) and not whole.slots.keys().isdisjoint(self._slots(node.variable)):
                return True
            if isinstance(node, Reference) and not whole.values.keys().isdisjoint(self._slots(node.variable)):
                return True
        return False

    def _slots(self, variable: Variable) -> range:
        first = self.model.layout.first.get(variable)
        if first is None:
            return range(0)
        first += self.leaves.processes
        return range(first, first + slot_count(variable.type))

    def _becomes(self, one: Participant, other: Participant, whole: StatePermutation) -> bool:
        edge, image = self.model.edge(one), self.model.edge(other)
        directions = [each.synchronisation and each.synchronisation.direction for each in (edge, image)]
        received = frozenset(whole.channels.get(channel, channel) for channel in self.behaviour.receives(one))
        return (
            edge.target == image.target
            and directions[0] == directions[1]
            and received == self.behaviour.receives(other)
            and self._corresponds(
                ("offer", one),
                self.behaviour.candidate(one),
                self.behaviour.candidate(other),
                whole,
                _is_image_of_step,
            )
            and self._corresponds(
                ("effect", one), self.behaviour.effect(one), self.behaviour.effect(other), whole, self._is_image
            )
        )

    def _of_predicates(self, whole: StatePermutation) -> str | None:
        if all(self._part_becomes(part, part, whole) for part in self._predicate_parts):
            return None
        return "the query distinguishes them"

    def _part_becomes(self, one: Part, other: Part, whole: StatePermutation) -> bool:
        if isinstance(one, PredicateAtom) and isinstance(other, PredicateAtom):
            return self._corresponds(one, one.truth, other.truth, whole, _is_image_of_truth)
        if not isinstance(one, Junction) or not isinstance(other, Junction) or one.conjunctive != other.conjunctive:
            return False
        places: dict[frozenset[int], list[int]] = {}
        for number, part in enumerate(other.parts):
            places.setdefault(self._support(part), []).append(number)
        missing = set(range(len(other.parts)))
        for part in one.parts:
            candidates = places.get(frozenset(map(whole.slot, self._support(part))), ())
            images = [number for number in candidates if self._part_becomes(part, other.parts[number], whole)]
            missing -= set(images)
            if not images:
                return False
        return not missing

    def _support(self, part: Part) -> frozenset[int]:
        """The slots on which a part depends as it is evaluated."""
        if part not in self._supports:
            leaves = (leaf for atom in atoms(part) for leaf in self.behaviour.of(atom, atom.truth))
            self._supports[part] = frozenset(slot for leaf in leaves for slot in leaf.case)
        return self._supports[part]

    # ---- cases and their images -------------------------------------------------------------------------------------

    def _corresponds(
        self,
        key: Any,
        question: Question,
        of_image: Question,
        whole: StatePermutation,
        agree: Callable[[Leaf, Leaf, StatePermutation], bool],
    ) -> bool:
        """True if in each case the answer to a question, exchanged, is what the other question has in the image."""
        return all(
            self._agree(leaf, image, whole, agree)
            for leaf in self.behaviour.of(key, question)
            for case in _images(leaf.case, whole)
            for image in self.leaves.of(of_image, case)
        )

    def _agree(
        self, leaf: Leaf, image: Leaf, whole: StatePermutation, agree: Callable[[Leaf, Leaf, StatePermutation], bool]
    ) -> bool:
        if leaf.answer is FAULT or image.answer is FAULT:
            return leaf.answer is image.answer
        return agree(leaf, image, whole)

    def _is_image(self, leaf: Leaf, image: Leaf, whole: StatePermutation) -> bool:
        effect, its_image = leaf.answer, image.answer
        origins = {whole.slot(slot): slot for slot in (*whole.slots, *effect.slots, *its_image.slots)}
        for place in {*map(whole.slot, effect.slots), *its_image.slots}:
            slot = origins.get(place, place)
            expected = self._moved(effect.slots.get(slot, self._before(leaf, slot)), slot, whole, image)
            if expected != self._moved(its_image.slots.get(place, self._before(image, place)), place, _STAY, image):
                return False
        if {whole.clock(clock) for clock in effect.clocks} != set(its_image.clocks):
            return False
        for clock, (source, more) in effect.clocks.items():
            its_source, its_more = its_image.clocks[whole.clock(clock)]
            if whole.clock(source) != its_source:
                return False
            if self._moved(more, None, whole, image) != self._moved(its_more, None, _STAY, image):
                return False
        return True

    def _before(self, leaf: Leaf, slot: int) -> Any:
        return content(slot, leaf.case.get(slot, self.leaves.ranges[slot]))

    def _moved(self, value: Any, slot: int | None, whole: StatePermutation, image: Leaf) -> Any:
        """The name of what a number that stands in a slot, or (None) that a clock is set to, becomes in the image."""
        there = {} if slot is None else whole.values.get(slot, {})
        if not isinstance(value, Unknown):
            return "number", there.get(value, value)
        here = whole.values.get(value.slot, {})
        if any(here.get(one, one) != there.get(one, one) for one in {*here, *there} if one in value.values):
            raise IndivisibleError("a name is copied to what holds other names, or none")
        return name_of(self._before(image, whole.slot(value.slot)))

    # ---- the order of receivers -------------------------------------------------------------------------------------

    def _of_broadcasts(self, whole: StatePermutation) -> str | None:
        receivers = [
            [
                (one, received)
                for of_location in by_location
                for one in of_location
                if (received := self.behaviour.broadcasts(one))
            ]
            for by_location in self.model.instances
        ]
        for first, own in enumerate(receivers):
            for second in range(first + 1, len(receivers)):
                if whole.slot(first) < whole.slot(second):
                    continue
                for (one, received), (other, also) in product(own, receivers[second]):
                    if not received.isdisjoint(also) and not self.behaviour.commute(one, other):
                        return "the order of the receivers of a broadcast matters"
        return None


_STAY = StatePermutation({}, {}, {}, {})


def _images(case: Case, whole: StatePermutation) -> Iterator[Case]:
    """The cases that an exchange makes of one."""
    places = [whole.slot(slot) for slot in case]
    for parts in product(*(_images_of_values(values, whole.values.get(slot, {})) for slot, values in case.items())):
        yield dict(zip(places, parts, strict=True))


def _images_of_values(values: Values, moved: Mapping[int, int]) -> list[Values]:
    inside = [one for one in moved if one in values and moved[one] != one]
    if {moved[one] for one in inside} == set(inside):
        return [values]
    if not isinstance(values, range):
        return [tuple(sorted(moved.get(one, one) for one in values))]
    borders = sorted({values[0], *inside, *(one + 1 for one in inside), values[-1] + 1})
    pieces = [range(low, high) for low, high in pairwise(borders)]
    return [(moved[piece[0]],) if piece[0] in inside else piece for piece in pieces]


def _distance(one: Participant, other: Participant) -> tuple[bool, bool]:
    return one.edge != other.edge, one.selects != other.selects


# ---- questions ------------------------------------------------------------------------------------------------------


def _exchanged(condition: Sets, whole: StatePermutation) -> Sets:
    return frozenset(frozenset((whole.clock(i), whole.clock(j), raw) for i, j, raw in part) for part in condition)


def _is_image_of_limits(leaf: Leaf, image: Leaf, whole: StatePermutation) -> bool:
    (limits, rates), (its_limits, its_rates) = leaf.answer, image.answer
    its_own = {(whole.clock(clock), rate) for clock, rate in rates}
    return bool(_exchanged(limits, whole) == its_limits and its_own == its_rates)


def _is_image_of_step(leaf: Leaf, image: Leaf, whole: StatePermutation) -> bool:
    (guard, channel), (its_guard, its_channel) = leaf.answer, image.answer
    return bool(_exchanged(guard, whole) == its_guard and whole.channels.get(channel, channel) == its_channel)


def _is_image_of_truth(leaf: Leaf, image: Leaf, whole: StatePermutation) -> bool:
    return all(
        _exchanged(some, whole) == its_some and _exchanged(all_, whole) == its_all
        for (some, all_), (its_some, its_all) in zip(leaf.answer, image.answer, strict=True)
    )
