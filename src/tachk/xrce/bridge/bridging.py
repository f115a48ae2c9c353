"""A bridge: between a part of a model and the packets of a session. It asks a clock for the time, and has no socket."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.xrce.bridge.clock import Clock
from tachk.xrce.bridge.packets import KINDS, ProtocolWord, Translator
from tachk.xrce.bridge.part import BridgedPart, SentEvent
from tachk.xrce.bridge.session import AgentSession, ClientSession

_CHANNEL = re.compile(r"(?P<row>send|deliver)\[(?P<link>\d+)\]\[(?P<kind>\d+)\]")


class Bridge:
    """A model in the place of a client, or of the Agent of one client.

    What the model says over ``send[link][kind]`` becomes packets, and packets become ``deliver[link][kind]``; the metas
    ``number`` and ``detail`` are their content (models/micro_xrce_dds/protocol.ta). Its time begins with the session.

    Attributes:
        to_agent: whether the model is the client.
        ignored: packets that arrived and mean nothing to the model.
    """

    def __init__(self, part: BridgedPart, clock: Clock, key: bytes = b"tchk", topic: str = "HelloWorldTopic") -> None:
        """Raises UsageError if the part has no such channels, or those of several clients."""
        self._part = part
        self._clock = clock
        out, received = _links(part.sends, "send"), _links(part.receives, "deliver")
        links = out or {link ^ 1 for link in received}
        if len(links) != 1:
            raise UsageError(
                f"these processes send on {len(links)} links to the outside",
                "choose the processes of one client, or of the Agent of one client; see docs/co_simulation.md",
            )
        (self._out,) = links
        self.to_agent = self._out % 2 == 0
        reads = self.to_agent and f"deliver[{self._out + 1}][0]" in part.receives and not _writes(part)
        self._session = ClientSession(key, topic, reads=reads, writes=not reads) if self.to_agent else AgentSession()
        self._begin: int | None = None
        self.ignored = 0

    @property
    def is_open(self) -> bool:
        """True if the session has begun."""
        return self._session.is_open

    def wake(self) -> int | None:
        """The time of the clock at which something is due next; None: when a packet arrives."""
        if self._begin is None:
            return self._clock.now() if self._session.is_open else self._session.wake()
        event = None if self._part.is_over else self._part.next_event()
        return None if event is None else self._begin + event

    def due(self) -> list[bytes]:
        """The packets that leave now."""
        now = self._clock.now()
        if not self._session.is_open:
            return self._session.due(now)
        if self._begin is None:
            self._begin = now
            self._translator = Translator(self.to_agent, self._session.before)
        return self._packets(self._part.advance(now - self._begin))

    def arrived(self, octets: bytes) -> list[bytes]:
        """The packets that leave because one arrives."""
        was_open = self._session.is_open
        packets = self._session.arrived(octets, self._clock.now())
        if not self._session.is_open:
            return packets
        packets += self.due()
        if not was_open:
            return packets
        words = [word for word in self._translator.words(octets) if self._is_received(word)]
        self.ignored += not words
        for word in words:
            channel = f"deliver[{self._out ^ 1}][{word.kind}]"
            values = {"number": max(word.number, 0), "detail": word.detail}
            packets += self._packets(self._part.receive(channel, values))
        return packets

    def _is_received(self, word: ProtocolWord) -> bool:
        """True if the model receives it: what is older than the session's first message means nothing to it."""
        old = word.detail < 0 if KINDS[word.kind] == "HEARTBEAT" else word.number < 0
        return not old and f"deliver[{self._out ^ 1}][{word.kind}]" in self._part.receives

    def _packets(self, sent: Iterable[SentEvent]) -> list[bytes]:
        return list(self._translated(sent))

    def _translated(self, sent: Iterable[SentEvent]) -> Iterator[bytes]:
        for one in sent:
            match = _CHANNEL.fullmatch(one.channel)
            if match is not None and match["row"] == "send" and not one.values.get("dropped", 0):
                yield self._translator.packet(
                    ProtocolWord(int(match["kind"]), one.values["number"], one.values["detail"])
                )


def _links(channels: Iterable[str], row: str) -> set[int]:
    found = (_CHANNEL.fullmatch(name) for name in channels)
    return {int(match["link"]) for match in found if match is not None and match["row"] == row}


def _writes(part: BridgedPart) -> bool:
    """True if the part receives acknowledgements, as writers do."""
    return any(name.endswith(f"[{KINDS.index('ACKNACK')}]") for name in part.receives if name.startswith("deliver"))
