"""Several recordings of one time as one: every value is held until its column changes, whichever file it comes from.

The whole begins when all that give a column have begun, for before that something is not known, and ends when the last
one of all does. What only arrives need not have begun: nothing arrives before. Where nothing else is read, the whole
begins with the first one in which something may arrive.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import chain
from math import lcm
from pathlib import Path

import numpy as np

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.time_units import length_of
from tachk.recordings.traces.arrivals import arrivals_of, arriving, topic_of
from tachk.recordings.traces.logs.labels import Labels
from tachk.recordings.traces.logs.set_of_runs import SeveralRuns
from tachk.recordings.traces.trace import Trace, TraceSource, Values
from tachk.recordings.traces.trace_csv import CsvRecording
from tachk.recordings.traces.trace_header import no_such_column

_LAST_TICK = 2**62


@dataclass(frozen=True, slots=True, eq=False)
class JoinedRecording:
    """Attributes:
    places: of each column: the number of the recording, and its name there.
    """

    name: str
    recordings: tuple[TraceSource, ...] = field(repr=False)
    places: dict[str, tuple[int, str]] = field(repr=False)

    @property
    def unit(self) -> str:
        return self.recordings[0].unit

    @property
    def columns(self) -> tuple[str, ...]:
        return tuple(self.places)

    def read(self, columns: Collection[str] | None = None) -> Trace:
        arrivals = {name: self._places_of(name, parts) for name, parts in arriving(columns or (), self.columns).items()}
        wanted = self.columns if columns is None else tuple(name for name in self.columns if name in columns)
        for name in columns or ():
            if name not in self.places and name not in arrivals:
                raise no_such_column(name, self.columns, self.name)
        requested = [*(self.places[name] for name in wanted), *chain.from_iterable(arrivals.values())]
        traces = [
            recording.read([own for number, own in requested if number == place])
            for place, recording in enumerate(self.recordings)
        ]
        factors = [self._factor(trace) for trace in traces]
        scale = lcm(
            *((trace.ticks_per_unit / factor).numerator for trace, factor in zip(traces, factors, strict=True)),
            *((trace.origin * factor).denominator for trace, factor in zip(traces, factors, strict=True)),
        )
        return self._joined(traces, factors, scale, wanted, arrivals)

    def _places_of(self, name: str, parts: Sequence[str]) -> tuple[tuple[int, str], ...]:
        """The recordings in which something arrives in a column of arrivals, and the name of the column there."""
        topic = topic_of(name) or ""
        places = []
        for part in parts:
            number, own = self.places[part]
            inside = len(part) - len(topic)
            # a column that is called after its file may be shorter there than what follows the name of the file
            places.append((number, arrivals_of(own[: len(own) - inside] if inside < len(own) else own)))
        return tuple(dict.fromkeys(places))

    def _factor(self, trace: Trace) -> Fraction:
        """The number of units of the whole that make one of a trace."""
        own, common = length_of(trace.unit), length_of(self.unit)
        return Fraction(1) if own is None or common is None else own / common

    def _joined(
        self,
        traces: list[Trace],
        factors: list[Fraction],
        scale: int,
        wanted: Sequence[str],
        arrivals: Mapping[str, Sequence[tuple[int, str]]],
    ) -> Trace:
        origins = [trace.origin * factor for trace, factor in zip(traces, factors, strict=True)]
        ends = [trace.clock(trace.end) * factor for trace, factor in zip(traces, factors, strict=True)]
        giving = {self.places[name][0] for name in wanted}
        if not giving and not arrivals:
            giving = set(range(len(traces)))
        first = (origins[number] for number, _ in chain.from_iterable(arrivals.values()))
        begin = max(origins[number] for number in giving) if giving else min(first)
        if (max(ends) - min(origins)) * scale > _LAST_TICK:
            raise UsageError(
                f"{self.name} is too long to be counted in {scale} ticks per unit of time", "--decimals 3 rounds times"
            )
        late = next((traces[number] for number in giving if ends[number] < begin), None)
        if late is not None:
            raise UsageError(
                f"{late.name} ends before another file begins", "files that are joined show the same clock"
            )
        times = []
        for trace, factor, origin in zip(traces, factors, origins, strict=True):
            step = Fraction(scale) * factor / trace.ticks_per_unit
            times.append(trace.times * int(step) + int((origin - begin) * scale))
        instants = np.unique(np.concatenate([[0], *times]))
        instants = instants[instants >= 0]
        columns: dict[str, Values] = {}
        texts = Labels()
        for name in wanted:
            number, own = self.places[name]
            values = traces[number].columns[own]
            if own in traces[number].texts:
                values = texts.recoded(values, traces[number].labels, name)
            columns[name] = values[np.searchsorted(times[number], instants, side="right") - 1]
        for name, places in arrivals.items():
            arrived = [times[number][traces[number].columns[own] != 0] for number, own in places]
            columns[name] = np.isin(instants, np.concatenate(arrived)).astype(np.uint8)
        end = int((max(ends) - begin) * scale)
        joined = Trace(self.name, instants, columns, end, scale, self.unit, begin)
        return texts.on(
            replace(
                joined,
                dated=all(trace.dated for trace in traces),
                calendar=all(trace.dated or trace.calendar for trace in traces),
                notes=tuple(dict.fromkeys(note for trace in traces for note in trace.notes)),
                warnings=tuple(dict.fromkeys(warning for trace in traces for warning in trace.warnings)),
            )
        )


@dataclass(frozen=True, slots=True, eq=False)
class RoundedRecording:
    """A recording whose times have so many decimals."""

    recording: TraceSource
    decimals: int

    @property
    def name(self) -> str:
        return self.recording.name

    @property
    def unit(self) -> str:
        return self.recording.unit

    @property
    def columns(self) -> tuple[str, ...]:
        return self.recording.columns

    def read(self, columns: Collection[str] | None = None) -> Trace:
        return self.recording.read(columns).rounded(self.decimals)


def with_decimals(recording: TraceSource, decimals: int | None) -> TraceSource:
    """A recording whose times are rounded to so many decimals; None: as they are."""
    if decimals is None:
        return recording
    if isinstance(recording, SeveralRuns):
        runs = {number: with_decimals(run, decimals) for number, run in recording.runs.items()}
        return replace(recording, runs=runs)
    return RoundedRecording(_rounding(recording, decimals), decimals)


def _rounding(recording: TraceSource, decimals: int) -> TraceSource:
    """The rounding of times as text before they are counted, for they may have more digits than can be."""
    from tachk.recordings.traces.logs.json_table import JsonTable
    from tachk.recordings.traces.logs.trace_jsonl import JsonRecording

    match recording:
        case CsvRecording() | JsonRecording() | JsonTable():
            return replace(recording, decimals=decimals)
        case JoinedRecording(recordings=recordings):
            return replace(recording, recordings=tuple(_rounding(part, decimals) for part in recordings))
        case _:
            return recording


def worded(recording: TraceSource) -> frozenset[str]:
    """The columns of CSV files whose first cells are no numbers."""
    match recording:
        case CsvRecording():
            return recording.worded
        case RoundedRecording(recording=exact):
            return worded(exact)
        case JoinedRecording(places=places, recordings=recordings):
            own = [worded(part) for part in recordings]
            return frozenset(name for name, (number, column) in places.items() if column in own[number])
        case _:
            return frozenset()


def with_texts(recording: TraceSource, columns: Collection[str]) -> TraceSource:
    """A recording that reads some columns as texts. Most see for themselves what holds texts; a cell of CSV could be
    anything."""
    if not columns:
        return recording
    match recording:
        case CsvRecording():
            return replace(recording, texts=recording.texts.union(columns))
        case RoundedRecording(recording=exact):
            return replace(recording, recording=with_texts(exact, columns))
        case JoinedRecording(places=places, recordings=recordings):

            def own(place: int) -> list[str]:
                return [places[name][1] for name in columns if name in places and places[name][0] == place]

            return replace(recording, recordings=tuple(with_texts(part, own(n)) for n, part in enumerate(recordings)))
        case _:
            return recording


def join(recordings: Sequence[TraceSource]) -> TraceSource:
    """One recording of several. Where two have a column of the same name, each is called after its file, as in
    ``drive.speed``. Raises UsageError where that does not distinguish them, or one has a unit and another none."""
    if len(recordings) == 1:
        return recordings[0]
    name = ", ".join(recording.name for recording in recordings)
    units = {recording.unit for recording in recordings}
    if "" in units and len(units) > 1:
        nameless = next(recording.name for recording in recordings if not recording.unit)
        raise UsageError(f"{nameless} does not say the unit of its times, and another file does", "give --unit")
    names = (column for recording in recordings for column in recording.columns)
    twice = {column for column, count in Counter(names).items() if count > 1}
    places: dict[str, tuple[int, str]] = {}
    for number, recording in enumerate(recordings):
        for column in recording.columns:
            called = f"{Path(recording.name).stem}.{column}" if column in twice else column
            if called in places:
                raise UsageError(f"two columns of these files are called {called!r}", "give the files other names")
            places[called] = number, column
    return JoinedRecording(name, tuple(recordings), places)
