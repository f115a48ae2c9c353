"""What submessages say, as numbers that are equal where they say the same."""

from __future__ import annotations

from collections.abc import Sequence
from hashlib import blake2b
from typing import Final

import numpy as np

from tachk.xrce.events import events
from tachk.xrce.legs import DIGEST, digests
from tachk.xrce.messages import Endpoint
from tachk.xrce.packets import Column, Numbers
from tachk.xrce.submessages import MALFORMED, NOTHING, Submessages
from tachk.xrce.wire import FORMAT, LAST_FRAGMENT, SubmessageKind

_FEW: Final = 100_000
_SAMPLES: Final = (SubmessageKind.WRITE_DATA, SubmessageKind.DATA)
_BEFORE_SAMPLE: Final = 4
"""Bytes of the request before a sample."""
_IN_COLUMNS: Final = (SubmessageKind.ACKNACK, SubmessageKind.HEARTBEAT, MALFORMED)
"""Kinds of which columns say everything, or that say nothing."""
_IDS: Final = ("first", "last", "bitmap", "subject", "request", "object")


def samples(found: Submessages, endpoints: list[Endpoint]) -> Column:
    """For each submessage a number that stands for its sample, or for what else it says beside its ids; NOTHING where
    there is no such thing."""
    numbers = np.full(len(found.kind), NOTHING, np.int32)
    is_sample, is_piece = np.isin(found.kind, _SAMPLES), found.kind == SubmessageKind.FRAGMENT
    octets = np.flatnonzero(is_sample | is_piece)
    skipped = np.where(is_sample[octets], _BEFORE_SAMPLE, 0)
    others = np.flatnonzero(~(is_sample | is_piece | np.isin(found.kind, _IN_COLUMNS)))
    texts = [repr(event.fields).encode() for event in events(found, endpoints, others)]
    parts = (
        digests(found.messages.octets, found.starts[octets] + skipped, found.sizes[octets] - skipped),
        _hashed(texts),
    )
    numbers[np.concatenate([octets, others])] = numbered(np.concatenate(parts))
    return numbers


def contents(found: Submessages, entries: Numbers, said: Column, ways: Column) -> Numbers:
    """A digest of each of some submessages, as a row of two numbers: rows are equal where two submessages are equal and
    went the same way.

    Args:
        entries: the numbers of these submessages.
        said: the `samples` of all submessages.
        ways: of each of them a number that stands for its sender and its receiver.
    """
    parts = bytearray()
    for first in range(0, len(entries), _FEW):
        few = entries[first : first + _FEW]
        kind = found.kind[few]
        matter = np.where(np.isin(kind, _SAMPLES), FORMAT, np.where(kind == SubmessageKind.FRAGMENT, LAST_FRAGMENT, 0))
        ids = [np.where(kind == MALFORMED, NOTHING, getattr(found, name)[few]) for name in _IDS]
        way = ways[first : first + _FEW]
        columns = [way, kind, found.stream[few], found.sequence[few], *ids, found.flags[few] & matter, said[few]]
        rows = np.stack(columns, axis=1).astype(np.int32)
        size = rows.itemsize * rows.shape[1]
        parts += digests(rows.view(np.uint8).ravel(), np.arange(len(rows)) * size, np.full(len(rows), size)).data
    return np.frombuffer(parts, np.int64).reshape(-1, 2)


def joined_contents(parts: Numbers, counts: Column) -> Column:
    """For each message a number that stands for the contents of its submessages, of which it has so many."""
    first = np.cumsum(counts) - counts
    found = parts[first]
    several = np.flatnonzero(counts > 1)
    ends = first[several] + counts[several]
    texts = [parts[a:b].tobytes() for a, b in zip(first[several].tolist(), ends.tolist(), strict=True)]
    found[several] = _hashed(texts)
    return numbered(found)


def _hashed(texts: Sequence[bytes]) -> Numbers:
    octets = b"".join([blake2b(text, digest_size=DIGEST).digest() for text in texts])
    return np.frombuffer(octets, np.int64).reshape(-1, 2)


def numbered(found: Numbers) -> Column:
    """From 0, one number for each pair; equal ones have equal numbers."""
    order = np.lexsort((found[:, 1], found[:, 0]))
    differs = np.zeros(max(len(found) - 1, 0), np.bool_)
    for half in found.T:
        differs |= np.diff(half[order]) != 0
    numbers = np.zeros(len(found), np.int32)
    numbers[order[1:]] = np.cumsum(differs, dtype=np.int32)
    return numbers
