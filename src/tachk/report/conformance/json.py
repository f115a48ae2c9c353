"""The machine form of what `tachk conform` found, as docs/schema/conform.schema.json describes it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from tachk.recordings.conformance.conform import Conformance
from tachk.recordings.conformance.coverage import Covered
from tachk.recordings.conformance.edits import Edit
from tachk.recordings.conformance.events import RecordedEvent


def conformance_to_json(found: Sequence[Conformance], model: str, covered: Sequence[Covered] = ()) -> dict[str, Any]:
    """One object, with an answer for each recording."""
    return {
        "model": model,
        "answers": [_answer(each) for each in found],
        "coverage": [_covered(each) for each in covered],
    }


def _answer(found: Conformance) -> dict[str, Any]:
    """Times are those of the recording."""
    recording = found.recording
    return {
        "recording": recording.source,
        "accepted": found.accepted,
        "reason": found.reason,
        "tolerance": float(found.tolerance),
        "late": float(found.late),
        "time_unit": found.time_unit,
        "events": len(recording.events) - found.queues.other,
        "other_events": found.queues.other,
        "states": found.statistics.states_stored,
        "seconds": found.statistics.seconds,
        "refusal": _refusal(found),
        "edit": None if found.edit is None else _edit(found, found.edit),
        "untried_edits": found.untried,
        "left_out": found.left_out,
    }


def _edit(found: Conformance, edit: Edit) -> dict[str, Any]:
    event = _event(found.recording.events[edit.event])
    return {"event": event, "what": edit.what, "by": edit.by, "name": edit.name, "cells": dict(edit.cells)}


def _covered(each: Covered) -> dict[str, Any]:
    return {
        "process": each.process,
        "template": each.template,
        "source": each.source,
        "target": each.target,
        "doc": each.doc,
        "times": each.times,
    }


def _refusal(found: Conformance) -> dict[str, Any] | None:
    refusal = found.refusal
    if refusal is None:
        return None
    event = None if refusal.event is None else _event(found.recording.events[refusal.event])
    return {
        "happened": refusal.happened,
        "event": event,
        "state": refusal.state,
        "allowed": [
            {
                "event": offer.name,
                "cells": dict(offer.cells),
                "earliest": _time(found, offer.earliest),
                "latest": None if offer.latest is None else _time(found, offer.latest),
            }
            for offer in refusal.offers
        ],
        "allowed_whole": refusal.offers_whole,
    }


def _event(event: RecordedEvent) -> dict[str, Any]:
    return {"place": event.place, "time": float(event.time), "event": event.name, "cells": dict(event.cells)}


def _time(found: Conformance, units: int) -> float:
    return float(units / found.queues.scale + found.queues.origin)
