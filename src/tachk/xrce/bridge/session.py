"""The beginning of a session: CREATE_CLIENT, then objects for one topic. The models leave it out, so that a bridge does
it for them, on either side."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.xrce import wire
from tachk.xrce.bridge.packets import READER, SESSION, STREAM, WRITER, joined, message, submessage, submessages_of
from tachk.xrce.wire import SubmessageKind

_VERSION, _VENDOR = b"\x01\x00", b"\x01\x0f"
_REFERENCE, _XML = 1, 2
_PARTICIPANT, _TOPIC, _PUBLISHER, _SUBSCRIBER = b"\x00\x11", b"\x00\x12", b"\x00\x13", b"\x00\x14"
_MTU = 508
_AGAIN = 200_000_000
"""Nanoseconds after which a client asks again."""


class ClientSession:
    """A client's side: it asks until everything has been answered.

    Attributes:
        before: messages of the own stream, and of the Agent's, with which the session has begun.
    """

    def __init__(self, key: bytes, topic: str, *, reads: bool, writes: bool) -> None:
        """Args: reads, writes: whether it has a reader, and a writer, of the topic."""
        self._key = key
        self._topic = topic
        self._creations = list(_creations(topic, reads, writes))
        self.before = (1, len(self._creations))
        self._created = False
        self._answers: set[int] = set()
        self._next = 0
        self.is_open = False

    def wake(self) -> int:
        return self._next

    def due(self, now: int) -> list[bytes]:
        """The packets to be sent now."""
        if self.is_open or now < self._next:
            return []
        self._next = now + _AGAIN
        return [self._objects() if self._created else self._client()]

    def arrived(self, octets: bytes, now: int) -> list[bytes]:
        """The answers to a packet."""
        reply: list[bytes] = []
        for event in submessages_of(octets):
            if event.kind is SubmessageKind.STATUS_AGENT and not self._created:
                self._created, self._next = True, now
                reply += self.due(now)
            elif event.kind is SubmessageKind.STATUS and event.sequence is not None:
                self._answers.add(event.sequence)
                confirmed = self._confirmed()
                reply.append(message(SubmessageKind.ACKNACK, {"first": confirmed, "bitmap": 0, "subject": STREAM}))
                self.is_open = confirmed == self.before[1]
            elif event.kind is SubmessageKind.HEARTBEAT:
                confirmed = self._confirmed()
                missing = sum(1 << n - confirmed for n in range(confirmed, self.before[1]) if n not in self._answers)
                reply.append(
                    message(SubmessageKind.ACKNACK, {"first": confirmed, "bitmap": missing, "subject": STREAM})
                )
        return reply

    def _client(self) -> bytes:
        content = {
            "peer": {"version": _VERSION, "vendor": _VENDOR},
            "key": self._key,
            "session": SESSION,
            "has_properties": False,
            "properties": None,
            "mtu": _MTU,
        }
        return message(SubmessageKind.CREATE_CLIENT, content, session=0x80)

    def _confirmed(self) -> int:
        return next(n for n in range(self.before[1] + 1) if n not in self._answers)

    def _objects(self) -> bytes:
        parts = [submessage(SubmessageKind.CREATE, content, wire.REUSE) for content in self._creations]
        return joined(parts, STREAM, 0)


def _creations(topic: str, reads: bool, writes: bool) -> Iterator[dict[str, object]]:
    objects = [
        (_PARTICIPANT, 1, _REFERENCE, "default_xrce_participant", None),
        (_TOPIC, 2, _REFERENCE, f"{topic}__t", _PARTICIPANT),
    ]
    if writes:
        objects.append((_PUBLISHER, 3, _XML, "", _PARTICIPANT))
        objects.append((WRITER, 5, _REFERENCE, f"{topic}__dw", _PUBLISHER))
    if reads:
        objects.append((_SUBSCRIBER, 4, _XML, "", _PARTICIPANT))
        objects.append((READER, 6, _REFERENCE, f"{topic}__dr", _SUBSCRIBER))
    for request, (name, kind, form, description, belongs) in enumerate(objects, start=10):
        what: dict[str, object] = {"description": {"format": form, "description": description}}
        what |= {"domain": 0 if belongs is None else None, "owner": belongs}
        base = {"request": request.to_bytes(2, "big"), "object": name}
        yield {"base": base, "new": {"kind": kind, "what": what}}


class AgentSession:
    """The Agent's side: it answers, and confirms what it has got before it reports on it.

    Attributes:
        before: messages of the own stream, and of the client's, with which the session has begun.
    """

    def __init__(self) -> None:
        self.is_open = False
        self.before = (0, 0)

    def wake(self) -> int | None:
        return None

    def due(self, now: int) -> list[bytes]:
        return []

    def arrived(self, octets: bytes, now: int) -> list[bytes]:
        found = submessages_of(octets)
        if any(event.kind is SubmessageKind.CREATE_CLIENT for event in found):
            peer = {"version": _VERSION, "vendor": _VENDOR}
            agent = {"peer": peer, "has_properties": False, "properties": None}
            return [message(SubmessageKind.STATUS_AGENT, {"result": _FINE, "agent": agent})]
        created = [event for event in found if event.kind is SubmessageKind.CREATE and event.sequence is not None]
        if not created:
            return []
        sequence = created[0].sequence
        assert sequence is not None
        if sequence >= self.before[1]:  # it may come again, and more may be created
            self._first, self.before = self.before[0], (self.before[0] + len(created), sequence + 1)
        self.is_open = True
        reply = [message(SubmessageKind.ACKNACK, {"first": self.before[1], "bitmap": 0, "subject": STREAM})]
        for number, event in enumerate(created, self._first):
            request, name = event.fields["request"], event.fields["object"]
            assert isinstance(request, int) and isinstance(name, str)
            base = {"request": request.to_bytes(2, "big"), "object": bytes.fromhex(name)}
            reply.append(message(SubmessageKind.STATUS, {"base": base, "result": _FINE}, STREAM, number))
        return reply


_FINE = {"status": 0, "implementation": 0}
