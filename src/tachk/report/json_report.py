"""The machine form of a run: plain dictionaries that follow docs/schema/verify.schema.json."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from itertools import compress, pairwise
from operator import ne
from typing import Any

from tachk.base.plain_data import Fields, PlainData, complaint
from tachk.base.span import NOWHERE, Span
from tachk.base.words import Direction
from tachk.engine.outcome import Statistics
from tachk.meaning.run_view import (
    ProcessMove,
    Snapshot,
    TraceView,
    TransitionView,
    ViewStep,
    view_event,
    view_path,
    view_trace,
)
from tachk.model.network import Network
from tachk.model.run import Due, RunTimeFault, TimedTrace
from tachk.model.types import ClockType
from tachk.report.json_text import json_text
from tachk.report.record import NotChecked, NotRead, RunRecord
from tachk.report.run_formats import ReportWriter
from tachk.verify.fault_explanation import diagnostic_of
from tachk.verify.verdict import Extreme, Verdict

Json = Mapping[str, "Json"] | Sequence["Json"] | str | int | float | bool | None

_WrittenSpans = dict[tuple[str, str, str], tuple[Span, ...]]
"""By process, source and target: the places of the edge that was taken last."""


class JsonReport(ReportWriter):
    """Writes all at the end."""

    def finish(self, records: Sequence[RunRecord | NotRead]) -> None:
        self.out.write(json_text(runs_to_json(records, self.presentation.display.every_step)))


def runs_to_json(records: Iterable[RunRecord | NotRead], every_step: bool = False) -> dict[str, Json]:
    """The results of a command, one run for each model, in the one shape of docs/schema/verify.schema.json.

    Args:
        every_step: include the steps that the model hides.
    """
    return {"runs": [not_read_to_json(r) if isinstance(r, NotRead) else run_to_json(r, every_step) for r in records]}


def run_to_json(record: RunRecord, every_step: bool = False) -> dict[str, Json]:
    """The run as a dictionary for `json.dumps`."""
    network = record.network
    forms = {
        **FORMS,
        TimedTrace: lambda run: trace_to_json(_visible(view_trace(network, run), every_step)),
        RunTimeFault: lambda fault: _fault(network, fault),
    }
    if record.estimates:
        from tachk.report.statistics.json import FORMS as STATISTICAL

        forms |= STATISTICAL
    return PlainData(forms).of(record)


def not_read_to_json(record: NotRead) -> dict[str, Json]:
    """A run that did not take place: no result, but errors."""
    return {
        "model": record.model,
        "constants": {},
        "time_unit": "",
        "templates": {},
        "results": [],
        "not_checked": [],
        "estimates": [],
        "errors": [*map(PlainData(), record.diagnostics)] or [complaint(record.message, record.help)],
    }


def _observer(verdict: Verdict) -> dict[str, object] | None:
    observer = verdict.query.observer
    return None if observer is None else {"formula": observer.formula, "moves": verdict.moves}


def _values(verdict: Verdict) -> list[dict[str, object]]:
    return [
        {
            "expression": found.expression,
            "is_time": isinstance(operand.type, ClockType),
            "lower": found.least,
            "upper": found.largest,
        }
        for operand, found in zip(verdict.query.operands, verdict.extremes, strict=False)
    ]


FORMS: dict[type, Fields | Callable[[Any], object]] = {
    RunRecord: Fields(
        "model constants time_unit=network.time_unit templates results=verdicts not_checked estimates errors=blocking",
        constants=lambda record: dict(record.network.constants),
        templates=lambda record: {process.name: process.template for process in record.network.processes},
    ),
    NotChecked: Fields("name title query=text reason errors=diagnostics"),
    Verdict: Fields(
        "name=query.name title=query.title query=query.text answer expected=query.expectation met exact reason "
        "strategy unexamined assumption notes stats=statistics trace ending=trace.ending loop_start=trace.loop_start "
        "due=trace.due fault observer values",
        observer=_observer,
        values=_values,
    ),
    Statistics: Fields(
        "states_explored states_stored transitions seconds peak_bytes interchangeable exchanged less_known "
        "asked_of_all local_times lost"
    ),
    Due: Fields("state=steps time"),
    Extreme: Fields("value strict trace=run"),
}
"""The JSON of the parts of a `RunRecord`, but for runs and run-time errors: their names need the network."""


def _visible(view: TraceView, every_step: bool) -> TraceView:
    return view if every_step else view.without_hidden()


def trace_to_json(trace: TraceView) -> list[dict[str, Json]]:
    """A list of states, the initial one first; exact times are strings such as ``"5/2"``.

    The initial state is whole. A later one names what is different: locations, variables, and the clocks that do not
    show their value of before plus the delay. Documentation and places of an edge stand where it is taken first, and
    where another edge between its locations was the last to be taken.
    """
    states = [trace.initial, *(step.state for step in trace.steps)]
    written_spans: _WrittenSpans = {}
    changes = (_change(*pair, step, written_spans) for pair, step in zip(pairwise(states), trace.steps, strict=True))
    return [_whole(trace.initial), *changes]


def _whole(state: Snapshot) -> dict[str, Json]:
    return {
        "time": _time(state.time),
        "locations": dict(state.locations),
        "variables": dict(state.variables),
        "clocks": None if state.clocks is None else {name: str(value) for name, value in state.clocks},
    }


def _change(before: Snapshot, after: Snapshot, step: ViewStep, written_spans: _WrittenSpans) -> dict[str, Json]:
    changes: dict[str, dict[str, Json]] = {
        "locations": dict(compress(after.locations, map(ne, before.locations, after.locations))),
        "variables": dict(compress(after.variables, map(ne, before.variables, after.variables))),
        "clocks": _changed_clocks(before, after, step.delay or Fraction(0)),
    }
    return {
        "delay": _time(step.delay),
        "time": _time(after.time),
        "transition": None if step.event is None else _transition(step.event, written_spans),
        **{name: changed for name, changed in changes.items() if changed},
    }


def _changed_clocks(before: Snapshot, after: Snapshot, delay: Fraction) -> dict[str, Json]:
    clocks = zip(before.clocks or (), after.clocks or (), strict=True)
    if not delay:
        return {name: str(value) for (_, old), (name, value) in clocks if value is not old and value != old}
    return {name: str(value) for (_, old), (name, value) in clocks if value != old + delay}


def _time(time: Fraction | None) -> str | None:
    return None if time is None else str(time)


def _transition(event: TransitionView, written_spans: _WrittenSpans) -> dict[str, Json]:
    transition: dict[str, Json] = {
        "channel": event.channel or None,
        "participants": [_participant(move, written_spans) for move in event.moves],
    }
    if event.payload:
        transition["carries"] = dict(event.payload)
    return transition


def _participant(move: ProcessMove, written_spans: _WrittenSpans) -> dict[str, Json]:
    participant: dict[str, Json] = {
        "process": move.process,
        "role": _ROLES[move.direction],
        "source": move.source,
        "target": move.target,
    }
    if move.news:
        participant["news"] = move.doc
    if move.selects:
        participant["select"] = dict(move.selects)
    edge = move.process, move.source, move.target
    if written_spans.get(edge) != move.spans:
        written_spans[edge] = move.spans
        participant |= {"doc": move.doc, "positions": _positions(move.spans)}
    return participant


_ROLES = {None: "internal", Direction.SEND: "sends", Direction.RECEIVE: "receives"}


def _positions(spans: Iterable[Span]) -> list[str]:
    return [str(span) for span in spans if span.source is not NOWHERE.source]


def _fault(network: Network, fault: RunTimeFault) -> dict[str, Json]:
    found = diagnostic_of(fault)
    return {
        "code": found.code,
        "message": found.message,
        "help": found.help,
        "kind": fault.kind.name.lower(),
        "position": str(fault.span),
        "text": fault.span.text,
        "detail": fault.detail,
        "path": trace_to_json(view_path(network, fault.path) if fault.run is None else view_trace(network, fault.run)),
        "transition": None
        if fault.transition is None
        else _transition(view_event(network, fault.path, fault.transition), {}),
    }
