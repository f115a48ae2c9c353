"""The tools about recordings of a real system: monitor and conform."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from tachk.api.model import conform as conform_recording
from tachk.api.monitoring import monitor as monitor_trace
from tachk.api.tools.answer import Evidence, EvidenceKind, ToolAnswer, answer
from tachk.api.tools.inputs import read_model, recorded_file
from tachk.api.tools.limits import ToolLimits
from tachk.base.diagnostics.render import render
from tachk.base.job import StoppedError
from tachk.meaning.judge.replay import ReplayError
from tachk.recordings.conformance.conform import Conformance, run_by_reference
from tachk.recordings.conformance.segments import LongRun
from tachk.report.conformance.json import conformance_to_json
from tachk.report.conformance.text import conformance_to_text

_TRACE, _RECORDING = "trace.csv", "recording.csv"
"""What answers call a recording that is given as text."""
_LONGEST = 2_000
"""Transitions of a run that is made and replayed by the reference semantics."""


def monitor(arguments: Mapping[str, Any], limits: ToolLimits) -> ToolAnswer:
    """The verdicts of formulas about a recorded trace."""
    with recorded_file(arguments["trace"], _TRACE) as (path, folder):
        report = monitor_trace(
            arguments["formula"],
            path,
            time=arguments.get("time"),
            unit=arguments.get("unit"),
            end=arguments.get("end", "undetermined"),
            constants=arguments.get("constants", {}),
            select=arguments.get("select", ()),
        )
        every = arguments.get("all_violations", False)
        result, text = report.to_dict(every), report.to_text(every)
    how = "computed once over the whole trace; no second monitor has judged it"
    evidence = [Evidence(verdict.name, EvidenceKind.NONE, False, how) for verdict in report]
    summary = repr(report).removeprefix("<MonitorReport on ").removesuffix(">")
    return _without(folder, answer(summary, result, text, evidence, limits))


def conform(arguments: Mapping[str, Any], limits: ToolLimits) -> ToolAnswer:
    """Whether a recording is a run of a model, and where it leaves it."""
    model = read_model(arguments)
    with recorded_file(arguments["recording"], _RECORDING) as (path, folder):
        found = conform_recording(
            model,
            path,
            arguments.get("tolerance"),
            arguments.get("late"),
            arguments.get("unit"),
            arguments.get("ports", ()),
            limits.of_search(),
            explain=arguments.get("explain", "short"),
        )
        result, text = conformance_to_json([found], model.path), conformance_to_text(found, model.path)
    says = {True: "is a run of", False: "is no run of", None: "may or may not be a run of"}[found.accepted]
    summary = f"{found.recording.source} {says} {model.path}{f' ({found.reason})' if found.reason else ''}"
    notes = [render(each) for each in (*model.refusals, *model.warnings)]
    return _without(folder, answer(summary, result, text, _evidence(found), limits, notes))


def _evidence(found: Conformance) -> Iterator[Evidence]:
    """A recording that conforms is shown by a run of each independent part of the model."""
    if not found.runs:
        yield Evidence("recording", EvidenceKind.NONE, False, "the answer of the search")
    for number, run in enumerate(found.runs, 1):
        about = "recording" if len(found.runs) == 1 else f"recording, part {number}"
        size = run.transitions
        if isinstance(run, LongRun) or size > _LONGEST:
            yield Evidence(
                about, EvidenceKind.RUN, False, f"a run of {size} transitions is too long to be replayed here"
            )
            continue
        try:
            run_by_reference(run.product, run.path)
        except (ReplayError, StoppedError) as error:
            yield Evidence(about, EvidenceKind.RUN, False, f"not replayed: {error}")
            continue
        transitions = f"{size} transition{'' if size == 1 else 's'}"
        how = f"a run of {transitions} that goes along with it, replayed by the reference semantics"
        yield Evidence(about, EvidenceKind.RUN, True, how)


def _without(folder: str, found: ToolAnswer) -> ToolAnswer:
    """The answer without the folder in which a text was a file for a while."""
    return found if not folder else ToolAnswer(found.text.replace(folder, ""), _shortened(found.structured, folder))


def _shortened(value: Any, folder: str) -> Any:
    match value:
        case str():
            return value.replace(folder, "")
        case dict():
            return {key: _shortened(item, folder) for key, item in value.items()}
        case list():
            return [_shortened(item, folder) for item in value]
        case _:
            return value
