"""Names of values in recordings: constants of message types of ROS, and values of enumerations.

`ERROR` of the type of the messages on the topic `/status` is called `status.ERROR`, and `ERROR` alone where that name
means one value only in the whole recording. Of an enumeration in the column `imu.mode`, `imu.mode.FAST` and `FAST`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Protocol, runtime_checkable

from tachk.recordings.traces.logs.joined import JoinedRecording, RoundedRecording
from tachk.recordings.traces.trace import TraceSource

Value = int | float | str


@runtime_checkable
class NamingValues(Protocol):
    """The interface of recordings of formats that name values."""

    def named_values(self) -> Mapping[str, Mapping[str, Value]]:
        """The values by their names, for each topic or column that has some."""
        ...

    def enumerations(self, columns: Collection[str]) -> Mapping[str, Mapping[str, int]]:
        """For those of some columns of numbers of which the file names the values: the values by their names."""
        ...


def named_values(recording: TraceSource) -> Mapping[str, Value]:
    """The names of values in a file. Raises UsageError for a file that cannot be read."""
    owned: dict[str, Mapping[str, Value]] = {}
    for part in _parts(recording):
        if isinstance(part, NamingValues):
            owned |= part.named_values()
    found: dict[str, Value] = {}
    unclear: set[str] = set()
    for owner, values in owned.items():
        for name, value in values.items():
            found[f"{owner}.{name}"] = value
            if found.setdefault(name, value) != value:
                unclear.add(name)
    return {name: value for name, value in found.items() if name not in unclear}


def enumerations(recording: TraceSource, columns: Collection[str]) -> Mapping[str, Mapping[str, int]]:
    """For those of some columns of numbers of which a file names the values: the values by their names. Raises
    UsageError for a file that cannot be read."""
    match recording:
        case NamingValues():
            return recording.enumerations(columns)
        case RoundedRecording(recording=inner):
            return enumerations(inner, columns)
        case JoinedRecording(recordings=parts, places=places):
            found: dict[str, Mapping[str, int]] = {}
            for number, part in enumerate(parts):
                own = {places[name][1]: name for name in columns if name in places and places[name][0] == number}
                found |= {own[column]: values for column, values in enumerations(part, own).items()}
            return found
        case _:
            return {}


def _parts(recording: TraceSource) -> Iterable[TraceSource]:
    match recording:
        case RoundedRecording(recording=inner):
            yield from _parts(inner)
        case JoinedRecording(recordings=parts):
            for part in parts:
                yield from _parts(part)
        case _:
            yield recording
