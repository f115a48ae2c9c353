"""Triggers that are true for no time only: in a chain of committed locations, and no longer at its end.

Temporal properties speak of what lasts, so such a trigger asks for nothing, and a property may hold because of that.
The verdict then says so. Whether a trigger is ever momentary is a question of reachability about a network in which
each edge that begins a transition notes what the trigger was when the chain began and whether it has been true since.
It is no part of the property: where it takes more states than it may, the verdict says that it is not known.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from time import monotonic

from tachk.compiler.fold import cannot_fail
from tachk.engines.options import Limits
from tachk.model.connectives import any_of, both, either, negation
from tachk.model.expressions import (
    BOOL,
    INT,
    Assign,
    Binary,
    Conditional,
    Constant,
    Expression,
    LocationTest,
    Reference,
    Variable,
    VariableKind,
)
from tachk.model.network import Edge, Network
from tachk.model.query import Query
from tachk.model.traversal import roots, walk, with_bodies, written_variables
from tachk.model.types import IntType
from tachk.operators import BinaryOperator
from tachk.properties.verdict import Answer, Verdict
from tachk.words import Direction, QueryKind

FEWEST_STATES = 20_000
"""So many states may be stored for a trigger, or as many as the property took."""


Deciding = Callable[[Network, Sequence[Query], Limits], Sequence[Verdict]]
"""What answers queries about a network."""


def with_momentary_triggers(
    network: Network, verdicts: Sequence[Verdict], limits: Limits, decide: Deciding
) -> tuple[Verdict, ...]:
    """The verdicts, those that hold with a note for each trigger that is true for no time only."""
    started = monotonic()
    stored = 0
    triggers: dict[str, Expression] = {}
    for verdict in verdicts:
        if verdict.query.observer is not None and verdict.answer is Answer.HOLDS:
            triggers |= verdict.query.observer.triggers
            stored = max(stored, verdict.statistics.states_stored)
    committed = _committed(network)
    chains = {text: _left_in_chains(network, condition) for text, condition in triggers.items() if committed}
    goals = {text: both(left, triggers[text]) for text, left in chains.items() if left and cannot_fail(triggers[text])}
    if committed is None or not goals:
        return tuple(verdicts)
    # First whether a trigger is true in a chain at all: that looks at fewer processes.
    bounded = limits.of_states(max(FEWEST_STATES, stored))
    found = _reached(network, goals, bounded, decide)
    in_chains = {text: triggers[text] for text in goals if found[text].answer is Answer.HOLDS}
    watched, momentary = _watched(network, committed, in_chains)
    left = bounded.after(monotonic() - started)
    notes = {text: _note(text, answer) for text, answer in _reached(watched, momentary, left, decide).items()}
    return tuple(_noted(verdict, notes) for verdict in verdicts)


def _noted(verdict: Verdict, notes: Mapping[str, str]) -> Verdict:
    if verdict.query.observer is None or verdict.answer is not Answer.HOLDS:
        return verdict
    own = [notes[text] for text, _ in verdict.query.observer.triggers if notes.get(text)]
    return replace(verdict, notes=(*verdict.notes, *dict.fromkeys(own))) if own else verdict


def _reached(
    network: Network, goals: Mapping[str, Expression], limits: Limits, decide: Deciding
) -> Mapping[str, Verdict]:
    """Whether each of the goals is reached."""
    queries = [Query(f"momentary {number}", QueryKind.POSSIBLY, goal) for number, goal in enumerate(goals.values())]
    verdicts = decide(network, queries, limits) if queries else ()
    return dict(zip(goals, verdicts, strict=True))


def _note(text: str, answer: Verdict) -> str:
    shown = " ".join(text.split())
    match answer.answer:
        case Answer.HOLDS:
            return f"`{shown}` is also true for no time, in committed locations; that does not count"
        case Answer.UNKNOWN:
            return (
                f"`{shown}` is also true in committed locations, where it does not count; "
                f"whether it is true only there at some moment is not known ({answer.reason})"
            )
        case Answer.FAILS:
            return ""


def _committed(network: Network) -> Expression | None:
    """Whether some process is in a committed location; None where there is no such location."""
    tests: list[Expression] = [
        LocationTest(process, location)
        for process, each in enumerate(network.processes)
        for location, place in enumerate(each.locations)
        if place.committed
    ]
    return any_of(tests) if tests else None


def _left_in_chains(network: Network, condition: Expression) -> Expression | None:
    """Where a transition of a chain of committed locations begins that may change the condition: in one of these
    locations a participant is. None where no such transition may."""
    read = {node.variable for node in _nodes(condition) if isinstance(node, Reference)}
    placed = {(node.process, node.location) for node in _nodes(condition) if isinstance(node, LocationTest)}
    ends = _ends_by_channel(network)
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


def _ends_by_channel(network: Network) -> Mapping[tuple[Variable, bool], set[tuple[int, int]]]:
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
    network: Network, committed: Expression, conditions: Mapping[str, Expression]
) -> tuple[Network, Mapping[str, Expression]]:
    """The network with two variables for each condition, and what is true where it has been true for no time.

    The variables are set before a transition changes anything, so they tell of the states before it.
    """
    variables, noted, over = [], [], {}
    for number, (text, condition) in enumerate(conditions.items()):
        before, risen = (_variable(f"{name}{number}") for name in ("before", "risen"))
        was, has_been = Reference(before), Reference(risen)
        again = _as_number(both(negation(_is_set(was)), either(_is_set(has_been), condition)))
        variables += [before, risen]
        noted += [
            Assign(has_been, Conditional(committed, again, Constant(0), INT), INT),
            Assign(was, Conditional(committed, was, _as_number(condition), INT), INT),
        ]
        over[text] = both(both(negation(committed), negation(condition)), _is_set(has_been))
    processes = tuple(
        replace(
            process,
            edges=tuple(
                replace(edge, updates=(*noted, *edge.updates)) if _begins(edge) else edge for edge in process.edges
            ),
        )
        for process in network.processes
    )
    return replace(network, processes=processes, variables=(*network.variables, *variables)), over


def _begins(edge: Edge) -> bool:
    """Whether a transition begins with the edge: its updates come before those of all others."""
    return edge.synchronisation is None or edge.synchronisation.direction is Direction.SEND


def _variable(name: str) -> Variable:
    return Variable(f"momentary.{name}", IntType(0, 1), VariableKind.GLOBAL, (0,))


def _is_set(place: Expression) -> Expression:
    return Binary(BinaryOperator.EQUAL, place, Constant(1), BOOL)


def _as_number(condition: Expression) -> Expression:
    return Binary(BinaryOperator.NOT_EQUAL, condition, Constant(0), BOOL)
