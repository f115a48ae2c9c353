"""Captures of networks: a reader for each protocol, from the table `captures` of `tachk.base.plugins`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.plugins import plugins

if TYPE_CHECKING:
    from tachk.recordings.conformance.event_streams import Constants
    from tachk.recordings.conformance.events import Cell, EventLog
    from tachk.recordings.traces.trace import TraceSource


class CaptureReader(Protocol):
    """A reader of the captures of one protocol.

    Attributes:
        suffixes: how the names of such files end.
    """

    suffixes: tuple[str, ...]

    def open_trace(self, path: Path, time: str | None, unit: str | None, ports: Sequence[int]) -> TraceSource:
        """The capture as columns of values over time. Raises InputError, UsageError."""

    def read_events(self, path: Path, ports: Sequence[int]) -> EventLog:
        """The capture as events in the words of the models of the protocol. Raises UsageError."""

    def samples_in(self, detail: Cell | None) -> int:
        """The number of samples of an application in a message with this content."""

    def check_room(self, recording: EventLog, constants: Constants) -> None:
        """Raises UsageError if a recording, captured or not, has more than the constants of a model leave room for."""


def capture_readers() -> tuple[CaptureReader, ...]:
    return plugins("captures")


def capture_reader(path: Path) -> CaptureReader | None:
    """The reader of a file, by the ending of its name; None if it is not a capture."""
    return next((each for each in capture_readers() if path.suffix.lower() in each.suffixes), None)


def open_capture(path: Path, time: str | None, unit: str | None, ports: Sequence[int] = ()) -> TraceSource:
    """A capture as columns of values over time. Raises InputError, and UsageError, also where no protocol is read."""
    reader = capture_reader(path)
    if reader is None:
        raise UsageError(f"no protocol that tachk knows is read from {path.suffix} files")
    return reader.open_trace(path, time, unit, ports)
