"""The common part of reports in verifyta's form: lines that verifyta does not have, and the memory of the process."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

_STATUS = Path("/proc/self/status")


def peak_memory() -> tuple[int, int] | None:
    """The largest virtual and resident sizes of the process so far, in KiB; None where they are not known."""
    try:
        lines = _STATUS.read_text(encoding="ascii", errors="replace").splitlines()
    except OSError:
        return _from_usage()
    sizes = {name: value.split()[0] for name, _, value in (line.partition(":") for line in lines) if value.split()}
    try:
        return int(sizes["VmPeak"]), int(sizes["VmHWM"])
    except (KeyError, ValueError):
        return _from_usage()


def _from_usage() -> tuple[int, int] | None:
    """The sizes from `getrusage`. Only the resident size is known, and stands for both. macOS counts bytes."""
    try:
        import resource
        import sys
    except ImportError:
        return None
    size = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    size = size // 1024 if sys.platform == "darwin" else size
    return size, size


def note(text: str) -> str:
    """A line that verifyta does not have."""
    return f" -- tachk: {harmless(text)}"


def harmless(text: str) -> str:
    """A text of one line without the word by which scripts recognise verdicts."""
    return " ".join(text.split()).replace("satisfied", "fulfilled")


def memory_lines() -> Iterator[str]:
    """The lines about the memory of the process, if that is known."""
    memory = peak_memory()
    if memory is not None:
        yield f" -- Virtual memory used : {memory[0]} KiB"
        yield f" -- Resident memory used : {memory[1]} KiB"
