"""The words of `models/micro_xrce_dds/protocol.ta` as messages of DDS-XRCE, and back.

A message of a reliable stream, a HEARTBEAT or an ACKNACK is a word each. Numbers of a model count from 0 behind what
the session has begun with; the streams count modulo 65536.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator

from tachk.base.records import dataclass
from tachk.xrce import wire
from tachk.xrce.events import SubmessageEvent, events
from tachk.xrce.messages import Endpoint, one_message
from tachk.xrce.submessages import submessages
from tachk.xrce.wire import SubmessageKind

KINDS = "DATA", "HEARTBEAT", "ACKNACK", "PING"
"""By the numbers that the models give them."""
STATUS, READ, UNLIMITED = -16, -32, 65535
SESSION, STREAM = 0x81, 0x80
WRITER, READER = b"\x00\x15", b"\x00\x16"
_NUMBERS = 65536


@dataclass(frozen=True, slots=True)
class ProtocolWord:
    """A message of an automaton: ``kind`` is a place in `KINDS`."""

    kind: int
    number: int
    detail: int


def message(kind: SubmessageKind, content: object, stream: int = 0, sequence: int = 0, session: int = SESSION) -> bytes:
    """A message with one submessage."""
    return _header(session, stream, sequence) + submessage(kind, content)


def submessage(kind: SubmessageKind, content: object, flags: int = 0) -> bytes:
    payload: bytes = wire.payloads(True)[kind].build(content)
    return struct.pack("<BBH", kind, flags | wire.LITTLE_ENDIAN, len(payload)) + payload


def joined(parts: list[bytes], stream: int, sequence: int) -> bytes:
    """A message with several submessages, each of which begins at a multiple of four bytes."""
    octets = _header(SESSION, stream, sequence)
    for part in parts:
        octets += bytes(-len(octets) % 4) + part
    return octets


def _header(session: int, stream: int, sequence: int) -> bytes:
    return struct.pack("<BBH", session, stream, sequence % _NUMBERS)


@dataclass(slots=True)
class Translator:
    """Between a model and the packets of a session.

    Attributes:
        to_agent: whether the model is the client.
        before: messages of the own stream, and of that of the other side, that are older than the model.
    """

    to_agent: bool
    before: tuple[int, int] = (0, 0)
    requests: int = 16

    def packet(self, word: ProtocolWord) -> bytes:
        """The packet of a message of a model. Raises ValueError for a word that has no packet."""
        own, other = self.before
        match KINDS[word.kind]:
            case "DATA":
                return _header(SESSION, STREAM, word.number + own) + self._carrier(word.detail)
            case "HEARTBEAT":
                first, last = (word.number + own) % _NUMBERS, (word.detail - 1 + own) % _NUMBERS
                return message(SubmessageKind.HEARTBEAT, {"first": first, "last": last, "subject": STREAM})
            case "ACKNACK":
                first = (word.number + other) % _NUMBERS
                return message(SubmessageKind.ACKNACK, {"first": first, "bitmap": word.detail, "subject": STREAM})
            case _:
                return message(SubmessageKind.GET_INFO, {"base": self._base(b"\xff\xfd"), "mask": 1})

    def _carrier(self, detail: int) -> bytes:
        sample = struct.pack("<I", detail) if detail >= 0 else b""
        if self.to_agent and detail >= 0:
            return submessage(SubmessageKind.WRITE_DATA, {"base": self._base(WRITER), "sample": sample})
        if self.to_agent and detail <= READ:
            count = UNLIMITED if detail == READ else READ - detail
            return submessage(SubmessageKind.READ_DATA, self._read_parameters(count))
        if not self.to_agent and detail >= 0:
            return submessage(SubmessageKind.DATA, {"base": self._base(READER), "sample": sample})
        if not self.to_agent and detail == STATUS:
            result = {"status": 0, "implementation": 0}
            return submessage(SubmessageKind.STATUS, {"base": self._base(b"\x00\x11"), "result": result})
        raise ValueError(f"a message that carries {detail} has no form on the wire here")

    def _read_parameters(self, count: int) -> dict[str, object]:
        control = {"max_samples": count, "max_elapsed_time": 0, "max_bytes_per_second": 0, "min_pace_period": 0}
        return {
            "base": self._base(READER),
            "preferred_stream": STREAM,
            "format": 0,
            "has_filter": False,
            "filter": None,
            "has_control": True,
            "control": control,
        }

    def _base(self, target: bytes) -> dict[str, bytes]:
        self.requests += 1
        return {"request": struct.pack(">H", self.requests % _NUMBERS), "object": target}

    def words(self, octets: bytes) -> Iterator[ProtocolWord]:
        """The messages to a model in a packet of the other side. Nothing, where the model has no word for it."""
        own, other = self.before
        for event in submessages_of(octets):
            match event.kind:
                case SubmessageKind.HEARTBEAT:
                    last = _number(event, "last") + 1
                    yield ProtocolWord(1, _counted(_number(event, "first") - other), _counted(last - other))
                case SubmessageKind.ACKNACK:
                    first, missing = _number(event, "first"), event.fields["missing"]
                    assert isinstance(missing, list)
                    yield ProtocolWord(
                        2, _counted(first - own), sum(1 << (number - first) % _NUMBERS for number in missing)
                    )
                case (
                    SubmessageKind.WRITE_DATA | SubmessageKind.DATA | SubmessageKind.READ_DATA | SubmessageKind.STATUS
                ) if event.is_reliable:
                    assert event.sequence is not None
                    yield ProtocolWord(0, _counted(event.sequence - other), _payload(event))
                case SubmessageKind.GET_INFO:
                    yield ProtocolWord(3, 0, 0)
                case _:
                    pass


def submessages_of(octets: bytes) -> list[SubmessageEvent]:
    """The submessages of a datagram; what is none has no kind."""
    return list(events(submessages(one_message(octets)), [Endpoint("", 0)]))


def _number(event: SubmessageEvent, name: str) -> int:
    value = event.fields[name]
    assert isinstance(value, int)
    return value


def _counted(number: int) -> int:
    """A difference of numbers of a stream: one that is a little below 0 is older than the model."""
    wrapped = number % _NUMBERS
    return wrapped - _NUMBERS if wrapped >= _NUMBERS // 2 else wrapped


def _payload(event: SubmessageEvent) -> int:
    match event.kind:
        case SubmessageKind.STATUS:
            return STATUS
        case SubmessageKind.READ_DATA:
            count = event.fields["max_samples"]
            return READ if count == UNLIMITED else READ - (count if isinstance(count, int) else 1)
        case _:
            sample = bytes.fromhex(str(event.fields["sample"]))
            return int.from_bytes(sample[:4], "little") % 32768
