"""Traces in MDF files (ASAM measurement data, ``.mf4``), read by asammdf. Channels have rates of their own."""

from __future__ import annotations

import gc
import sys
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from traceback import clear_frames
from typing import Any, Final

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.optional_packages import optional_packages
from tachk.recordings.traces.arrivals import arriving
from tachk.recordings.traces.logs.foreign import library_errors
from tachk.recordings.traces.logs.joined import JoinedRecording
from tachk.recordings.traces.logs.trace_hdf5 import plain_texts
from tachk.recordings.traces.trace import Trace, TraceSource
from tachk.recordings.traces.trace_arrays import TableRecording
from tachk.recordings.traces.trace_header import TraceHeader, agreed_unit, no_such_column, without_unit

_PIECE: Final = 1 << 22
"""Bytes of the records of a group that asammdf holds at a time; else 256 MiB, and what is decompressed for them."""

_LARGEST_RATIO: Final = 1100
"""No byte of deflate stands for more bytes than this."""


@dataclass(frozen=True, slots=True, eq=False)
class MdfRecording:
    """Attributes:
    channels: the group and the number there of each channel.
    """

    name: str
    channels: Mapping[str, tuple[int, int]] = field(repr=False)

    @property
    def unit(self) -> str:
        return "s"

    @property
    def columns(self) -> tuple[str, ...]:
        return tuple(self.channels)

    def read(self, columns: Collection[str] | None = None) -> Trace:
        names = self.columns if columns is None else tuple(columns)
        arrivals = arriving(names, self.columns)
        for name in names:
            if name not in self.channels and name not in arrivals:
                raise no_such_column(name, self.columns, self.name)
        parts = (part for parts in arrivals.values() for part in parts)
        wanted = tuple(dict.fromkeys((*(name for name in names if name not in arrivals), *parts)))
        tables: list[TraceSource] = []
        with _opened_file(Path(self.name)) as file:
            for name in wanted:
                group, number = self.channels[name]
                signal = file.get(group=group, index=number)
                if not len(signal.timestamps):
                    raise UsageError(f"{self.name}: channel {name!r} never has a value")
                cells = (signal.timestamps, plain_texts(signal.samples))
                tables.append(TableRecording(self.name, TraceHeader(("time", name), 0, "s"), cells))
            spans = list(_spans(file))
        if not spans:
            raise UsageError(f"{self.name} has no samples", "the verdict needs at least the state at the beginning")
        end = max(last for _, last in spans)
        if not tables:
            first = min(first for first, _ in spans)
            return TableRecording(self.name, TraceHeader(("time",), 0, "s"), ([first, end],)).read()
        tables.append(TableRecording(self.name, TraceHeader(("time",), 0, "s"), ([end],)))
        places = {name: (place, name) for place, name in enumerate(wanted)}
        return JoinedRecording(self.name, tuple(tables), places).read(names)


def _spans(file: Any) -> Iterator[tuple[float, float]]:
    """The first and the last time of each group that has samples."""
    for group in range(len(file.groups)):
        times = file.get_master(group)
        if len(times):
            yield float(times[0]), float(times[-1])


def open_mdf(path: Path, time: str | None, unit: str | None) -> TraceSource:
    """Lists the channels of a file; times are in seconds. Raises UsageError, also where asammdf is not installed.

    A channel whose name another one has too is called after its group, ``speed_2``.
    """
    if time is not None:
        raise UsageError("channels of an MDF file have times of their own, none to choose")
    with optional_packages():
        import asammdf  # noqa: F401
    agreed_unit("s", unit, str(path))
    channels: dict[str, tuple[int, int]] = {}
    with _opened_file(path) as file:
        for number, group in enumerate(file.groups):
            for index, channel in enumerate(group.channels):
                if index != file.masters_db.get(number):
                    name = without_unit(channel.name)
                    name = name if name not in channels else f"{name}_{number}"
                    channels[name] = number, index
    if not channels:
        raise UsageError(f"{path} has no channels with values")
    return MdfRecording(str(path), channels)


@contextmanager
def _opened_file(path: Path) -> Iterator[Any]:
    with library_errors(path, "MDF file"), _opened(path) as file:
        _check_places(file, path)
        file.configure(read_fragment_size=_PIECE)
        yield file


def _check_places(file: Any, path: Path) -> None:
    """Raises UsageError for a channel that lies behind the end of its records, or a block of records behind the end of
    the file: a file is damaged so, and asammdf would read memory that is not its own."""
    size = path.stat().st_size
    for group in file.groups:
        for block in group.data_blocks:
            end = block.address + block.compressed_size
            if not 0 <= end <= size or not 0 <= block.original_size <= _LARGEST_RATIO * size:
                raise UsageError(f"{path}: a block of records lies behind the end of the file", "the file is damaged")
        bits = 8 * group.channel_group.samples_byte_nr
        for channel in group.channels:
            if hasattr(channel, "start_offset"):  # MDF 3
                end = channel.start_offset + 8 * channel.additional_byte_offset + channel.bit_count
            else:
                end = 8 * channel.byte_offset + channel.bit_offset + channel.bit_count
            if channel.bit_count and end > bits:
                raise UsageError(
                    f"{path}: channel {channel.name!r} lies behind the end of its records", "the file is damaged"
                )


def _opened(path: Path) -> Any:
    """The file. asammdf's destructor of what could not be read prints an error of its own, which says nothing new."""
    from asammdf import MDF

    hook = sys.unraisablehook
    sys.unraisablehook = lambda _: None
    try:
        return MDF(path)
    except Exception as error:
        reason: BaseException | None = error
        while reason is not None:
            clear_frames(reason.__traceback__)
            reason = reason.__context__
        gc.collect()
        raise
    finally:
        sys.unraisablehook = hook
