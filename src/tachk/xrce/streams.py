"""Reliable streams: numbers sent, acknowledged and missing, as the packets at one place show them.

Numbers have 16 bits on the wire and go round; here they go on. They begin again where a session is created.
"""

from __future__ import annotations

from typing import Final

SIGNALS: Final = (
    "sent",
    "acknowledged",
    "outstanding",
    "missing",
    "heartbeats",
    "repetitions",
    "delivered",
    "repaired",
    "confirmed",
)
"""The signals of a stream: the number of messages that have been sent, that have arrived without gap by the last
ACKNACK, that no ACKNACK has confirmed, and that the last ACKNACK names as missing; of HEARTBEATs and of repetitions
that have been sent; of messages that have arrived in order, and that had been named as missing and arrived later; and 1
if all that were sent have arrived."""

_CYCLE: Final = 1 << 16
_MOST_CONTENTS: Final = 1 << 12
"""Messages of which the content is kept until they are acknowledged; no window is nearly as large."""

Item = tuple[object, ...]
"""The content of a submessage for comparisons."""


def nearest_number(number: int, reference: int) -> int:
    """The number with these last 16 bits that is nearest to another one."""
    return reference + (number - reference + _CYCLE // 2) % _CYCLE - _CYCLE // 2


class StreamState:
    """The state of one direction of a stream.

    Attributes:
        sent: messages that have been sent, as far as is known.
        acknowledged: the number up to which the last ACKNACK has all.
        arrived: the number up to which all have arrived. Unlike the one above it never goes back, and no ACKNACK of
            messages that was not sent counts.
        missing: how many the last ACKNACK names.
        contents: of the messages that have been seen here and not arrived yet, by number and place.
    """

    __slots__ = (
        "_begun",
        "_behind",
        "_known",
        "_named",
        "_seen",
        "acknowledged",
        "arrived",
        "contents",
        "heartbeats",
        "missing",
        "repaired",
        "repetitions",
        "sent",
    )

    def __init__(self) -> None:
        self.heartbeats = self.repetitions = self.repaired = 0
        self.restart(0)
        self._begun = False

    def restart(self, number: int) -> None:
        """All before this number has arrived, and nothing else has been sent."""
        self.sent = self.acknowledged = self.arrived = number
        self.missing = 0
        self._seen: set[int] = set()
        self._named: set[int] = set()
        self._known: set[int] = set()
        self._behind = number
        self.contents: dict[int, dict[int, Item]] = {}
        self._begun = True

    def message(self, number: int) -> int:
        """A message has been seen. Returns its number, counted on."""
        if not self._begun:
            self.restart(number)
        number = nearest_number(number, self.sent)
        if number < self.arrived or number in self._seen:
            self.repetitions += 1
        else:
            self._seen.add(number)
            self._know(number)
        if number >= self.sent:
            self.sent = number + 1
            if self.sent - self.arrived > _CYCLE // 2:
                self._arrive(self.sent - _CYCLE // 2)  # more cannot be outstanding: ACKNACKs were not captured
        return number

    def _know(self, number: int) -> None:
        self._known.add(number)
        if number >= self._behind:
            self._behind = number + 1

    def _arrive(self, behind: int) -> None:
        """All before this number has arrived."""
        numbers = range(self.arrived, behind)
        self.arrived = behind
        if len(numbers) == 1 and not self._named:
            self._seen.discard(numbers.start)
            self._known.discard(numbers.start)
            return
        if self._named:
            self.repaired += sum(number < behind for number in self._named)
            self._named = {number for number in self._named if number >= behind}
        if len(numbers) < len(self._known):
            self._seen.difference_update(numbers)
            self._known.difference_update(numbers)
        else:
            self._seen = {number for number in self._seen if number >= behind}
            self._known = {number for number in self._known if number >= behind}

    def note_item(self, number: int, place: int, item: Item) -> bool:
        """Notes the payload of a message. Returns whether it carried something else before."""
        if number < self.arrived:
            return False
        content = self.contents.get(number)
        if content is None:
            self.contents[number] = {place: item}
            if len(self.contents) > _MOST_CONTENTS:
                del self.contents[next(iter(self.contents))]
            return False
        return content.setdefault(place, item) != item

    def heartbeat(self, first: int, last: int) -> None:
        """The sender holds these: the last of them has been sent, even if it has not been seen."""
        self.heartbeats += 1
        if not self._begun:
            self.restart(first)
        first, last = nearest_number(first, self.sent), nearest_number(last, self.sent)
        if first <= last:
            self.sent = max(self.sent, last + 1)

    def acknack(self, first: int, bitmap: int) -> range:
        """The receiver lacks this number, and others. Returns the numbers that have arrived now."""
        if not self._begun:
            self.restart(first)
        before, self.acknowledged = self.arrived, nearest_number(first, self.sent)
        if before < self.acknowledged <= self.sent:
            self._arrive(self.acknowledged)
        self.missing = bitmap.bit_count()
        for bit in range(bitmap.bit_length()) if bitmap else ():
            if bitmap >> bit & 1 and self.acknowledged + bit >= self.arrived:
                self._named.add(self.acknowledged + bit)
                self._know(self.acknowledged + bit)
        return range(before, self.arrived)

    def lacks(self, first: int, behind: int) -> bool:
        """True if a message from the first to before the last number has not been seen here nor named as missing."""
        first = max(first, self.arrived)
        if first == self.arrived and self._behind <= behind:
            return len(self._known) < behind - first
        return not all(number in self._known for number in range(first, behind))

    def lacks_unheard(self, first: int, behind: int, sender: StreamState) -> bool:
        """True if a message of these has not been seen here, and the sender does not know that it is missing."""
        first = max(first, self.arrived, sender.arrived)
        if first >= behind or (first == self.arrived and self._behind <= behind and len(self._seen) == behind - first):
            return False
        return not all(number in self._seen or number in sender._named for number in range(first, behind))

    def values(self) -> tuple[int, ...]:
        """The `SIGNALS` now."""
        outstanding = max(self.sent - self.arrived, 0)
        return (
            self.sent,
            self.acknowledged,
            outstanding,
            self.missing,
            self.heartbeats,
            self.repetitions,
            self.arrived,
            self.repaired,
            not outstanding,
        )
