"""Data writers, data readers and topics of a capture, and their numbers in `models/micro_xrce_dds/protocol.ta`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

from tachk.base.records import dataclass
from tachk.xrce.events import SubmessageEvent
from tachk.xrce.signals.samples import topic_of
from tachk.xrce.wire import SubmessageKind

_REPRESENTATIONS: Final = {"reference": 1, "XML": 2}
_BINARY: Final = "binary"
_WRITER, _READER, _TOPIC = "data writer", "data reader", "topic"

Reader = tuple[int, int]
"""A link, and the number of one of its data readers, by the order of their first READ_DATA."""


@dataclass(frozen=True, slots=True)
class Numbering:
    """Numbers in the automata: sample i is of the topic i % topics, and reader r has the topic r % topics.

    Attributes:
        topics, readers: how many there are, readers of each client.
        of_topics: the topic of the automata of each topic of the capture.
        before: of each topic of the capture how many samples come before its own in that topic of the automata.
        of_readers: the number of each data reader that is read from.
        seconds: the time to which READ_DATA is limited, where it is.
        cancels: whether some READ_DATA is for 0 samples.
        rate: the octets a second to which READ_DATA is limited, where it is.
        size: the octets of samples on the way to clients; where there are none, from them.
    """

    topics: int
    readers: int
    of_topics: tuple[int, ...]
    before: tuple[int, ...]
    of_readers: Mapping[Reader, int]
    seconds: int = 0
    cancels: bool = False
    rate: int = 0
    size: int = 0

    @property
    def is_plain(self) -> bool:
        """True if there is one topic, and one reader a client."""
        return self.readers == 1 and len(self.of_topics) == 1


def constants_of(numbering: Numbering) -> dict[str, int]:
    """Constants of the automata that have these numbers."""
    found = {"TOPICS": numbering.topics, "READERS": numbering.readers}
    if numbering.seconds or numbering.cancels or numbering.rate:
        found["LIMITED_READS"] = 1
    if numbering.seconds:
        found["READ_SECONDS"] = numbering.seconds
    if numbering.cancels:
        found["CANCELS"] = 1
    if numbering.rate:
        found["READ_BYTES"] = numbering.rate
        found["SAMPLE_BYTES"] = numbering.size
    return found


class Objects:
    """Notes the objects of clients and what is read from them, as far as messages show it.

    Topics are numbered by the order in which they appear. An object has the first one where no CREATE was captured,
    and where its CREATE names none.

    Attributes:
        seconds, cancels, rate: as of a `Numbering`.
        sizes, written_sizes: of samples on the way to clients and from them, in octets.
    """

    def __init__(self) -> None:
        self._names: dict[tuple[int, str], str] = {}
        self._topics: dict[tuple[int, str], str] = {}
        self._numbers: dict[str, int] = {}
        self._readers: dict[int, list[str]] = {}
        self.seconds = 0
        self.cancels = False
        self.rate = 0
        self.sizes = set[int]()
        self.written_sizes = set[int]()

    def note(self, link: int, event: SubmessageEvent) -> None:
        """Notes what a CREATE says of a topic, a data writer or a data reader."""
        kind, made = event.fields.get("object_kind"), str(event.fields.get("object"))
        if event.kind is not SubmessageKind.CREATE or kind not in (_TOPIC, _WRITER, _READER):
            return
        form, described = event.fields.get("representation"), event.fields.get("description")
        name = None
        if form == _BINARY:
            octets = bytes.fromhex(str(described))
            name = _text(octets) if kind == _TOPIC else self._names.get((link, octets[:2].hex().upper()))
        elif kind != _TOPIC:
            name = topic_of(_REPRESENTATIONS.get(str(form), 0), described)
        if name and kind == _TOPIC:
            self._names[link, made] = name
        elif name:
            self._topics[link, made] = name
            self._numbers.setdefault(name, len(self._numbers))

    def topic(self, link: int, made: object) -> int:
        """The number of the topic of a data writer or reader."""
        return self._numbers.get(self._topics.get((link, str(made)), ""), 0)

    def read(self, link: int, event: SubmessageEvent) -> int:
        """Notes a READ_DATA. Returns the number of its data reader among those of the client."""
        made = event.fields["object"]
        self.seconds = self.seconds or _number(event.fields["max_elapsed_seconds"])
        self.cancels |= event.fields["max_samples"] == 0
        self.rate = self.rate or _number(event.fields["max_bytes_per_second"])
        known = self._readers.setdefault(link, [])
        if str(made) not in known:
            known.append(str(made))
        return known.index(str(made))

    def has_several_sizes(self) -> bool:
        """True if samples differ in size, also those that a limit in octets holds up."""
        return len(self.sizes | self.written_sizes) > 1

    def numbering(self, samples: Iterable[int] = ()) -> Numbering:
        """The numbers in the automata: topics from which nobody reads are one topic of them.

        Args:
            samples: how many different ones each topic has.
        """
        read = {self.topic(link, made) for link, known in self._readers.items() for made in known}
        of_read = {topic: number for number, topic in enumerate(sorted(read))}
        all_topics = range(max(len(self._numbers), 1))
        of_topics = tuple(of_read.get(topic, len(of_read)) for topic in all_topics)
        topics = max(of_topics) + 1
        found, before, unread = list(samples), [], 0
        for topic in all_topics:
            before.append(0 if topic in of_read else unread)
            unread += found[topic] if topic < len(found) and topic not in of_read else 0
        of_readers, most = {}, 1
        for link, known in self._readers.items():
            places = [0] * topics
            for number, made in enumerate(known):
                topic = of_topics[self.topic(link, made)]
                of_readers[link, number] = topic + topics * places[topic]
                places[topic] += 1
            most = max(most, *places)
        return Numbering(
            topics,
            topics * most,
            of_topics,
            tuple(before),
            of_readers,
            self.seconds,
            self.cancels,
            self.rate,
            max(self.sizes or self.written_sizes, default=0),
        )


def _number(field: object) -> int:
    return field if isinstance(field, int) else 0


def _text(octets: bytes) -> str | None:
    """A string in the encoding of CDR, little-endian."""
    size = int.from_bytes(octets[:4], "little")
    return octets[4 : 4 + size].rstrip(b"\0").decode("utf-8", "replace") if 0 < size <= len(octets) - 4 else None
