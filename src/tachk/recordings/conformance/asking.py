"""A file of recorded events is held against a model that has been read."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import StoppedError, limited
from tachk.engine.options import Limits
from tachk.frontend.loaded import LoadedModel
from tachk.frontend.scope import ValueSymbol
from tachk.model.expressions import Constant
from tachk.recordings.captures import capture_reader, capture_readers
from tachk.recordings.conformance.application_logs import with_log
from tachk.recordings.conformance.conform import Conformance, conform
from tachk.recordings.conformance.event_tables import read_events
from tachk.recordings.conformance.events import EventLog
from tachk.recordings.conformance.nearby import SHORT_WORK, smallest_edit
from tachk.recordings.conformance.question import ExplanationDetail, Question
from tachk.recordings.conformance.queues import Constants
from tachk.recordings.conformance.tolerances import duration, least

AUTO = "auto"
_STATES_OF_EDIT = 20_000
_STATES_OF_EVENT = 20
"""So many states at most, and so many more for each event, are stored when a recording is held against the model with
an edit."""


def conform_file(loaded: LoadedModel, name: str, recording: str, asked: Question, limits: Limits) -> Conformance:
    """As `tachk.api.model.conform`. Raises UsageError, UnsupportedError, StoppedError."""
    with limited(limits.seconds):
        return _conform_file(loaded, name, recording, asked, limits)


def _conform_file(loaded: LoadedModel, name: str, recording: str, asked: Question, limits: Limits) -> Conformance:
    network, mapping = loaded.network, loaded.recording
    if mapping is None:
        raise UsageError(
            f"{name} does not say how recordings are read", "write `recording { visible channel as event(); }` into it"
        )

    events = _read(Path(recording), asked)
    constants = constants_of(loaded)
    for reader in capture_readers():
        reader.check_room(events, constants)
    lateness = None if asked.late is None else duration(asked.late, network.time_unit)

    def ask(allowed: Fraction | None) -> Conformance:
        explain = asked.explanation is not ExplanationDetail.NONE
        return conform(network, mapping, events, constants, allowed, lateness, limits=limits, explain=explain)

    if asked.tolerance == AUTO:
        return least(ask)
    found = ask(None if asked.tolerance is None else duration(asked.tolerance, network.time_unit))
    if found.accepted is not False or found.refusal is None or found.refusal.event is None:
        return found

    def accepts(other: EventLog) -> bool:
        exact = found.tolerance, found.late
        few = limits.of_states(_STATES_OF_EDIT + _STATES_OF_EVENT * len(other.events))
        tried = conform(network, mapping, other, constants, *exact, limits=few, run=False, explain=False)
        return tried.accepted is True

    try:
        work = None if asked.explanation is ExplanationDetail.FULL else SHORT_WORK
        search = smallest_edit(network, mapping, events, constants, found, limits, accepts, work)
        return replace(found, edit=search.edit, untried=search.untried)
    except StoppedError:
        return replace(found, left_out="whether an edit of the recording would make it a run")


def _read(path: Path, asked: Question) -> EventLog:
    """A capture of packets, or a file of events; with the logs of applications."""
    reader = capture_reader(path)
    if reader is None:
        recording = read_events(path, asked.unit)
    elif asked.unit is not None:
        raise UsageError("a capture has its own times: it takes no unit")
    else:
        recording = reader.read_events(path, asked.ports)
    for log in asked.applications:
        recording = with_log(recording, read_events(Path(log)))
    return recording


def constants_of(loaded: LoadedModel) -> Constants:
    """The values of the constants of a model, by name."""

    def constant(name: str) -> int | None:
        symbol = loaded.scope.lookup(name)
        found = symbol.expression if isinstance(symbol, ValueSymbol) else None
        return found.value if isinstance(found, Constant) else None

    return constant
