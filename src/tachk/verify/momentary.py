"""Conditions that hold for no time only: in a chain of committed or urgent locations, and no longer at its end.

Temporal properties speak of what lasts. A trigger that is true for no time asks for nothing, a condition that must
always be true may lapse for no time, and a property may hold because of that. The verdict then says so. Whether it
happens is a question of reachability about a network in which each edge that begins a transition notes whether the
condition was false when the chain began and has been true since. It is not a part of the property: where it takes more
states than it may, the verdict says that it is not known. Invariants and urgent channels that stop time are not looked
at. What is so where a run ends in a committed or urgent location, or takes steps for ever in such ones, does not last
either: a formula without deadline counts it, every other one gets a note.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from tachk.analysis.fold import cannot_fail
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, replace
from tachk.base.words import Direction, QueryKind
from tachk.engine.options import Limits
from tachk.model.connectives import any_of, both, negation
from tachk.model.expressions import (
    BOOL,
    INT,
    Assign,
    Binary,
    Conditional,
    Constant,
    Deadlock,
    Expression,
    LocationTest,
    Reference,
    Variable,
    VariableKind,
)
from tachk.model.network import Edge, Location, Network
from tachk.model.query import Observer, Query
from tachk.model.traversal import roots, walk, with_bodies, written_variables
from tachk.model.types import IntType
from tachk.verify.verdict import Answer, Verdict

FEWEST_STATES = 20_000
"""So many states may be stored for a trigger, or as many as the property took."""

_STATES_OF_LOOPS = 5_000
"""So many may be stored for runs that take steps for ever while time stops: to look for cycles takes longer."""


@dataclass(frozen=True, slots=True)
class _MomentaryCondition:
    """Attributes:
    text: of a condition.
    truth: whether it matters that the condition is true, or that it is false.
    """

    text: str
    truth: bool

    @property
    def shown(self) -> str:
        return f"`{' '.join(self.text.split())}`"

    @property
    def value(self) -> str:
        return "true" if self.truth else "false"


@dataclass(frozen=True, slots=True)
class _EdgeEnd:
    """An edge that may be one side of a synchronisation."""

    process: int
    source: int
    target: int


_Ends = Mapping[tuple[Variable, bool], set[_EdgeEnd]]

_OPEN, _LASTING, _RISEN = Constant(0), Constant(1), Constant(2)
"""The note about a condition in a chain: it was false when the chain began; it was true then; it was false and has been
true since. Where no chain is open, there is no note, which counts as false."""

Deciding = Callable[[Network, Sequence[Query], Limits], Sequence[Verdict]]
"""The function that answers queries about a network."""


def with_momentary_triggers(
    network: Network, verdicts: Sequence[Verdict], limits: Limits, decide: Deciding
) -> tuple[Verdict, ...]:
    """The verdicts, those that hold with a note for each trigger that is true for no time only, and for each condition
    that must always be true and is false for no time only."""
    stopped = _may_stop_time(network)
    if stopped is None:
        return tuple(verdicts)
    stored = 0
    conditions: dict[_MomentaryCondition, Expression] = {}
    for verdict in verdicts:
        if _may_be_noted(verdict):
            conditions |= _moments(verdict.query.observer)
            stored = max(stored, verdict.statistics.states_stored)
    ends = _ends_by_channel(network) if conditions else {}
    chains = {of: _left_in_chains(network, ends, condition) for of, condition in conditions.items()}
    goals = {of: both(left, conditions[of]) for of, left in chains.items() if left and cannot_fail(conditions[of])}
    bounded = limits.of_states(max(FEWEST_STATES, stored))
    verdicts = _with_stuck_conditions(network, verdicts, limits.of_states(FEWEST_STATES), decide)
    verdicts = _with_endless_conditions(network, stopped, verdicts, limits.of_states(_STATES_OF_LOOPS), decide)
    if not goals:
        return tuple(verdicts)
    # First whether it is so in a chain at all: that looks at fewer processes.
    found = _reached(network, goals, bounded, decide)
    in_chains = {of: conditions[of] for of in goals if found[of].answer is Answer.HOLDS}
    watched, momentary = _watched(network, stopped, ends, in_chains)
    where = _kinds_of_locations(network)
    notes = {of: _not_known(of, where, found[of]) for of in goals if found[of].answer is Answer.UNKNOWN}
    notes |= {of: _note(of, where, answer) for of, answer in _reached(watched, momentary, bounded, decide).items()}
    return tuple(_noted(verdict, notes) for verdict in verdicts)


def _with_stuck_conditions(
    network: Network, verdicts: Sequence[Verdict], bounded: Limits, decide: Deciding
) -> Sequence[Verdict]:
    """The verdicts, those that hold with a note for each condition that counts only where it lasts, and that a run ends
    with in a committed or urgent location, as far as the states that may be stored show it."""
    ends = _some_stops_time(network, _perhaps_last_places(network))
    if ends is None:
        return verdicts
    goals = {of: both(ends, condition) for of, condition in _lasting_only(verdicts).items() if cannot_fail(condition)}
    # First whether it is so in such a location at all: to look for deadlocks takes more states.
    there = _reached(network, goals, bounded, decide)
    stuck = {of: both(goals[of], Deadlock()) for of, found in there.items() if found.answer is Answer.HOLDS}
    where = _kinds_of_locations(network)
    notes = {
        of: f"{of.shown} is also {of.value} where runs end in {where}; that does not count"
        for of, found in _reached(network, stuck, bounded, decide).items()
        if found.answer is Answer.HOLDS
    }
    return [_noted(verdict, notes) if _needs_time(verdict) else verdict for verdict in verdicts]


def _with_endless_conditions(
    network: Network, stopped: Expression, verdicts: Sequence[Verdict], bounded: Limits, decide: Deciding
) -> Sequence[Verdict]:
    """The same for conditions that are so again and again while a run takes steps for ever in such locations."""
    conditions = _lasting_only(verdicts)
    if not conditions or not _may_go_on(network):
        return verdicts
    (anything,) = decide(network, [_left_again(0, stopped, None)], bounded)
    if anything.answer is not Answer.FAILS:  # no run does that, as far as it is known
        return verdicts
    goals = {of: condition for of, condition in conditions.items() if cannot_fail(condition)}
    queries = [_left_again(number, stopped, condition) for number, condition in enumerate(goals.values())]
    where = _kinds_of_locations(network)
    notes = {
        of: f"{of.shown} is also {of.value} where runs take steps for ever in {where}; that does not count"
        for of, verdict in zip(goals, decide(network, queries, bounded) if queries else (), strict=True)
        if verdict.answer is Answer.FAILS
    }
    return [_noted(verdict, notes) if _needs_time(verdict) else verdict for verdict in verdicts]


def _left_again(number: int, stopped: Expression, condition: Expression | None) -> Query:
    """The query whether time passes again in every run without end that meets a condition again and again; conditions
    of formulas are not about clocks."""
    true, false = Constant(1, BOOL), Constant(0, BOOL)
    met, leaves = (true if condition is None else condition), negation(stopped)
    return Query(f"momentary {number}", QueryKind.LEADS_TO, stopped, (leaves,), again=(met,), ends=false)


def _may_go_on(network: Network) -> bool:
    """True if some process has a cycle of edges that it may take while time stops: through one of its own locations
    that stop it, or anywhere while another process is in an urgent location."""
    urgent = {process for process, _ in _urgent_places(network)}
    edges = [(process.locations[edge.source], edge) for process in network.processes for edge in process.edges]
    joined = {channel for source, edge in edges if _stops_time(source) for channel in _channels(edge)}
    for number, process in enumerate(network.processes):
        free = bool(urgent - {number})
        following: defaultdict[int, set[int]] = defaultdict(set)
        for edge in process.edges:
            stops = _stops_time(process.locations[edge.source])
            if free or stops or not joined.isdisjoint(_channels(edge)):
                following[edge.source].add(edge.target)
        places = [place for place, location in enumerate(process.locations) if free or _stops_time(location)]
        if any(place in _behind(following, place) for place in places):
            return True
    return False


def _channels(edge: Edge) -> frozenset[Variable]:
    return frozenset() if edge.synchronisation is None else frozenset(roots(edge.synchronisation.channel))


def _behind(following: Mapping[int, set[int]], place: int) -> set[int]:
    """The places that are reached from a place by one step or more."""
    pending, seen = list(following.get(place, ())), set(following.get(place, ()))
    while pending:
        for after in following.get(pending.pop(), set()) - seen:
            seen.add(after)
            pending.append(after)
    return seen


def _lasting_only(verdicts: Sequence[Verdict]) -> dict[_MomentaryCondition, Expression]:
    """The conditions of those verdicts that need time: they count only where they last."""
    found: dict[_MomentaryCondition, Expression] = {}
    for verdict in verdicts:
        if _needs_time(verdict):
            found |= _moments(verdict.query.observer)
    return found


def _needs_time(verdict: Verdict) -> bool:
    """True if the last values of a run count only if time passes: the formula asks nothing of runs without end."""
    return _may_be_noted(verdict) and verdict.query.observer is not None and not verdict.query.observer.endings


def _perhaps_last_places(network: Network) -> Iterator[tuple[int, int]]:
    """The locations that are not left by an edge that is always possible: updates may break an invariant anywhere."""
    bounded = any(location.invariant is not None for process in network.processes for location in process.locations)
    for number, process in enumerate(network.processes):
        free = {
            edge.source
            for edge in process.edges
            if not (bounded and edge.updates) and _is_always_possible(network, number, edge)
        }
        yield from ((number, place) for place, _ in enumerate(process.locations) if place not in free)


def _is_always_possible(network: Network, process: int, edge: Edge) -> bool:
    """True if an edge waits for nothing: no guard, no partner, no invariant behind it, no edge that goes before it."""
    return (
        edge.guard is None
        and edge.synchronisation is None
        and not edge.selects
        and network.processes[process].locations[edge.target].invariant is None
        and not network.has_priorities
    )


def _stops_time(location: Location) -> bool:
    return location.committed or location.urgent


def _may_stop_time(network: Network) -> Expression | None:
    """The predicate that some process is in a committed or urgent location. None: there is no such location."""
    return _some_stops_time(
        network, ((p, n) for p, process in enumerate(network.processes) for n, _ in enumerate(process.locations))
    )


def _kinds_of_locations(network: Network) -> str:
    """The kinds of locations that stop time in the network, in words."""
    locations = [location for process in network.processes for location in process.locations]
    committed = any(location.committed for location in locations)
    urgent = any(location.urgent for location in locations)
    return " or ".join([*(["committed"] if committed else []), *(["urgent"] if urgent else [])]) + " locations"


def _may_be_noted(verdict: Verdict) -> bool:
    return verdict.query.observer is not None and verdict.answer is Answer.HOLDS


def _moments(observer: Observer | None) -> dict[_MomentaryCondition, Expression]:
    """The conditions that may hold for no time."""
    if observer is None:
        return {}
    found = {_MomentaryCondition(text, True): condition for text, condition in observer.triggers}
    return found | {_MomentaryCondition(text, False): negation(condition) for text, condition in observer.demanded}


def _noted(verdict: Verdict, notes: Mapping[_MomentaryCondition, str]) -> Verdict:
    own = [notes[of] for of in _moments(verdict.query.observer) if notes.get(of)] if _may_be_noted(verdict) else []
    return replace(verdict, notes=(*verdict.notes, *own)) if own else verdict


def _reached(
    network: Network, goals: Mapping[_MomentaryCondition, Expression], limits: Limits, decide: Deciding
) -> Mapping[_MomentaryCondition, Verdict]:
    """The verdicts whether each of the goals is reached."""
    queries = [Query(f"momentary {number}", QueryKind.POSSIBLY, goal) for number, goal in enumerate(goals.values())]
    verdicts = decide(network, queries, limits) if queries else ()
    return dict(zip(goals, verdicts, strict=True))


def _note(of: _MomentaryCondition, where: str, answer: Verdict) -> str:
    match answer.answer:
        case Answer.HOLDS:
            return f"{of.shown} is also {of.value} for no time, in {where}; that does not count"
        case Answer.UNKNOWN:
            return (
                f"{of.shown} is also {of.value} in {where}, where it does not count; "
                f"whether it is {of.value} only there at some moment is not known ({answer.reason})"
            )
        case Answer.FAILS:
            return ""


def _not_known(of: _MomentaryCondition, where: str, answer: Verdict) -> str:
    return f"whether {of.shown} is also {of.value} for no time, in {where}, is not known ({answer.reason})"


def _left_in_chains(network: Network, ends: _Ends, condition: Expression) -> Expression | None:
    """The predicate that a transition of a chain may begin that changes the condition: a participant is in one of these
    committed locations, or any process in one of these urgent ones. None where no such transition may."""
    read = {node.variable for node in _nodes(condition) if isinstance(node, Reference)}
    placed = {(node.process, node.location) for node in _nodes(condition) if isinstance(node, LocationTest)}
    found: set[tuple[int, int]] = set()
    for number, process in enumerate(network.processes):
        for edge in process.edges:
            moves = edge.source != edge.target and not placed.isdisjoint({(number, edge.source), (number, edge.target)})
            if moves or not read.isdisjoint(written_variables(edge.updates)):
                found.add((number, edge.source))
                found |= {(end.process, end.source) for end in _partners(edge, ends)}
    changing = {process for process, _ in found}
    waiting = {place for place in _urgent_places(network) if changing - {place[0]}}
    return _some_stops_time(network, found | waiting)


def _urgent_places(network: Network) -> Iterator[tuple[int, int]]:
    """The urgent locations: other processes may act while a process is there."""
    for number, process in enumerate(network.processes):
        yield from ((number, place) for place, location in enumerate(process.locations) if location.urgent)


def _some_stops_time(network: Network, places: Iterable[tuple[int, int]]) -> Expression | None:
    """The predicate that some process is in one of the given locations and this stops time; None: none of them does."""
    tests: list[Expression] = [
        LocationTest(process, location)
        for process, location in sorted(places)
        if _stops_time(network.processes[process].locations[location])
    ]
    return any_of(tests) if tests else None


def _ends_by_channel(network: Network) -> _Ends:
    """For each channel, the edges that send on it (True) and that receive (False)."""
    found: defaultdict[tuple[Variable, bool], set[_EdgeEnd]] = defaultdict(set)
    for number, process in enumerate(network.processes):
        for edge in process.edges:
            if edge.synchronisation is not None:
                for channel in roots(edge.synchronisation.channel):
                    sends = edge.synchronisation.direction is Direction.SEND
                    found[channel, sends].add(_EdgeEnd(number, edge.source, edge.target))
    return found


def _partners(edge: Edge, ends: _Ends) -> set[_EdgeEnd]:
    """The edges with which the edge may synchronise."""
    if edge.synchronisation is None:
        return set()
    receives = edge.synchronisation.direction is Direction.RECEIVE
    return {end for channel in roots(edge.synchronisation.channel) for end in ends.get((channel, receives), ())}


def _nodes(condition: Expression) -> Iterator[Expression]:
    for outer in with_bodies([condition]):
        yield from walk(outer)


def _watched(
    network: Network, stopped: Expression, ends: _Ends, conditions: Mapping[_MomentaryCondition, Expression]
) -> tuple[Network, Mapping[_MomentaryCondition, Expression]]:
    """The network with a variable for each condition, and what is true where it has been true for no time.

    The variables are set before a transition changes anything, so they tell of the states before it.
    """
    variables = {of: _variable(number) for number, of in enumerate(conditions)}
    noted = [(variables[of], condition) for of, condition in conditions.items()]
    processes = tuple(
        replace(
            process,
            edges=tuple(
                replace(edge, updates=(*_noting(network, number, edge, ends, noted), *edge.updates))
                if edge.begins
                else edge
                for edge in process.edges
            ),
        )
        for number, process in enumerate(network.processes)
    )
    over = {
        of: both(both(negation(stopped), negation(condition)), _is(Reference(variables[of]), _RISEN))
        for of, condition in conditions.items()
    }
    return replace(network, processes=processes, variables=(*network.variables, *variables.values())), over


def _noting(
    network: Network, process: int, edge: Edge, ends: _Ends, noted: Sequence[tuple[Variable, Expression]]
) -> Iterator[Expression]:
    """The notes that the edge takes of each condition before it begins a transition.

    While a process is in a committed location, a process that takes part is, so most edges know whether a chain begins
    with them, goes on, or neither. An urgent location may be that of a process that does not take part.
    """
    partners = _partners(edge, ends)
    locations = network.processes[process].locations
    chain_follows = _stops_time(locations[edge.target]) or any(
        _stops_time(network.processes[end.process].locations[end.target]) for end in partners
    )
    elsewhere = {place for place in _urgent_places(network) if place[0] != process}
    others_stop = _some_stops_time(network, elsewhere | {(end.process, end.source) for end in partners})
    for variable, condition in noted:
        so_far = Reference(variable)
        again = Conditional(both(_is(so_far, _OPEN), condition), _RISEN, so_far, INT)
        anew = Conditional(condition, _LASTING, _OPEN, INT) if chain_follows else _OPEN
        if _stops_time(locations[edge.source]):
            yield Assign(so_far, again, INT)
        elif others_stop is None:
            yield Assign(so_far, anew, INT)
        else:
            yield Assign(so_far, Conditional(others_stop, again, anew, INT), INT)


def _is(noted: Expression, value: Constant) -> Expression:
    return Binary(BinaryOperator.EQUAL, noted, value, BOOL)


def _variable(number: int) -> Variable:
    return Variable(f"momentary.{number}", IntType(0, 2), VariableKind.GLOBAL, (0,))
