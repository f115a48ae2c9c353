"""SIGTERM breaks the program off as Ctrl-C does, so that it ends its processes and leaves no half-written file.

After the first signal the program reports what it has found; a second one ends it at once.
"""

from __future__ import annotations

import signal
import sys
import threading
from time import monotonic
from types import FrameType
from typing import NoReturn

from tachk.base.unfinished_files import remove_unfinished
from tachk.cli.terminal import end_by

_SECONDS_OF_ONE_INTERRUPT = 0.25
"""`timeout` and `make` send a signal to the program and then to its group: it comes twice and is meant once."""

_UNHEEDED = (signal.SIG_DFL, signal.default_int_handler)
"""Python's own handlers of a signal. A program in the background of a shell ignores Ctrl-C and goes on doing so."""


class Termination:
    """The signal by which the program ends if it is interrupted."""

    number = signal.SIGINT

    def __init__(self) -> None:
        self._first: float | None = None

    def heed(self) -> None:
        """Takes SIGINT and SIGTERM for an interrupt from now on. A second one ends the program at once."""
        self._replace(_UNHEEDED, self._break_off)

    def leave(self) -> None:
        """From now on a signal ends the program silently, as it has reported everything."""
        self._replace((self._break_off,), signal.SIG_DFL)

    def end(self) -> NoReturn:
        """Ends the program by the signal that has broken it off."""
        end_children()
        remove_unfinished()
        end_by(self.number)

    def _replace(self, old: tuple[object, ...], new: signal._HANDLER) -> None:
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                if signal.getsignal(number) in old:
                    signal.signal(number, new)

    def _break_off(self, number: int, frame: FrameType | None) -> None:
        now = monotonic()
        if self._first is None:
            self._first = now
            self.number = signal.Signals(number)
            raise KeyboardInterrupt
        if now - self._first > _SECONDS_OF_ONE_INTERRUPT:
            self.number = signal.Signals(number)
            self.end()


def end_children() -> None:
    """Ends the processes that compute for the program."""
    processes = sys.modules.get("multiprocessing.process")
    if processes is not None:
        for child in processes.active_children():
            child.kill()
