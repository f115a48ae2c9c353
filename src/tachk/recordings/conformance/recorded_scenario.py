"""A recording as a scenario of its model: the events in their recorded order, with the times between them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.model.expressions import Constant, Expression, LocationTest, Reference, Variable
from tachk.model.quantity import grouped
from tachk.model.recording import VisibleEvents
from tachk.model.traversal import walk
from tachk.recordings.conformance.conform import Conformance
from tachk.recordings.conformance.event_streams import EventStream, channel_variable
from tachk.recordings.conformance.segments import LongRun
from tachk.syntax.printing.scenario_text import scenario_text


def scenario_of_recording(found: Conformance, name: str) -> str:
    """The scenario whose events are those of a recording that was held against its model.

    Two events are as far apart as they may be with the tolerance and the lateness of both. Columns that show where a
    process is, or that are computed of an index, are left out. Raises UsageError for a recording without events, for
    one of so many that its run is not held, or one that does not say whether an event has happened.
    """
    if any(isinstance(run, LongRun) for run in found.runs):
        raise UsageError(
            f"{found.recording.source} has {grouped(len(found.recording.events))} events, too many for a scenario",
            "cut out the part that matters",
        )
    streams = found.streams.streams
    events = sorted(
        (number, n, place) for n, stream in enumerate(streams) for place, number in enumerate(stream.events)
    )
    if not events:
        raise UsageError(f"{found.recording.source} has no event that the model knows, so it makes no scenario")
    channels = dict.fromkeys(channel_variable(stream.visible.channel).name for stream in streams)
    lines = [f"observes {', '.join(channels)}"]
    before = (0, 0)
    for number, n, place in events:
        stream = streams[n]
        if stream.optional and stream.optional[place]:
            where = found.recording.events[number].place
            raise UsageError(
                f"{found.recording.source}, {where}: whether this event has happened is unknown",
                "a scenario needs a recording of both sides of the way",
            )
        window = stream.earliest[place], stream.latest[place]
        bounds = f"from {max(window[0] - before[1], 0)} to {max(window[1] - before[0], 0)} "
        lines.append(bounds + _event(stream, place))
        before = window
    return scenario_text(name, lines)


def _event(stream: EventStream, place: int) -> str:
    visible = stream.visible
    values = {column: value for (column, _), value in zip(visible.columns, stream.values[place], strict=True)}
    contents = " && ".join(_contents(visible, values))
    return f"{_channel(stream, values)}{' with ' if contents else ''}{contents}"


def _channel(stream: EventStream, values: Mapping[str, int | None]) -> str:
    """The channel with its indices, up to the first that the recording does not say."""
    known: dict[Variable, int | None] = dict(stream.common)
    for column, expression in stream.visible.columns:
        if isinstance(expression, Reference) and expression.variable in stream.visible.indices:
            known[expression.variable] = values[column]
    text = channel_variable(stream.visible.channel).name
    for index in stream.visible.indices:
        value = index.value if isinstance(index, Constant) else known.get(index)
        if value is None:
            break
        text += f"[{value}]"
    return text


def _contents(visible: VisibleEvents, values: Mapping[str, int | None]) -> Iterator[str]:
    for column, expression in visible.columns:
        value = values[column]
        if value is not None and _is_of_variables(expression, visible):
            yield f"{expression.span.text} == {value}"


def _is_of_variables(expression: Expression, visible: VisibleEvents) -> bool:
    """True if a scenario can look at what a column shows."""
    if isinstance(expression, Constant) or not expression.span.text:
        return False
    return not any(
        isinstance(node, LocationTest) or (isinstance(node, Reference) and node.variable in visible.indices)
        for node in walk(expression)
    )
