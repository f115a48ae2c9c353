"""What is so for no time only: in a chain of committed locations, and no longer at its end.

Temporal properties speak of what lasts. A trigger that is true for no time asks for nothing, a condition that must
always be true may lapse for no time, and a property may hold because of that. The verdict then says so. Whether it
happens is a question of reachability about a network in which each edge that begins a transition notes what the
condition was when the chain began and whether it has been true since. It is no part of the property: where it takes
more states than it may, the verdict says that it is not known.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from time import monotonic

from tachk.compiler.fold import cannot_fail
from tachk.engines.options import Limits
from tachk.model.connectives import any_of, as_number, both, either, is_set, negation, somebody_committed
from tachk.model.expressions import (
    INT,
    Assign,
    Conditional,
    Constant,
    Expression,
    LocationTest,
    Reference,
    Variable,
    VariableKind,
)
from tachk.model.network import Network
from tachk.model.query import Observer, Query
from tachk.model.traversal import roots, walk, with_bodies, written_variables
from tachk.model.types import IntType
from tachk.properties.verdict import Answer, Verdict
from tachk.records import dataclass
from tachk.words import Direction, QueryKind

FEWEST_STATES = 20_000
"""So many states may be stored for a trigger, or as many as the property took."""


@dataclass(frozen=True, slots=True)
class _Moment:
    """Attributes:
    text: of a condition.
    truth: whether it matters that the condition is true, or that it is false.
    """

    text: str
    truth: bool


_Ends = Mapping[tuple[Variable, bool], set[tuple[int, int]]]

Deciding = Callable[[Network, Sequence[Query], Limits], Sequence[Verdict]]
"""What answers queries about a network."""


def with_momentary_triggers(
    network: Network, verdicts: Sequence[Verdict], limits: Limits, decide: Deciding
) -> tuple[Verdict, ...]:
    """The verdicts, those that hold with a note for each trigger that is true for no time only, and for each condition
    that must always be true and is false for no time only."""
    started = monotonic()
    committed = somebody_committed(network)
    if isinstance(committed, Constant):
        return tuple(verdicts)
    stored = 0
    conditions: dict[_Moment, Expression] = {}
    for verdict in verdicts:
        if _may_be_noted(verdict):
            conditions |= _moments(verdict.query.observer)
            stored = max(stored, verdict.statistics.states_stored)
    ends = _ends_by_channel(network) if conditions else {}
    chains = {of: _left_in_chains(network, ends, condition) for of, condition in conditions.items()}
    goals = {of: both(left, conditions[of]) for of, left in chains.items() if left and cannot_fail(conditions[of])}
    if not goals:
        return tuple(verdicts)
    # First whether it is so in a chain at all: that looks at fewer processes.
    bounded = limits.of_states(max(FEWEST_STATES, stored))
    found = _reached(network, goals, bounded, decide)
    in_chains = {of: conditions[of] for of in goals if found[of].answer is Answer.HOLDS}
    watched, momentary = _watched(network, committed, in_chains)
    left = bounded.after(monotonic() - started)
    notes = {of: _note(of, answer) for of, answer in _reached(watched, momentary, left, decide).items()}
    return tuple(_noted(verdict, notes) for verdict in verdicts)


def _may_be_noted(verdict: Verdict) -> bool:
    return verdict.query.observer is not None and verdict.answer is Answer.HOLDS


def _moments(observer: Observer | None) -> dict[_Moment, Expression]:
    """What may be so for no time, each as a condition."""
    if observer is None:
        return {}
    found = {_Moment(text, True): condition for text, condition in observer.triggers}
    return found | {_Moment(text, False): negation(condition) for text, condition in observer.demanded}


def _noted(verdict: Verdict, notes: Mapping[_Moment, str]) -> Verdict:
    own = [notes[of] for of in _moments(verdict.query.observer) if notes.get(of)] if _may_be_noted(verdict) else []
    return replace(verdict, notes=(*verdict.notes, *own)) if own else verdict


def _reached(
    network: Network, goals: Mapping[_Moment, Expression], limits: Limits, decide: Deciding
) -> Mapping[_Moment, Verdict]:
    """Whether each of the goals is reached."""
    queries = [Query(f"momentary {number}", QueryKind.POSSIBLY, goal) for number, goal in enumerate(goals.values())]
    verdicts = decide(network, queries, limits) if queries else ()
    return dict(zip(goals, verdicts, strict=True))


def _note(of: _Moment, answer: Verdict) -> str:
    shown, truth = " ".join(of.text.split()), "true" if of.truth else "false"
    match answer.answer:
        case Answer.HOLDS:
            return f"`{shown}` is also {truth} for no time, in committed locations; that does not count"
        case Answer.UNKNOWN:
            return (
                f"`{shown}` is also {truth} in committed locations, where it does not count; "
                f"whether it is {truth} only there at some moment is not known ({answer.reason})"
            )
        case Answer.FAILS:
            return ""


def _left_in_chains(network: Network, ends: _Ends, condition: Expression) -> Expression | None:
    """Where a transition of a chain of committed locations begins that may change the condition: in one of these
    locations a participant is. None where no such transition may."""
    read = {node.variable for node in _nodes(condition) if isinstance(node, Reference)}
    placed = {(node.process, node.location) for node in _nodes(condition) if isinstance(node, LocationTest)}
    found: set[tuple[int, int]] = set()
    for number, process in enumerate(network.processes):
        for edge in process.edges:
            moves = edge.source != edge.target and not placed.isdisjoint({(number, edge.source), (number, edge.target)})
            if moves or not read.isdisjoint(written_variables(edge.updates)):
                found.add((number, edge.source))
                if edge.synchronisation is not None:
                    for channel in roots(edge.synchronisation.channel):
                        found |= ends[channel, edge.synchronisation.direction is Direction.RECEIVE]
    tests: list[Expression] = [
        LocationTest(process, location)
        for process, location in sorted(found)
        if network.processes[process].locations[location].committed
    ]
    return any_of(tests) if tests else None


def _ends_by_channel(network: Network) -> _Ends:
    """For each channel and for its senders (True) and its receivers (False): processes and locations of their edges."""
    found: defaultdict[tuple[Variable, bool], set[tuple[int, int]]] = defaultdict(set)
    for number, process in enumerate(network.processes):
        for edge in process.edges:
            if edge.synchronisation is not None:
                for channel in roots(edge.synchronisation.channel):
                    found[channel, edge.synchronisation.direction is Direction.SEND].add((number, edge.source))
    return found


def _nodes(condition: Expression) -> Iterator[Expression]:
    for outer in with_bodies([condition]):
        yield from walk(outer)


def _watched(
    network: Network, committed: Expression, conditions: Mapping[_Moment, Expression]
) -> tuple[Network, Mapping[_Moment, Expression]]:
    """The network with two variables for each condition, and what is true where it has been true for no time.

    The variables are set before a transition changes anything, so they tell of the states before it.
    """
    variables, noted, over = [], [], {}
    for number, (of, condition) in enumerate(conditions.items()):
        before, risen = (_variable(f"{name}{number}") for name in ("before", "risen"))
        was, has_been = Reference(before), Reference(risen)
        again = as_number(both(negation(is_set(was)), either(is_set(has_been), condition)))
        variables += [before, risen]
        noted += [
            Assign(has_been, Conditional(committed, again, Constant(0), INT), INT),
            Assign(was, Conditional(committed, was, as_number(condition), INT), INT),
        ]
        over[of] = both(both(negation(committed), negation(condition)), is_set(has_been))
    processes = tuple(
        replace(
            process,
            edges=tuple(
                replace(edge, updates=(*noted, *edge.updates)) if edge.begins else edge for edge in process.edges
            ),
        )
        for process in network.processes
    )
    return replace(network, processes=processes, variables=(*network.variables, *variables)), over


def _variable(name: str) -> Variable:
    return Variable(f"momentary.{name}", IntType(0, 1), VariableKind.GLOBAL, (0,))
