"""Events on the wire in the words of the protocol, a line for each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from tachk.xrce.events import SubmessageEvent
from tachk.xrce.messages import Endpoint
from tachk.xrce.wire import SubmessageKind

_WIDEST_SAMPLE = 16
"""The number of bytes of a sample that are shown."""

UNLIMITED = 0xFFFF


def event_to_text(event: SubmessageEvent, start: int) -> str:
    """A line: when, in which packet, between whom, and what.

    Args:
        start: the time of the first event, in nanoseconds since the epoch.
    """
    moment = f"{(event.time - start) / 1e9:13.6f} s {event.packet:>7}"
    between = f"{_name(event.client):>21} {'->' if event.to_agent else '<-'} {_name(event.agent):<15}"
    return f"{moment}  {between}  {_number(event):>9}  {_said(event)}"


def _name(endpoint: Endpoint | None) -> str:
    return "?" if endpoint is None else str(endpoint)


def _number(event: SubmessageEvent) -> str:
    """The number of the message in its stream, where it has one."""
    if not event.stream:
        return ""
    return f"{event.stream:02X}:{event.sequence}"


def _said(event: SubmessageEvent) -> str:
    if event.kind is None:
        return f"malformed: {event.problem}"
    words = _WORDS[event.kind](event.fields)
    return f"{event.kind.name} {words}" if words else event.kind.name


Fields = Mapping[str, Any]


def _request(fields: Fields) -> str:
    return f"(request {fields['request']})"


def _client(fields: Fields) -> str:
    words = f"key {fields['key']}, session {fields['new_session']:02X}, messages of up to {fields['mtu']} bytes"
    return words + _properties(fields)


def _properties(fields: Fields) -> str:
    return "".join(f", {name}={value}" for name, value in fields["properties"].items())


def _create(fields: Fields) -> str:
    words = f"{fields['object_kind']} {fields['object']}"
    if "owner" in fields:
        words += f" of {fields['owner']}"
    if "domain" in fields:
        words += f" in domain {fields['domain']}"
    if fields.get("representation") == "reference":
        words += f' by reference "{fields["description"]}"'
    elif "representation" in fields:
        words += f" in {fields['representation']}"
    return f"{words} {_request(fields)}"


def _requested(fields: Fields) -> str:
    requested = [name for name in ("configuration", "activity") if fields[name]]
    return f"{' and '.join(requested) or 'nothing'} of {fields['object']} {_request(fields)}"


def _deleted(fields: Fields) -> str:
    return f"{fields['object']} {_request(fields)}"


def _status(fields: Fields) -> str:
    return f"{fields['status']} for {fields['object']} {_request(fields)}"


def _sample(fields: Fields) -> str:
    sample = bytes.fromhex(fields["sample"])
    shown = sample[:_WIDEST_SAMPLE].hex(" ", 4) + (" ..." if len(sample) > _WIDEST_SAMPLE else "")
    form = "" if fields["format"] == "data" else f" as {fields['format']}"
    return f"{fields['object']}, {len(sample)} bytes{form}: {shown} {_request(fields)}"


def _read(fields: Fields) -> str:
    words = f"{fields['object']} on stream {fields['preferred_stream']:02X}"
    samples = fields["max_samples"]
    if samples is None:
        words += ", one sample"
    elif samples != UNLIMITED:
        words += f", at most {samples} samples"
    if fields["max_elapsed_seconds"]:
        words += f", for {fields['max_elapsed_seconds']} s"
    if fields["max_bytes_per_second"]:
        words += f", at most {fields['max_bytes_per_second']} bytes/s"
    if fields["filter"] is not None:
        words += f', where "{fields["filter"]}"'
    return f"{words} {_request(fields)}"


def _acknack(fields: Fields) -> str:
    words = f"stream {fields['subject']:02X}: all before {fields['first']} arrived"
    return words + (f", missing {', '.join(map(str, fields['missing']))}" if fields["missing"] else "")


def _heartbeat(fields: Fields) -> str:
    first, last = fields["first"], fields["last"]
    held = f"holds {first} to {last}" if (last - first) % 65536 < 32768 else "holds nothing"
    return f"stream {fields['subject']:02X}: {held}"


def _fragment(fields: Fields) -> str:
    return f"{len(fields['piece']) // 2} bytes{', the last' if fields['last'] else ''}"


_WORDS: Mapping[SubmessageKind, Callable[[Fields], str]] = {
    SubmessageKind.CREATE_CLIENT: _client,
    SubmessageKind.CREATE: _create,
    SubmessageKind.GET_INFO: _requested,
    SubmessageKind.DELETE: _deleted,
    SubmessageKind.STATUS_AGENT: lambda fields: fields["status"] + _properties(fields),
    SubmessageKind.STATUS: _status,
    SubmessageKind.INFO: _status,
    SubmessageKind.WRITE_DATA: _sample,
    SubmessageKind.READ_DATA: _read,
    SubmessageKind.DATA: _sample,
    SubmessageKind.ACKNACK: _acknack,
    SubmessageKind.HEARTBEAT: _heartbeat,
    SubmessageKind.RESET: lambda fields: "",
    SubmessageKind.FRAGMENT: _fragment,
    SubmessageKind.TIMESTAMP: lambda fields: f"sent at {fields['transmitted_ns']} ns",
    SubmessageKind.TIMESTAMP_REPLY: lambda fields: f"to what was sent at {fields['originated_ns']} ns",
    SubmessageKind.PERFORMANCE: lambda fields: f"{len(fields['octets']) // 2} bytes",
}
