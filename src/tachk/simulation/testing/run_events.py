"""The events that a recording of a run would have."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.job import StoppedError, limited
from tachk.base.records import dataclass
from tachk.engine.options import Limits
from tachk.frontend.expressions.folded_expressions import substitute
from tachk.meaning.discrete import PreparedNetwork, bind_selects, channel_of, environment, initial_discrete, prepare
from tachk.model.evaluate import Environment, channel_number, evaluate, execute
from tachk.model.expressions import Constant, Expression, Variable
from tachk.model.network import Network
from tachk.model.recording import RecordingMap, VisibleEvents
from tachk.model.run import DiscreteState, TimedStep, TimedTrace, Transition
from tachk.recordings.conformance.conform import conform
from tachk.recordings.conformance.event_streams import Constants, element
from tachk.recordings.conformance.events import Cell, EventLog, RecordedEvent
from tachk.recordings.conformance.location_columns import with_location_variables
from tachk.simulation.testing.event_columns import channel_indices, index_cases, is_broadcast


@dataclass(frozen=True, slots=True)
class _ShownChannel:
    """A channel that a recording shows, and the values of the indices of its events."""

    visible: VisibleEvents
    indices: Mapping[Variable, Expression]


def recording_of_run(
    network: Network, mapping: RecordingMap, constants: Constants, run: TimedTrace, name: str, limits: Limits
) -> EventLog | None:
    """The recording of a run, which the search of `tachk conform` has accepted; None where a limit stops that search.

    Times are exact, in units of the model. Raises InternalError if that search says that it is no run.
    """
    recording = events_of_run(network, mapping, run, name)
    instrumented = with_location_variables(network, mapping)
    try:
        with limited(limits.seconds):
            found = conform(*instrumented, recording, constants, limits=limits, explain=False)
    except StoppedError:
        return None
    if found.accepted is False:
        raise InternalError("the events of a run of the model are not accepted as one")
    return recording if found.accepted else None


def events_of_run(network: Network, mapping: RecordingMap, run: TimedTrace, name: str) -> EventLog:
    """The events of the steps of a run that the recording of a model shows."""
    model = prepare(network)
    channels = _visible_channels(model, mapping)
    events: list[RecordedEvent] = []
    before = run.initial.discrete
    for step in run.steps:
        if step.transition is not None:
            channel = channels.get(channel_of(model, before, step.transition))
            if channel is not None and _is_seen(mapping, channel, step.transition):
                events.append(_event(model, channel, before, step, step.transition, len(events)))
        before = step.state.discrete
    end = run.states[-1].time
    return EventLog(name, tuple(events), None, Fraction(0), end)


def _visible_channels(model: PreparedNetwork, mapping: RecordingMap) -> dict[int | None, _ShownChannel]:
    scratch = environment(model, initial_discrete(model))
    found: dict[int | None, _ShownChannel] = {}
    for visible in mapping.visible:
        for case in index_cases(visible):
            indices = {variable: Constant(value) for variable, value in case.items()}
            number = channel_number(element(visible.channel, channel_indices(visible, indices)), scratch)
            found[number] = _ShownChannel(visible, indices)
    return found


def _is_seen(mapping: RecordingMap, channel: _ShownChannel, transition: Transition) -> bool:
    """True unless two processes meet that a recording replaces both: what it replaces has no inside."""
    moved = {participant.process for participant in transition.participants}
    return is_broadcast(channel.visible) or not moved <= mapping.replaced


def _event(
    model: PreparedNetwork,
    channel: _ShownChannel,
    before: DiscreteState,
    step: TimedStep,
    transition: Transition,
    number: int,
) -> RecordedEvent:
    """The event of a step. Its columns are read behind the updates, where `meta` variables hold what was passed."""
    scratch = environment(model, before)
    for participant in transition.participants:
        bind_selects(model, participant, scratch)
        execute(model.edge(participant).updates, scratch)
    after = Environment(model.layout, scratch.values, step.state.discrete.locations, None)
    cells: dict[str, Cell] = {}
    for column, expression in channel.visible.columns:
        value = evaluate(substitute(expression, channel.indices, set()), after)
        words = {known: word for word, known in channel.visible.words.get(column, {}).items()}
        cells[column] = words.get(value, value)
    return RecordedEvent(step.state.time, channel.visible.event, cells, f"event {number + 1}")
