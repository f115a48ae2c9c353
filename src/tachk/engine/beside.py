"""Work beside the main thread: one piece after the other, in a thread of its own, until one of them is the last."""

from __future__ import annotations

from collections.abc import Callable
from contextvars import copy_context
from queue import SimpleQueue
from threading import Event, Thread

from tachk.base.job import current_job, stopped_if, under_way
from tachk.base.records import replace

_LONGEST_SLEEP = 0.1
"""Seconds until Ctrl-C is looked at where the system does not wake a thread that waits."""


class WorkBeside:
    """Pieces of work, in the order in which they are given. Who begins it stops it.

    Its thread has the job of who begins it, whose progress it does not report.
    """

    def __init__(self) -> None:
        self._given: SimpleQueue[tuple[Callable[[], bool], Event] | None] = SimpleQueue()
        self._is_stopped = False
        self._error: BaseException | None = None
        self.is_over = False
        """True once a piece was the last, or has raised something: those behind it are left out."""
        self._thread = Thread(target=copy_context().run, args=(self._do_all,), name="beside", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Stops what is not done yet."""
        self._is_stopped = True
        self._given.put(None)
        self._thread.join()

    def add(self, work: Callable[[], bool]) -> Event:
        """Gives a piece of work, which returns True if it is the last. The event is set once it is done or left out."""
        done = Event()
        self._given.put((work, done))
        return done

    def wait(self, done: Event) -> None:
        """Waits for a piece. Raises what one has raised."""
        while not done.wait(_LONGEST_SLEEP):
            pass
        if self._error is not None:
            raise self._error

    def _do_all(self) -> None:
        with under_way(replace(current_job(), progress=None)), stopped_if(lambda: self._is_stopped):
            while (piece := self._given.get()) is not None:
                work, done = piece
                if not self.is_over and not self._is_stopped:
                    try:
                        self.is_over = work()
                    except BaseException as error:
                        self._error, self.is_over = error, True
                done.set()
