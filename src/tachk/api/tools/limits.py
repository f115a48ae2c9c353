"""The limits of a call of a tool: what the call asks for, within what the server allows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from tachk.base.job import current_job, limited
from tachk.base.records import dataclass, replace
from tachk.engine.options import Limits

_MEGABYTE = 1 << 20


@dataclass(frozen=True, slots=True)
class ToolLimits:
    """Attributes:
    seconds: wall-clock seconds of a call.
    megabytes: by which the process may grow during a call.
    states: stored states of each search.
    """

    seconds: float
    megabytes: int
    states: int

    def within(self, ceilings: ToolLimits) -> ToolLimits:
        """The smaller one of each limit."""
        return ToolLimits(
            min(self.seconds, ceilings.seconds),
            min(self.megabytes, ceilings.megabytes),
            min(self.states, ceilings.states),
        )

    def requested(self, arguments: Mapping[str, Any]) -> ToolLimits:
        """These limits where a call does not name others, which the schema of its arguments has bounded."""
        return ToolLimits(
            arguments.get("seconds", self.seconds),
            arguments.get("megabytes", self.megabytes),
            arguments.get("states", self.states),
        )

    def of_search(self) -> Limits:
        """The same for searches; the seconds are those of the job."""
        return Limits(states=self.states, seconds=self.seconds, memory_bytes=self.megabytes * _MEGABYTE)

    def before_evidence(self) -> Limits:
        """The limits of searches whose answers are judged in the same call: a fifth of the time that the job has left,
        at most `GRACE` seconds, is kept for that."""
        left = current_job().seconds_left
        seconds = self.seconds if left is None else left
        return replace(self.of_search(), seconds=seconds - min(seconds / 5, GRACE))

    @contextmanager
    def in_force(self) -> Iterator[None]:
        """A part of the program that raises StoppedError where it hits one."""
        with limited(self.seconds, self.megabytes * _MEGABYTE):
            yield


GRACE = 5.0
"""Seconds for writing down what was found when the time of a call is over."""

DEFAULT_LIMITS = ToolLimits(seconds=30, megabytes=1024, states=1_000_000)
"""Of a call that names none: short enough for whoever waits for the answer."""

DEFAULT_CEILINGS = ToolLimits(seconds=300, megabytes=4096, states=20_000_000)
"""Of a server whose command line names none."""


def limit_schemas(ceilings: ToolLimits) -> dict[str, Any]:
    """The arguments of every tool that computes."""
    defaults = DEFAULT_LIMITS.within(ceilings)
    return {
        "seconds": {
            "type": "number",
            "exclusiveMinimum": 0,
            "maximum": ceilings.seconds,
            "default": defaults.seconds,
            "description": "Wall-clock seconds for the call. What is not decided by then is unknown.",
        },
        "megabytes": {
            "type": "integer",
            "minimum": 1,
            "maximum": ceilings.megabytes,
            "default": defaults.megabytes,
            "description": "Memory that the call may take.",
        },
        "states": {
            "type": "integer",
            "minimum": 1,
            "maximum": ceilings.states,
            "default": defaults.states,
            "description": "States that each search may store.",
        },
    }


LIMITS_SCHEMA: dict[str, Any] = {
    "type": "object",
    "description": "The limits that this call had.",
    "additionalProperties": False,
    "required": ["seconds", "megabytes", "states"],
    "properties": {
        "seconds": {"type": "number"},
        "megabytes": {"type": "integer"},
        "states": {"type": "integer"},
    },
}
