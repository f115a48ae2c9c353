"""The systems under test of DDS-XRCE, by the word behind ``xrce:``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.simulation.testing.adapters import AdapterMaker, real_time_unit
from tachk.simulation.testing.system_adapter import SystemAdapter
from tachk.xrce.testing.agent import TestedAgent
from tachk.xrce.testing.client import TestedClient
from tachk.xrce.testing.relay import TestedSession

_ROLES: Mapping[str, Callable[[str, Fraction], SystemAdapter]] = {
    "agent": TestedAgent,
    "client": TestedClient,
    "relay": TestedSession,
}


def _open(text: str, nanoseconds: Fraction | None) -> SystemAdapter:
    role, colon, command = text.partition(":")
    if not colon or role not in _ROLES:
        known = ", ".join(f"xrce:{each}:COMMAND" for each in _ROLES)
        raise UsageError(f"`xrce:{text}` names no system to test", did_you_mean(role, _ROLES) or f"one of {known}")
    return _ROLES[role](command, real_time_unit(nanoseconds))


ADAPTERS: Mapping[str, AdapterMaker] = {"xrce": _open}
