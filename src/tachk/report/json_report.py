"""The machine form of a run: plain dictionaries that follow docs/schema/verify.schema.json."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from tachk.diagnostics.diagnostic import Diagnostic, Severity
from tachk.diagnostics.render_json import diagnostic_to_json
from tachk.diagnostics.span import NOWHERE, Span
from tachk.engines.protocol import RunTimeFault
from tachk.model.network import Direction, Network
from tachk.properties.verdict import Verdict
from tachk.report.record import NotRead, RunRecord
from tachk.report.trace_view import Event, Snapshot, TraceView, ViewStep, view_event, view_path, view_trace

Json = Mapping[str, "Json"] | Sequence["Json"] | str | int | float | bool | None


def runs_to_json(records: Iterable[RunRecord | NotRead]) -> dict[str, Json]:
    """What a command did, one run for each model, in the one shape of docs/schema/verify.schema.json."""
    return {"runs": [not_read_to_json(r) if isinstance(r, NotRead) else run_to_json(r) for r in records]}


def run_to_json(record: RunRecord) -> dict[str, Json]:
    """The run as a dictionary for `json.dumps`."""
    return {
        "model": record.model,
        "constants": dict(record.network.constants),
        "time_unit": record.network.time_unit,
        "results": [verdict_to_json(record.network, verdict) for verdict in record.verdicts],
        "not_checked": [
            {
                "name": query.name,
                "title": query.title,
                "query": query.text,
                "reason": query.reason,
                "errors": _errors(query.diagnostics),
            }
            for query in record.not_checked
        ],
        "errors": _errors(record.refusals),
    }


def not_read_to_json(record: NotRead) -> dict[str, Json]:
    """A run that did not take place: no result, but errors."""
    plain: dict[str, Json] = {
        "code": None,
        "severity": Severity.ERROR.value,
        "message": record.message,
        "help": record.help,
        "place": None,
        "labels": [],
    }
    return {
        "model": record.model,
        "constants": {},
        "time_unit": "",
        "results": [],
        "not_checked": [],
        "errors": _errors(record.diagnostics) or [plain],
    }


def _errors(diagnostics: Iterable[Diagnostic]) -> list[Json]:
    return [diagnostic_to_json(diagnostic) for diagnostic in diagnostics]


def verdict_to_json(network: Network, verdict: Verdict) -> dict[str, Json]:
    """One answer; ``trace`` is a list of states, each with the step that leads to it."""
    query = verdict.query
    statistics = verdict.statistics
    return {
        "name": query.name,
        "title": query.title,
        "query": query.text,
        "answer": verdict.answer.value,
        "expected": None if query.expectation is None else query.expectation.value,
        "met": verdict.met,
        "exact": verdict.exact,
        "reason": verdict.reason,
        "stats": {
            "states_explored": statistics.states_explored,
            "states_stored": statistics.states_stored,
            "transitions": statistics.transitions,
            "seconds": statistics.seconds,
            "peak_bytes": statistics.peak_bytes,
        },
        "trace": None if verdict.trace is None else trace_to_json(view_trace(network, verdict.trace)),
        "fault": None if verdict.fault is None else _fault(network, verdict.fault),
        "observer": _observer(verdict),
    }


def _observer(verdict: Verdict) -> Json:
    observer = verdict.query.observer
    if observer is None:
        return None
    moves = [{"time": str(move.time), "location": move.location} for move in verdict.moves]
    return {"formula": observer.formula, "moves": moves}


def trace_to_json(trace: TraceView) -> list[dict[str, Json]]:
    """A list of states, the initial one first; exact times are strings such as ``"5/2"``."""
    return [_state(trace.initial, None), *(_state(step.state, step) for step in trace.steps)]


def _state(state: Snapshot, step: ViewStep | None) -> dict[str, Json]:
    event = None if step is None else step.event
    return {
        "delay": None if step is None or step.delay is None else str(step.delay),
        "transition": None if event is None else _transition(event),
        "time": None if state.time is None else str(state.time),
        "locations": dict(state.locations),
        "variables": dict(state.variables),
        "clocks": None if state.clocks is None else {name: str(value) for name, value in state.clocks},
    }


def _transition(event: Event) -> dict[str, Json]:
    return {
        "channel": event.channel or None,
        "participants": [
            {
                "process": move.process,
                "role": _ROLES[move.direction],
                "source": move.source,
                "target": move.target,
                "select": dict(move.selects),
                "doc": move.doc,
                "positions": _positions(move.spans),
            }
            for move in event.moves
        ],
    }


_ROLES = {None: "internal", Direction.SEND: "sends", Direction.RECEIVE: "receives"}


def _positions(spans: Iterable[Span]) -> list[str]:
    return [str(span) for span in spans if span.source is not NOWHERE.source]


def _fault(network: Network, fault: RunTimeFault) -> dict[str, Json]:
    return {
        "kind": fault.kind.name.lower(),
        "position": str(fault.span),
        "text": fault.span.text,
        "detail": fault.detail,
        "path": trace_to_json(view_path(network, fault.path) if fault.run is None else view_trace(network, fault.run)),
        "transition": None
        if fault.transition is None
        else _transition(view_event(network, fault.path, fault.transition)),
    }
