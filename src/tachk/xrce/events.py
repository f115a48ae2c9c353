"""Events on the wire, one for each submessage."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import BinaryIO, Final

import numpy as np
from construct import Container

from tachk.base.records import dataclass
from tachk.xrce import wire
from tachk.xrce.capture_decoder import CaptureDecoder
from tachk.xrce.messages import Endpoint
from tachk.xrce.packets import Numbers
from tachk.xrce.serial_line import NO_ENDPOINT, SerialDecoder
from tachk.xrce.submessages import Submessages, parsed, payload
from tachk.xrce.wire import SubmessageKind

DEFAULT_PORT: Final = wire.DEFAULT_PORT

Value = str | int | bool | None | list[int] | dict[str, str]


@dataclass(frozen=True, slots=True)
class SubmessageEvent:
    """A submessage that was sent, or bytes that are none.

    Attributes:
        packet: the number of its packet in the capture, from 1.
        place: how many events come before it in its message.
        time: nanoseconds since the epoch.
        client, agent: who talks; None where the file ends, or a frame of a serial line before it says so.
        to_agent: whether the client sent it.
        kind: None if it is malformed.
        session, stream, sequence: as in the header of its message; None where there is no header.
        fields: what it says, by name.
        problem: why it is malformed; else empty.
    """

    packet: int
    place: int
    time: int
    client: Endpoint | None
    agent: Endpoint | None
    to_agent: bool
    kind: SubmessageKind | None
    session: int | None
    stream: int | None
    sequence: int | None
    fields: Mapping[str, Value]
    problem: str = ""

    @property
    def is_reliable(self) -> bool:
        """True if its message has a number that is acknowledged."""
        return self.stream is not None and self.stream >= wire.FIRST_RELIABLE_STREAM

    @property
    def is_best_effort(self) -> bool:
        """True if its message has a number, and is never acknowledged."""
        return self.stream is not None and 0 < self.stream < wire.FIRST_RELIABLE_STREAM


def decode(stream: BinaryIO, ports: Iterable[int] = (DEFAULT_PORT,)) -> Iterator[SubmessageEvent]:
    """The events in a capture of a network, in the order of its packets.

    Only what goes to or from the ports of Agents is looked at; all of it becomes events. A capture that ends too early
    or is damaged ends with a malformed event. Raises CaptureError for what is not a capture.

    Args:
        stream: a pcap or pcapng file, or a pipe from a running capture.
        ports: UDP and TCP ports of Agents, or of relays that clients take for the Agent.
    """
    return _decoded(CaptureDecoder(stream, ports))


def decode_serial(stream: BinaryIO) -> Iterator[SubmessageEvent]:
    """The events on a serial line, in eProsima's framing. Frames that a receiver would drop are malformed events.

    Raises CaptureError for a file without bytes.

    Args:
        stream: the bytes of the line, or a pcap or pcapng file whose packets hold them.
    """
    return _decoded(SerialDecoder(stream))


def _decoded(decoder: CaptureDecoder | SerialDecoder) -> Iterator[SubmessageEvent]:
    for found in decoder.pieces():
        yield from events(found, decoder.endpoints)
    if decoder.problem:
        number, time = decoder.packets + 1, decoder.time
        yield SubmessageEvent(number, 0, time, None, None, False, None, None, None, None, {}, decoder.problem)


_BEFORE_SAMPLE: Final = 4
"""Bytes of the request before a sample."""
_KINDS: Final = {kind.value: kind for kind in SubmessageKind}


def events(found: Submessages, endpoints: list[Endpoint], entries: Numbers | None = None) -> Iterator[SubmessageEvent]:
    """Submessages one by one: all of them, or those of some entries."""
    messages = found.messages
    chosen = np.arange(len(found.message)) if entries is None else entries
    message = found.message[chosen]
    header = zip(
        chosen.tolist(),
        *(column[message].tolist() for column in (messages.packets, messages.times, messages.clients)),
        *(column[message].tolist() for column in (messages.agents, messages.to_agent)),
        *(column[chosen].tolist() for column in (found.place, found.kind, found.session, found.stream, found.sequence)),
        strict=True,
    )
    for entry, *row in header:
        packet, time, client, agent, to_agent, place, number, session, stream, sequence = row
        kind = _KINDS.get(number)
        yield SubmessageEvent(
            packet,
            place,
            time,
            None if client == NO_ENDPOINT else endpoints[client],
            None if agent == NO_ENDPOINT else endpoints[agent],
            to_agent,
            kind,
            None if session < 0 else session,
            None if stream < 0 else stream,
            None if sequence < 0 else sequence,
            {} if kind is None else _fields(found, entry, kind),
            found.problems.get(entry, ""),
        )


def _fields(found: Submessages, entry: int, kind: SubmessageKind) -> dict[str, Value]:
    """The fields of a submessage; those that come in masses are in columns already."""
    flags = int(found.flags[entry])
    described: dict[str, Value] = {}
    if found.request[entry] >= 0:
        described = {"request": int(found.request[entry]), "object": f"{int(found.object[entry]):04X}"}
    match kind:
        case SubmessageKind.ACKNACK:
            first, bitmap = int(found.first[entry]), int(found.bitmap[entry])
            missing = [(first + bit) % 65536 for bit in range(16) if bitmap >> bit & 1] if bitmap else []
            return {"subject": int(found.subject[entry]), "first": first, "missing": missing}
        case SubmessageKind.HEARTBEAT:
            first, last = int(found.first[entry]), int(found.last[entry])
            return {"subject": int(found.subject[entry]), "first": first, "last": last}
        case SubmessageKind.WRITE_DATA | SubmessageKind.DATA:
            form = flags & wire.FORMAT
            described["format"] = wire.SAMPLE_FORMATS.get(form, f"{form:#x}")
            described["sample"] = payload(found, entry)[_BEFORE_SAMPLE:].hex()
            return described
        case SubmessageKind.FRAGMENT:
            return {"last": bool(flags & wire.LAST_FRAGMENT), "piece": payload(found, entry).hex()}
        case _:
            return described | _declared(kind, flags, found.contents.get(entry) or parsed(found, entry))


def _declared(kind: SubmessageKind, flags: int, content: Container) -> dict[str, Value]:
    """The fields of a submessage beside its request, as its declaration has them."""
    match kind:
        case SubmessageKind.CREATE_CLIENT:
            return _peer(content.peer) | {
                "key": content.key.hex().upper(),
                "new_session": content.session,
                "mtu": content.mtu,
                "properties": _properties(content),
            }
        case SubmessageKind.STATUS_AGENT:
            return _status(content.result) | _peer(content.agent.peer) | {"properties": _properties(content.agent)}
        case SubmessageKind.CREATE:
            return {"reuse": bool(flags & wire.REUSE), "replace": bool(flags & wire.REPLACE)} | _variant(content.new)
        case SubmessageKind.GET_INFO:
            return {"configuration": bool(content.mask & 1), "activity": bool(content.mask & 2)}
        case SubmessageKind.STATUS | SubmessageKind.INFO:
            return _status(content.result)
        case SubmessageKind.READ_DATA:
            control = content.control
            return {
                "preferred_stream": content.preferred_stream,
                "format": wire.SAMPLE_FORMATS.get(content.format, f"{content.format:#x}"),
                "filter": content.filter,
                "max_samples": None if control is None else control.max_samples,
                "max_elapsed_seconds": None if control is None else control.max_elapsed_time,
                "max_bytes_per_second": None if control is None else control.max_bytes_per_second,
                "min_pace_ms": None if control is None else control.min_pace_period,
            }
        case SubmessageKind.TIMESTAMP:
            return {"transmitted_ns": _nanoseconds(content.transmitted)}
        case SubmessageKind.TIMESTAMP_REPLY:
            return {f"{name}_ns": _nanoseconds(content[name]) for name in ("transmitted", "received", "originated")}
        case SubmessageKind.PERFORMANCE:
            return {"octets": content.octets.hex()}
        case _:
            return {}


def _peer(peer: Container) -> dict[str, Value]:
    return {"version": f"{peer.version[0]}.{peer.version[1]}", "vendor": peer.vendor.hex().upper()}


def _properties(holder: Container) -> dict[str, str]:
    return {one.name: one.value for one in holder.properties or ()}


def _status(result: Container) -> dict[str, Value]:
    return {
        "status": wire.STATUS.get(result.status, f"{result.status:#04x}"),
        "implementation_status": result.implementation,
    }


def _variant(new: Container) -> dict[str, Value]:
    described: dict[str, Value] = {"object_kind": wire.OBJECT_KINDS[new.kind]}
    if "description" not in new.what:
        return described
    form, description = new.what.description.format, new.what.description.description
    described["representation"] = wire.REPRESENTATIONS[form]
    described["description"] = description if isinstance(description, str) else description.hex()
    if new.what.domain is not None:
        described["domain"] = new.what.domain
    if new.what.owner is not None:
        described["owner"] = new.what.owner.hex().upper()
    return described


def _nanoseconds(moment: Container) -> int:
    seconds, nanoseconds = moment.seconds, moment.nanoseconds
    return int(seconds * 1_000_000_000 + nanoseconds)
