"""Submessages of many pieces of a capture as one, to be held: in columns as narrow as their numbers allow."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Final

import numpy as np

from tachk.xrce.datagrams import Flags
from tachk.xrce.messages import Messages
from tachk.xrce.packets import Column, Numbers
from tachk.xrce.submessages import MALFORMED, Submessages
from tachk.xrce.wire import SubmessageKind

Kinds = Mapping[str, type[np.generic]]
"""The types of the numbers of columns, by name."""

_OF_MESSAGES: Final[Kinds] = {
    "packets": np.int64,
    "times": np.int64,
    "clients": np.int32,
    "agents": np.int32,
    "to_agent": np.bool_,
}
_OF_SUBMESSAGES: Final[Kinds] = {
    "place": np.int16,
    "kind": np.int16,
    "session": np.int16,
    "stream": np.int16,
    "sequence": np.int32,
    "flags": np.uint8,
    "first": np.int32,
    "last": np.int32,
    "bitmap": np.int32,
    "subject": np.int16,
    "request": np.int32,
    "object": np.int32,
}
_WHOLLY_IN_COLUMNS: Final = (SubmessageKind.ACKNACK, SubmessageKind.HEARTBEAT)


class GrowingColumns:
    """Columns that become longer piece by piece. They grow in place: memory never holds a column twice."""

    def __init__(self, kinds: Kinds) -> None:
        self._kinds = kinds
        self._octets = {name: bytearray() for name in kinds}

    def extend(self, pieces: Mapping[str, Column]) -> None:
        """Adds what each column has next."""
        for name, kind in self._kinds.items():
            self._octets[name] += pieces[name].astype(kind).tobytes()

    def whole(self) -> dict[str, Any]:
        """The columns. They cannot grow any more."""
        return {name: np.frombuffer(self._octets[name], kind) for name, kind in self._kinds.items()}


def joined(pieces: Iterable[tuple[Submessages, Flags]]) -> Submessages:
    """Some messages of each piece, one behind the other.

    Of their bytes there are the payloads of those submessages that columns do not say everything of. What has an inner
    structure is to be parsed again.

    Args:
        pieces: each with a truth value for each of its messages.
    """
    of_messages = GrowingColumns(_OF_MESSAGES)
    of_submessages = GrowingColumns({**_OF_SUBMESSAGES, "message": np.int32, "sizes": np.int32})
    octets = bytearray()
    problems: dict[int, str] = {}
    texts: dict[str, str] = {}
    messages = entries = 0
    for found, wanted in pieces:
        chosen = np.flatnonzero(wanted[found.message])
        of_messages.extend({name: getattr(found.messages, name)[wanted] for name in _OF_MESSAGES})
        sizes = np.where(np.isin(found.kind[chosen], _WHOLLY_IN_COLUMNS), 0, found.sizes[chosen])
        columns = {name: getattr(found, name)[chosen] for name in _OF_SUBMESSAGES}
        message = np.cumsum(wanted)[found.message[chosen]] - 1 + messages
        of_submessages.extend({**columns, "message": message, "sizes": sizes})
        there = memoryview(found.messages.octets.data)
        stretches = zip(found.starts[chosen].tolist(), sizes.tolist(), strict=True)
        octets += b"".join([there[start : start + size] for start, size in stretches if size])
        for number in np.flatnonzero(found.kind[chosen] == MALFORMED).tolist():
            problem = found.problems[int(chosen[number])]
            problems[entries + number] = texts.setdefault(problem, problem)
        messages += int(wanted.sum())
        entries += len(chosen)
    nothing = np.broadcast_to(np.int64(0), messages)
    held = Messages(
        octets=np.frombuffer(octets, np.uint8), **of_messages.whole(), starts=nothing, sizes=nothing, missing=nothing
    )
    whole = of_submessages.whole()
    ends = np.cumsum(whole["sizes"], dtype=np.int64)
    return Submessages(held, **whole, starts=ends - whole["sizes"], problems=problems, contents={})


def places_in(starts: Numbers, sizes: Column) -> Numbers:
    """The places of stretches, one behind the other."""
    before = np.cumsum(sizes) - sizes
    places: Numbers = np.repeat(starts - before, sizes) + np.arange(int(sizes.sum()))
    return places
