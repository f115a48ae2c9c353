"""Submessages of messages, found in all messages of a piece at once.

`tachk.xrce.wire` declares the formats. What monitors and signals need of the submessages that come in masses is taken
from the bytes here; whatever has an inner structure is decoded by the declarations.
"""

from __future__ import annotations

from functools import cache, lru_cache
from typing import Final

import construct
import numpy as np

from tachk.base.records import dataclass
from tachk.xrce import wire
from tachk.xrce.datagrams import Flags
from tachk.xrce.messages import Messages
from tachk.xrce.packets import Numbers
from tachk.xrce.wire import SubmessageKind

MALFORMED: Final = -1
"""The kind of bytes that are no submessage."""

_SMALLEST: Final = {
    SubmessageKind.CREATE_CLIENT: 16,
    SubmessageKind.CREATE: 6,
    SubmessageKind.GET_INFO: 8,
    SubmessageKind.DELETE: 4,
    SubmessageKind.STATUS_AGENT: 11,
    SubmessageKind.STATUS: 6,
    SubmessageKind.INFO: 8,
    SubmessageKind.WRITE_DATA: 4,
    SubmessageKind.READ_DATA: 8,
    SubmessageKind.DATA: 4,
    SubmessageKind.ACKNACK: 5,
    SubmessageKind.HEARTBEAT: 5,
    SubmessageKind.RESET: 0,
    SubmessageKind.FRAGMENT: 1,
    SubmessageKind.TIMESTAMP: 8,
    SubmessageKind.TIMESTAMP_REPLY: 24,
    SubmessageKind.PERFORMANCE: 0,
}
_STRUCTURED: Final = (
    SubmessageKind.CREATE_CLIENT,
    SubmessageKind.CREATE,
    SubmessageKind.STATUS_AGENT,
    SubmessageKind.INFO,
    SubmessageKind.READ_DATA,
)
_HAS_REQUEST: Final = (
    SubmessageKind.CREATE,
    SubmessageKind.GET_INFO,
    SubmessageKind.DELETE,
    SubmessageKind.STATUS,
    SubmessageKind.INFO,
    SubmessageKind.WRITE_DATA,
    SubmessageKind.READ_DATA,
    SubmessageKind.DATA,
)
NOTHING: Final = -1
"""The value of a column for submessages that have no such field."""


@dataclass(frozen=True, slots=True)
class Submessages:
    """One entry in each column for a submessage, or for what is none and should be one.

    Attributes:
        message: the index of its message in ``messages``.
        place: how many come before it in its message.
        kind: a `SubmessageKind`, or MALFORMED.
        session, stream, sequence: as in the header of the message; NOTHING where that is cut.
        flags: those of the submessage.
        starts, sizes: where its payload is in ``messages.octets``.
        first: of an ACKNACK the first number that is not acknowledged, of a HEARTBEAT the first that is held.
        last: of a HEARTBEAT the last number that is held.
        bitmap: of an ACKNACK, bit i for ``first + i``.
        subject: which stream an ACKNACK or a HEARTBEAT is about.
        request, object: ids.
        problems: by entry, why it is MALFORMED.
        contents: by entry, what has an inner structure, as `tachk.xrce.wire` declares it.
    """

    messages: Messages
    message: Numbers
    place: Numbers
    kind: Numbers
    session: Numbers
    stream: Numbers
    sequence: Numbers
    flags: Numbers
    starts: Numbers
    sizes: Numbers
    first: Numbers
    last: Numbers
    bitmap: Numbers
    subject: Numbers
    request: Numbers
    object: Numbers
    problems: dict[int, str]
    contents: dict[int, construct.Container]


def submessages(messages: Messages) -> Submessages:
    """The submessages of messages, in their order. Nothing raises: what cannot be decoded is MALFORMED."""
    walk = _HeaderWalk(messages)
    walk.run()
    return walk.collected()


class _HeaderWalk:
    """From header to header, in all messages side by side."""

    def __init__(self, messages: Messages) -> None:
        self.messages = messages
        octets = messages.octets
        # One zero page behind the bytes lets fields be read before it is known that they are there.
        self.octets = np.concatenate([octets, np.zeros(64, np.uint8)])
        self.ends = messages.starts + messages.sizes
        self.rounds: list[tuple[Numbers, ...]] = []
        self.problems: list[tuple[Numbers, Numbers, str]] = []

    def byte(self, at: Numbers) -> Numbers:
        return self.octets.take(at, mode="clip").astype(np.int64)

    def little(self, at: Numbers) -> Numbers:
        return self.byte(at) | self.byte(at + 1) << 8

    def big(self, at: Numbers) -> Numbers:
        return self.byte(at) << 8 | self.byte(at + 1)

    def run(self) -> None:
        messages = self.messages
        header = np.where(self.byte(messages.starts) < wire.FIRST_SESSION_WITHOUT_KEY, 8, 4)
        active = np.arange(len(messages.starts))
        at = messages.starts + header
        place = 0
        while len(active):
            at, active = self.round(active, at, place)
            place += 1

    def round(self, active: Numbers, at: Numbers, place: int) -> tuple[Numbers, Numbers]:
        """Reads one submessage of each message, and gives where the next begin."""
        ends = self.ends[active]
        cut = at + 4 > ends
        kind, flags, size = self.byte(at), self.byte(at + 1), self.little(at + 2)
        rest = ends - at - 4
        to_the_end = (kind == SubmessageKind.WRITE_DATA) & (size == 0) & (rest > 0)
        size = np.where(to_the_end, rest, size)
        kind = np.where(cut | (size > rest) | (_smallest()[kind] > size), MALFORMED, kind)
        self.rounds.append((active, np.full(len(active), place), kind, flags, at, size, ends))
        following = at + 4 + size
        following += -(following - self.messages.starts[active]) % 4
        goes_on = ~cut & (size <= rest) & (following < ends)
        return following[goes_on], active[goes_on]

    def collected(self) -> Submessages:
        columns = [np.concatenate(column) for column in zip(*self.rounds, strict=True)] if self.rounds else []
        if not columns:
            columns = [np.zeros(0, np.int64)] * 7
        order = np.argsort(columns[0], kind="stable")
        message, place, kind, flags, at, size, ends = (column[order] for column in columns)
        start = at + 4
        begin = self.messages.starts[message]
        headless = begin + 4 > ends
        is_little = flags & wire.LITTLE_ENDIAN != 0
        one, other = (np.where(is_little, self.little(start + k), self.big(start + k)) for k in (0, 2))
        is_acknack, is_heartbeat = kind == SubmessageKind.ACKNACK, kind == SubmessageKind.HEARTBEAT
        about_stream, has_request = is_acknack | is_heartbeat, np.isin(kind, _HAS_REQUEST)
        found = Submessages(
            self.messages,
            message,
            place,
            kind,
            np.where(headless, NOTHING, self.byte(begin)),
            np.where(headless, NOTHING, self.byte(begin + 1)),
            np.where(headless, NOTHING, self.little(begin + 2)),
            flags,
            start,
            np.clip(size, 0, np.maximum(ends - start, 0)),
            np.where(about_stream, one, NOTHING),
            np.where(is_heartbeat, other, NOTHING),
            np.where(is_acknack, self.big(start + 2), NOTHING),
            np.where(about_stream, self.byte(start + 4), NOTHING),
            np.where(has_request, self.big(start), NOTHING),
            np.where(has_request, self.big(start + 2), NOTHING),
            {},
            {},
        )
        self.explain(found, at, size, ends, headless)
        self.parse_contents(found)
        return found

    def explain(self, found: Submessages, at: Numbers, size: Numbers, ends: Numbers, headless: Flags) -> None:
        """Says why entries are MALFORMED."""
        messages = self.messages
        for entry in np.flatnonzero(found.kind == MALFORMED).tolist():
            message = int(found.message[entry])
            missing, there = int(messages.missing[message]), int(messages.sizes[message])
            left = int(ends[entry] - at[entry])
            stated = int(self.byte(at[entry : entry + 1])[0])
            if message in messages.problems:
                problem = messages.problems[message]
            elif missing:
                problem = f"{missing} of {there + missing} bytes of the message were not captured"
            elif headless[entry]:
                problem = f"a message has a header of 4 or 8 bytes, this one has {there} bytes"
            elif left < 0:
                problem = f"the header of a message with a client key has 8 bytes, this one has {there} bytes"
            elif left < 4:
                problem = f"the header of a submessage has 4 bytes, {left} are left" if left else "the message is empty"
            elif stated not in _KINDS:
                problem = f"{stated} is not a kind of submessage"
            elif size[entry] > left - 4:
                problem = f"{_KINDS[stated]} claims to have {size[entry]} bytes, {left - 4} are left"
            else:
                problem = (
                    f"{_KINDS[stated]} has {size[entry]} bytes, at least {_SMALLEST[SubmessageKind(stated)]} are needed"
                )
            found.problems[entry] = problem

    def parse_contents(self, found: Submessages) -> None:
        for entry in np.flatnonzero(np.isin(found.kind, _STRUCTURED)).tolist():
            kind = SubmessageKind(int(found.kind[entry]))
            try:
                found.contents[entry] = parsed(found, entry)
            except construct.ConstructError as error:
                found.kind[entry] = MALFORMED
                found.problems[entry] = f"{kind.name} is damaged: {_reason(error)}"


def parsed(found: Submessages, entry: int) -> construct.Container:
    """A submessage as `tachk.xrce.wire` declares it. Raises construct.ConstructError."""
    kind, is_little = SubmessageKind(int(found.kind[entry])), bool(found.flags[entry] & wire.LITTLE_ENDIAN)
    return _parsed(kind, is_little, payload(found, entry))


def payload(found: Submessages, entry: int) -> bytes:
    """The bytes of a submessage behind its header."""
    start, size = int(found.starts[entry]), int(found.sizes[entry])
    return found.messages.octets[start : start + size].tobytes()


@lru_cache(maxsize=256)
def _parsed(kind: SubmessageKind, is_little: bool, octets: bytes) -> construct.Container:
    """Kept, because sessions begin with the same bytes again and again."""
    return wire.payloads(is_little)[kind].parse(octets)


_KINDS: Final = {kind.value: kind.name for kind in SubmessageKind}


@cache
def _smallest() -> Numbers:
    """By kind, how many bytes a payload has at least; more than any has where there is no such kind."""
    sizes = np.full(256, 1 << 32, np.int64)
    for kind, size in _SMALLEST.items():
        sizes[kind] = size
    return sizes


def _reason(error: construct.ConstructError) -> str:
    match error:
        case construct.StreamError():
            return "it ends too early"
        case construct.ConstError():
            return f"it does not begin with the bytes {wire.COOKIE.decode()}"
        case construct.StringError():
            return "a text in it is not UTF-8, or does not end with a zero byte"
        case _:
            return "an id in it is none of those that exist"
