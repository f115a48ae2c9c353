"""Samples on their way from writers to readers: which ones a reader has not got, and whether it got them in order.

Samples are known by their bytes. What a reader gets and no client has written comes from elsewhere, and is not judged.
A capture may show that a reader has got a sample before it shows that it was written. If several writers have a topic,
each may write the same bytes: a reader may get them as often as there were writers.
"""

from __future__ import annotations

import re
from collections import Counter, OrderedDict, deque
from typing import Final, NamedTuple

_MOST_UNREAD: Final = 1 << 16
_MOST_REMEMBERED: Final = 1 << 12

Topic = str | None
"""A name, or None if it is not known; then it may be any."""

_IN_XML: Final = re.compile(r"<topic>.*?<name>\s*(.*?)\s*</name>", re.DOTALL)


def topic_of(representation: int, description: object) -> Topic:
    """The topic of a data writer or reader: of a reference such as ``Name__dw``, or of its XML."""
    if not isinstance(description, str):
        return None
    if representation == 1:
        return description.rpartition("__")[0] or None
    found = _IN_XML.search(description)
    return found[1] if found else None


class TooManyUnread(Exception):
    """A reader lags so far behind that what it lacks is no longer kept."""


class _Remembered:
    """The last samples of many, and how often each was there."""

    def __init__(self) -> None:
        self._samples: OrderedDict[int, int] = OrderedDict()

    def add(self, sample: int) -> None:
        self._samples[sample] = self._samples.get(sample, 0) + 1
        if len(self._samples) > _MOST_REMEMBERED:
            self._samples.popitem(last=False)

    def count(self, sample: int) -> int:
        return self._samples.get(sample, 0)

    def discard(self, sample: int) -> bool:
        """Forgets it once. Returns whether it was there."""
        found = self._samples.get(sample, 0)
        if found > 1:
            self._samples[sample] = found - 1
        else:
            self._samples.pop(sample, None)
        return found > 0


Owner = tuple[object, int]
"""A client and an object of it."""


class DataReader:
    """A data reader, and what it is owed.

    Attributes:
        skipped: how many samples were passed over: newer ones of the same writer came.
        disordered: whether a sample came that had come, or had been passed over.
    """

    def __init__(self, topic: Topic) -> None:
        self.topic = topic
        self.closed = False
        self.unread = 0
        self.skipped = 0
        self.disordered = False
        self._owed: dict[Owner, deque[int]] = {}
        self._passed = _Remembered()
        self._early = _Remembered()

    @property
    def has_all(self) -> bool:
        """True if it has got everything that has been written."""
        return not self.unread and not self.skipped

    def written(self, writer: Owner, sample: int) -> None:
        """A writer of its topic has written this."""
        if self._early.discard(sample):
            self._passed.add(sample)
            return
        self._owed.setdefault(writer, deque()).append(sample)
        self.unread += 1
        if self.unread > _MOST_UNREAD:
            raise TooManyUnread(f"a reader lacks more than {_MOST_UNREAD} samples")

    def got(self, sample: int, writers: int = 1) -> None:
        """It has got this; so many writers of its topic have been created."""
        places = [(owed.index(sample), writer) for writer, owed in self._owed.items() if sample in owed]
        if places:
            place, writer = min(places, key=lambda found: found[0])
            owed = self._owed[writer]
            for _ in range(place + 1):
                self._passed.add(owed.popleft())
            self.unread -= place + 1
            self.skipped += place
        elif self._passed.count(sample) > 0 and self._passed.count(sample) + self._early.count(sample) >= writers:
            self.disordered = True
        else:
            self._early.add(sample)


class Standing(NamedTuple):
    """``complete``: every reader has got everything; ``ordered``: in the order in which it was written."""

    complete: bool
    ordered: bool


class SampleExchange:
    """All writers and readers."""

    def __init__(self) -> None:
        self._writers: dict[Owner, Topic] = {}
        self._readers: dict[Owner, DataReader] = {}
        self._creations: Counter[Topic] = Counter()
        self._disordered = False

    def new_writer(self, writer: Owner, topic: Topic) -> None:
        self._writers[writer] = topic
        self._creations[topic] += 1

    def new_reader(self, reader: Owner, topic: Topic) -> None:
        """A reader that is there already goes on; one that had been deleted begins anew."""
        known = self._readers.get(reader)
        if known is None or known.closed:
            self._readers[reader] = DataReader(topic)

    def close(self, client: object, number: int | None) -> None:
        """Closes the readers of an object of a client, or of all its objects: they are owed nothing new."""
        for owner, reader in self._readers.items():
            if owner[0] is client and number in (None, owner[1]):
                reader.closed = True

    def forget(self, client: object) -> None:
        """A client does not come back: its writers and readers are dropped, unless a verdict depends on them."""
        self._writers = {owner: topic for owner, topic in self._writers.items() if owner[0] is not client}
        self._readers = {
            owner: reader
            for owner, reader in self._readers.items()
            if owner[0] is not client or not reader.closed or not reader.has_all or reader.disordered
        }

    def drop(self, client: object) -> None:
        """A client has vanished: nothing is owed to it any more. That one of its readers was disordered is kept."""
        self._disordered |= any(one.disordered for owner, one in self._readers.items() if owner[0] is client)
        self._writers = {owner: topic for owner, topic in self._writers.items() if owner[0] is not client}
        self._readers = {owner: reader for owner, reader in self._readers.items() if owner[0] is not client}

    def written(self, writer: Owner, sample: int) -> None:
        topic = self._writers.get(writer)
        for reader in self._readers.values():
            if not reader.closed and (topic is None or reader.topic is None or topic == reader.topic):
                reader.written(writer, sample)

    def got(self, reader: Owner, sample: int) -> None:
        if reader not in self._readers:
            self._readers[reader] = DataReader(None)
        topic = self._readers[reader].topic
        self._readers[reader].got(
            sample, sum(n for t, n in self._creations.items() if topic is None or t in (None, topic))
        )

    def standing(self) -> Standing:
        readers = self._readers.values()
        return Standing(
            all(one.has_all for one in readers), not (self._disordered or any(one.disordered for one in readers))
        )
