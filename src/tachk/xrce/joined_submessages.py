"""Submessages of many pieces of a capture as one, to be held: in columns as narrow as their numbers allow."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

import numpy as np

from tachk.xrce.datagrams import Flags
from tachk.xrce.messages import Messages
from tachk.xrce.packets import Column, Numbers, Octets
from tachk.xrce.submessages import MALFORMED, Submessages
from tachk.xrce.wire import SubmessageKind

_OF_MESSAGES: Final = {
    "packets": np.int64,
    "times": np.int64,
    "clients": np.int32,
    "agents": np.int32,
    "to_agent": np.bool_,
}
_OF_SUBMESSAGES: Final = {
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


def joined(pieces: Iterable[tuple[Submessages, Flags]]) -> Submessages:
    """Some messages of each piece, one behind the other.

    Of their bytes there are the payloads of those submessages that columns do not say everything of. What has an inner
    structure is to be parsed again.

    Args:
        pieces: each with a truth value for each of its messages.
    """
    columns: dict[str, list[Any]] = {
        name: [np.zeros(0, kind)]
        for name, kind in {**_OF_MESSAGES, **_OF_SUBMESSAGES, "message": np.int32, "sizes": np.int32}.items()
    }
    octets: list[Octets] = [np.zeros(0, np.uint8)]
    problems: dict[int, str] = {}
    texts: dict[str, str] = {}
    messages = entries = 0
    for found, wanted in pieces:
        chosen = np.flatnonzero(wanted[found.message])
        for name, kind in _OF_MESSAGES.items():
            columns[name].append(getattr(found.messages, name)[wanted].astype(kind))
        for name, kind in _OF_SUBMESSAGES.items():
            columns[name].append(getattr(found, name)[chosen].astype(kind))
        columns["message"].append((np.cumsum(wanted)[found.message[chosen]] - 1 + messages).astype(np.int32))
        sizes = np.where(np.isin(found.kind[chosen], _WHOLLY_IN_COLUMNS), 0, found.sizes[chosen])
        columns["sizes"].append(sizes.astype(np.int32))
        octets.append(found.messages.octets[places_in(found.starts[chosen], sizes)])
        for number in np.flatnonzero(found.kind[chosen] == MALFORMED).tolist():
            problem = found.problems[int(chosen[number])]
            problems[entries + number] = texts.setdefault(problem, problem)
        messages += int(wanted.sum())
        entries += len(chosen)
    whole = {name: np.concatenate(columns.pop(name)) for name in list(columns)}
    nothing = np.broadcast_to(np.int64(0), messages)
    own: dict[str, Any] = {name: whole.pop(name) for name in _OF_MESSAGES}
    held = Messages(octets=np.concatenate(octets), **own, starts=nothing, sizes=nothing, missing=nothing)
    ends = np.cumsum(whole["sizes"], dtype=np.int64)
    return Submessages(held, **whole, starts=ends - whole["sizes"], problems=problems, contents={})


def places_in(starts: Numbers, sizes: Column) -> Numbers:
    """The places of stretches, one behind the other."""
    before = np.cumsum(sizes) - sizes
    places: Numbers = np.repeat(starts - before, sizes) + np.arange(int(sizes.sum()))
    return places
