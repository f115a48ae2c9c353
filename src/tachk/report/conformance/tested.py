"""Reports on tests of a running system: for people, for machines, and as JUnit XML."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any
from xml.etree import ElementTree

from tachk.base.plain_data import Fields, PlainData
from tachk.model.quantity import grouped
from tachk.recordings.conformance.events import RecordedEvent
from tachk.report.conformance.json import answer_to_json
from tachk.report.conformance.text import event_text, rejection_lines, uncertainty_text, units_text
from tachk.report.junit_report import clean
from tachk.simulation.testing.property_goal import PropertyGoal
from tachk.simulation.testing.shortening import Shortening
from tachk.simulation.testing.tester import TestResult, TestSettings, TestVerdict

_LAST = 5
"""So many events before the end of a test that failed are shown."""


def test_to_text(result: TestResult, shortening: Shortening | None, model: str, time_unit: str) -> str:
    """The verdict, and where the system leaves the model."""
    lines = [*_lines(result, model, time_unit), *([] if shortening is None else [_shortening_line(shortening)])]
    return "\n".join(lines) + "\n"


test_to_text.__test__ = False  # type: ignore[attr-defined]


def _lines(result: TestResult, model: str, unit: str) -> Iterator[str]:
    events, settings = result.recording.events, result.settings
    outputs = len(events) - result.inputs
    yield (
        f"{result.verdict.value}: {model}, {_counted(result.inputs, 'input')} and {_counted(outputs, 'output')} in "
        f"{units_text(Fraction(round(result.recording.end)), unit)}"
    )
    yield f"with seed {settings.seed}, {uncertainty_text(settings.uncertainty, unit)}"
    if result.reason:
        yield result.reason
    if result.verdict is TestVerdict.FAIL:
        yield "the last events"
        yield from (f"  {_time(event.time)}  {event_text(event)}" for event in events[-_LAST:])
        if result.conformance is not None:
            yield from rejection_lines(result.conformance)
    if isinstance(settings.goal, PropertyGoal):
        yield _goal_line(settings.goal, result.reached, unit)
    yield f"{grouped(result.covered)} of {_counted(result.edges, 'edge')} of the system taken"
    yield f"{grouped(result.explored)} states; at most {grouped(result.states)} at a moment"


def _goal_line(goal: PropertyGoal, reached: Fraction | None, unit: str) -> str:
    name = goal.query.name
    if reached is None:
        return f"goal {name}: no state that decides it was reached"
    return f"goal {name}: a state that decides it may have been reached by {units_text(reached, unit)}"


def _shortening_line(shortening: Shortening) -> str:
    tests = _counted(shortening.tries, "more test")
    if not shortening.is_repeated:
        return f"the same inputs did not make it fail again: {tests}"
    least = "" if shortening.is_minimal else "; the time was over before fewer inputs were excluded"
    return f"shortened from {_counted(shortening.inputs, 'input')} by {tests}{least}"


def _counted(count: int, what: str) -> str:
    return f"{grouped(count)} {what}{'' if count == 1 else 's'}"


def _time(time: Fraction) -> str:
    return f"{float(time):.3f}"


def test_to_json(result: TestResult, shortening: Shortening | None, model: str, time_unit: str) -> dict[str, Any]:
    """One object, as docs/schema/test.schema.json describes it. Times are in units of the model."""
    plain = PlainData(
        {
            RecordedEvent: Fields("time event=name cells", cells=lambda event: dict(event.cells)),
            TestSettings: Fields(
                "tolerance=uncertainty.tolerance late=uncertainty.late input_late=uncertainty.input_late "
                "output_late=uncertainty.output_late"
            ),
            Fraction: float,
        }
    )
    return {
        "model": model,
        "time_unit": time_unit,
        "verdict": result.verdict.value,
        "reason": result.reason,
        "seed": result.settings.seed,
        **plain.of(result.settings),
        "end": float(result.recording.end),
        "inputs": result.inputs,
        "outputs": len(result.recording.events) - result.inputs,
        "states": result.explored,
        "goal": _goal_to_json(result),
        "edges": {"taken": result.covered, "all": result.edges},
        "largest_estimate": result.states,
        "shortening": None
        if shortening is None
        else {
            "inputs": shortening.inputs,
            "tests": shortening.tries,
            "repeated": shortening.is_repeated,
            "minimal": shortening.is_minimal,
        },
        "events": plain.of(list(result.recording.events)),
        "conformance": None if result.conformance is None else answer_to_json(result.conformance),
    }


def _goal_to_json(result: TestResult) -> dict[str, Any]:
    goal = result.settings.goal
    if not isinstance(goal, PropertyGoal):
        return {"kind": goal.value}
    reached = None if result.reached is None else float(result.reached)
    return {"kind": "property", "property": goal.query.name, "reached": reached}


test_to_json.__test__ = False  # type: ignore[attr-defined]


def test_to_junit(result: TestResult, model: str, adapter: str, time_unit: str) -> str:
    """One suite with one case; a test that failed is a failure, one without a verdict an error."""
    failed, open_ = (result.verdict is each for each in (TestVerdict.FAIL, TestVerdict.INCONCLUSIVE))
    suites = ElementTree.Element("testsuites")
    suite = ElementTree.SubElement(
        suites, "testsuite", name=clean(model), tests="1", failures=str(int(failed)), errors=str(int(open_))
    )
    case = ElementTree.SubElement(
        suite, "testcase", classname=clean(model), name=clean(f"{adapter} with seed {result.settings.seed}")
    )
    if result.verdict is not TestVerdict.PASS:
        first, *others = _lines(result, model, time_unit)
        problem = ElementTree.SubElement(case, "failure" if failed else "error", message=clean(first))
        problem.text = clean("\n".join(others))
    ElementTree.indent(suites)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(suites, encoding="unicode") + "\n"


test_to_junit.__test__ = False  # type: ignore[attr-defined]
