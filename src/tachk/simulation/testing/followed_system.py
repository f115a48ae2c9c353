"""A running system beside its model: what it may have done so far, and what may come next."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import ceil, floor

from tachk.base.records import dataclass
from tachk.engine.options import Limits
from tachk.engine.state_estimate import PredictedStep, StateEstimate, Window
from tachk.model.recording import RecordingMap
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.event_streams import Constants, EventStreamReader, with_words
from tachk.recordings.conformance.events import Cell, EventLog, RecordedEvent
from tachk.simulation.testing.event_columns import is_broadcast
from tachk.simulation.testing.instrumented_network import LONGEST, InstrumentedNetwork, ObservedStream

SOURCE = "the system"
"""The name of what is followed, in messages."""


_DISTANCE = 10
"""An edge is looked for as far as so many times the largest constant of the clocks, ..."""
_STATES_OF_LEAD = 3_000
"""... and among so many states: that takes some milliseconds."""


@dataclass(frozen=True, slots=True)
class AllowedEvent:
    """An event that may happen first if nothing else does.

    Attributes:
        cells: what it contains, by column.
        windows: when, in units of the model since its start.
        boundaries: moments at which the system may change how it reacts to it.
        blocked: when a system as the model describes it may not be able to receive it; empty for an output.
    """

    name: str
    cells: Mapping[str, Cell]
    is_input: bool
    windows: tuple[Window, ...]
    blocked: tuple[Window, ...] = ()
    boundaries: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class AllowedNext:
    """Attributes:
    events: that may happen first.
    silent_until: nothing may be seen up to this moment, in units of the model since its start.
    bounded: the silence must end then; otherwise no longer one was looked at.
    """

    events: tuple[AllowedEvent, ...]
    silent_until: int
    bounded: bool


class FollowedSystem:
    """The states in which a system may be that is as its model says.

    Times are in units of the model since its start. An event happened in the window that the time at which it was seen
    leaves open, rounded outwards to whole units, as `tachk conform` has it.

    Attributes:
        moment: what happened until then has been seen, and the states are those of this moment.
        reached: by then the system may have been in a state that decides the query of the network; None: never yet.
    """

    def __init__(
        self,
        observed: InstrumentedNetwork,
        mapping: RecordingMap,
        constants: Constants,
        uncertainty: TimestampUncertainty,
        limits: Limits,
    ) -> None:
        self.moment = 0
        self._observed = observed
        self._uncertainty = uncertainty
        self._mapping = mapping
        self._reader = EventStreamReader(mapping, EventLog(SOURCE, (), None, None, Fraction(0)), constants)
        self._streams = {_key(mapping, stream): n for n, stream in enumerate(observed.streams)}
        self._estimate = StateEstimate(
            observed.program, observed.channels, len(observed.streams), observed.marks, limits=limits
        )
        self._estimate.watch(observed.reaching)
        self.reached: Fraction | None = None
        self._advance(0)

    @property
    def is_as_modelled(self) -> bool:
        """False if no state is left: what was seen is no run of the model."""
        return self._estimate.size > 0

    @property
    def states(self) -> int:
        """The number of symbolic states in which the system may be."""
        return self._estimate.size

    @property
    def explored(self) -> int:
        return self._estimate.explored

    def unknown_part(self, event: RecordedEvent) -> str | None:
        """The event, or the column of it, that no `visible` of the model has, as messages name it; None if all is
        known."""
        clauses = [visible for visible in self._mapping.visible if visible.event == event.name]
        if not clauses:
            return f"`{event.name}`"
        known = {name for visible in clauses for name, _ in visible.columns}
        extra = next((column for column in event.cells if column not in known), None)
        return None if extra is None else f"`{event.name}` with a column `{extra}`"

    def is_input(self, event: RecordedEvent) -> bool:
        """Whether it is an event that the environment sends. Raises UsageError as `observe`."""
        placed = self._reader.place(event)
        return placed is not None and self._observed.streams[self._streams[placed[0], placed[1]]].is_input

    def is_always_received(self, event: RecordedEvent) -> bool:
        """Whether an input needs no receiver: its channel is a broadcast one."""
        placed = self._reader.place(event)
        return placed is not None and is_broadcast(self._observed.streams[self._streams[placed[0], placed[1]]].visible)

    def observe(self, event: RecordedEvent) -> bool:
        """Adds an event that was seen, or may have happened, an input or an output; False if it is of no visible kind.

        Raises UsageError for one that no `visible` of the model allows.
        """
        placed = self._reader.place(event)
        if placed is None:
            return False
        clause, common, values = placed
        stream = self._streams[clause, common]
        before, behind = self._uncertainty.around(is_output=not self._observed.streams[stream].is_input)
        window = (floor(event.time - before) - self.moment, ceil(event.time + behind) - self.moment)
        self._estimate.observe(stream, values, window, event.optional)
        return True

    def advance(self, time: Fraction) -> None:
        """Takes note that everything has been seen that was recorded up to a time. Raises EstimateLimitError."""
        self._move_to(floor(time - self._uncertainty.earliest))

    def ends_as_modelled(self, time: Fraction) -> bool:
        """True if what was seen up to the end of the recording is a run of the model; what happened less than the
        lateness of outputs before may not have been recorded. Raises EstimateLimitError."""
        self._move_to(max(floor(time - self._uncertainty.earliest), 0))
        return self.is_as_modelled and self._estimate.can_conclude()

    def _move_to(self, moment: int) -> None:
        while moment > self.moment and self._estimate.size:
            step = min(moment - self.moment, LONGEST // 2)
            self._advance(step)

    def _advance(self, step: int) -> None:
        self._estimate.advance(step)
        self.moment += step
        if self.reached is None and self._estimate.passed:
            self.reached = Fraction(self.moment)

    def allowed(self, until: int) -> AllowedNext:
        """What may happen first if nothing more is seen, up to a moment. Raises EstimateLimitError."""
        length = min(max(until - self.moment, 0), LONGEST // 2)
        prediction = self._estimate.prediction(length)
        blocked: dict[int, list[Window]] = {}
        for channel, window in prediction.blocked:
            blocked.setdefault(channel, []).append(self._since_start(window))
        events = tuple(
            AllowedEvent(
                stream.visible.event,
                self._cells(stream, step.values),
                stream.is_input,
                tuple(map(self._since_start, step.windows)),
                tuple(blocked.get(step.channel, ())),
                tuple(self.moment + each for each in step.boundaries),
            )
            for step in prediction.steps
            for stream in (self._observed.streams[self._observed.channels[step.channel].stream],)
        )
        return AllowedNext(events, self.moment + prediction.silent_until, prediction.silent_until < length)

    @property
    def covered(self) -> frozenset[int]:
        """The edges of the system that were taken for sure, by their place in `InstrumentedNetwork.edges`."""
        return frozenset(self._estimate.covered())

    def lead(self, covered: frozenset[int]) -> AllowedEvent | None:
        """The first event of a run that takes an edge of the system that is not covered; None if none is found near.

        Raises EstimateLimitError.
        """
        marks = self._observed.marks
        wanted = [n for n, mark in enumerate(marks) if mark is not None and mark not in covered]
        length = min(_DISTANCE * self._observed.largest_constant, LONGEST // 2)
        return self._event_of(self._estimate.lead(length, wanted, _STATES_OF_LEAD)) if wanted else None

    def lead_to_target(self) -> AllowedEvent | None:
        """The first event of a run to a state that decides the query of the network; None if none is found near, or if
        no event comes before.

        Raises EstimateLimitError.
        """
        length = min(_DISTANCE * self._observed.largest_constant, LONGEST // 2)
        return self._event_of(self._estimate.lead(length, self._observed.reaching, _STATES_OF_LEAD))

    def _event_of(self, step: PredictedStep | None) -> AllowedEvent | None:
        if step is None:
            return None
        stream = self._observed.streams[self._observed.channels[step.channel].stream]
        windows = tuple(map(self._since_start, step.windows))
        return AllowedEvent(stream.visible.event, self._cells(stream, step.values), stream.is_input, windows)

    def _since_start(self, window: Window) -> Window:
        return window[0] + self.moment, window[1] + self.moment

    def _cells(self, stream: ObservedStream, values: tuple[int, ...]) -> dict[str, Cell]:
        names = (name for name, _ in stream.visible.columns)
        return dict(with_words(stream.visible, zip(names, values, strict=True)))


def _key(mapping: RecordingMap, stream: ObservedStream) -> tuple[int, tuple[int | None, ...]]:
    number = next(n for n, visible in enumerate(mapping.visible) if visible is stream.visible)
    return number, tuple(stream.common.values())
