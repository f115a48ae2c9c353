"""The interface between a test and the system that it tests."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Protocol

from tachk.base.records import dataclass
from tachk.recordings.conformance.events import Cell


@dataclass(frozen=True, slots=True)
class SeenOutput:
    """An output of the system.

    Attributes:
        time: when it was seen, in units of the model since the start.
        cells: what it contains, by column.
    """

    time: Fraction
    name: str
    cells: Mapping[str, Cell]


class SystemEndedError(Exception):
    """The system does not run any more. Its text says how it ended."""


class SystemAdapter(Protocol):
    """A system under test. Times are in units of the model since `start`."""

    def start(self) -> None:
        """Starts the system; the model starts at the same time. Raises UsageError if it does not start."""

    def time(self) -> Fraction:
        """The present time."""

    def send(self, name: str, cells: Mapping[str, Cell]) -> Fraction:
        """Gives the system an input; the time at which it got it. Raises SystemEndedError."""

    def next_output(self, until: Fraction) -> SeenOutput | None:
        """The next output. None when that time has come and all earlier outputs have been given. Raises
        SystemEndedError, UsageError for what is no event."""

    def waited(self) -> Fraction:
        """How long the operating system has let the system wait for a processor so far; 0 where that is not known."""

    def close(self) -> None:
        """Ends the system after a test."""

    def abandon(self) -> None:
        """Ends the system at once, where there is no result."""
