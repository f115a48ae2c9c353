"""A test of a system by a model that has been read."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass, replace
from tachk.base.time_units import length_of
from tachk.engine.options import Limits
from tachk.engine.simulation.policy import Policy
from tachk.frontend.loaded import LoadedModel
from tachk.model.recording import RecordingMap
from tachk.recordings.conformance.conform_file import allowances_of, constants_of, duration
from tachk.recordings.conformance.event_streams import EventStreamReader, input_names, origin_of, with_words
from tachk.recordings.conformance.events import EventLog, RecordedEvent
from tachk.recordings.conformance.location_columns import with_location_variables
from tachk.simulation.testing.adapters import open_adapter
from tachk.simulation.testing.goals import TestGoal
from tachk.simulation.testing.input_choice import ScriptedInputs
from tachk.simulation.testing.modelled_system import ModelledSystem
from tachk.simulation.testing.property_goal import PropertyGoal
from tachk.simulation.testing.shortening import Shortening, shorten
from tachk.simulation.testing.system_adapter import SystemAdapter
from tachk.simulation.testing.tester import TestedModel, TestResult, TestSettings, TestVerdict, confirmed, follow

_SECONDS, _UNITS = "10s", "10000"
"""The duration of a test if none is wanted, of models with and without a unit of time."""


@dataclass(frozen=True, slots=True)
class TestRequest:
    """The arguments of a test, as of `tachk.api.testing.test`.

    Attributes:
        adapter: the system, as `--adapter` names it; or a model, whose processes stand for the system.
        duration: such as ``5ms``; None: 10 s, or 10,000 units of a model that does not say how long a unit is.
        pause, tolerance: durations; None: as the model says.
        late: a duration, or durations by ``input`` and ``output``; None: as the model says.
        shorten: for so many seconds shorter tests that fail are looked for if a test fails.
        inputs: a recording whose inputs are sent, at its times, in place of chosen ones.
    """

    __test__ = False

    adapter: str | LoadedModel
    duration: str | None = None
    seed: int = 0
    tolerance: str | None = None
    late: str | Mapping[str, str] | None = None
    pause: str | None = None
    shorten: float | None = None
    goal: TestGoal | PropertyGoal = TestGoal.RANDOM
    inputs: EventLog | None = None


def run_test_of_model(
    loaded: LoadedModel, name: str, request: TestRequest, limits: Limits
) -> tuple[TestResult, Shortening | None]:
    """Runs a test; if it fails and that is wanted, gives the shortest one that fails.

    Raises as `follow` and `confirmed`, and UsageError for a model without a recording.
    """
    network, mapping = with_location_variables(loaded.network, replacing_map(loaded, name))
    unit = network.time_unit
    allowances = allowances_of(request.tolerance, request.late, unit).over(mapping.allowances)
    settings = TestSettings(
        duration(request.duration or (_SECONDS if unit else _UNITS), unit),
        request.seed,
        allowances.uncertainty(),
        None if request.pause is None else _pause(request.pause, unit),
        limits,
        request.goal,
    )
    query = request.goal.query if isinstance(request.goal, PropertyGoal) else None
    tested = TestedModel.of(network, mapping, constants_of(loaded), query)

    def open_system() -> SystemAdapter:
        if isinstance(request.adapter, str):
            return open_adapter(request.adapter, nanoseconds_of(unit))
        return _system_of(request.adapter, request.seed)

    inputs = tested.inputs(settings)
    if request.inputs is not None:
        script = _script(tested, request.inputs, settings)
        inputs = ScriptedInputs(script.events, settings.uncertainty)
        if request.duration is None:
            settings = replace(settings, duration=script.end + tested.pause(settings))
    run = follow(tested, open_system(), settings, inputs)
    result = confirmed(tested, run)
    if request.shorten is None or result.verdict is not TestVerdict.FAIL:
        return result, None
    shortening = shorten(tested, open_system, run, result, request.shorten)
    return shortening.result, shortening


def replacing_map(loaded: LoadedModel, name: str) -> RecordingMap:
    """What the model says of its environment and of what is seen. Raises UsageError if that allows no test."""
    mapping = loaded.recording
    if mapping is None or not mapping.visible:
        raise UsageError(
            f"{name} does not say what can be seen of the system",
            "write `recording { replaces Environment; visible channel as event(); }` into it",
        )
    if not mapping.replaced:
        raise UsageError(
            f"the recording of {name} replaces no process, so nothing of the model is the environment",
            "write `replaces` with the processes that a test stands for",
        )
    if len(mapping.replaced) == len(loaded.network.processes):
        raise UsageError(
            f"the recording of {name} replaces every process, so nothing of the model is the system",
            "leave out of `replaces` what is tested",
        )
    return mapping


def _script(model: TestedModel, recording: EventLog, settings: TestSettings) -> EventLog:
    """The inputs of a recording, with times in units of the model since its start. Raises UsageError if it has none, or
    one that the model does not have."""
    origin, scale = origin_of(model.network, recording, settings.uncertainty)
    names = input_names(model.network, model.mapping)
    inputs = tuple(
        replace(event, time=(event.time - origin) * scale) for event in recording.events if event.name in names
    )
    if not inputs:
        raise UsageError(
            f"{recording.source} has no event that is an input of the system",
            f"the inputs in the model are {', '.join(f'`{name}`' for name in sorted(names))}",
        )
    reader = EventStreamReader(model.mapping, recording, model.constants)
    end = max((recording.end - origin) * scale, inputs[-1].time) + settings.uncertainty.width + 1
    read = tuple(_as_read(event, reader, model.mapping) for event in inputs)
    return EventLog(recording.source, read, None, Fraction(0), end)


def _as_read(event: RecordedEvent, reader: EventStreamReader, mapping: RecordingMap) -> RecordedEvent:
    """The event with its columns in the model's own values, and no other columns."""
    placed = reader.place(event)
    assert placed is not None
    visible, values = mapping.visible[placed[0]], placed[2]
    known = ((name, value) for (name, _), value in zip(visible.columns, values, strict=True) if value is not None)
    return replace(event, cells=dict(with_words(visible, known)))


def _pause(text: str, unit: str) -> int:
    pause = int(duration(text, unit))
    if pause < 1:
        raise UsageError(
            f"a pause of `{text}` is shorter than a unit of the model", "write a longer one: time has to pass"
        )
    return pause


def _system_of(loaded: LoadedModel, seed: int) -> SystemAdapter:
    if loaded.recording is None or not loaded.recording.replaced:
        raise UsageError(
            "the model that stands for the system has no recording that replaces its environment",
            "make it a changed copy of the model of the test",
        )
    network, mapping = with_location_variables(loaded.network, loaded.recording)
    return ModelledSystem(network, mapping, constants_of(loaded), seed, Policy.BOUNDARY)


def nanoseconds_of(time_unit: str) -> Fraction | None:
    """The length of a unit of a model; None if the model does not say it."""
    return length_of(time_unit) if time_unit else None
