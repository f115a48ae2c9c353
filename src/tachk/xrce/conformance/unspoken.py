"""What captures may hold of which the automata do not speak: they would take it for something else, and refuse the
capture at an innocent packet.

The automata speak of one topic, of one reader a client, and of READ_DATA that asks for a number of samples.
"""

from __future__ import annotations

from collections.abc import Iterator

from tachk.xrce.events import SubmessageEvent
from tachk.xrce.signals.samples import topic_of
from tachk.xrce.transmissions import Transmission
from tachk.xrce.wire import SubmessageKind

_ENDS = ("data writer", "data reader")
_LIMITS = (("max_elapsed_seconds", "max_elapsed_time"), ("max_bytes_per_second", "max_bytes_per_second"))
"""Fields of READ_DATA, as events and as DDS-XRCE call them. 0 is no limit."""
_REPRESENTATIONS = {"reference": 1, "XML": 2}


class Objects:
    """The writers and readers of a capture, as far as messages have shown them."""

    def __init__(self) -> None:
        self._topics: dict[tuple[int, object], str | None] = {}
        self._readers: dict[int, object] = {}
        self._topic: str | None = None

    def unspoken(self, one: Transmission) -> Iterator[str]:
        """What a message has of which the automata do not speak, in words that go on ``this message``."""
        for event in one.events:
            match event.kind:
                case SubmessageKind.CREATE if event.fields.get("object_kind") in _ENDS:
                    form = _REPRESENTATIONS.get(str(event.fields.get("representation")), 0)
                    topic = topic_of(form, event.fields.get("description")) if form else None
                    self._topics[one.link, event.fields["object"]] = topic
                case SubmessageKind.READ_DATA:
                    yield from self._read(one.link, event)
                case SubmessageKind.WRITE_DATA | SubmessageKind.DATA:
                    yield from self._sample(one.link, event)
                case _:
                    pass

    def _read(self, link: int, event: SubmessageEvent) -> Iterator[str]:
        for name, field in _LIMITS:
            if event.fields[name]:
                yield f"READ_DATA has {field} {event.fields[name]}: the automata know READ_DATA with max_samples alone"
        reader = event.fields["object"]
        if self._readers.setdefault(link, reader) != reader:
            before = self._readers[link]
            yield f"READ_DATA is for the data reader {reader}, one before for {before}: the automata know one a client"

    def _sample(self, link: int, event: SubmessageEvent) -> Iterator[str]:
        topic = self._topics.get((link, event.fields["object"]))
        if topic is None:
            return
        self._topic = self._topic or topic
        if topic != self._topic:
            yield f"sample is of the topic {topic}, those before were of {self._topic}: the automata know one topic"
