"""DDS-XRCE messages as bytes: OMG DDS-XRCE 1.0 (formal/20-02-01), section 8.3, as the Micro XRCE-DDS client has them.

A message is a header and submessages, each of which begins at a multiple of four bytes. The header and the lengths of
submessages are little-endian; bit 0 of the flags says which order the fields of a submessage have. Ids of requests and
objects, versions and the bitmap of an ACKNACK are bytes, whose order never changes.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum
from functools import cache
from typing import Any, Final

import construct as c


class SubmessageKind(IntEnum):
    """The kind of a submessage; section 8.3.5. PERFORMANCE is eProsima's own."""

    CREATE_CLIENT = 0
    CREATE = 1
    GET_INFO = 2
    DELETE = 3
    STATUS_AGENT = 4
    STATUS = 5
    INFO = 6
    WRITE_DATA = 7
    READ_DATA = 8
    DATA = 9
    ACKNACK = 10
    HEARTBEAT = 11
    RESET = 12
    FRAGMENT = 13
    TIMESTAMP = 14
    TIMESTAMP_REPLY = 15
    PERFORMANCE = 255


COOKIE: Final = b"XRCE"

DEFAULT_PORT: Final = 8888
"""The port of the Agent in eProsima's and micro-ROS's examples."""

LITTLE_ENDIAN: Final = 0x01
LAST_FRAGMENT: Final = 0x02
REUSE: Final = 0x02
REPLACE: Final = 0x04
FORMAT: Final = 0x0E

FIRST_RELIABLE_STREAM: Final = 0x80
FIRST_SESSION_WITHOUT_KEY: Final = 0x80
SESSION_IDS_NONE: Final = (0x00, 0x80)
"""In the header of a message that belongs to no session, with and without a key; section 8.3.2.1."""

OBJECT_KINDS: Final = {
    0x1: "participant",
    0x2: "topic",
    0x3: "publisher",
    0x4: "subscriber",
    0x5: "data writer",
    0x6: "data reader",
    0x7: "requester",
    0x8: "replier",
    0xA: "type",
    0xB: "QoS profile",
    0xC: "application",
    0xD: "agent",
    0xE: "client",
    0xF: "other",
}
"""By the last four bits of an object id, and by the byte before the representation of a new object."""

STATUS: Final = {
    0x00: "OK",
    0x01: "OK_MATCHED",
    0x80: "ERR_DDS_ERROR",
    0x81: "ERR_MISMATCH",
    0x82: "ERR_ALREADY_EXISTS",
    0x83: "ERR_DENIED",
    0x84: "ERR_UNKNOWN_REFERENCE",
    0x85: "ERR_INVALID_DATA",
    0x86: "ERR_INCOMPATIBLE",
    0x87: "ERR_RESOURCES",
}

SAMPLE_FORMATS: Final = {
    0x0: "data",
    0x2: "sample",
    0x8: "data sequence",
    0xA: "sample sequence",
    0xE: "packed samples",
}

_REFERENCE, _XML, _BINARY = 1, 2, 3
REPRESENTATIONS: Final = {_REFERENCE: "reference", _XML: "XML", _BINARY: "binary"}
"""The representations of the description of a new object."""

_PARTICIPANT, _APPLICATION, _AGENT, _CLIENT = 0x1, 0xC, 0xD, 0xE
_ALONE = frozenset({0xA, 0xB, _APPLICATION})
"""Kinds of objects that belong to no other."""


class _ZeroEndedText(c.Adapter):  # type: ignore[misc]
    """A text and the zero behind it."""

    def _decode(self, obj: bytes, context: object, path: str) -> str:
        if not obj.endswith(b"\0"):
            raise c.StringError("a text does not end with a zero byte", path=path)
        try:
            return obj[:-1].decode()
        except UnicodeDecodeError:
            raise c.StringError("a text is not UTF-8", path=path) from None

    def _encode(self, obj: str, context: object, path: str) -> bytes:
        return obj.encode() + b"\0"


class _Aligned(c.Construct):  # type: ignore[misc]
    """Zeros up to the next multiple of a number of bytes."""

    def __init__(self, to: int) -> None:
        super().__init__()
        self._to = to
        self.flagbuildnone = True

    def _parse(self, stream: Any, context: object, path: str) -> None:
        c.stream_read(stream, -c.stream_tell(stream, path) % self._to, path)

    def _build(self, obj: None, stream: Any, context: object, path: str) -> None:
        missing = -c.stream_tell(stream, path) % self._to
        c.stream_write(stream, bytes(missing), missing, path)


class _ByteOrder:
    """The fields of more than one byte, in one of the two orders."""

    def __init__(self, little: bool) -> None:
        self.u16, self.u32 = (c.Int16ul, c.Int32ul) if little else (c.Int16ub, c.Int32ub)
        self.i16, self.i32 = (c.Int16sl, c.Int32sl) if little else (c.Int16sb, c.Int32sb)
        length = c.FocusedSeq("length", _Aligned(4), "length" / self.u32)
        self.text = _ZeroEndedText(c.Prefixed(length, c.GreedyBytes))
        self.octets = c.Prefixed(length, c.GreedyBytes)
        self.properties = c.PrefixedArray(length, c.Struct("name" / self.text, "value" / self.text))
        self.moment = c.Struct("seconds" / self.i32, "nanoseconds" / self.u32)


_PEER = c.Struct("cookie" / c.Const(COOKIE), "version" / c.Bytes(2), "vendor" / c.Bytes(2))
_REQUEST = c.Struct("request" / c.Bytes(2), "object" / c.Bytes(2))
_RESULT = c.Struct("status" / c.Int8ub, "implementation" / c.Int8ub)


def _client(order: _ByteOrder) -> Any:
    return c.Struct(
        "peer" / _PEER,
        "key" / c.Bytes(4),
        "session" / c.Int8ub,
        "has_properties" / c.Flag,
        "properties" / c.If(c.this.has_properties, order.properties),
        "_mtu" / _Aligned(2),
        "mtu" / order.u16,
    )


def _agent(order: _ByteOrder) -> Any:
    return c.Struct(
        "peer" / _PEER,
        "has_properties" / c.Flag,
        "properties" / c.If(c.this.has_properties, order.properties),
    )


def _object(order: _ByteOrder) -> Any:
    """The description of an object: ObjectVariant."""
    forms = {_REFERENCE: order.text, _XML: order.text, _BINARY: order.octets}
    described = c.Struct(
        "format" / c.Int8ub,
        "description" / c.Switch(c.this.format, forms, default=c.Error),
    )
    owned = c.Struct(
        "description" / described,
        "_domain" / c.If(lambda context: context._.kind == _PARTICIPANT, _Aligned(2)),
        "domain" / c.If(lambda context: context._.kind == _PARTICIPANT, order.i16),
        "owner" / c.If(lambda context: context._.kind != _PARTICIPANT and context._.kind not in _ALONE, c.Bytes(2)),
    )
    return c.Struct(
        "kind" / c.OneOf(c.Int8ub, OBJECT_KINDS),
        "what" / c.Switch(c.this.kind, {_AGENT: _agent(order), _CLIENT: _client(order)}, default=owned),
    )


def _information(order: _ByteOrder) -> Any:
    return c.Struct(
        "base" / _REQUEST,
        "result" / _RESULT,
        "has_configuration" / c.Flag,
        "configuration" / c.If(c.this.has_configuration, _object(order)),
        "has_activity" / c.Flag,
        "activity" / c.If(c.this.has_activity, c.GreedyBytes),
    )


def _read(order: _ByteOrder) -> Any:
    control = c.Struct(
        "_control" / _Aligned(2),
        "max_samples" / order.u16,
        "max_elapsed_time" / order.u16,
        "max_bytes_per_second" / order.u16,
        "min_pace_period" / order.u16,
    )
    return c.Struct(
        "base" / _REQUEST,
        "preferred_stream" / c.Int8ub,
        "format" / c.Int8ub,
        "has_filter" / c.Flag,
        "filter" / c.If(c.this.has_filter, order.text),
        "has_control" / c.Flag,
        "control" / c.If(c.this.has_control, control),
    )


@cache
def payloads(little: bool) -> Mapping[SubmessageKind, Any]:
    """The payload of a submessage of each kind, in one of the two byte orders."""
    order = _ByteOrder(little)
    u16, moment = order.u16, order.moment
    payload = c.Struct("base" / _REQUEST, "sample" / c.GreedyBytes)
    return {
        SubmessageKind.CREATE_CLIENT: _client(order),
        SubmessageKind.CREATE: c.Struct("base" / _REQUEST, "new" / _object(order)),
        SubmessageKind.GET_INFO: c.Struct("base" / _REQUEST, "mask" / order.u32),
        SubmessageKind.DELETE: c.Struct("base" / _REQUEST),
        SubmessageKind.STATUS_AGENT: c.Struct("result" / _RESULT, "agent" / _agent(order)),
        SubmessageKind.STATUS: c.Struct("base" / _REQUEST, "result" / _RESULT),
        SubmessageKind.INFO: _information(order),
        SubmessageKind.WRITE_DATA: payload,
        SubmessageKind.READ_DATA: _read(order),
        SubmessageKind.DATA: payload,
        SubmessageKind.ACKNACK: c.Struct("first" / u16, "bitmap" / c.Int16ub, "subject" / c.Int8ub),
        SubmessageKind.HEARTBEAT: c.Struct("first" / u16, "last" / u16, "subject" / c.Int8ub),
        SubmessageKind.RESET: c.Struct(),
        SubmessageKind.FRAGMENT: c.Struct("piece" / c.GreedyBytes),
        SubmessageKind.TIMESTAMP: c.Struct("transmitted" / moment),
        SubmessageKind.TIMESTAMP_REPLY: c.Struct("transmitted" / moment, "received" / moment, "originated" / moment),
        SubmessageKind.PERFORMANCE: c.Struct("octets" / c.GreedyBytes),
    }
