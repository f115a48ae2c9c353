"""SIGTERM breaks the program off as Ctrl-C does, so that it ends its processes and leaves no half-written file."""

from __future__ import annotations

import signal
import threading
from types import FrameType


class Termination:
    """By which signal the program is to end where it is broken off."""

    signal = signal.SIGINT

    def heed(self) -> None:
        """Takes SIGTERM for an interrupt from now on. A second one ends the program at once."""
        if threading.current_thread() is threading.main_thread() and signal.getsignal(signal.SIGTERM) is signal.SIG_DFL:
            signal.signal(signal.SIGTERM, self._break_off)

    def _break_off(self, number: int, frame: FrameType | None) -> None:
        self.signal = signal.SIGTERM
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        raise KeyboardInterrupt
