"""The automorphisms among permutations, checked one discrete state after the other: the oracle for
`tachk.meaning.judge.automorphism`, by the symbolic semantics of single states.

States are any with numbers within the ranges, reachable or not, but for what nothing writes.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Mapping, Sequence
from random import Random

from tachk.meaning.dbm import Federation, Zone, subtract_all
from tachk.meaning.discrete import PreparedNetwork
from tachk.meaning.judge.transpositions import StatePermutation, SymmetryGroup
from tachk.meaning.symbolic import situation, where
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.run import DiscreteState

Possible = Mapping[Hashable, Federation]
"""What is possible in a discrete state, and for which clock values."""


def random_state(model: PreparedNetwork, constants: Mapping[int, int], random: Random) -> DiscreteState:
    """Any discrete state; of some slots the values are given."""
    processes = model.network.processes
    locations = tuple(random.randrange(len(process.locations)) for process in processes)
    slots = [
        constants.get(len(processes) + slot, initial if meta or high - low > 1_000 else random.randint(low, high))
        for slot, ((low, high), meta, initial) in enumerate(
            zip(model.layout.ranges, model.layout.meta, model.layout.initial, strict=True)
        )
    ]
    return DiscreteState(locations, tuple(slots))


def is_kept(
    model: PreparedNetwork, predicates: Sequence[Expression], state: DiscreteState, given: StatePermutation
) -> bool:
    """Whether what is possible in the image of a state is the image of what is possible in the state."""
    here, there = _possible(model, predicates, state), _possible(model, predicates, _image(state, given))
    expected: dict[Hashable, Federation] = defaultdict(list)
    for what, zones in here.items():
        expected[_exchanged(what, given)] += [_zone(zone, given) for zone in zones]
    return all(
        not subtract_all(expected.get(what, []), there.get(what, []))
        and not subtract_all(there.get(what, []), expected.get(what, []))
        for what in {*expected, *there}
    )


def mutated(group: SymmetryGroup, random: Random, slots: Sequence[int], clocks: int, channels: int) -> SymmetryGroup:
    """A group with less, more or other parts: as a rule nothing of the model."""
    match random.randrange(8):
        case 0 if len(group.slots[0]) > 1:
            gone = random.randrange(len(group.slots[0]))
            return _with(group, slots=tuple(own[:gone] + own[gone + 1 :] for own in group.slots))
        case 1 if group.clocks[0]:
            gone = random.randrange(len(group.clocks[0]))
            return _with(group, clocks=tuple(own[:gone] + own[gone + 1 :] for own in group.clocks))
        case 2 if group.channels[0]:
            gone = random.randrange(len(group.channels[0]))
            return _with(group, channels=tuple(own[:gone] + own[gone + 1 :] for own in group.channels))
        case 3 if group.names:
            gone = random.randrange(len(group.names))
            return _with(group, names=group.names[:gone] + group.names[gone + 1 :])
        case 4 if group.tables:
            return _with(group, names=(*group.names, (random.choice(slots), random.randrange(len(group.tables)))))
        case 5:
            column = random.sample(slots, group.size)
            return _with(group, slots=tuple((*own, new) for own, new in zip(group.slots, column, strict=True)))
        case 6 if group.clocks[0]:
            one, other = random.sample(range(group.size), 2)
            order = [*range(group.size)]
            order[one], order[other] = other, one
            return _with(group, clocks=tuple(group.clocks[member] for member in order))
        case 7 if channels >= group.size:
            column = random.sample(range(channels), group.size)
            return _with(group, channels=tuple((*o, new) for o, new in zip(group.channels, column, strict=True)))
    return _with(group, cyclic=not group.cyclic)


def _with(group: SymmetryGroup, **changes: object) -> SymmetryGroup:
    return SymmetryGroup(**{**group.to_json(), **changes})


def _possible(model: PreparedNetwork, predicates: Sequence[Expression], state: DiscreteState) -> Possible:
    found: dict[Hashable, Federation] = defaultdict(list)
    try:
        here = situation(model, state)
    except EvaluationFault:
        return {"an error in an invariant": []}
    found["invariant", here.delays, here.stopped] += [] if here.invariant is None else [here.invariant]
    found["urgent"] += here.urgent
    for fault in here.faults:
        found["error"] += fault.domain
    for move in here.moves:
        if move.target is None:
            found["error"] += move.domain
        else:
            found[move.target, frozenset(move.resets)] += subtract_all(move.domain, move.blockers)
    for number, predicate in enumerate(predicates):
        found["predicate", number] += where(model, here, predicate)
    return {what: zones for what, zones in found.items() if zones or what != "urgent"}


def _image(state: DiscreteState, given: StatePermutation) -> DiscreteState:
    before = (*state.locations, *state.values)
    after = list(before)
    for slot, value in enumerate(before):
        after[given.slot(slot)] = given.value(slot, value)
    processes = len(state.locations)
    return DiscreteState(tuple(after[:processes]), tuple(after[processes:]))


def _exchanged(what: Hashable, given: StatePermutation) -> Hashable:
    match what:
        case (DiscreteState() as target, frozenset() as resets):
            return _image(target, given), frozenset(
                (given.clock(clock), given.clock(source), more) for clock, source, more in resets
            )
        case ("invariant", delays, frozenset() as stopped):
            return "invariant", delays, frozenset(map(given.clock, stopped))
        case _:
            return what


def _zone(zone: Zone, given: StatePermutation) -> Zone:
    bounds = list(zone.bounds)
    for i in range(zone.dimension):
        for j in range(zone.dimension):
            bounds[given.clock(i) * zone.dimension + given.clock(j)] = zone.bounds[i * zone.dimension + j]
    return Zone(zone.dimension, tuple(bounds))
