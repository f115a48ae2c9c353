"""Messages before a relay and those behind it, told by their bytes."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Sequence

import numpy as np

from tachk.base.records import dataclass
from tachk.xrce.datagrams import Flags
from tachk.xrce.joined_submessages import places_in
from tachk.xrce.legs import MessageColumns
from tachk.xrce.packets import Numbers


@dataclass(frozen=True, slots=True)
class Matched:
    """Attributes:
    arrivals: pairs of places, of a message before a relay and of one behind it that it has become; in the order of the
        first, and then of the second.
    unsent: the places of messages behind the relay that nobody has sent before it.
    """

    arrivals: Numbers
    unsent: Numbers


def matched(before: MessageColumns, behind: MessageColumns) -> Matched:
    """Messages before a relay with those behind it that have the same bytes."""
    entered, left = len(before.packets), len(behind.packets)
    both = np.concatenate([before.digests, behind.digests])
    order = np.lexsort((both[:, 1], both[:, 0]))  # stable: those before come first, each in the order of packets
    both = both[order]
    begins = np.ones(entered + left, np.bool_)
    begins[1:] = (both[1:] != both[:-1]).any(axis=1)
    first = np.flatnonzero(begins)
    sizes = np.diff(np.append(first, entered + left))
    of_before = np.add.reduceat(order < entered, first) if len(first) else first
    pairs = [_single(order, first[(sizes == 2) & (of_before == 1)], before, behind)]
    alike = (sizes > 2) & (2 * of_before == sizes)
    alike[alike] = _in_turn(order, first[alike], of_before[alike], before, behind, pairs)
    several = ~alike & (sizes > 2) & (of_before > 0) & (of_before < sizes)
    found: list[tuple[int, int]] = []
    for start, size, count in np.stack([first, sizes, of_before], axis=1)[several].tolist():
        here, there = order[start : start + count], order[start + count : start + size] - entered
        equal = _equal_ones(before.packets[here].tolist(), behind.packets[there].tolist())
        found += [(int(here[one]), int(there[other])) for one, other in equal]
    pairs.append(np.array(found, np.int64).reshape(-1, 2))
    together = np.concatenate(pairs)
    unsent = np.repeat(of_before == 0, sizes)
    return Matched(together[np.lexsort((together[:, 1], together[:, 0]))], np.sort(order[unsent] - entered))


def _single(order: Numbers, first: Numbers, before: MessageColumns, behind: MessageColumns) -> Numbers:
    """The pairs of those that are there once on each side."""
    here, there = order[first], order[first + 1] - len(before.packets)
    passed = before.packets[here] < behind.packets[there]
    return np.stack([here[passed], there[passed]], axis=1)


def _in_turn(
    order: Numbers,
    first: Numbers,
    counts: Numbers,
    before: MessageColumns,
    behind: MessageColumns,
    pairs: list[Numbers],
) -> Flags:
    """Adds the pairs of those that are there equally often on each side, where each has come out after it had gone in:
    then `_equal_ones` gives one after the other. Returns whether that is so."""
    here = order[places_in(first, counts)]
    there = order[places_in(first + counts, counts)] - len(before.packets)
    passed = before.packets[here] < behind.packets[there]
    whole: Flags = np.logical_and.reduceat(passed, np.cumsum(counts) - counts) if len(first) else np.zeros(0, np.bool_)
    taken = np.repeat(whole, counts)
    pairs.append(np.stack([here[taken], there[taken]], axis=1))
    return whole


def _equal_ones(entered: Sequence[int], behind: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Matches messages with the same bytes that came out with those that went in, given by their packets.

    Only the time distinguishes them. If there are not more than went in, the last that came out is the last that had
    gone in, and so on, which makes the delays as short as they can be in this order. Else the first that came out is
    the first that had gone in, and so on, and the rest are copies: each of the last that had gone in.
    """
    if len(behind) <= len(entered):
        free = len(entered)
        for number in reversed(range(len(behind))):
            free = min(bisect_left(entered, behind[number]), free) - 1
            if free < 0:
                return
            yield free, number
        return
    waiting = 0
    for number, packet in enumerate(behind):
        at = bisect_left(entered, packet)
        if waiting < at:
            yield waiting, number
            waiting += 1
        elif at:
            yield at - 1, number
