"""What a whole process takes, its start included: CPU time and memory, by wait4."""

from __future__ import annotations

import os
import subprocess
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


def finished(command: Sequence[str], source: Path | None = None, statuses: Collection[int] = (0,)) -> Finished:
    """Runs a command to its end.

    Args:
        source: the folder that holds the package, where it is not the one that Python finds by itself.
        statuses: with which it may end. Raises RuntimeError if it ends with another one.
    """
    environment = None if source is None else os.environ | {"PYTHONPATH": str(source)}
    process = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in statuses:
        raise RuntimeError(f"{' '.join(command)} ended with status {process.returncode}:\n{output}")
    return Finished(output, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024)
