"""Processes that cannot influence an answer are held still, so that their states are not told apart.

A cone of influence on the level of processes. A *spectator* only receives broadcasts or moves on its own, never
forbids a delay (no invariant, no urgent or committed location, no rate) and writes nothing that a process that counts
reads: every run of the others is possible with it and without it. Its own run-time errors are not looked for.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from tachk.base.words import Direction
from tachk.meaning.discrete import PreparedNetwork, is_announced
from tachk.meaning.step import StepError, begun_by, delay, fire, initial_state, is_possible
from tachk.model.expressions import Expression, LocationTest, Reference, Variable
from tachk.model.network import Location, Network, Process
from tachk.model.remembered import by_network, by_part
from tachk.model.run import Participant, TimedStep, TimedTrace, Transition
from tachk.model.traversal import (
    asks_deadlock,
    process_expressions,
    walk,
    with_bodies,
    written_variables,
)
from tachk.model.types import ChannelType


def without_spectators(network: Network, targets: Sequence[Expression]) -> Network:
    """The network with every process held in its initial location that cannot influence whether a target is reachable.

    Processes and variables keep their numbers. Nothing is held still where a target speaks of ``deadlock`` or where
    processes or channels have priorities: there every possible action counts. Nor is it where a target speaks of
    nothing, as that is how to ask for the whole state space.
    """
    return _without_spectators(network, tuple(targets))


@by_network
def _without_spectators(network: Network, targets: tuple[Expression, ...]) -> Network:
    still = spectators(network, targets)
    if not still:
        return network
    processes = enumerate(network.processes)
    return replace(network, processes=tuple(held_still(p) if number in still else p for number, p in processes))


def every_action_counts(network: Network, targets: Sequence[Expression]) -> bool:
    """Whether what any process can do matters: for priorities, or as a target speaks of ``deadlock`` or of nothing."""
    return network.has_priorities or any(map(asks_deadlock, targets)) or any(map(speaks_of_nothing, targets))


def speaks_of_nothing(target: Expression) -> bool:
    """Whether no location, no variable and no ``deadlock`` occurs in a target: ``E<> false``, ``A[] true``."""
    return not any(mentioned([target])) and not asks_deadlock(target)


def spectators(network: Network, targets: Sequence[Expression]) -> set[int]:
    """The processes that cannot influence whether a target is reachable; none where every action counts."""
    if every_action_counts(network, targets):
        return set()
    candidates = {number for number, process in enumerate(network.processes) if _only_watches(process)}
    processes, variables = mentioned(targets)
    for number, process in enumerate(network.processes):
        if number not in candidates:
            seen_processes, seen_variables = mentioned(list(process_expressions(process)))
            processes |= seen_processes
            variables |= seen_variables
    relevant = True
    while relevant:
        relevant = False
        for number in sorted(candidates):
            process = network.processes[number]
            expressions = list(process_expressions(process))
            if number in processes or not variables.isdisjoint(written_variables(expressions)):
                candidates.remove(number)
                seen_processes, seen_variables = mentioned(expressions)
                processes |= seen_processes
                variables |= seen_variables
                relevant = True
    return candidates


def with_spectators(model: PreparedNetwork, reduced: Network, trace: TimedTrace) -> TimedTrace:
    """A run of the model that is the given run of the reduced network, with what the spectators hear on the way.

    Raises:
        StepError: there is none.
        EvaluationFault: a spectator meets a run-time error on the way.
    """
    pairs = zip(model.network.processes, reduced.processes, strict=True)
    still = {number for number, (process, held) in enumerate(pairs) if process != held}
    if not still:
        return trace

    def others(transition: Transition) -> tuple[Participant, ...]:
        return tuple(participant for participant in transition.participants if participant.process not in still)

    state = initial = initial_state(model)
    steps = []
    for step in trace.steps:
        state = delay(model, state, step.delay)
        transition = step.transition
        if transition is not None:
            wanted = transition.participants
            if is_announced(model, state.discrete, transition):
                heard = (t for t in begun_by(model, state, wanted[0]) if others(t) == wanted)
                transition = next((t for t in heard if is_possible(model, state, t)), None)
                if transition is None:
                    raise StepError("no transition of the whole network is the one of the reduced network")
            state = fire(model, state, transition)
        steps.append(TimedStep(step.delay, transition, state))
    return TimedTrace(initial, tuple(steps))


def held_still(process: Process) -> Process:
    return replace(process, locations=(process.locations[process.initial],), edges=(), initial=0)


def _only_watches(process: Process) -> bool:
    return not any(map(_forbids_delay, process.locations)) and all(
        edge.synchronisation is None
        or (edge.synchronisation.direction is Direction.RECEIVE and is_broadcast(edge.synchronisation.channel))
        for edge in process.edges
    )


def _forbids_delay(location: Location) -> bool:
    return location.urgent or location.committed or location.invariant is not None or bool(location.rates)


def is_broadcast(channel: Expression) -> bool:
    return isinstance(channel.type, ChannelType) and channel.type.broadcast


def mentioned(expressions: Iterable[Expression]) -> tuple[set[int], set[Variable]]:
    """The processes whose locations are tested and the variables that occur, functions included."""
    processes: set[int] = set()
    variables: set[Variable] = set()
    for expression in expressions:
        its_processes, its_variables = _mentioned(expression)
        processes |= its_processes
        variables |= its_variables
    return processes, variables


@by_part
def _mentioned(expression: Expression) -> tuple[frozenset[int], frozenset[Variable]]:
    nodes = [node for outer in with_bodies([expression]) for node in walk(outer)]
    processes = frozenset(node.process for node in nodes if isinstance(node, LocationTest))
    return processes, frozenset(node.variable for node in nodes if isinstance(node, Reference))
