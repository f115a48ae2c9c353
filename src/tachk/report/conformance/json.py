"""The machine form of the result of `tachk conform`, as docs/schema/conform.schema.json describes it."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from tachk.base.plain_data import Fields, PlainData
from tachk.recordings.conformance.conform import Conformance, Rejection
from tachk.recordings.conformance.coverage import Covered
from tachk.recordings.conformance.edits import Edit
from tachk.recordings.conformance.events import RecordedEvent
from tachk.recordings.conformance.rejection import PossibleEvent


def conformance_to_json(found: Sequence[Conformance], model: str, covered: Sequence[Covered] = ()) -> dict[str, Any]:
    """One object, with an answer for each recording."""
    return {
        "model": model,
        "answers": [answer_to_json(each) for each in found],
        "coverage": PlainData()(list(covered)),
    }


def answer_to_json(found: Conformance) -> dict[str, Any]:
    """Times are those of the recording."""
    events = found.recording.events

    def time(units: int) -> Fraction:
        return units / found.streams.scale + found.streams.origin

    def cells(of: RecordedEvent | Edit | PossibleEvent) -> dict[str, object]:
        return dict(of.cells)

    plain = PlainData(
        {
            type(found): Fields(
                "recording=recording.source accepted reason tolerance late "
                "input_late=uncertainty.input_late output_late=uncertainty.output_late time_unit events "
                "other_events=streams.other states=statistics.states_stored seconds=statistics.seconds refusal edit "
                "untried_edits=untried left_out",
                events=lambda found: len(events) - found.streams.other,
            ),
            Rejection: Fields(
                "happened event state allowed=enabled_events allowed_whole=enabled_complete",
                event=lambda rejection: None if rejection.event is None else events[rejection.event],
            ),
            PossibleEvent: Fields(
                "event=name cells earliest latest",
                cells=cells,
                earliest=lambda enabled_event: time(enabled_event.earliest),
                latest=lambda enabled_event: None if enabled_event.latest is None else time(enabled_event.latest),
            ),
            Edit: Fields("event what by name cells", cells=cells, event=lambda edit: events[edit.event]),
            RecordedEvent: Fields("place time event=name cells", cells=cells),
            Fraction: float,
        }
    )
    return plain.of(found)
