"""The kinds of systems that can be tested, by the word that `--adapter` begins with."""

from __future__ import annotations

import socket
from collections.abc import Callable, Mapping
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.plugins import plugins
from tachk.simulation.testing.program_system import DrivenProgram, RealTimeProgram, command_of
from tachk.simulation.testing.socket_program import SocketProgram
from tachk.simulation.testing.system_adapter import SystemAdapter

AdapterMaker = Callable[[str, Fraction | None], SystemAdapter]


def real_time_unit(nanoseconds: Fraction | None) -> Fraction:
    """The length of a unit of a model whose time passes by the clock of the wall. Raises UsageError if it has none."""
    if nanoseconds is None:
        raise UsageError(
            "the model does not say how long its time unit is, so it has no real time",
            "write `time_unit = 1 ms;` into it",
        )
    return nanoseconds


def _real_time_program(command: str, nanoseconds: Fraction | None) -> SystemAdapter:
    return RealTimeProgram(command_of(command), real_time_unit(nanoseconds))


def _driven_program(command: str, nanoseconds: Fraction | None) -> SystemAdapter:
    return DrivenProgram(command_of(command))


def _tcp_program(place: str, nanoseconds: Fraction | None) -> SystemAdapter:
    return SocketProgram(place, socket.SOCK_STREAM, real_time_unit(nanoseconds))


def _udp_program(place: str, nanoseconds: Fraction | None) -> SystemAdapter:
    return SocketProgram(place, socket.SOCK_DGRAM, real_time_unit(nanoseconds))


_ADAPTERS: Mapping[str, AdapterMaker] = {
    "process": _real_time_program,
    "driven": _driven_program,
    "tcp": _tcp_program,
    "udp": _udp_program,
}
"""``process:COMMAND``, ``driven:COMMAND``, ``tcp:HOST:PORT``, ``udp:HOST:PORT``.

Those of protocols are in the table `adapters` of `tachk.base.plugins`."""


def _adapters() -> Mapping[str, AdapterMaker]:
    found = dict(_ADAPTERS)
    for each in plugins("adapters"):
        found.update(each)
    return found


def open_adapter(text: str, nanoseconds: Fraction | None) -> SystemAdapter:
    """The system that ``KIND:REST`` names. Raises UsageError.

    Args:
        nanoseconds: of a unit of the model; None if the model does not say it.
    """
    kind, colon, rest = text.partition(":")
    adapters = _adapters()
    if not colon or kind not in adapters:
        known = ", ".join(f"{each}:..." for each in adapters)
        raise UsageError(f"`{text}` names no system to test", did_you_mean(kind, adapters) or f"one of {known}")
    return adapters[kind](rest, nanoseconds)
