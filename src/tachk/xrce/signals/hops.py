"""What happened to messages between the two sides of a relay: lost, copied, overtaken, delayed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

import numpy as np

from tachk.xrce.packets import Numbers
from tachk.xrce.signals.changes import ChangeLog, SignalChanges
from tachk.xrce.transmissions import Capture, Transmission

HOP_SIGNALS: Final = ("lost", "copies", "overtaken", "delay_ms")
"""Of all messages of a client, or of the Agent to it, so far: how many were lost, counted when they were sent; how many
copies came; how many came after one that was sent later; and how long the last one that came was on its way, of which
`hop_changes` has nanoseconds."""

Direction = tuple[str, bool]
"""The key of a client, and whether it sends."""


def hop_changes(recording: Capture, packets: Numbers) -> Mapping[Direction, SignalChanges]:
    """The `HOP_SIGNALS` of each client whose relay was recorded on both sides.

    Args:
        packets: the number of the packet in each row.
    """
    numbers, firsts = np.unique(packets, return_index=True)
    rows = dict(zip(numbers.tolist(), firsts.tolist(), strict=True))
    sent: dict[Direction, list[Transmission]] = {}
    for one in recording.transmissions:
        link = recording.links[one.link]
        if link.relay is not None and link.key:
            sent.setdefault((link.key, one.to_agent), []).append(one)
    return {direction: _changes(ones, rows) for direction, ones in sent.items()}


def _changes(sent: Iterable[Transmission], rows: Mapping[int, int]) -> SignalChanges:
    happened: list[tuple[int, int, int, int]] = []  # row, lost, place in order of sending, delay
    for place, one in enumerate(sorted(sent, key=lambda transmission: transmission.packet)):
        if one.is_lost:
            happened.append((rows[one.packet], 1, place, 0))
        for copy, arrival in enumerate(one.arrivals or ()):
            happened.append((rows[arrival.packet], -copy, place, arrival.time - one.sent))
    log = ChangeLog(len(HOP_SIGNALS))
    lost = copies = overtaken = delay = 0
    latest = -1
    for row, what, place, took in sorted(happened):
        if what > 0:
            lost += 1
        elif what < 0:
            copies += 1
        else:
            overtaken += place < latest
            latest = max(latest, place)
            delay = took
        log.note(row, (lost, copies, overtaken, delay))
    return log.take(0)
