"""The machine form of events on the wire: a line of docs/schema/decode.schema.json for each."""

from __future__ import annotations

from typing import Any

from tachk.xrce.events import SubmessageEvent


def event_to_json(event: SubmessageEvent) -> dict[str, Any]:
    """The event as a dictionary for `json.dumps`."""
    return {
        "packet": event.packet,
        "place": event.place,
        "time_ns": event.time,
        "client": None if event.client is None else str(event.client),
        "agent": None if event.agent is None else str(event.agent),
        "to_agent": event.to_agent,
        "kind": "malformed" if event.kind is None else event.kind.name,
        "session": event.session,
        "stream": event.stream,
        "sequence": event.sequence,
        "fields": dict(event.fields),
        "problem": event.problem,
    }
