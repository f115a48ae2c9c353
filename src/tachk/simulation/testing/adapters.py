"""The kinds of systems that can be tested, by the word that `--adapter` begins with."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.simulation.testing.program_system import DrivenProgram, RealTimeProgram, command_of
from tachk.simulation.testing.system_adapter import SystemAdapter

AdapterMaker = Callable[[str, Fraction | None], SystemAdapter]


def _real_time_program(command: str, nanoseconds: Fraction | None) -> SystemAdapter:
    if nanoseconds is None:
        raise UsageError(
            "the model does not say how long its time unit is, so it has no real time",
            "write `time_unit = 1 ms;` into it",
        )
    return RealTimeProgram(command_of(command), nanoseconds)


def _driven_program(command: str, nanoseconds: Fraction | None) -> SystemAdapter:
    return DrivenProgram(command_of(command))


ADAPTERS: Mapping[str, AdapterMaker] = {
    "process": _real_time_program,
    "driven": _driven_program,
}
"""``process:COMMAND``, ``driven:COMMAND``."""


def open_adapter(text: str, nanoseconds: Fraction | None) -> SystemAdapter:
    """The system that ``KIND:REST`` names. Raises UsageError.

    Args:
        nanoseconds: of a unit of the model; None if the model does not say it.
    """
    kind, colon, rest = text.partition(":")
    if not colon or kind not in ADAPTERS:
        known = ", ".join(f"{each}:COMMAND" for each in ADAPTERS)
        raise UsageError(f"`{text}` names no system to test", did_you_mean(kind, ADAPTERS) or f"one of {known}")
    return ADAPTERS[kind](rest, nanoseconds)
