"""Cells computed by processes on this machine.

Each process has one cell at a time, so that it is known which cell a killed process was at: the others go on.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import current_process, get_context, parent_process, resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from threading import Thread
from time import monotonic
from traceback import format_exc

from tachk.base.cycles import collect_rarely
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.model.grid import Values
from tachk.verify.campaign.job import ComputedCell, Verification, computed, killed

TRIES = 2
"""The number of processes that try a cell, one after another, if the first ones die."""

_CONTEXT = get_context("spawn")
_UNGUARDED = 75
"""The exit status of a process that has run the program which started it, and came to this sweep again."""


@dataclass(slots=True)
class _Worker:
    process: SpawnProcess
    pipe: Connection
    cell: Values | None = None


def compute_locally(
    job: Verification, cells: Sequence[Values], seconds: float | None, processes: int
) -> Iterator[ComputedCell]:
    """Each cell as soon as it is computed, in any order, until so many seconds have passed.

    A cell whose process was killed, for want of memory say, is tried once more; then its answers are unknown. Ending
    the iteration early ends the processes.
    """
    ends = None if seconds is None else monotonic() + seconds
    left = list(reversed(cells))
    tries: dict[Values, int] = {}
    workers = [_started() for _ in range(min(processes, len(cells)))]
    try:
        for worker in workers:
            _send(worker, job)
            _give(worker, left)
        while busy := [worker for worker in workers if worker.cell is not None]:
            ready = wait([worker.pipe for worker in busy], None if ends is None else max(0.0, ends - monotonic()))
            if not ready:
                return
            for worker in busy:
                if worker.pipe in ready:
                    received = _received(worker, job, left, tries)
                    _give(worker, left)
                    if received is not None:
                        yield received
    finally:
        for worker in workers:
            _end(worker)


def _received(worker: _Worker, job: Verification, left: list[Values], tries: dict[Values, int]) -> ComputedCell | None:
    """The cell that a process has finished; None where it was killed and the cell is to be tried again."""
    values = worker.cell
    assert values is not None
    try:
        result: ComputedCell | str = worker.pipe.recv()
    except (EOFError, OSError):
        worker.process.join()
        if worker.process.exitcode == _UNGUARDED:
            raise UsageError(
                "the processes of a sweep import the program that calls it, and it would sweep again",
                'put what it does under: if __name__ == "__main__":',
            ) from None
        _end(worker)
        again = _started()
        worker.process, worker.pipe = again.process, again.pipe
        _send(worker, job)
        tries[values] = tries.get(values, 0) + 1
        if tries[values] < TRIES:
            left.append(values)
            return None
        return killed(job, values)
    if isinstance(result, str):
        raise RuntimeError(f"in cell {values} of {job.names}:\n{result}")
    return result


def _started() -> _Worker:
    ours, theirs = _CONTEXT.Pipe()
    process = _CONTEXT.Process(target=_work, args=(theirs,), daemon=True)
    try:
        with _importable_program(), _interrupts_held():
            process.start()
    except RuntimeError:
        if current_process().name == "MainProcess":
            raise
        os._exit(_UNGUARDED)
    theirs.close()
    return _Worker(process, ours)


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Blocks Ctrl-C, also for a process that is started meanwhile: where that imports its modules, it would print the
    place of the interrupt."""
    if sys.platform == "win32":
        yield
        return
    resource_tracker.ensure_running()  # which unblocks what it blocks itself
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _importable_program() -> Iterator[None]:
    """Hides the path of the program where there is no such file, as for one that comes from standard input: a process
    that could not import it would end, and no cell needs it."""
    program = sys.modules["__main__"]
    path = getattr(program, "__file__", None)
    if path is None or getattr(program, "__spec__", None) is not None or os.path.exists(path):
        yield
        return
    del program.__file__
    try:
        yield
    finally:
        program.__file__ = path


def _give(worker: _Worker, left: list[Values]) -> None:
    worker.cell = left.pop() if left else None
    if worker.cell is not None:
        _send(worker, worker.cell)


def _send(worker: _Worker, what: Verification | Values) -> None:
    with suppress(OSError):  # it was killed, as reading from it will tell
        worker.pipe.send(what)


def _end(worker: _Worker) -> None:
    worker.process.kill()
    worker.process.join()
    worker.pipe.close()


def _work(pipe: Connection) -> None:
    """The loop of a process until it is killed. Ctrl-C is for the program that started it."""
    collect_rarely()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if sys.platform != "win32":
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    Thread(target=_end_with_parent, daemon=True).start()
    job = pipe.recv()
    while True:
        values = pipe.recv()
        result: ComputedCell | str
        try:
            result = computed(job, values)
        except Exception:
            result = format_exc()
        pipe.send(result)


def _end_with_parent() -> None:
    """A program that is killed cannot end its processes."""
    parent = parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(0)
