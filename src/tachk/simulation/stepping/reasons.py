"""The reason why a network does not take a step: the false guard or invariant, with its values."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import Label
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass
from tachk.meaning.discrete import bind_selects, clocks_after, environment, execute_updates, may_delay, stopped_clocks
from tachk.meaning.run_view import RunNames
from tachk.meaning.step import StepError, begun_by, delay, fire, is_open
from tachk.model.evaluate import Environment, clock_number, evaluate, holds
from tachk.model.expressions import Binary, Constant, Expression, Field, Index, Reference
from tachk.model.fault import EvaluationFault
from tachk.model.network import Location, Process
from tachk.model.quantity import decimal
from tachk.model.run import Participant, TimedState, Transition
from tachk.model.traversal import children
from tachk.model.types import BoolType, ClockType, IntType
from tachk.simulation.stepping.submitted import SubmittedMove, SubmittedStep


@dataclass(frozen=True, slots=True)
class StepReason:
    """Attributes:
    message: without a full stop.
    labels: places of the model.
    """

    message: str
    labels: tuple[Label, ...] = ()


class NoSuchProcessError(ValueError):
    """The network has no process of the name."""


def process_named(names: RunNames, name: str) -> int:
    """The number of a process. Raises NoSuchProcessError."""
    for number, process in enumerate(names.network.processes):
        if process.name == name:
            return number
    known = ", ".join(process.name for process in names.network.processes)
    raise NoSuchProcessError(f"there is no process {name}; there are {known}")


# ---- delays ---------------------------------------------------------------------------------------------------------


def why_no_delay(names: RunNames, state: TimedState, duration: Fraction) -> StepReason:
    """The reason why a delay that the semantics refuses cannot pass."""
    model = names.model
    if duration < 0:
        return StepReason(f"it would be at {decimal(state.time + duration)}, and the run is at {decimal(state.time)}")
    if not may_delay(model, state.discrete):
        label = [
            Label(location.span, f"{process.name} is here, which is {'committed' if location.committed else 'urgent'}")
            for process, location in _current(names, state)
            if location.committed or location.urgent
        ]
        return StepReason("time cannot pass", tuple(label))
    stopped = stopped_clocks(model, state.discrete)
    clocks = tuple(value if n in stopped else value + duration for n, value in enumerate(state.clocks, start=1))
    later = TimedState(state.discrete, clocks, state.time + duration)
    broken = tuple(_broken_invariants(names, later))
    if broken:
        return StepReason(f"an invariant would be violated after a delay of {decimal(duration)}", broken)
    try:
        delay(model, state, duration)
    except StepError as error:
        return StepReason(str(error))
    return StepReason("time cannot pass")


def _current(names: RunNames, state: TimedState) -> Iterator[tuple[Process, Location]]:
    return zip(names.network.processes, names.model.current(state.discrete), strict=True)


def _broken_invariants(names: RunNames, state: TimedState) -> Iterator[Label]:
    for process, location in _current(names, state):
        if location.invariant is not None:
            scratch = environment(names.model, state.discrete, state.clocks)
            yield from _false_parts(location.invariant, scratch, f"{process.name}, invariant of {location.name}")


# ---- transitions ----------------------------------------------------------------------------------------------------


def why_no_transition(names: RunNames, state: TimedState, step: SubmittedStep) -> StepReason:
    """The reason why none of the transitions that a submitted step may mean can be taken."""
    model = names.model
    groups: list[list[Participant]] = []
    for move in step.moves:
        process = process_named(names, move.process)
        here = names.network.processes[process].locations[state.discrete.locations[process]]
        if here.name != move.source:
            return StepReason(f"{move.process} is in {here.name}, not in {move.source}", (Label(here.span, "here"),))
        found = edges_meant(names, state, process, move)
        if not found:
            return StepReason(_no_edge(names, process, move), (Label(here.span, "from here"),))
        open_ = [each for each in found if is_open(model, state, each)]
        if not open_:
            labels = [label for each in found for label in _false_guard(names, state, each)]
            return StepReason(f"a guard of {move.process} is false", _distinct(labels))
        groups.append(open_)
    return _why_not_together(names, state, step, groups)


def edges_meant(names: RunNames, state: TimedState, process: int, move: SubmittedMove) -> list[Participant]:
    """The edges of a process, with values of select variables, that a submitted move may mean."""
    of_process = names.network.processes[process]
    alike = [
        number
        for number, edge in enumerate(of_process.edges)
        if of_process.locations[edge.source].name == move.source
        and of_process.locations[edge.target].name == move.target
    ]
    if move.number is not None:
        alike = alike[move.number - 1 : move.number]
    return [
        each
        for each in names.model.instances[process][state.discrete.locations[process]]
        if each.edge in alike and _selects_fit(names, each, move)
    ]


def _selects_fit(names: RunNames, participant: Participant, move: SubmittedMove) -> bool:
    edge = names.model.edge(participant)
    synchronisation = edge.synchronisation
    if move.direction is not None and (synchronisation is None or synchronisation.direction is not move.direction):
        return False
    chosen = {variable.name: value for variable, value in zip(edge.selects, participant.selects, strict=True)}
    return all(chosen.get(name) == value for name, value in move.selects.items())


def _no_edge(names: RunNames, process: int, move: SubmittedMove) -> str:
    of_process = names.network.processes[process]
    known = {place.name for place in of_process.locations}
    if move.target not in known:
        return f"{move.process} has no location {move.target}"
    number = f" number {move.number}" if move.number else ""
    values = ", ".join(f"{name} = {value}" for name, value in move.selects.items())
    return (
        f"{move.process} has no edge{number} from {move.source} to {move.target}{f' with {values}' if values else ''}"
    )


def _why_not_together(
    names: RunNames, state: TimedState, step: SubmittedStep, groups: list[list[Participant]]
) -> StepReason:
    model = names.model
    begun = [found for first in groups[0] for found in begun_by(model, state, first)]
    if not begun:
        return _no_receiver(names, state, groups[0][0])
    wanted = [found for found in begun if _made_of(found, groups)]
    if not wanted:
        others = {names.network.processes[p.process].name for found in begun for p in found.participants[1:]}
        submitted = {move.process for move in step.moves[1:]}
        missing, extra = sorted(submitted - others), sorted(others - submitted)
        if missing:
            return StepReason(f"{', '.join(missing)} cannot take part")
        return StepReason(f"{' or '.join(extra)} takes part too" if extra else "these processes do not move together")
    for found in wanted:
        channel = names.event(state.discrete, found).channel
        if step.channel and channel != step.channel:
            return StepReason(f"they synchronise over {channel or 'nothing'}, not over {step.channel}")
        try:
            fire(model, state, found)
        except StepError as error:
            return _why_not_fired(names, state, found, str(error))
    return StepReason("the state after it differs from the submitted one")


def _made_of(transition: Transition, groups: list[list[Participant]]) -> bool:
    if len(transition.participants) != len(groups):
        return False
    return all(any(p in group for p in transition.participants) for group in groups)


def _no_receiver(names: RunNames, state: TimedState, first: Participant) -> StepReason:
    edge = names.model.edge(first)
    process = names.network.processes[first.process].name
    committed = [p.name for p, location in _current(names, state) if location.committed]
    labels = () if edge.synchronisation is None else (Label(edge.synchronisation.span, "here"),)
    if committed:
        return StepReason(f"{process} has to wait for {', '.join(committed)}, in a committed location", labels)
    return StepReason(f"no process can receive what {process} sends", labels)


def _why_not_fired(names: RunNames, state: TimedState, transition: Transition, message: str) -> StepReason:
    discrete, resets = execute_updates(names.model, state.discrete, transition)
    broken = tuple(_broken_invariants(names, TimedState(discrete, clocks_after(state.clocks, resets), state.time)))
    return StepReason("the state after it would violate an invariant", broken) if broken else StepReason(message)


def _false_guard(names: RunNames, state: TimedState, participant: Participant) -> Iterator[Label]:
    edge = names.model.edge(participant)
    if edge.guard is None:
        committed = [p.name for p, location in _current(names, state) if location.committed]
        yield Label(edge.spans[0], f"{', '.join(committed)} goes first" if committed else "not possible here")
        return
    scratch = environment(names.model, state.discrete, state.clocks)
    bind_selects(names.model, participant, scratch)
    yield from _false_parts(edge.guard, scratch, f"{names.network.processes[participant.process].name}, guard")


def _false_parts(condition: Expression, scratch: Environment, whose: str) -> Iterator[Label]:
    """The parts of a conjunction that are false, with the values of what they speak of."""
    if isinstance(condition, Binary) and condition.operator is BinaryOperator.AND:
        for part in (condition.left, condition.right):
            yield from _false_parts(part, scratch, whose)
        return
    try:
        if holds(condition, scratch):
            return
        values = ", ".join(dict.fromkeys(_values(condition, scratch)))
        yield Label(condition.span, f"{whose}: false{f' with {values}' if values else ''}")
    except EvaluationFault as fault:
        yield Label(fault.span, f"{whose}: {fault}")


def _values(expression: Expression, scratch: Environment) -> Iterator[str]:
    """``x = 3.5`` for each variable and clock in an expression."""
    match expression:
        case Constant():
            return
        case Reference() | Index() | Field():
            type_ = expression.type
            if isinstance(type_, ClockType):
                value = (scratch.clocks or ())[clock_number(expression, scratch) - 1]
                yield f"{expression.span.text} = {decimal(value)}"
            elif isinstance(type_, IntType | BoolType) and expression.span.text:
                number = evaluate(expression, scratch)
                shown = str(bool(number)).lower() if isinstance(type_, BoolType) else str(number)
                if expression.span.text != shown:
                    yield f"{expression.span.text} = {shown}"
        case _:
            for child in children(expression):
                yield from _values(child, scratch)


def _distinct(labels: Iterable[Label]) -> tuple[Label, ...]:
    return tuple(dict.fromkeys(labels))
