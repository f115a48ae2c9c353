"""Payloads of messages of streams, in the words of the automata: see `models/micro_xrce_dds/protocol.ta`."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from tachk.recordings.conformance.events import RecordedEvent
from tachk.xrce.events import SubmessageEvent, events
from tachk.xrce.messages import Endpoint, one_message
from tachk.xrce.objects import Objects
from tachk.xrce.submessages import submessages
from tachk.xrce.transmission import Transmission
from tachk.xrce.wire import FIRST_RELIABLE_STREAM, OBJECT_KINDS, SubmessageKind

BEST_EFFORT = "BEST_EFFORT"
"""The kind of a message of a best-effort stream."""
_STATUS, _PIECE, _READ, _READ_BEST_EFFORT = -16, -17, -32, -16384
BATCH, READER = 1 << 23, 1 << 15
_UNLIMITED = 65535
_SAMPLES = (SubmessageKind.WRITE_DATA, SubmessageKind.DATA)
_ANSWERED = (SubmessageKind.CREATE, SubmessageKind.DELETE)
"""The submessages that a STATUS answers."""
_TIMED, _OUTSIDE, _CANCEL, _RATED = 1, 2, 4, 8
"""The forms of READ_DATA."""
_FASTEST = 4096
"""Octets a second: the automata count them one by one."""
_MOST_CREATED = 15
_MOST_READ = _READ - _READ_BEST_EFFORT
_NO_ENDPOINT = Endpoint("", 0)


class UnknownContentError(Exception):
    """The automata have no word for what a message carries; the text says what that is."""


class Payload(NamedTuple):
    """What a message carries.

    Attributes:
        detail: as the automata have it if they had one topic and one reader a client; None where it is unknown.
        about: of a sample the number of its topic, of READ_DATA that of the data reader, as of `Objects`; else -1.
    """

    detail: int | None
    about: int = -1


class MessageContents:
    """Payloads of messages. Samples of a topic are numbered by the order in which they first appear, and known by their
    bytes.

    Pieces of a larger message are put together: the last one carries what the whole does.

    Attributes:
        objects: those that messages have shown so far.
    """

    def __init__(self) -> None:
        self.objects = Objects()
        self._samples: dict[tuple[int, str], int] = {}
        self._counts: dict[int, int] = {}
        self._pieces: dict[tuple[int, bool], dict[int, tuple[str, bool]]] = {}

    def counts(self) -> list[int]:
        """The number of different samples of each topic."""
        return [self._counts.get(topic, 0) for topic in range(max(self._counts, default=0) + 1)]

    def payload(self, one: Transmission, number: int) -> Payload:
        """The payload of the message of a stream that has this number, counted without a wrap.

        Raises UnknownContentError.
        """
        found = self._whole(one, number)
        if found is None:
            return Payload(None)
        if not found:
            return Payload(_PIECE)
        for event in found:
            self.objects.note(one.link, event)
        answered = sum(event.kind in _ANSWERED for event in found)
        read = [event for event in found if event.kind is SubmessageKind.READ_DATA]
        samples = [event for event in found if event.kind in _SAMPLES]
        if (answered > 0) + (len(read) > 0) + (len(samples) > 0) > 1 or len(read) > 1 or answered > _MOST_CREATED:
            kinds = ", ".join(dict.fromkeys(event.kind.name for event in found if event.kind is not None))
            raise UnknownContentError(
                f"message carries {len(found)} submessages ({kinds}) that the automata know apart"
            )
        if one.events[0].is_best_effort and not samples:
            kinds = ", ".join(dict.fromkeys(event.kind.name for event in found if event.kind is not None))
            raise UnknownContentError(f"message of a best-effort stream carries {kinds}: the automata expect samples")
        if answered:
            return Payload(-answered)
        if read:
            reader = self.objects.read(one.link, read[0])
            return Payload(_requests(read[0], self.objects), reader)
        if samples:
            return self._batch(one.link, samples)
        if any(event.kind is SubmessageKind.STATUS for event in found):
            return Payload(_STATUS)
        return Payload(_PIECE if one.to_agent else None)

    def _batch(self, link: int, samples: Sequence[SubmessageEvent]) -> Payload:
        for event in samples:
            if event.kind is SubmessageKind.WRITE_DATA:
                _check_kind(event, "data writer")
        topics = {self.objects.topic(link, event.fields["object"]) for event in samples}
        if len(topics) > 1:
            raise UnknownContentError("message carries samples of several topics: the automata expect one topic")
        (topic,) = topics
        sizes = {len(str(event.fields["sample"])) // 2 for event in samples}
        known = self.objects.written_sizes if samples[0].kind is SubmessageKind.WRITE_DATA else self.objects.sizes
        known |= sizes
        if self.objects.rate and self.objects.has_several_sizes():
            raise UnknownContentError(
                "sample has another size than those before: "
                "the automata know one where READ_DATA has max_bytes_per_second"
            )
        numbers = [self._number(topic, str(event.fields["sample"])) for event in samples]
        if any(after != before + 1 for before, after in pairwise(numbers)):
            raise UnknownContentError("message carries several samples, of which some had been written before")
        return Payload(numbers[0] + BATCH * (len(numbers) - 1), topic)

    def _number(self, topic: int, sample: str) -> int:
        known = self._counts.setdefault(topic, 0)
        number = self._samples.setdefault((topic, sample), known)
        self._counts[topic] = max(known, number + 1)
        return number

    def _whole(self, one: Transmission, number: int) -> Sequence[SubmessageEvent] | None:
        """The submessages that are complete with this message; None where earlier pieces were not captured."""
        whole = [event for event in one.events if event.kind is not SubmessageKind.FRAGMENT]
        for event in one.events:
            if event.kind is SubmessageKind.FRAGMENT:
                pieces = self._pieces.setdefault((one.link, one.to_agent), {})
                pieces[number] = str(event.fields["piece"]), bool(event.fields["last"])
                if event.fields["last"]:
                    together = _together(pieces, number)
                    if together is None:
                        return None
                    whole += together
        return whole


def _requests(read: SubmessageEvent, objects: Objects) -> int:
    """READ_DATA, by how many samples it asks for, on which stream, and in which form. Raises UnknownContentError.

    Args:
        objects: which know the limits of READ_DATA.
    """
    rate, elapsed = read.fields["max_bytes_per_second"], read.fields["max_elapsed_seconds"]
    if rate and rate != objects.rate:
        raise UnknownContentError(
            f"READ_DATA has max_bytes_per_second {rate}, one before had {objects.rate}: the automata know one"
        )
    if rate and objects.has_several_sizes():
        raise UnknownContentError(
            f"READ_DATA has max_bytes_per_second {rate} beside samples of several sizes: the automata know one"
        )
    if isinstance(rate, int) and rate > _FASTEST:
        raise UnknownContentError(f"READ_DATA has max_bytes_per_second {rate}: the automata know at most {_FASTEST}")
    if elapsed and elapsed != objects.seconds:
        raise UnknownContentError(
            f"READ_DATA has max_elapsed_time {elapsed}, one before had {objects.seconds}: the automata know one"
        )
    _check_kind(read, "data reader")
    count, stream = read.fields["max_samples"], int(str(read.fields["preferred_stream"]))
    code = _READ if stream >= FIRST_RELIABLE_STREAM else _READ_BEST_EFFORT
    form = (
        (_TIMED if elapsed else 0)
        + (_RATED if rate else 0)
        + (0 if stream else _OUTSIDE)
        + (_CANCEL if count == 0 else 0)
    )
    number = 1 if count is None else 0 if count == _UNLIMITED else int(str(count))
    if number >= _MOST_READ:
        raise UnknownContentError(f"READ_DATA asks for {number} samples: the automata know fewer than {_MOST_READ}")
    return code - number - READER * form


def _check_kind(event: SubmessageEvent, wanted: str) -> None:
    """Raises UnknownContentError for a message of an object of another kind."""
    made = str(event.fields["object"])
    kind = OBJECT_KINDS.get(int(made[-1], 16), "object")
    if kind != wanted and event.kind is not None:
        raise UnknownContentError(f"{event.kind.name} is for the {kind} {made}: the automata know one for a {wanted}")


def samples_in(detail: object) -> int:
    """The number of samples of a message."""
    return detail // BATCH + 1 if isinstance(detail, int) and detail >= 0 else 1


def begins_sample(event: SubmessageEvent) -> bool:
    """True if a client writes a sample here, or the first piece of one."""
    if event.kind is SubmessageKind.FRAGMENT:
        return event.to_agent and str(event.fields["piece"]).startswith(f"{SubmessageKind.WRITE_DATA:02x}")
    return event.kind is SubmessageKind.WRITE_DATA


def _together(pieces: dict[int, tuple[str, bool]], last: int) -> list[SubmessageEvent] | None:
    """The submessage that ends with a piece."""
    text = pieces[last][0]
    number = last - 1
    while number in pieces and not pieces[number][1]:
        text = pieces[number][0] + text
        number -= 1
    octets = bytes.fromhex(text)
    if len(octets) < 4 or int.from_bytes(octets[2:4], "little") != len(octets) - 4:
        return None
    return list(events(submessages(one_message(bytes([0x81, 0x80, 0, 0]) + octets)), [_NO_ENDPOINT]))


class PieceCounter:
    """Counts the pieces of samples that the Agent sends to clients."""

    def __init__(self) -> None:
        self._pieces: set[tuple[int, int]] = set()

    def add(self, event: RecordedEvent) -> None:
        cells = event.cells
        if event.name == "sent" and cells.get("detail") == _PIECE and int(cells.get("link", 0)) % 2 == 1:
            self._pieces.add((int(cells["link"]), int(cells["number"])))

    def most(self) -> int:
        """The number of pieces of one sample before its last one."""
        most = 0
        for link, number in self._pieces:
            if (link, number - 1) not in self._pieces:
                behind = number
                while (link, behind) in self._pieces:
                    behind += 1
                most = max(most, behind - number)
        return most
