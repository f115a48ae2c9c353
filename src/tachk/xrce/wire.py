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


class Kind(IntEnum):
    """What a submessage is; section 8.3.5. PERFORMANCE is eProsima's own."""

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

LITTLE_ENDIAN: Final = 0x01
LAST_FRAGMENT: Final = 0x02
REUSE: Final = 0x02
REPLACE: Final = 0x04
FORMAT: Final = 0x0E

FIRST_RELIABLE_STREAM: Final = 0x80
FIRST_SESSION_WITHOUT_KEY: Final = 0x80

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
"""How the description of a new object is written."""

_PARTICIPANT, _APPLICATION, _AGENT, _CLIENT = 0x1, 0xC, 0xD, 0xE
_ALONE = frozenset({0xA, 0xB, _APPLICATION})
"""Kinds of objects that belong to no other."""


class _Text(c.Adapter):  # type: ignore[misc]
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


@cache
def payloads(little: bool) -> Mapping[Kind, Any]:
    """What a submessage of each kind carries, in one of the two byte orders."""
    u16, u32, i16, i32 = (
        (c.Int16ul, c.Int32ul, c.Int16sl, c.Int32sl) if little else (c.Int16ub, c.Int32ub, c.Int16sb, c.Int32sb)
    )
    length = c.FocusedSeq("length", _Aligned(4), "length" / u32)
    text = _Text(c.Prefixed(length, c.GreedyBytes))
    octets = c.Prefixed(length, c.GreedyBytes)
    request = c.Struct("request" / c.Bytes(2), "object" / c.Bytes(2))
    result = c.Struct("status" / c.Int8ub, "implementation" / c.Int8ub)
    properties = c.PrefixedArray(length, c.Struct("name" / text, "value" / text))
    moment = c.Struct("seconds" / i32, "nanoseconds" / u32)
    peer = c.Struct("cookie" / c.Const(COOKIE), "version" / c.Bytes(2), "vendor" / c.Bytes(2))
    given = c.Flag
    client = c.Struct(
        "peer" / peer,
        "key" / c.Bytes(4),
        "session" / c.Int8ub,
        "has_properties" / given,
        "properties" / c.If(c.this.has_properties, properties),
        "_mtu" / _Aligned(2),
        "mtu" / u16,
    )
    agent = c.Struct("peer" / peer, "has_properties" / given, "properties" / c.If(c.this.has_properties, properties))
    described = c.Struct(
        "format" / c.Int8ub,
        "description" / c.Switch(c.this.format, {_REFERENCE: text, _XML: text, _BINARY: octets}, default=c.Error),
    )
    owned = c.Struct(
        "description" / described,
        "_domain" / c.If(lambda context: context._.kind == _PARTICIPANT, _Aligned(2)),
        "domain" / c.If(lambda context: context._.kind == _PARTICIPANT, i16),
        "owner" / c.If(lambda context: context._.kind != _PARTICIPANT and context._.kind not in _ALONE, c.Bytes(2)),
    )
    variant = c.Struct(
        "kind" / c.OneOf(c.Int8ub, OBJECT_KINDS),
        "what" / c.Switch(c.this.kind, {_AGENT: agent, _CLIENT: client}, default=owned),
    )
    control = c.Struct(
        "_control" / _Aligned(2),
        "max_samples" / u16,
        "max_elapsed_time" / u16,
        "max_bytes_per_second" / u16,
        "min_pace_period" / u16,
    )
    carried = c.Struct("base" / request, "sample" / c.GreedyBytes)
    return {
        Kind.CREATE_CLIENT: client,
        Kind.CREATE: c.Struct("base" / request, "new" / variant),
        Kind.GET_INFO: c.Struct("base" / request, "mask" / u32),
        Kind.DELETE: c.Struct("base" / request),
        Kind.STATUS_AGENT: c.Struct("result" / result, "agent" / agent),
        Kind.STATUS: c.Struct("base" / request, "result" / result),
        Kind.INFO: c.Struct(
            "base" / request,
            "result" / result,
            "has_configuration" / given,
            "configuration" / c.If(c.this.has_configuration, variant),
            "has_activity" / given,
            "activity" / c.If(c.this.has_activity, c.GreedyBytes),
        ),
        Kind.WRITE_DATA: carried,
        Kind.READ_DATA: c.Struct(
            "base" / request,
            "preferred_stream" / c.Int8ub,
            "format" / c.Int8ub,
            "has_filter" / given,
            "filter" / c.If(c.this.has_filter, text),
            "has_control" / given,
            "control" / c.If(c.this.has_control, control),
        ),
        Kind.DATA: carried,
        Kind.ACKNACK: c.Struct("first" / u16, "bitmap" / c.Int16ub, "subject" / c.Int8ub),
        Kind.HEARTBEAT: c.Struct("first" / u16, "last" / u16, "subject" / c.Int8ub),
        Kind.RESET: c.Struct(),
        Kind.FRAGMENT: c.Struct("piece" / c.GreedyBytes),
        Kind.TIMESTAMP: c.Struct("transmitted" / moment),
        Kind.TIMESTAMP_REPLY: c.Struct("transmitted" / moment, "received" / moment, "originated" / moment),
        Kind.PERFORMANCE: c.Struct("octets" / c.GreedyBytes),
    }
