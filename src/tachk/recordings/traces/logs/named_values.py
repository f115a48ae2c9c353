"""Names of values in recordings: constants of message types of ROS, and values of enumerations of HDF5.

`ERROR` of the type of the messages on the topic `/status` is called `status.ERROR`, and `ERROR` alone where that name
means one value only in the whole recording. Of an enumeration in the column `imu.mode`, `imu.mode.FAST` and `FAST`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from tachk.recordings.traces.logs.joined import JoinedRecording, RoundedRecording
from tachk.recordings.traces.logs.messages import MessageRecording, topic_name
from tachk.recordings.traces.logs.trace_hdf5 import Hdf5Table
from tachk.recordings.traces.trace import TraceSource

Value = int | float | str


def named_values(recording: TraceSource) -> Mapping[str, Value]:
    """The names of values in a file. Raises UsageError for a file that cannot be read."""
    owned: dict[str, Mapping[str, Value]] = {}
    for part in _parts(recording):
        if isinstance(part, MessageRecording):
            owned |= {topic_name(topic): values for topic, values in part.messages.constants().items()}
        elif isinstance(part, Hdf5Table):
            owned |= part.enumerations()
    found: dict[str, Value] = {}
    unclear: set[str] = set()
    for owner, values in owned.items():
        for name, value in values.items():
            found[f"{owner}.{name}"] = value
            if found.setdefault(name, value) != value:
                unclear.add(name)
    return {name: value for name, value in found.items() if name not in unclear}


def _parts(recording: TraceSource) -> Iterable[TraceSource]:
    match recording:
        case RoundedRecording(recording=inner):
            yield from _parts(inner)
        case JoinedRecording(recordings=parts):
            for part in parts:
                yield from _parts(part)
        case _:
            yield recording
