"""Ctrl-C, noted instead of raised: what is being put down when it comes is put down."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class Interrupts:
    """Whether there was one that nobody has heard of."""

    def __init__(self) -> None:
        self._new = False

    def note(self, number: int, frame: FrameType | None) -> None:
        self._new = True

    def take(self) -> bool:
        """Whether there was one since this was asked last."""
        new, self._new = self._new, False
        return new


def ignored() -> bool:
    """Whether the program is to ignore Ctrl-C."""
    return signal.getsignal(signal.SIGINT) is signal.SIG_IGN


@contextmanager
def noted_interrupts() -> Iterator[Interrupts]:
    """Only the main thread of a program hears of Ctrl-C; elsewhere there are none.

    Nor are there any in a program that is to ignore it because a shell runs it in the background.
    """
    interrupts = Interrupts()
    if threading.current_thread() is not threading.main_thread() or ignored():
        yield interrupts
        return
    before = signal.signal(signal.SIGINT, interrupts.note)
    try:
        yield interrupts
    finally:
        signal.signal(signal.SIGINT, before)
