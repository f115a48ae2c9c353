"""Searches that run at the same time, each in a process of its own."""

from __future__ import annotations

import os
import pickle
import signal
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from traceback import format_exc
from types import FrameType

from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.job import current_job, followed, note_interruption
from tachk.base.records import dataclass, replace
from tachk.engine.options import Limits
from tachk.engine.outcome import INTERRUPTED, Statistics
from tachk.verify.plan import Search
from tachk.verify.verdict import Verdict, none_begun


class Interrupts:
    """Records whether Ctrl-C was pressed and not yet handled."""

    def __init__(self) -> None:
        self._new = False

    def note(self, number: int, frame: FrameType | None) -> None:
        self._new = True

    def take(self) -> bool:
        """True if Ctrl-C was pressed since the last call."""
        new, self._new = self._new, False
        return new


def ignored() -> bool:
    """True if the program ignores Ctrl-C."""
    return signal.getsignal(signal.SIGINT) is signal.SIG_IGN


@contextmanager
def noted_interrupts() -> Iterator[Interrupts]:
    """Records interrupts in the main thread.

    There are none in other threads, and where the program ignores Ctrl-C because a shell runs it in the background.
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


Answer = Callable[[Search, Limits], dict[int, Verdict]]
"""The function that finds the verdicts of a search, by the numbers of its tasks."""

_LONGEST_SLEEP = 0.2
"""Seconds until Ctrl-C is looked at, where the system gave it to a thread other than the one that waits."""


@dataclass(frozen=True, slots=True)
class _Running:
    search: Search
    process: BaseProcess
    pipe: Connection


class SideBySide:
    """Searches that are left, and those that run."""

    def __init__(self, searches: Iterable[Search], answer: Answer, limits: Callable[[Search], Limits]) -> None:
        """Args:
        limits: of a search that is about to begin.
        """
        self._left = deque(searches)
        self._running: list[_Running] = []
        self._verdicts: dict[int, Verdict] = {}
        self._answer, self._limits = answer, limits

    def answered(self, processes: int) -> dict[int, Verdict]:
        """The verdicts of all searches, so many of which run at the same time. They begin in their order.

        A search whose process ends without a word, killed for want of memory say, has the answer UNKNOWN. After Ctrl-C
        no further one begins, and those that run tell what they know. What a search raises is raised here.
        """
        try:
            with noted_interrupts() as interrupts:
                while self._running or self._left:
                    self._begin(processes)
                    for pipe in wait([one.pipe for one in self._running], _LONGEST_SLEEP):
                        self._receive(next(one for one in self._running if one.pipe is pipe))
                    if interrupts.take():
                        note_interruption()
                        self._leave_out()
                        for one in self._running:
                            _interrupt(one.process)
        finally:
            for one in self._running:
                _end(one)
        return self._verdicts

    def _begin(self, processes: int) -> None:
        while self._left and len(self._running) < processes:
            search = self._left.popleft()
            self._running.append(_begun(search, self._answer, self._limits(search)))

    def _receive(self, one: _Running) -> None:
        message = _received(one)
        if isinstance(message, Statistics):
            progress = current_job().progress
            if progress is not None:
                progress(message, one.search.names)
            return
        self._running.remove(one)
        _end(one)
        if isinstance(message, Exception):
            raise message
        self._verdicts |= message
        if any(verdict.reason == INTERRUPTED for verdict in message.values()):
            note_interruption()
            self._leave_out()

    def _leave_out(self) -> None:
        """No further search begins."""
        for search in self._left:
            self._verdicts |= none_begun(search.tasks, INTERRUPTED)
        self._left.clear()


def _received(one: _Running) -> Statistics | dict[int, Verdict] | Exception:
    """The message of a process; verdicts and errors are its last ones."""
    try:
        message: Statistics | dict[int, Verdict] | Exception = one.pipe.recv()
    except (EOFError, OSError):
        one.process.join()
        return none_begun(one.search.tasks, _ended_by(one.process.exitcode or 0))
    if isinstance(message, dict):
        # The variables of the network are distinguished by identity, and a copy of the query has others.
        return {task.number: replace(message[task.number], query=task.query) for task in one.search.tasks}
    return message


def _ended_by(status: int) -> str:
    how = f"was ended by signal {-status}" if status < 0 else f"ended with status {status}"
    return f"the process of this search {how}"


def _begun(search: Search, answer: Answer, limits: Limits) -> _Running:
    context = get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_work, args=(theirs, os.getpid(), search, answer, limits), daemon=True)
    # The process is interrupted only once it knows what to do about it.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        process.start()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
    theirs.close()
    return _Running(search, process, ours)


def _interrupt(process: BaseProcess) -> None:
    if process.pid is not None and process.is_alive():
        os.kill(process.pid, signal.SIGINT)


def _end(one: _Running) -> None:
    one.process.kill()
    one.process.join()
    one.pipe.close()


def _work(pipe: Connection, parent: int, search: Search, answer: Answer, limits: Limits) -> None:
    """The main function of a process."""
    if not ignored():
        signal.signal(signal.SIGINT, _interrupted_once)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})

    watched = current_job().progress is not None

    def report_progress(statistics: Statistics, names: tuple[str, ...]) -> None:
        if os.getppid() != parent:
            os._exit(1)
        if watched:
            pipe.send(statistics)

    try:
        with followed(report_progress):
            found: dict[int, Verdict] | Exception = answer(search, limits)
    except KeyboardInterrupt:
        found = none_begun(search.tasks, INTERRUPTED)
    except Exception as error:
        found = _portable(error)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    pipe.send(found)


def _interrupted_once(number: int, frame: FrameType | None) -> None:
    """Ctrl-C comes to all processes of a terminal, and once more from the one that waits for them."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    raise KeyboardInterrupt


def _portable(error: Exception) -> Exception:
    """The error as it comes out at the other end of a pipe, where it says where it was raised."""
    try:
        copy: object = pickle.loads(pickle.dumps(error))
    except Exception:
        copy = None
    portable = copy if isinstance(copy, Exception) else InternalError(str(error))
    portable.add_note(format_exc())
    return portable
