"""The rejection of a recording: the place where it leaves a model, and the events that the model allows there.

From the state in which the longest run ends, the model goes on by all steps that no recording shows. On the way, every
event that it could do is enabled, whether it was recorded or not, with the time window in which it could come.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import isqrt

from tachk.base.job import check_job
from tachk.base.records import dataclass, replace
from tachk.engine.compiler.program import Program
from tachk.engine.exact.concretise import discrete_run
from tachk.engine.exact.exact_run import end_of_path
from tachk.meaning import dbm, symbolic
from tachk.meaning.constraints import TooManyConjunctionsError
from tachk.meaning.dbm import INFINITY, Zone
from tachk.meaning.discrete import PreparedNetwork, execute_updates, may_delay, prepare
from tachk.model.expressions import Variable
from tachk.model.network import Network
from tachk.model.recording import RecordingMap, VisibleEvents
from tachk.model.run import DiscreteState, Transition
from tachk.model.types import slot_count
from tachk.recordings.conformance.event_streams import EventStreams, around, with_words
from tachk.recordings.conformance.events import Cell
from tachk.recordings.conformance.trace_product import TraceProduct, trace_product

_STATES = 200
"""At most so many states behind the longest run are looked at."""
_CASES = 1_000
"""States are not looked at whose steps have guards that are disjunctions of more conjunctions than this."""


@dataclass(frozen=True, slots=True)
class PossibleEvent:
    """An event that the model could do.

    Attributes:
        cells: what it would say.
        earliest, latest: when, in units of the model from its start; None: at any time.
    """

    name: str
    cells: tuple[tuple[str, Cell], ...]
    earliest: int
    latest: int | None


@dataclass(frozen=True, slots=True)
class AllowedEvents:
    """Attributes:
    offers: by the earliest time.
    whole: there are no others.
    """

    enabled_events: tuple[PossibleEvent, ...]
    whole: bool


@dataclass(frozen=True, slots=True)
class FinalState:
    """The state in which a run ends.

    Attributes:
        locations: one for each process of the network that follows the recording.
        values: the cells of its variables.
        zones: the clock valuations with which it does.
    """

    locations: tuple[int, ...]
    values: Mapping[Variable, tuple[int, ...]]
    zones: tuple[Zone, ...]


def end_of(
    product: TraceProduct, program: Program, path: Sequence[Transition], actions: Sequence[Sequence[int]]
) -> FinalState:
    """The state in which a path ends; found by the core, or by the reference where the core does not know it.

    Args:
        program: of the network that follows the recording; it has the recording's tables in its code.
        actions: the path by the numbers of the edges of the program.
    """
    found = end_of_path(program, actions)
    if found is None:
        return end_by_reference(product, path)
    slots, bounds = found
    return end_in_slots(product, slots, Zone(isqrt(len(bounds)), bounds) if bounds else None)


def end_in_slots(product: TraceProduct, slots: tuple[int, ...], zone: Zone | None) -> FinalState:
    """The state that the slots of a program of the network hold."""
    place = processes = len(product.network.processes)
    values = {}
    for variable in product.network.all_variables():
        if variable not in product.tables:
            count = slot_count(variable.type)
            values[variable] = slots[place : place + count]
            place += count
    return FinalState(slots[:processes], values, () if zone is None else (zone,))


def end_by_reference(product: TraceProduct, path: Sequence[Transition]) -> FinalState:
    """The same by the meaning of the network."""
    model = prepare(product.network)
    discrete, zones = _end(model, path)
    layout = model.layout
    values = {v: discrete.values[n : n + slot_count(v.type)] for v, n in layout.first.items()}
    return FinalState(discrete.locations, values, tuple(zones))


def enabled_events(
    network: Network,
    mapping: RecordingMap,
    product: TraceProduct,
    streams: EventStreams,
    happened: Sequence[int],
    end: FinalState,
) -> AllowedEvents:
    """The events that the model allows after a run.

    Of the recording only what is next matters, so that a long one takes no longer than a short one.

    Args:
        network, mapping: of which the other network was made.
        happened: how many events of each stream have happened.
    """
    next_streams = around(streams, happened)
    product = trace_product(network, mapping, next_streams, product.modelled)
    lenient, said = product.lenient(next_streams)
    model = replace(prepare(lenient), most_cases=_CASES)
    start, zones = _start(model, product, happened, end), list(end.zones)
    clock = model.layout.initial[model.layout.first[product.now]]
    found: dict[tuple[int, tuple[tuple[str, int], ...]], tuple[int, int]] = {}
    pending: list[tuple[DiscreteState, list[Zone]]] = [(start, zones)]
    seen: dict[DiscreteState, list[Zone]] = {}
    explored, whole = 0, True
    while pending and explored < _STATES:
        check_job()
        explored += 1
        discrete, arrived = pending.pop(0)
        try:
            here = symbolic.situation(model, discrete)
        except TooManyConjunctionsError:
            whole = False
            continue
        passed = seen.setdefault(discrete, [])
        fresh = [z for z in symbolic.elapse(here, arrived) if not any(dbm.includes(p, z) for p in passed)]
        if not fresh:
            continue
        passed += fresh
        for move in here.moves:
            after = symbolic.fire(here, fresh, move)
            if not after or move.target is None:
                continue
            stream = product.stream_of(move.transition)
            if stream is None:
                pending.append((move.target, after))
                continue
            if not streams.streams[stream].outputs:
                continue
            key = (stream, tuple(_cells(model, move.target, said[stream])))
            for zone in after:
                window = (-dbm.bound_value(zone[0, clock]), zone[clock, 0])
                before = found.get(key, window)
                found[key] = (min(window[0], before[0]), max(window[1], before[1]))
    allowed = tuple(
        _possible(streams.streams[n].visible, cells, low, raw)
        for (n, cells), (low, raw) in sorted(found.items(), key=lambda item: item[1][0])
    )
    return AllowedEvents(allowed, whole and not pending)


def state_text(product: TraceProduct, end: FinalState) -> str:
    """The locations of the processes of the model."""
    processes = zip(product.network.processes, end.locations, strict=True)
    named = [f"{p.name}.{p.locations[location].name}" for p, location in processes]
    return ", ".join(named[place] for place in product.places_of_modelled)


def _end(model: PreparedNetwork, path: Sequence[Transition]) -> tuple[DiscreteState, list[Zone]]:
    """The state in which a run ends, and the clock valuations with which it does; of a guard with several parts the
    first that is possible counts."""
    states, phases = discrete_run(model, path)
    zone: Zone | None = dbm.point(model.layout.starts)
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
        if zone is not None:
            zone = dbm.assign(zone, execute_updates(model, state, path[number])[1])
    return states[-1], [] if zone is None else [zone]


def _start(model: PreparedNetwork, product: TraceProduct, happened: Sequence[int], end: FinalState) -> DiscreteState:
    """The state of the network with the near events of each stream only."""
    values = list(model.layout.initial)
    for variable, first in model.layout.first.items():
        if variable in end.values and variable not in product.tables:
            values[first : first + slot_count(variable.type)] = end.values[variable]
    for position, count in zip(product.positions, happened, strict=True):
        values[model.layout.first[position]] = min(count, 1)
    return DiscreteState(end.locations, tuple(values))


def _possible(visible: VisibleEvents, cells: Iterable[tuple[str, int]], low: int, raw: int) -> PossibleEvent:
    """The event with locations by their names, and its latest time from a raw bound."""
    said = tuple(with_words(visible, cells))
    return PossibleEvent(visible.event, said, low, None if raw == INFINITY else dbm.bound_value(raw))


def _cells(
    model: PreparedNetwork, discrete: DiscreteState, said: Sequence[tuple[str, Variable]]
) -> Iterator[tuple[str, int]]:
    for name, variable in said:
        yield name, discrete.values[model.layout.first[variable]]
