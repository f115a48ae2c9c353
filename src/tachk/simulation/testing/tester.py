"""Tests a running system by its model: sends inputs that the environment may send, and follows what it answers.

The relation is rtioco: after all that was seen, each output, and each silence, must be one that the model allows in the
environment of the model (Larsen, Mikucionis, Nielsen, "Online testing of real-time systems using Uppaal", 2004;
Brandan Briones, Brinksma, "A test generation framework for quiescent real-time systems", 2004). Every test is recorded,
and judged again from its recording by the search of `tachk conform`.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from enum import StrEnum
from fractions import Fraction
from math import ceil

from tachk.base.diagnostics.diagnostic import InternalError, UsageError
from tachk.base.job import check_job
from tachk.base.records import dataclass, replace
from tachk.engine.options import Limits
from tachk.engine.state_estimate import EstimateLimitError
from tachk.model.network import Network
from tachk.model.quantity import duration
from tachk.model.query import Query
from tachk.model.recording import RecordingMap
from tachk.model.run import TimedTrace
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import Conformance, conform
from tachk.recordings.conformance.event_streams import Constants, input_names
from tachk.recordings.conformance.events import Cell, EventLog, RecordedEvent
from tachk.simulation.testing.followed_system import SOURCE, AllowedNext, FollowedSystem
from tachk.simulation.testing.goals import TestGoal
from tachk.simulation.testing.input_choice import (
    GuidedInputs,
    InputChoice,
    NotReceivedError,
    PlannedInput,
    RandomInputs,
    UncoveredEdges,
    must_act,
)
from tachk.simulation.testing.instrumented_network import InstrumentedNetwork, instrumented_network
from tachk.simulation.testing.property_goal import DecidingStates, InputsOfRun, PropertyGoal
from tachk.simulation.testing.run_events import events_of_run
from tachk.simulation.testing.system_adapter import SeenOutput, SystemAdapter, SystemEndedError

_EXCUSE = 4
"""So many times as long as it may be late a system goes on after a failure, to see whether it had to wait."""
_RECENT = 10
"""That it had to wait counts for so many times as long as it may be late."""
_AT_ONCE = 1_000
"""The largest number of outputs at the same time."""


class TestVerdict(StrEnum):
    """The result of a test."""

    __test__ = False  # pytest takes it for a test

    PASS = "pass"
    """All that was seen is allowed."""
    FAIL = "fail"
    """The system did what the model does not allow, or was silent for longer than it may be."""
    INCONCLUSIVE = "inconclusive"
    """The test says nothing: a limit was hit, the system ended, or it did what the environment does not expect."""


@dataclass(frozen=True, slots=True)
class TestSettings:
    """Attributes:
    duration: of the test, in units of the model.
    pause: the longest time until the next input, in units of the model; None: the largest constant of its clocks.
    uncertainty: of the times at which events are seen, as of `tachk conform`.
    goal: how inputs are chosen.
    """

    __test__ = False

    duration: Fraction
    seed: int
    uncertainty: TimestampUncertainty
    pause: int | None = None
    limits: Limits = Limits()
    goal: TestGoal | PropertyGoal = TestGoal.RANDOM


@dataclass(frozen=True, slots=True)
class TestResult:
    """Attributes:
    recording: all inputs and outputs, with times in units of the model.
    inputs: how many of the events are inputs.
    allowed: what the model allowed before the test failed; None if it did not.
    reason: why it is inconclusive; empty otherwise.
    conformance: what the search of `tachk conform` says of the recording; None where no verdict is due.
    states: the largest number of symbolic states in which the system may have been at a moment.
    explored: the number of symbolic states that were explored.
    covered: how many edges of the system were taken, on one way to each state in which it may have been.
    edges: how many it has.
    reached: by then the system may have been in a state that decides the property of the goal; None: never.
    """

    __test__ = False

    verdict: TestVerdict
    settings: TestSettings
    recording: EventLog
    inputs: int
    allowed: AllowedNext | None
    reason: str
    conformance: Conformance | None
    states: int
    explored: int
    covered: int
    edges: int
    reached: Fraction | None = None


@dataclass(frozen=True, slots=True)
class TestedModel:
    """A model that is ready for tests of systems.

    Attributes:
        network, mapping: locations in columns are variables already.
        constants: the values of words in events.
        instrumented: the network that notes what events contain.
    """

    __test__ = False

    network: Network
    mapping: RecordingMap
    constants: Constants
    instrumented: InstrumentedNetwork

    @staticmethod
    def of(network: Network, mapping: RecordingMap, constants: Constants, query: Query | None = None) -> TestedModel:
        """Args:
            query: tests may have the goal to reach a state that decides it.

        Raises UsageError for a model that cannot be followed, UnsupportedError.
        """
        return TestedModel(network, mapping, constants, instrumented_network(network, mapping, query))

    def pause(self, settings: TestSettings) -> int:
        """The longest time until the next input."""
        return self.instrumented.largest_constant if settings.pause is None else settings.pause

    def inputs(self, settings: TestSettings) -> InputChoice:
        """The inputs of a test with these settings."""
        others = RandomInputs(settings.seed, self.pause(settings), settings.uncertainty)
        match settings.goal:
            case TestGoal.RANDOM:
                return others
            case TestGoal.EDGES:
                return GuidedInputs(UncoveredEdges(), settings.seed, others, settings.uncertainty)
            case PropertyGoal(run=run):
                then = GuidedInputs(DecidingStates(), settings.seed, others, settings.uncertainty)
                return then if run is None else InputsOfRun(self.inputs_of(run), then, settings.uncertainty)

    def inputs_of(self, run: TimedTrace) -> tuple[RecordedEvent, ...]:
        """The inputs of a run of the network."""
        names = input_names(self.network, self.mapping)
        events = events_of_run(self.network, self.mapping, run, SOURCE).events
        return tuple(event for event in events if event.name in names)


@dataclass(frozen=True, slots=True)
class TestRun:
    """A test that was run, not yet judged.

    Attributes:
        sent: the inputs.
        is_as_modelled: the system did what the model allows.
        is_at_limit: a limit of the search ended it.
        waited: for a processor, shortly before the end.
    others: as of `TestResult`.
    """

    __test__ = False

    settings: TestSettings
    recording: EventLog
    sent: tuple[RecordedEvent, ...]
    is_as_modelled: bool
    allowed: AllowedNext | None
    reason: str
    is_at_limit: bool
    overdue: str
    waited: Fraction
    states: int
    explored: int
    covered: frozenset[int]
    reached: Fraction | None


def follow(model: TestedModel, system: SystemAdapter, settings: TestSettings, choice: InputChoice) -> TestRun:
    """Runs one test with these inputs. Raises UsageError for a system that does not start, and for lines that are no
    events."""
    test = _TestUnderWay(model, system, settings, choice)
    try:
        test.run()
    except BaseException:
        system.abandon()
        raise
    system.close()
    return test.outcome()


def _is_test_to_blame(model: TestedModel, run: TestRun, found: Conformance) -> bool:
    """True if all that was seen before an input is as the model says, and only the input is not."""
    number = None if found.refusal is None else found.refusal.event
    if number is None or not any(run.recording.events[number] is each for each in run.sent):
        return False
    before = replace(run.recording, events=run.recording.events[:number], end=run.recording.events[number].time)
    settings = run.settings
    seen = conform(
        model.network,
        model.mapping,
        before,
        model.constants,
        settings.uncertainty,
        limits=settings.limits,
        run=False,
        explain=False,
    )
    return seen.accepted is True


def _unexpected(run: TestRun) -> str:
    """What the environment of the model does not do, or does not expect."""
    if not run.recording.events:
        return "nothing was sent or seen, and the model lets no more time pass"
    last = run.recording.events[-1]
    if any(last is each for each in run.sent):
        return f"the test sent `{last.name}` at a moment at which the environment of the model does not"
    return "the system did what the environment of the model does not expect"


def confirmed(model: TestedModel, run: TestRun) -> TestResult:
    """The result of a test, confirmed by the search of `tachk conform`. Raises InternalError if that disagrees."""
    settings, found, reason = run.settings, None, run.reason
    verdict = TestVerdict.PASS if run.is_as_modelled else TestVerdict.FAIL
    if reason:
        verdict = TestVerdict.INCONCLUSIVE
    else:
        found = conform(
            model.network,
            model.mapping,
            run.recording,
            model.constants,
            settings.uncertainty,
            limits=settings.limits,
            run=False,  # two searches agree; exact times of a long run can take much longer than they
        )
        if verdict is TestVerdict.PASS and found.accepted is False:
            raise InternalError("the recording of a test that passed is not a run of the model")
        if verdict is TestVerdict.FAIL and found.accepted is True:
            verdict = TestVerdict.INCONCLUSIVE
            reason = run.overdue or _unexpected(run)
        if verdict is TestVerdict.FAIL and _is_test_to_blame(model, run, found):
            verdict = TestVerdict.INCONCLUSIVE
            reason = "the test sent an input at the very moment from which on the model does not allow it"
        if verdict is TestVerdict.FAIL and run.waited > settings.uncertainty.least_late:
            verdict = TestVerdict.INCONCLUSIVE
            reason = (
                "the system had to wait for a processor for "
                f"{duration(Fraction(round(run.waited)), model.network.time_unit)}, longer than it may be late: "
                "the machine is too busy; test again, or allow more with --late"
            )
    allowed = run.allowed if verdict is TestVerdict.FAIL else None
    return TestResult(
        verdict,
        settings,
        run.recording,
        len(run.sent),
        allowed,
        reason,
        found,
        run.states,
        run.explored,
        len(run.covered),
        len(model.instrumented.edges),
        run.reached,
    )


class _TestUnderWay:
    """A test under way."""

    def __init__(self, model: TestedModel, system: SystemAdapter, settings: TestSettings, choice: InputChoice) -> None:
        self.system = system
        self.settings = settings
        self.choice = choice
        self.pause = model.pause(settings)
        self.followed = FollowedSystem(
            model.instrumented, model.mapping, model.constants, settings.uncertainty, settings.limits
        )
        self.known = Fraction(0)
        self.events: list[RecordedEvent] = []
        self.sent: list[RecordedEvent] = []
        self.waits: list[tuple[Fraction, Fraction]] = []
        self.states = 1
        self.reason, self.is_at_limit = "", False
        self.is_as_modelled = True
        self.allowed: AllowedNext | None = None

    def run(self) -> None:
        try:
            self.system.start()
            while self._step():
                pass
            if self.is_as_modelled:
                self.is_as_modelled = self.followed.ends_as_modelled(self.known)
            if not self.is_as_modelled:
                self._wait_for_excuse()
        except EstimateLimitError as limit:
            self.reason = f"the states in which the system may be cannot be computed: {limit}"
            self.is_at_limit = True
        except (SystemEndedError, NotReceivedError) as ended:
            self.reason = str(ended)

    def _step(self) -> bool:
        """Waits for an output, or sends an input. False when the test is over."""
        check_job()
        self.waits.append((self.known, self.system.waited()))
        self.followed.advance(self.known)
        self.is_as_modelled = self.followed.is_as_modelled
        if not self.is_as_modelled or self.known >= self.settings.duration:
            return False
        self.states = max(self.states, self.followed.states)
        now = max(self.system.time(), self.known)
        spread = self.settings.uncertainty.largest
        self.allowed = self.followed.allowed(ceil(now) + self.pause + ceil(spread) + 1)
        planned = self.choice.next_input(self.followed, self.allowed, now)
        self._wait(planned, now)
        return True

    def _wait(self, planned: PlannedInput | None, now: Fraction) -> None:
        assert self.allowed is not None
        until = now + self.pause if planned is None else planned.moment
        if self.allowed.bounded:  # a silence that is too long is seen a little later
            seen = self.allowed.silent_until + self.settings.uncertainty.earliest + 1
            until = min(until, max(seen, now))
        until = min(until, self.settings.duration)
        if self._take_outputs(until):
            return
        self.known = until
        if planned is not None and planned.moment <= until:
            time = self.system.send(planned.name, planned.cells)
            self.choice.is_sent()
            self.sent.append(self._note(time, planned.name, planned.cells))

    def _take_outputs(self, until: Fraction) -> bool:
        """Waits for an output, and takes those that come with it. False if none came."""
        seen = self.system.next_output(until)
        first = seen
        for _ in range(_AT_ONCE):
            if seen is None:
                return first is not None
            self.known = max(self.known, seen.time)
            self._note_output(seen)
            seen = self.system.next_output(self.known)
        raise SystemEndedError(f"the system sends {_AT_ONCE} outputs at the same time")

    def _note_output(self, seen: SeenOutput) -> None:
        event = RecordedEvent(seen.time, seen.name, seen.cells, f"event {len(self.events) + 1}")
        unknown = self.followed.unknown_part(event)
        if unknown is not None:
            raise SystemEndedError(f"the system sends {unknown}, which the recording of the model does not show")
        if self.followed.is_input(event):
            raise SystemEndedError(f"the system sends `{seen.name}`, which is an input of it in the model")
        self._note(seen.time, seen.name, seen.cells)

    def _note(self, time: Fraction, name: str, cells: Mapping[str, Cell]) -> RecordedEvent:
        event = RecordedEvent(time, name, cells, f"event {len(self.events) + 1}")
        self.events.append(event)
        self.followed.observe(event)
        return event

    def _wait_for_excuse(self) -> None:
        """Lets the system go on: that it has to wait for a processor is counted when it has got one."""
        last = self.system.time() + _EXCUSE * self.settings.uncertainty.width
        with suppress(SystemEndedError, UsageError):
            for _ in range(_AT_ONCE):
                if self.system.next_output(last) is None:
                    break
        self.waits.append((self.known, self.system.waited()))

    def _waited(self) -> Fraction:
        """The time for which the system waited for a processor while it came to what is the last event."""
        begin = self.known - _RECENT * self.settings.uncertainty.width
        before = [waited for known, waited in self.waits if known <= begin]
        return self.waits[-1][1] - (before[-1] if before else self.waits[0][1]) if self.waits else Fraction(0)

    def _overdue(self) -> str:
        """Which input had to end a silence that lasted too long; empty if none had."""
        if self.is_as_modelled or self.allowed is None or not must_act(self.allowed):
            return ""
        names = sorted({event.name for event in self.allowed.events if event.is_input})
        return (
            f"the environment of the model must send `{'` or `'.join(names)}` by {self.allowed.silent_until}, "
            "and the test was too late for that: give it more time in the model"
        )

    def outcome(self) -> TestRun:
        end = max([self.known, *(event.time for event in self.events)])
        order = sorted(self.events, key=lambda event: event.time)
        recording = EventLog(SOURCE, tuple(order), None, Fraction(0), end)
        return TestRun(
            self.settings,
            recording,
            tuple(self.sent),
            self.is_as_modelled,
            self.allowed,
            self.reason,
            self.is_at_limit,
            self._overdue(),
            self._waited(),
            self.states,
            self.followed.explored,
            self.followed.covered,
            self.followed.reached,
        )
