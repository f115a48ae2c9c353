"""Event streams: recorded events as synchronisations of a model, each with its window of time.

Events of different places are not recorded in one order. So they form streams: events of one stream happen in their
recorded order, events of different streams as their times allow.

The window of an event is what its recorded time leaves open (`TimestampUncertainty`), rounded outwards to whole units
of the model. An output is seen a little later than it happens, and an input comes to the model a little later.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import accumulate, product
from math import floor, lcm

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.operators import CONSTANT_HIGH, CONSTANT_LOW
from tachk.base.records import dataclass, replace
from tachk.base.time_units import length_of
from tachk.base.words import Direction
from tachk.frontend.expressions.folded_expressions import substitute
from tachk.model.expressions import Constant, Expression, Index, Reference, Variable
from tachk.model.network import Network
from tachk.model.recording import RecordingMap, VisibleEvents
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.model.types import ArrayType, IntType, ScalarType
from tachk.recordings.conformance.events import END, Cell, Closing, EventLog, RecordedEvent

_SHOWN = 30
"""Messages show at most so many characters of a cell."""

Constants = Callable[[str], int | None]
"""The value of a constant of the model, by its name."""


@dataclass(frozen=True, slots=True)
class EventStream:
    """Events that happen in their recorded order.

    Attributes:
        visible: the declaration of the events.
        outputs: True for outputs of the model, False for inputs.
        common: the values of the indices that its events have in common.
        events: the numbers of its events in the recording.
        values: the values in the columns of each event; None where a cell is empty.
        earliest, latest: the window of each event; neither decreases.
        recorded: the time at which each event was recorded.
        needed: for each event the numbers of events of other streams that must have happened before: pairs (stream,
            count).
        optional: for each event, whether it may be left out.
        quiet_until: the time up to which the recording is complete.
        ends_itself: the recording ends with an event of the same sender, before which it has finished its work.
    """

    visible: VisibleEvents
    outputs: bool
    common: Mapping[Variable, int]
    events: tuple[int, ...]
    values: tuple[tuple[int | None, ...], ...]
    earliest: tuple[int, ...]
    latest: tuple[int, ...]
    recorded: tuple[int, ...] = ()
    needed: tuple[tuple[tuple[int, int], ...], ...] = ()
    optional: tuple[bool, ...] = ()
    quiet_until: int = 0
    ends_itself: bool = False

    @property
    def name(self) -> str:
        """The name of the stream in messages."""
        common = ", ".join(f"{variable.name} = {value}" for variable, value in self.common.items())
        return f"{self.visible.event}({common})" if common else self.visible.event


@dataclass(frozen=True, slots=True)
class EventStreams:
    """Attributes:
    quiet_until: what happens until then has been recorded.
    time_bound: no event happens later.
    other: how many events of the recording are of no visible kind.
    origin: the time of the recording at which the model starts.
    scale: units of the model in a unit of the recording.
    names: by column, what recordings call values.
    """

    streams: tuple[EventStream, ...]
    quiet_until: int
    time_bound: int
    other: int
    origin: Fraction
    scale: Fraction
    names: Mapping[str, Mapping[int, str]]


def make_streams(
    network: Network,
    mapping: RecordingMap,
    recording: EventLog,
    constants: Constants,
    uncertainty: TimestampUncertainty,
) -> EventStreams:
    """The streams of a recording. Raises UsageError for an event that says what is none of the model's, or is too late
    for its clocks."""
    origin, scale = origin_of(network, recording, uncertainty)
    reader = EventStreamReader(mapping, recording, constants)
    entries = reader.entries()
    outgoing = [is_output(visible, network, mapping) for visible, _, _ in entries]
    place = {event: (number, position) for number, e in enumerate(entries) for position, (event, _) in enumerate(e[2])}
    passed = _passed(recording, place, outgoing)
    clock = _RecordingClock.of(recording, origin, scale, uncertainty)
    streams = []
    for (visible, common, found), outputs in zip(entries, outgoing, strict=True):
        events = [recording.events[number] for number, _ in found]
        before, after = uncertainty.around(outputs or any(event.inferred for event in events))
        times = clock.ticks(event.time for event in events)
        closing = _closing(recording, visible, common)
        end = recording.end if closing is None else min(closing.time, recording.end)
        pairs = zip(found, events, strict=True)
        streams.append(
            EventStream(
                visible,
                outputs,
                common,
                tuple(number for number, _ in found),
                tuple(values for _, values in found),
                tuple(accumulate(clock.floors(times, -before), max, initial=0))[1:],
                tuple(accumulate(reversed(clock.ceilings(times, after)), min))[::-1],
                tuple(clock.floors(times, Fraction(0))),
                tuple(_sent(place, event.after) + passed.get(number, ()) for (number, _), event in pairs),
                tuple(event.optional for event in events),
                max(floor((end - origin) * scale - uncertainty.earliest), 0),
                outputs and closing is not None and closing.by_sender,
            )
        )
    quiet = max([stream.quiet_until for stream in streams], default=0)
    time_bound = max([quiet, *(stream.latest[-1] for stream in streams if stream.latest)]) + 1
    if time_bound > CONSTANT_HIGH:
        last = f"the last event of {recording.source}, {recording.events[-1].place}," if recording.events else "the end"
        raise UsageError(
            f"{last} may happen more than {CONSTANT_HIGH} units of the model after its start, beyond its clocks",
            "cut the recording, give the model a larger time unit, or allow less lateness",
        )
    return EventStreams(tuple(streams), quiet, time_bound, reader.other, origin, scale, reader.names)


def _passed(
    recording: EventLog, place: Mapping[int, tuple[int, int]], outgoing: Sequence[bool]
) -> dict[int, tuple[tuple[int, int], ...]]:
    """For each event from outside how many events of the model passed the same place before it, by stream.

    One observer has seen both: what was sent before it passed has happened before what came later reached its receiver.
    """
    sent: dict[int, dict[int, int]] = {}
    found: dict[int, tuple[tuple[int, int], ...]] = {}
    for number, event in enumerate(recording.events):
        if event.passes is None or number not in place:
            continue
        stream, position = place[number]
        if outgoing[stream]:
            sent.setdefault(event.passes, {})[stream] = position + 1
        elif event.passes in sent:
            found[number] = tuple(sent[event.passes].items())
    return found


def around(streams: EventStreams, happened: Sequence[int]) -> EventStreams:
    """For each stream the last event that has happened, if there is one, and the next one."""
    bases = [max(count - 1, 0) for count in happened]
    return _between(streams, bases, [count + 1 for count in happened])


def behind(streams: EventStreams, happened: Sequence[int]) -> EventStreams:
    """The events of each stream behind those that have happened."""
    return _between(streams, happened, [len(stream.events) for stream in streams.streams])


def _between(streams: EventStreams, bases: Sequence[int], tops: Sequence[int]) -> EventStreams:
    """Of each stream the events from one place on and before another one."""
    shortened = []
    for stream, base, top in zip(streams.streams, bases, tops, strict=True):
        component = slice(base, top)
        shortened.append(
            replace(
                stream,
                events=stream.events[component],
                values=stream.values[component],
                earliest=stream.earliest[component],
                latest=stream.latest[component],
                recorded=stream.recorded[component],
                needed=tuple(
                    tuple((other, number - bases[other]) for other, number in needs if number > bases[other])
                    for needs in stream.needed[component]
                ),
                optional=stream.optional[component],
            )
        )
    return replace(streams, streams=tuple(shortened))


def origin_of(network: Network, recording: EventLog, uncertainty: TimestampUncertainty) -> tuple[Fraction, Fraction]:
    """The time of the recording at which the model starts, and the units of the model in a unit of the recording.
    Raises UsageError."""
    scale = _scale(network, recording)
    first = recording.events[0].time if recording.events else Fraction(0)
    return first - uncertainty.earliest / scale if recording.start is None else recording.start, scale


def _scale(network: Network, recording: EventLog) -> Fraction:
    """Units of the model in a unit of the recording."""
    if recording.unit is None:
        return Fraction(1)
    length = length_of(network.time_unit) if network.time_unit else None
    if length is None:
        raise UsageError(
            f"the times of {recording.source} have a unit, but the model does not say how long its time unit is",
            "write `time_unit = 1 ms;` into the model",
        )
    return recording.unit / length


def _closing(recording: EventLog, visible: VisibleEvents, common: Mapping[Variable, int]) -> Closing | None:
    """The first closing that ends the recording of a stream."""
    found = [
        closing
        for name, expression in visible.columns
        for closing in recording.closings
        if closing.column == name and _value_in(expression, common) == closing.value
    ]
    return min(found, key=lambda closing: closing.time, default=None)


def _value_in(expression: Expression, common: Mapping[Variable, int]) -> int | None:
    """The value that a column has for all events of a stream; None if there is none."""
    found = substitute(expression, {variable: Constant(value) for variable, value in common.items()}, set())
    return found.value if isinstance(found, Constant) else None


@dataclass(frozen=True, slots=True)
class _RecordingClock:
    """Times since the model starts as whole numbers, since there are many of them.

    Attributes:
        parts: of which a unit of the model has so many.
        factor: how many of them are a unit of the recording.
        origin: the start of the model.
    """

    subdivision: int
    factor: Fraction
    origin: int

    @staticmethod
    def of(
        recording: EventLog, origin: Fraction, scale: Fraction, uncertainty: TimestampUncertainty
    ) -> _RecordingClock:
        """In which all times of a recording, and what they leave open, are whole."""
        others = uncertainty.tolerance, uncertainty.input_late, uncertainty.output_late
        different = {event.time.denominator for event in recording.events}
        subdivision = lcm(
            lcm(*different) * scale.denominator, (origin * scale).denominator, *(o.denominator for o in others)
        )
        return _RecordingClock(subdivision, scale * subdivision, int(origin * scale * subdivision))

    def ticks(self, times: Iterable[Fraction]) -> list[int]:
        """The parts at times of the recording."""
        of_time, of_one = self.factor.as_integer_ratio()
        ratios = [time.as_integer_ratio() for time in times]
        return [numerator * of_time // (denominator * of_one) - self.origin for numerator, denominator in ratios]

    def floors(self, ticks: Iterable[int], shift: Fraction) -> list[int]:
        """In units of the model, so much later, rounded down."""
        by, subdivision = int(shift * self.subdivision), self.subdivision
        return [(time + by) // subdivision for time in ticks]

    def ceilings(self, ticks: Iterable[int], shift: Fraction) -> list[int]:
        """The same, rounded up."""
        by, subdivision = int(shift * self.subdivision), self.subdivision
        return [-((-time - by) // subdivision) for time in ticks]


def _sent(place: Mapping[int, tuple[int, int]], after: int | None) -> tuple[tuple[int, int], ...]:
    """The position behind an event in its stream, if it is in one."""
    if after is None or after not in place:
        return ()
    stream, position = place[after]
    return ((stream, position + 1),)


def is_output(visible: VisibleEvents, network: Network, mapping: RecordingMap) -> bool:
    """True if what is left of the model sends these events, and not what is outside."""
    if visible.direction is not None:
        return visible.direction is Direction.SEND
    variable = channel_variable(visible.channel)
    return any(
        edge.synchronisation is not None
        and edge.synchronisation.direction is Direction.SEND
        and channel_variable(edge.synchronisation.channel) is variable
        for number in mapping.modelled(network)
        for edge in network.processes[number].edges
    )


def input_names(network: Network, mapping: RecordingMap) -> frozenset[str]:
    """The events that the environment sends."""
    return frozenset(each.event for each in mapping.visible if not is_output(each, network, mapping))


def with_words(visible: VisibleEvents, cells: Iterable[tuple[str, int]]) -> Iterator[tuple[str, Cell]]:
    """The cells of an event as a recording writes them: a column that shows where a process is has the name of the
    location, and not its number."""
    for column, value in cells:
        words = {number: word for word, number in visible.words.get(column, {}).items()}
        yield column, words.get(value, value)


def channel_variable(channel: Expression) -> Variable:
    while isinstance(channel, Index):
        channel = channel.base
    assert isinstance(channel, Reference)
    return channel.variable


def index_range(type_: IntType | ScalarType) -> range:
    return range(type_.low, type_.high + 1) if isinstance(type_, IntType) else range(type_.size)


_Values = tuple[int | None, ...]
_Entry = tuple[VisibleEvents, dict[Variable, int], list[tuple[int, _Values]]]


@dataclass(frozen=True, slots=True)
class _ColumnClause:
    """The possible values of a column in the events of a clause.

    Attributes:
        wanted: only this number, or nothing.
        index, values: one of the values of this index of the channel.
    """

    name: str
    wanted: int | None
    index: Variable | None
    values: range | None

    def miss(self, event: RecordedEvent, value: int | None) -> str | None:
        """The reason why an event cannot be of the clause; None if it can."""
        if self.wanted is not None and value is not None and value != self.wanted:
            return f"no event `{event.name}` of the model has {self.name} = {event.cells[self.name]}"
        if self.index is None or self.values is None:
            return None
        if value is None:
            return f"the event does not say its {self.name}"
        if value not in self.values:
            return f"{self.name} = {event.cells[self.name]} is outside the range of `{self.index.name}`"
        return None


@dataclass(frozen=True, slots=True)
class _RecordingClause:
    """A clause of the mapping: its number, the names of its columns, those by place that may not say anything, the
    places of those that the events of a stream have in common, and the words for locations by column."""

    number: int
    names: tuple[str, ...]
    limited: tuple[tuple[int, _ColumnClause], ...]
    per: tuple[int, ...]
    words: Mapping[str, Mapping[str, int]]


def _clause_of(number: int, visible: VisibleEvents) -> _RecordingClause:
    limited = []
    for place, (name, expression) in enumerate(visible.columns):
        match expression:
            case Constant(wanted):
                limited.append((place, _ColumnClause(name, wanted, None, None)))
            case Reference(variable) if variable in visible.indices:
                limited.append((place, _ColumnClause(name, None, variable, index_range(index_type(variable)))))
            case _:
                pass
    place_of = {column.index: place for place, column in limited}
    names = tuple(name for name, _ in visible.columns)
    per = tuple(place_of[variable] for variable in visible.per)
    return _RecordingClause(number, names, tuple(limited), per, visible.words)


class EventStreamReader:
    """Sorts events into streams."""

    def __init__(self, mapping: RecordingMap, recording: EventLog, constants: Constants) -> None:
        """The recording gives messages its name, and words for values; its events are sorted by `entries`."""
        self.mapping = mapping
        self.recording = recording
        self.constants = constants
        self.other = 0
        self.names: dict[str, dict[int, str]] = {}
        self.read: dict[tuple[str, str], int | None] = {}
        self._named: dict[str, list[_RecordingClause]] = {}
        for number, visible in enumerate(mapping.visible):
            self._named.setdefault(visible.event, []).append(_clause_of(number, visible))
        for column, words in recording.words.items():
            for word in words:
                self._name(column, word, constants(word))

    def entries(self) -> list[_Entry]:
        entries: dict[tuple[int, tuple[int | None, ...]], _Entry] = {}
        for number, visible in enumerate(self.mapping.visible):
            for values in product(*(index_range(index_type(v)) for v in visible.per)):
                entries[number, values] = (visible, dict(zip(visible.per, values, strict=True)), [])
        for position, event in enumerate(self.recording.events):
            placed = self.place(event)
            if placed is None:
                self.other += event.name != END
            else:
                clause, common, said = placed
                entries[clause, common][2].append((position, said))
        return list(entries.values())

    def place(self, event: RecordedEvent) -> tuple[int, tuple[int | None, ...], _Values] | None:
        """The number of the clause that an event belongs to, what it has in common with its stream, and the values of
        its columns; None if it is of no visible kind. Raises UsageError for an event that no clause allows."""
        if event.name not in self._named:
            return None
        clause, said = self._clause(event, self._named[event.name])
        return clause.number, tuple([said[n] for n in clause.per]), said

    def _clause(self, event: RecordedEvent, clauses: Sequence[_RecordingClause]) -> tuple[_RecordingClause, _Values]:
        """The clause that the event belongs to, and what its columns say."""
        misses: list[str] = []
        for clause in clauses:
            values = tuple([self._value(event, name, clause) for name in clause.names])
            for place, column in clause.limited:
                miss = column.miss(event, values[place])
                if miss is not None:
                    misses.append(miss)
                    break
            else:
                return clause, values
        raise UsageError(f"{self.recording.source}, {event.place}: {misses[0]}")

    def _value(self, event: RecordedEvent, name: str, clause: _RecordingClause) -> int | None:
        cell = event.cells.get(name, "")
        if name in clause.words:
            return self._location(event, name, str(cell).strip(), clause.words[name])
        if isinstance(cell, int):
            return self._bounded(event, name, int(cell))
        known = (name, cell)
        if known not in self.read:
            self.read[known] = self._bounded(event, name, self._number(event, name, cell.strip()))
        return self.read[known]

    def _location(self, event: RecordedEvent, name: str, text: str, words: Mapping[str, int]) -> int | None:
        if not text:
            return None
        if text not in words:
            place = f"{self.recording.source}, {event.place}"
            raise UsageError(
                f"{place}: {name} is `{_begun(text)}`, which is not a location of the process",
                f"its locations are {', '.join(words)}",
            )
        return words[text]

    def _bounded(self, event: RecordedEvent, name: str, value: int | None) -> int | None:
        if value is None or CONSTANT_LOW <= value <= CONSTANT_HIGH:
            return value
        raise UsageError(
            f"{self.recording.source}, {event.place}: {name} is {_begun(event.cells[name])}, which no model can say",
            f"numbers of a model lie between {CONSTANT_LOW} and {CONSTANT_HIGH}",
        )

    def _number(self, event: RecordedEvent, name: str, text: str) -> int | None:
        if not text:
            return None
        if text in ("true", "false"):
            return int(text == "true")
        value = self.constants(text)
        self._name(name, text, value)
        if value is None:
            try:
                return int(text, 0)
            except ValueError:
                raise UsageError(
                    f"{self.recording.source}, {event.place}: {name} is `{_begun(text)}`, which is neither a "
                    "number nor a constant of the model"
                ) from None
        return value

    def _name(self, column: str, text: str, value: int | None) -> None:
        if value is not None:
            self.names.setdefault(column, {})[value] = text


def _begun(cell: object) -> str:
    """A cell as messages show it: of a long one the beginning."""
    text = str(cell).strip()
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."


def index_type(variable: Variable) -> IntType | ScalarType:
    assert isinstance(variable.type, IntType | ScalarType)
    return variable.type


def element(channel: Expression, indices: Sequence[Expression]) -> Expression:
    """The channel with these indices."""
    for index in indices:
        assert isinstance(channel.type, ArrayType)
        channel = Index(channel, index, channel.type.element)
    return channel
