"""What comes from a system while a test does something else."""

from __future__ import annotations

import heapq
import threading
import time
from typing import NamedTuple


class Arrival(NamedTuple):
    """Attributes:
    moment: of `time.monotonic_ns`.
    place: of the arrival among all, so that those of one moment are in the order in which they came.
    source: which part of the system it is from.
    """

    moment: int
    place: int
    source: str
    octets: bytes


class Arrivals:
    """What has arrived, in the order of its moments, until it is taken. Threads put it in.

    Attributes:
        is_over: nothing comes any more.
    """

    def __init__(self) -> None:
        self.is_over = False
        self._count = 0
        self._waiting: list[Arrival] = []
        self._change = threading.Condition()

    @property
    def is_empty(self) -> bool:
        """True if all that has arrived was taken."""
        with self._change:
            return not self._waiting

    def put(self, moment: int, octets: bytes, source: str = "") -> None:
        with self._change:
            heapq.heappush(self._waiting, Arrival(moment, self._count, source, octets))
            self._count += 1
            self._change.notify()

    def end(self) -> None:
        with self._change:
            self.is_over = True
            self._change.notify()

    def next(self, last: int) -> Arrival | None:
        """The earliest arrival; None when that moment has come, or nothing comes any more, and all were taken."""
        with self._change:
            while not self._waiting:
                left = last - time.monotonic_ns()
                if self.is_over or left <= 0:
                    return None
                self._change.wait(left / 1e9)
            return heapq.heappop(self._waiting)
