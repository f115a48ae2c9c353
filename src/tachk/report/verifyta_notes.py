"""What reports in verifyta's form share: lines that verifyta does not have, and the memory of the process."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.report.process_memory import peak_memory


def note(text: str) -> str:
    """A line that verifyta does not have."""
    return f" -- tachk: {harmless(text)}"


def harmless(text: str) -> str:
    """A text of one line without the word by which scripts tell verdicts."""
    return " ".join(text.split()).replace("satisfied", "fulfilled")


def memory_lines() -> Iterator[str]:
    """How much memory the process has taken, where that is known."""
    memory = peak_memory()
    if memory is not None:
        yield f" -- Virtual memory used : {memory[0]} KiB"
        yield f" -- Resident memory used : {memory[1]} KiB"
