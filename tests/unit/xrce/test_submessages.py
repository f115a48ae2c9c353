"""What is found in all messages at once is what the declarations say of each."""

from __future__ import annotations

import construct as c
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tachk.xrce import wire
from tachk.xrce.events import events
from tachk.xrce.messages import Endpoint, Messages
from tachk.xrce.report.json import event_to_json
from tachk.xrce.report.text import event_to_text
from tachk.xrce.submessages import parsed, submessages
from tachk.xrce.wire import SubmessageKind
from tests.unit.xrce.captures import ACKNACK, CREATE_CLIENT, HEARTBEAT, WRITE_DATA

HEADER = c.Struct(
    "session" / c.Int8ul,
    "stream" / c.Int8ul,
    "sequence" / c.Int16ul,
    "key" / c.If(c.this.session < wire.FIRST_SESSION_WITHOUT_KEY, c.Bytes(4)),
)
SUBMESSAGE_HEADER = c.Struct("kind" / c.Int8ul, "flags" / c.Int8ul, "length" / c.Int16ul)

CREATE = bytes.fromhex("8180000001011400000A001101010000050000006162636400000000")
READ_DATA = bytes.fromhex("8180010008011000000E001680000001FFFF000000000000")
STATUS_AGENT = bytes.fromhex("8100000004010B000000585243450100010F00")
SAMPLES = (HEARTBEAT, ACKNACK, WRITE_DATA, CREATE_CLIENT, CREATE, READ_DATA, STATUS_AGENT)


def side_by_side(messages: list[bytes]) -> Messages:
    sizes = np.array([len(message) for message in messages], np.int64)
    nothing = np.zeros(len(messages), np.int64)
    octets = np.frombuffer(b"".join(messages), np.uint8)
    starts = np.cumsum(sizes) - sizes
    return Messages(octets, nothing + 1, nothing, nothing, nothing + 1, nothing == 0, starts, sizes, nothing)


def one_by_one(message: bytes) -> list[str]:
    """The kinds in a message, by the declarations alone."""
    found: list[str] = []
    try:
        header = HEADER.parse(message)
        at = 4 if header.key is None else 8
        while not found or at < len(message):
            submessage = SUBMESSAGE_HEADER.parse(message[at : at + 4])
            rest = message[at + 4 :]
            size = submessage.length or (len(rest) if submessage.kind == SubmessageKind.WRITE_DATA else 0)
            found.append(_kind(submessage, rest[:size] if size <= len(rest) else None))
            at += 4 + size
            at += -at % 4
    except c.StreamError:
        found.append("malformed")
    return found


def _kind(submessage: c.Container, payload: bytes | None) -> str:
    if payload is None or submessage.kind not in set(SubmessageKind):
        return "malformed"
    try:
        wire.payloads(bool(submessage.flags & wire.LITTLE_ENDIAN))[SubmessageKind(submessage.kind)].parse(payload)
    except c.ConstructError:
        return "malformed"
    return SubmessageKind(submessage.kind).name


@st.composite
def damaged(draw: st.DrawFn) -> bytes:
    message = bytearray(b"".join(part if n == 0 else part[4:] for n, part in enumerate(draw(_PARTS))))
    for _ in range(draw(st.integers(0, 3))):
        match draw(st.integers(0, 2)):
            case 0 if message:
                message[draw(st.integers(0, len(message) - 1))] = draw(st.integers(0, 255))
            case 1:
                del message[draw(st.integers(0, len(message))) :]
            case _:
                place = draw(st.integers(0, len(message)))
                message[place:place] = draw(st.binary(max_size=8))
    return bytes(message)


_PARTS = st.lists(
    st.sampled_from(SAMPLES).map(lambda message: message + bytes(-len(message) % 4)), min_size=1, max_size=3
)


@given(st.lists(st.one_of(damaged(), st.binary(max_size=40)), min_size=1, max_size=20))
def test_columns_and_declarations_find_the_same(messages: list[bytes]):
    found = submessages(side_by_side(messages))
    told = list(events(found, [Endpoint("client", 1), Endpoint("agent", 2)]))
    for event in told:
        event_to_json(event)
        event_to_text(event, 0)
    for number, message in enumerate(messages):
        mine = [told[entry] for entry in np.flatnonzero(found.message == number)]
        assert [event.place for event in mine] == list(range(len(mine)))
        kinds = ["malformed" if event.kind is None else event.kind.name for event in mine]
        assert kinds == one_by_one(message)
    for entry, event in enumerate(told):
        if event.kind in DECLARED:
            content = parsed(found, entry)
            assert all(event.fields[name] == said(content) for name, said in DECLARED[event.kind].items())


DECLARED = {
    SubmessageKind.ACKNACK: {
        "subject": lambda content: content.subject,
        "first": lambda content: content.first,
        "missing": lambda content: [(content.first + n) % 65536 for n in range(16) if content.bitmap & 1 << n],
    },
    SubmessageKind.HEARTBEAT: {
        "subject": lambda content: content.subject,
        "first": lambda content: content.first,
        "last": lambda content: content.last,
    },
    SubmessageKind.WRITE_DATA: {"sample": lambda content: content.sample.hex()},
    SubmessageKind.DATA: {"sample": lambda content: content.sample.hex()},
    SubmessageKind.FRAGMENT: {"piece": lambda content: content.piece.hex()},
}
"""What is taken from the bytes, and where the declarations have it."""


@pytest.mark.parametrize("sample", [CREATE_CLIENT, CREATE, READ_DATA, STATUS_AGENT, HEARTBEAT, ACKNACK, WRITE_DATA])
def test_what_is_parsed_can_be_built(sample: bytes):
    header = SUBMESSAGE_HEADER.parse(sample[4:8])
    declared = wire.payloads(True)[SubmessageKind(header.kind)]
    payload = sample[8 : 8 + header.length]
    assert declared.build(declared.parse(payload)) == payload
