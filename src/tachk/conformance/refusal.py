"""Where a recording leaves a model, and what the model would have done there.

From the state in which the longest run ends, the model goes on by all steps that no recording shows. On the way, every
event that it could do is an offer, whether it was recorded or not, with the time window in which it could come.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tachk.conformance.followers import Following
from tachk.conformance.queues import Queues
from tachk.engines.concretise import discrete_run
from tachk.model.expressions import Variable
from tachk.records import dataclass
from tachk.semantics import dbm, symbolic
from tachk.semantics.dbm import INFINITY, Zone
from tachk.semantics.discrete import PreparedNetwork, may_delay, prepare
from tachk.semantics.timed_trace import DiscreteState, Transition

_STATES = 200
"""At most so many states behind the longest run are looked at."""


@dataclass(frozen=True, slots=True)
class Offer:
    """An event that the model could do.

    Attributes:
        cells: what it would say.
        earliest, latest: when, in units of the model from its start; None: at any time.
    """

    name: str
    cells: tuple[tuple[str, int], ...]
    earliest: int
    latest: int | None


def offers(following: Following, queues: Queues, path: Sequence[Transition]) -> tuple[Offer, ...]:
    """What the model could do behind a run, by the earliest time."""
    lenient, said = following.lenient(queues)
    strict, model = prepare(following.network), prepare(lenient)
    discrete, zones = _end(strict, path)
    start = _moved(strict, discrete, model)
    clock = model.layout.initial[model.layout.first[following.now]]
    found: dict[tuple[int, tuple[tuple[str, int], ...]], tuple[int, int]] = {}
    pending: list[tuple[DiscreteState, list[Zone]]] = [(start, zones)]
    seen: dict[DiscreteState, list[Zone]] = {}
    looked_at = 0
    while pending and looked_at < _STATES:
        looked_at += 1
        discrete, arrived = pending.pop(0)
        here = symbolic.situation(model, discrete)
        passed = seen.setdefault(discrete, [])
        fresh = [z for z in symbolic.elapse(here, arrived) if not any(dbm.includes(p, z) for p in passed)]
        if not fresh:
            continue
        passed += fresh
        for move in here.moves:
            after = symbolic.fire(here, fresh, move)
            if not after or move.target is None:
                continue
            queue = following.queue_of(move.transition)
            if queue is None:
                pending.append((move.target, after))
                continue
            if not queues.queues[queue].outputs:
                continue
            key = (queue, tuple(_cells(model, move.target, said[queue])))
            for zone in after:
                window = (-dbm.bound_value(zone[0, clock]), zone[clock, 0])
                before = found.get(key, window)
                found[key] = (min(window[0], before[0]), max(window[1], before[1]))
    return tuple(
        Offer(queues.queues[queue].visible.event, cells, low, None if raw == INFINITY else dbm.bound_value(raw))
        for (queue, cells), (low, raw) in sorted(found.items(), key=lambda item: item[1][0])
    )


def state_text(following: Following, discrete: DiscreteState) -> str:
    """The locations of the processes of the model."""
    processes = zip(following.network.processes, discrete.locations, strict=True)
    named = [f"{p.name}.{p.locations[location].name}" for p, location in processes]
    return ", ".join(named[-len(following.kept) :] if following.kept else [])


def end_of(following: Following, path: Sequence[Transition]) -> DiscreteState:
    """The discrete state in which a run ends."""
    return _end(prepare(following.network), path)[0]


def _end(model: PreparedNetwork, path: Sequence[Transition]) -> tuple[DiscreteState, list[Zone]]:
    """The state in which a run ends, and the clock valuations with which it does; of a guard with several parts the
    first that is possible counts."""
    states, phases = discrete_run(model, path)
    zone: Zone | None = dbm.origin(model.dimension)
    for number, state in enumerate(states):
        invariant = symbolic.invariant_zone(model, state)
        assert zone is not None and invariant is not None
        zone = dbm.intersect(zone, invariant)
        if number == len(path) or zone is None:
            break
        if may_delay(model, state):
            zone = dbm.intersect(dbm.up(zone, phases[number].stopped), invariant)
        guards = symbolic.guard_of(model, state, path[number])
        possible = (zone and dbm.constrain_all(zone, guard) for guard in guards)
        zone = next((narrowed for narrowed in possible if narrowed is not None), None)
        for clock, (since, value) in enumerate(phases[number + 1].resets[: model.dimension]):
            if zone is not None and clock > 0 and since == number + 1:
                zone = dbm.reset(zone, clock, value)
    return states[-1], [] if zone is None else [zone]


def _moved(model: PreparedNetwork, discrete: DiscreteState, other: PreparedNetwork) -> DiscreteState:
    """The state of another network whose variables are those of the first one and some more."""
    values = list(other.layout.initial)
    for variable, first in model.layout.first.items():
        place = other.layout.first[variable]
        count = len(variable.initial)
        values[place : place + count] = discrete.values[first : first + count]
    return DiscreteState(discrete.locations, tuple(values))


def _cells(
    model: PreparedNetwork, discrete: DiscreteState, said: Sequence[tuple[str, Variable]]
) -> Iterator[tuple[str, int]]:
    for name, variable in said:
        yield name, discrete.values[model.layout.first[variable]]
