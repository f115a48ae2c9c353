"""The sequence chart of a test of a running system."""

from __future__ import annotations

from collections.abc import Container, Iterator
from fractions import Fraction

from tachk.base.time_units import unit_in_text
from tachk.report.conformance.text import enabled_event_text, event_text, units_text
from tachk.report.drawing.sequence.chart import Category, Chart, Event, Message, Moment, Note
from tachk.simulation.testing.tester import TestResult, TestVerdict

_TEST, _SYSTEM = 0, 1
_LAST = 200
"""So many events before the end of a test are drawn: there the failure is."""
_ALLOWED = 3
"""So many events that the model allows are named."""


def chart_of_test(result: TestResult, inputs: Container[str], model: str, time_unit: str) -> Chart:
    """The last inputs and outputs of a test, and at the end of one that failed what the model allowed there.

    Args:
        inputs: the names of the events that the test sends.
        time_unit: of the model, such as ``1 ms``; empty if it does not say it.
    """
    factor, unit = unit_in_text(time_unit)
    events = result.recording.events
    shown: list[Event] = []
    for order, event in enumerate(events[-_LAST:]):
        time, is_input = Moment(event.time * factor, order), event.name in inputs
        ends = (_TEST, _SYSTEM) if is_input else (_SYSTEM, _TEST)
        category = Category.DATA if is_input else Category.ANSWER
        shown.append(Message(ends[0], (ends[1],), time, (time,), event_text(event), category=category))
    end = result.recording.end * factor
    notes = [*_reasons(result)] if result.verdict is TestVerdict.FAIL else [result.reason or "the end of the test"]
    shown += [Note(None, Moment(end, len(events) + order), text) for order, text in enumerate(notes)]
    left_out = max(len(events) - _LAST, 0)
    description = f"{result.verdict.value}: {model}" + (f", without the first {left_out} events" if left_out else "")
    return Chart(f"{result.verdict.value}: {model}", description, unit, ("test", "system"), tuple(shown))


def _reasons(result: TestResult) -> Iterator[str]:
    """Where the system leaves the model, and what is allowed there, in short lines."""
    found = result.conformance
    rejection = None if found is None else found.refusal
    if found is None or rejection is None:
        return
    if rejection.event is None:
        yield "this silence is too long"
    else:
        yield f"not allowed: {event_text(found.recording.events[rejection.event])}"
    if rejection.state:
        yield f"in {rejection.state}"
    for possible in rejection.enabled_events[:_ALLOWED]:
        until = "" if possible.latest is None else f" to {units_text(Fraction(possible.latest), found.time_unit)}"
        yield f"allowed: {enabled_event_text(found, possible)}"
        yield f"from {units_text(Fraction(possible.earliest), found.time_unit)}{until}"
    if not rejection.enabled_events and rejection.enabled_complete:
        yield "allowed: nothing"
