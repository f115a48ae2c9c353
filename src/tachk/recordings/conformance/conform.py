"""Is a recording a run of a model? The search for that run, by the zone engine.

Parts of the model that share nothing are searched one by one, each with its own events. That is exact: a part of which
the events of others are forgotten has every run that it has in a run of the whole, so if it has none there is none; and
runs of all parts that are apart are a run of the whole. Where neither says yes or no, the whole is searched.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from itertools import accumulate
from math import ceil, lcm

from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.job import StoppedError
from tachk.base.records import dataclass, replace
from tachk.engine.compiler.lower import MeasuredExpression, lower, lower_measures
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.exact.concretise import concretise
from tachk.engine.exact.exact_run import Moments, exact_run
from tachk.engine.measuring import ExtremeMeasurement, measure
from tachk.engine.options import Limits, Options, SearchOrder
from tachk.engine.outcome import INTERRUPTED, GoalOutcome, Statistics, Status
from tachk.engine.zone import explore
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import replay
from tachk.model.expressions import BOOL, Constant
from tachk.model.network import Network
from tachk.model.recording import RecordingMap
from tachk.model.run import TimedTrace, Transition
from tachk.model.selections import check_selections
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.components import (
    IndependentComponent,
    are_independent,
    components_of,
    restricted,
    separated,
)
from tachk.recordings.conformance.edits import Edit
from tachk.recordings.conformance.event_streams import Constants, EventStreams, make_streams
from tachk.recordings.conformance.events import EventLog
from tachk.recordings.conformance.rejection import PossibleEvent, enabled_events, end_of, state_text
from tachk.recordings.conformance.segments import LONG, LongRun, SegmentSearch
from tachk.recordings.conformance.trace_product import TraceProduct, trace_product

LONGEST_BY_REFERENCE = 100
"""The reference judges runs of at most so many transitions, too."""


def moments_of_run(
    product: TraceProduct, program: Program, goal: Goal, actions: Sequence[Sequence[int]], path: Sequence[Transition]
) -> Moments:
    """The moments of the transitions of a path in a run to the end of the recording. Raises InternalError, ReplayError.

    Args:
        program, goal: of the network that follows the recording.
        actions: the path by the numbers of the edges of the program.
    """
    moments, _ = exact_run(program, goal, actions)
    if moments is not None and len(path) > LONGEST_BY_REFERENCE:
        return moments
    by_reference = moments_of_trace(run_by_reference(product, path), len(path))
    return by_reference if moments is None else moments


def run_by_reference(product: TraceProduct, path: Sequence[Transition]) -> TimedTrace:
    """The earliest run along a path, made and judged by the meaning of the network. Raises as `moments_of_run`."""
    model = prepare(product.network)
    trace = concretise(model, path, product.done)
    if trace is None:
        raise InternalError("the run that was found cannot be made")
    replay(model, trace, product.done)
    return trace


def moments_of_trace(trace: TimedTrace, transitions: int) -> Moments:
    """The moments of the transitions of a trace, and of its end."""
    times = list(accumulate(step.delay for step in trace.steps))
    times += times[-1:] if len(times) == transitions else []
    unit = lcm(*(time.denominator for time in times))
    return Moments(tuple(int(time * unit) for time in times), unit)


_TRUE = Constant(1, BOOL)
_STATES_OF_EVENT = 20
"""The largest number of states for each event that the budgeted search stores."""


@dataclass(frozen=True, slots=True)
class Rejection:
    """The place where the recording leaves the model, at the end of the longest run that agrees with it.

    Attributes:
        path: of a run that has as many events of the recording as possible.
        happened: how many events of the recording happen before, in all parts of the model.
        event: the number of the event that cannot come next; None if all have come and the model would not be silent.
        state: the locations of that part of the model there.
        enabled_events: the events that the model allows there.
        enabled_complete: True if `enabled_events` lists them all.
    """

    path: tuple[Transition, ...]
    happened: int
    event: int | None
    state: str
    enabled_events: tuple[PossibleEvent, ...]
    enabled_complete: bool


@dataclass(frozen=True, slots=True)
class ConformingRun:
    """A run of a part of the model that goes along with its events.

    Attributes:
        path: its transitions in the network that follows the recording.
        moments: those of the transitions and of the end of the run; None if they were not requested.
    """

    product: TraceProduct
    path: tuple[Transition, ...]
    moments: Moments | None

    @property
    def modelled(self) -> tuple[int, ...]:
        """The numbers in the model of its processes."""
        return self.product.modelled

    @property
    def transitions(self) -> int:
        """How many it has."""
        return len(self.path)

    @property
    def taken(self) -> Mapping[tuple[int, int], int]:
        """How often it takes edges, each by the numbers of its process and of it."""
        lifted = filter(None, map(self.product.lift_transition, self.path))
        return Counter((p.process, p.edge) for transition in lifted for p in transition.participants)


@dataclass(frozen=True, slots=True)
class Reached:
    """A run of a part of the model that goes along with its events as far as any that was found.

    Attributes:
        streams: those of the part.
        program: of the network that follows the recording.
        actions: the path by the numbers of the edges of the program.
    """

    component: IndependentComponent
    product: TraceProduct
    streams: EventStreams
    program: Program
    path: tuple[Transition, ...]
    actions: Sequence[Sequence[int]]


@dataclass(frozen=True, slots=True)
class Conformance:
    """Whether a recording is a run of a model, with the run or the place at which it leaves the model.

    Attributes:
        accepted: the recording is a run of the model; None where a limit was hit first.
        uncertainty: with which this was found.
        time_unit: of the model.
        runs: of all parts of the model, which show it.
        refusal: where the recording leaves the model; None where it does not, or that was not found in the limits.
        reached: how far each part goes along, where there is a refusal.
        reason: why there is no answer; empty if there is one.
        edit: of the recording, with which it would be a run; None where it is one, or none was found.
        untried: how many edits near the event were not tried, since that would have taken too long.
        left_out: what of the explanation the time limit left no time for, in words; empty if there is all of it.
    """

    accepted: bool | None
    uncertainty: TimestampUncertainty
    time_unit: str
    recording: EventLog
    streams: EventStreams
    statistics: Statistics
    runs: tuple[ConformingRun | LongRun, ...] = ()
    refusal: Rejection | None = None
    reached: tuple[Reached, ...] = ()
    reason: str = ""
    edit: Edit | None = None
    untried: int = 0
    left_out: str = ""

    @property
    def tolerance(self) -> Fraction:
        """The tolerance with which this was found, in units of the model."""
        return self.uncertainty.tolerance

    @property
    def late(self) -> Fraction:
        """The larger of the two latenesses with which this was found, in units of the model."""
        return self.uncertainty.late


def conform(
    network: Network,
    mapping: RecordingMap,
    recording: EventLog,
    constants: Constants,
    uncertainty: TimestampUncertainty | None = None,
    options: Options = Options(order=SearchOrder.DFS),
    limits: Limits = Limits(),
    run: bool = True,
    explain: bool = True,
    divide: bool = True,
) -> Conformance:
    """Checks if a recording is a run of a model.

    Args:
        uncertainty: of recorded times; None: as the model says.
        run: give the run that shows it exact times, and judge it.
        explain: find where the recording leaves the model.
        divide: search parts that share nothing one by one; no verdict depends on it.

    Raises UsageError for a recording that does not fit the model, UnsupportedError.
    """
    uncertainty = mapping.allowances.uncertainty() if uncertainty is None else uncertainty
    if len(recording.events) > LONG:
        segments = SegmentSearch(network, mapping, recording, constants, uncertainty, options, limits, divide)
        followed = segments.followed()
        if followed is not None:
            long, statistics, runs = followed.streams, followed.statistics, followed.runs
            return Conformance(True, uncertainty, network.time_unit, recording, long, statistics, runs)
    streams = make_streams(network, mapping, recording, constants, uncertainty)
    modelled = mapping.modelled(network)
    whole = IndependentComponent(modelled, tuple(range(len(streams.streams))))
    components = components_of(network, mapping, streams) if divide else (whole,)
    search = _ConformanceSearch(network, mapping, streams, options, limits, explain)
    separately = len(components) > 1 and are_independent(network, modelled, streams)
    answers = search.separately(components, (0, ceil(uncertainty.tolerance))) if separately else None
    if answers is None:
        answers = [search.component(whole, streams)]
    found = Conformance(
        None, uncertainty, network.time_unit, recording, streams, _total(a.statistics for a in search.answers)
    )
    refusing = [answer for answer in answers if answer.accepted is not True]
    if not refusing:
        return replace(found, accepted=True, runs=tuple(_run(answer, run) for answer in answers))
    rejected = [answer for answer in refusing if answer.accepted is False]
    found = replace(found, accepted=False if rejected else None, reason="" if rejected else refusing[0].reason)
    if not explain:
        return found
    try:
        rejection = _earliest(search, rejected or refusing)
    except StoppedError:
        rejection = None
    left_out = "where the recording leaves the model" if rejected and rejection is None else ""
    reached = tuple(one for answer in answers if (one := _reached(answer)) is not None)
    return replace(found, refusal=rejection, reached=reached, left_out=left_out)


@dataclass(frozen=True, slots=True)
class _SearchOutcome:
    """The result of one search, about a component or the whole.

    Attributes:
        furthest: the path that agrees with the recording as far as any; None if it was not requested.
    """

    component: IndependentComponent
    accepted: bool | None
    product: TraceProduct
    streams: EventStreams
    statistics: Statistics
    program: Program
    goal: Goal
    found: GoalOutcome
    reason: str
    furthest: ExtremeMeasurement | None


class _ConformanceSearch:
    """Searches of the parts of one network for runs that go along with one recording."""

    def __init__(
        self,
        network: Network,
        mapping: RecordingMap,
        streams: EventStreams,
        options: Options,
        limits: Limits,
        explain: bool,
    ) -> None:
        self.network = network
        self.mapping = mapping
        self.streams = streams
        self.options = options
        self.limits = limits
        self.explain = explain
        self.answers: list[_SearchOutcome] = []

    def component(
        self,
        component: IndependentComponent,
        streams: EventStreams,
        to_the_end: bool = False,
        states: int | None = None,
    ) -> _SearchOutcome:
        own = restricted(streams, component)
        product = trace_product(self.network, self.mapping, own, component.processes, to_the_end)
        check_selections(product.network)
        limits = self.limits if states is None else self.limits.of_states(states)
        furthest = None
        if self.explain and not to_the_end:
            measured = [MeasuredExpression(_TRUE, product.progress, largest=True)]
            program, goals, measures = lower_measures(product.network, measured, product.tables, [product.done])
            outcome, (furthest,) = measure(program, goals, measures, self.options, limits)
        else:
            program, goals = lower(product.network, [product.done], product.tables)
            outcome = explore(program, goals, self.options, limits)
        if outcome.reason == INTERRUPTED:
            raise KeyboardInterrupt
        found = outcome.goals[0]
        accepted = {Status.REACHED: True, Status.UNREACHABLE: None if outcome.reason else False}.get(found.status)
        reason = "" if accepted is not None else outcome.reason or "unknown"
        answer = _SearchOutcome(
            component, accepted, product, own, outcome.statistics, program, goals[0], found, reason, furthest
        )
        self.answers.append(answer)
        return answer

    def separately(
        self, components: Sequence[IndependentComponent], delays: Sequence[int]
    ) -> list[_SearchOutcome] | None:
        """An answer for each independent component; None if these do not decide the whole.

        A budgeted search for runs with cut windows comes first: most recordings that are runs need no other one.
        """
        states = _STATES_OF_EVENT * (1 + sum(len(stream.events) for stream in self.streams.streams))
        quick = self._cut(components, delays[0], states)
        if len(quick) == len(components) and quick[-1].accepted:
            return quick
        free: list[_SearchOutcome] = []
        for component in components:
            try:
                free.append(self.component(component, self.streams))
            except StoppedError:
                if any(answer.accepted is False for answer in free):
                    return free
                raise
            if free[-1].accepted is False and not self.explain:
                return free
        if any(answer.accepted is False for answer in free):
            return free
        settled = not quick or quick[-1].accepted is False
        for delay in delays[1:] if settled else delays:
            found = self._cut(components, delay)
            if len(found) == len(components) and found[-1].accepted:
                return found
        return None

    def _cut(
        self, components: Sequence[IndependentComponent], delay: int, states: int | None = None
    ) -> list[_SearchOutcome]:
        """Answers of parts up to the first that is not accepted, with windows cut so that nothing arrives before it is
        sent. None of them if there is no room for that."""
        cut = separated(self.streams, components, delay)
        if cut is None:
            return []
        found: list[_SearchOutcome] = []
        for component in components:
            found.append(self.component(component, cut, to_the_end=True, states=states))
            if not found[-1].accepted:
                break
        return found


def _total(statistics: Iterable[Statistics]) -> Statistics:
    first, *others = statistics
    for other in others:
        first = first.then(other)
    return first


def _reached(answer: _SearchOutcome) -> Reached | None:
    found = answer.found if answer.accepted else answer.furthest
    if found is None:
        return None
    path, actions = tuple(found.path or ()), found.actions or ()
    return Reached(answer.component, answer.product, answer.streams, answer.program, path, actions)


def _run(answer: _SearchOutcome, exact: bool) -> ConformingRun:
    found, path = answer.found, tuple(answer.found.path or ())
    if not exact:
        return ConformingRun(answer.product, path, None)
    moments = moments_of_run(answer.product, answer.program, answer.goal, found.actions or (), path)
    return ConformingRun(answer.product, path, moments)


def _earliest(search: _ConformanceSearch, refusing: Sequence[_SearchOutcome]) -> Rejection | None:
    """The first place where the recording leaves the model, of all components that reject it."""
    found = [rejection for answer in refusing if (rejection := _furthest(search, answer)) is not None]
    return min(found, key=lambda each: (each.event is None, each.event or 0), default=None)


def _furthest(search: _ConformanceSearch, answer: _SearchOutcome) -> Rejection | None:
    """A run of a part that goes along with the recording as far as any that was found."""
    product, streams, program, found = answer.product, answer.streams, answer.program, answer.furthest
    if found is None:
        return None
    happened = events_along(product, streams, found.path)
    waiting = [
        (stream.latest[count], stream.events[count])
        for stream, count in zip(streams.streams, happened, strict=True)
        if count < len(stream.events)
    ]
    event = min(waiting)[1] if waiting else None
    own = {number for stream in streams.streams for number in stream.events}
    others = [
        n for stream in search.streams.streams for n in stream.events if n not in own and (event is None or n < event)
    ]
    end = end_of(product, program, found.path, found.actions)
    allowed = enabled_events(search.network, search.mapping, product, streams, happened, end)
    count, state = sum(happened) + len(others), state_text(product, end)
    return Rejection(found.path, count, event, state, allowed.enabled_events, allowed.whole)


def events_along(product: TraceProduct, streams: EventStreams, path: Sequence[Transition]) -> list[int]:
    """How many events of each stream happen along a path."""
    counts = [0] * len(streams.streams)
    for transition in path:
        stream = product.stream_of(transition)
        if stream is not None and counts[stream] < len(streams.streams[stream].events):
            counts[stream] += 1
    return counts
