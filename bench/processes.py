"""What a whole process takes, its start included: CPU time and memory, by wait4."""

from __future__ import annotations

import math
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Finished:
    """A process that has ended.

    Attributes:
        output: its standard output.
        cpu_seconds: user and system time.
        memory_bytes: its largest resident set.
    """

    output: str
    cpu_seconds: float
    memory_bytes: int


class Stopped(Exception):
    """A process was ended because it took too much."""

    def __init__(self, cpu_seconds: float, memory_bytes: int) -> None:
        super().__init__(f"ended after {cpu_seconds:.1f} s of CPU time, with {memory_bytes / 1e6:.0f} MB")
        self.cpu_seconds = cpu_seconds
        self.memory_bytes = memory_bytes


class TimeOut(Stopped):
    """It took too long."""


class OutOfMemory(Stopped):
    """It wanted more memory than it may have."""


def tachk(*arguments: str) -> list[str]:
    """A command line of tachk."""
    return [sys.executable, "-m", "tachk", *arguments]


def finished(
    command: Sequence[str],
    source: Path | None = None,
    statuses: Collection[int] = (0,),
    seconds: float | None = None,
    memory: int | None = None,
    *,
    told: bool = True,
) -> Finished:
    """Runs a command to its end.

    Args:
        source: the folder that holds the package, where it is not the one that Python finds by itself.
        statuses: with which it may end. Raises RuntimeError if it ends with another one.
        seconds: of CPU time that it may take. Raises TimeOut if that is not enough.
        memory: the address space that it may have, in bytes. Raises OutOfMemory if it ends for want of it.
        told: whether its error messages are shown.
    """

    def limit() -> None:
        if seconds is not None:
            resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(seconds), math.ceil(seconds) + 1))
        if memory is not None:
            resource.setrlimit(resource.RLIMIT_AS, (memory, memory))

    environment = None if source is None else os.environ | {"PYTHONPATH": str(source)}
    messages = None if told else subprocess.DEVNULL
    process = subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=messages, text=True, preexec_fn=limit
    )
    assert process.stdout is not None
    with process.stdout:
        output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode in (-signal.SIGXCPU, -signal.SIGKILL) and seconds is not None:
        raise TimeOut(usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024)
    if memory is not None and process.returncode != 0 and usage.ru_maxrss * 1024 > memory / 2:
        raise OutOfMemory(usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024)
    if process.returncode not in statuses:
        raise RuntimeError(f"{' '.join(command)} ended with status {process.returncode}:\n{output}")
    return Finished(output, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024)
