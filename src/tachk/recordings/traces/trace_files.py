"""The formats of recorded traces, one row each, listed here only; opens a trace, whatever it is kept in.

A format is loaded when a trace of it is opened: the command line names all of them.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.plugins import load_object
from tachk.recordings.traces.compressed import COMPRESSED_SUFFIXES, is_compressed, plain_suffix

if TYPE_CHECKING:
    from tachk.recordings.traces.trace import Trace, TraceSource


class TraceFormat(NamedTuple):
    """A format of files.

    Attributes:
        name: as people call it.
        suffixes: how its files end.
        reader: the function that opens a file, given its path, the name of the time column and the unit of times; that
            of captures takes the ports of `open_trace` as well.
        compressed: a file of it is also read compressed, with the ending of `COMPRESSED_SUFFIXES` behind its own.
    """

    name: str
    suffixes: tuple[str, ...]
    reader: str
    compressed: bool = False

    def open(self, path: Path, time: str | None, unit: str | None, ports: Sequence[int] = ()) -> TraceSource:
        opened: TraceSource = load_object(self.reader)(path, time, unit, *([ports] if ports else []))
        return opened


CSV = TraceFormat("CSV", (".csv", ".tsv", ".txt"), "tachk.recordings.traces.trace_csv:open_csv", compressed=True)
"""A file without an ending is read as CSV too."""

PACKETS = TraceFormat("pcap", (".pcap", ".pcapng"), "tachk.recordings.captures:open_capture")
"""A capture of a network."""

JSON_LINES = TraceFormat(
    "JSON lines", (".jsonl", ".ndjson"), "tachk.recordings.traces.logs.trace_jsonl:open_jsonl", compressed=True
)
"""An object for each line."""

BAG = TraceFormat("ROS bag", (".bag", ".db3"), "tachk.recordings.traces.logs.trace_rosbag:open_bag")
"""The format of bags of ROS; a bag of ROS 2 is a folder."""

FORMATS = (
    CSV,
    JSON_LINES,
    TraceFormat("Parquet", (".parquet", ".pq"), "tachk.recordings.traces.trace_parquet:open_parquet"),
    TraceFormat("VCD", (".vcd",), "tachk.recordings.traces.trace_vcd:open_vcd", compressed=True),
    PACKETS,
    TraceFormat("MCAP", (".mcap",), "tachk.recordings.traces.logs.trace_mcap:open_mcap", compressed=True),
    BAG,
    TraceFormat("HDF5", (".h5", ".hdf5"), "tachk.recordings.traces.logs.trace_hdf5:open_hdf5"),
    TraceFormat("MDF", (".mf4", ".mdf"), "tachk.recordings.traces.logs.trace_mdf:open_mdf"),
)

TRACE_SUFFIXES = tuple(
    suffix + packed
    for known in FORMATS
    for packed in ("", *(COMPRESSED_SUFFIXES if known.compressed else ()))
    for suffix in known.suffixes
)
"""By which a file is known to be a trace."""


_RUN = ".run"
"""The ending of files with the steps of a run, which have a meaning only with their model."""


def is_csv(path: Path) -> bool:
    """True if a file of this name is read as comma-separated values."""
    return plain_suffix(path) in (*CSV.suffixes, "")


class _Ready:
    """A trace that has been read."""

    def __init__(self, trace: Trace) -> None:
        self._trace = trace

    @property
    def name(self) -> str:
        return self._trace.name

    @property
    def unit(self) -> str:
        return self._trace.unit

    @property
    def columns(self) -> tuple[str, ...]:
        return tuple(self._trace.columns)

    def read(self, columns: Collection[str] | None = None) -> Trace:
        from tachk.recordings.traces.arrivals import arriving, no_arrivals, topic_of

        for name in arriving(columns or (), self.columns):
            topic = topic_of(name) or ""
            raise no_arrivals(self.name, topic, f"write `change({topic})`, if the value changes then")
        return self._trace


def open_trace(
    source: Any,
    time: str | None = None,
    unit: str | None = None,
    ports: Sequence[int] = (),
    run: int | None = None,
) -> TraceSource:
    """Opens a file by its ending, a data frame, a mapping from names to arrays, a `Trace`, or several of these as one.

    Args:
        time: the name of the time column; without it ``time``, ``t`` or ``timestamp``.
        unit: of the times, such as ``ms``; without it what the file says.
        ports: of a capture of packets, those of Agents.
        run: the number of the one that is meant in a file of several runs; None: `SeveralRuns` stands for all.

    Raises:
        InputError: something in the file is wrong.
        UsageError: it cannot be read, or is not a trace.
    """
    recording = _opened(source, time, unit, ports)
    if run is None and "run" not in recording.columns:
        return recording
    from tachk.recordings.traces.logs.several_runs import one_run

    return one_run(recording, run)


def _opened(source: Any, time: str | None, unit: str | None, ports: Sequence[int]) -> TraceSource:
    from tachk.recordings.traces.trace import Trace
    from tachk.recordings.traces.trace_arrays import open_table

    if isinstance(source, (list, tuple)) and source and not any(isinstance(row, Mapping) for row in source):
        from tachk.recordings.traces.logs.joined import join

        return join([open_trace(each, time, unit, ports) for each in source])
    path = None if isinstance(source, Trace) or not isinstance(source, (str, os.PathLike)) else Path(source)
    if ports and (path is None or path.suffix.lower() not in PACKETS.suffixes):
        raise UsageError(
            "a port says something of captures of packets only", f"these end with {' or '.join(PACKETS.suffixes)}"
        )
    if isinstance(source, Trace):
        return _Ready(source)
    if path is None:
        return open_table(source, time, unit)
    if os.path.isdir(path):  # unlike Path.is_dir false for a name that is too long
        if (path / "metadata.yaml").is_file():
            return BAG.open(path, time, unit)
        return _bag_without_metadata(path, time, unit, ports)
    known = _format_of(path)
    if known is not None:
        return known.open(path, time, unit, ports)
    if path.suffix.lower() == _RUN:
        raise UsageError(
            f"{path} holds the steps of a run, and values only together with its model",
            f"write `tachk replay MODEL {path} --monitor FORMULA`; with -o FILE.csv it writes the values",
        )
    if not path.suffix or not os.path.isfile(path):
        return CSV.open(path, time, unit, ports)
    raise UsageError(f"unknown kind of trace: {path}", f"known endings: {', '.join(TRACE_SUFFIXES)}")


def _bag_without_metadata(path: Path, time: str | None, unit: str | None, ports: Sequence[int]) -> TraceSource:
    """The file of a bag whose recorder was stopped before it wrote `metadata.yaml`. Raises UsageError."""
    parts = sorted(each for suffix in (".mcap", ".db3") for each in path.glob(f"*{suffix}"))
    if not parts:
        raise UsageError(f"{path} is a folder, not a trace", "a bag of ROS 2 is one with metadata.yaml")
    if len(parts) > 1:
        raise UsageError(
            f"{path} is a bag of several files without metadata.yaml", f"make that with: ros2 bag reindex {path}"
        )
    return _opened(parts[0], time, unit, ports)


def _format_of(path: Path) -> TraceFormat | None:
    """By the ending of a file; None for one that is not known. Raises UsageError for what is not read compressed."""
    known = next((each for each in FORMATS if plain_suffix(path) in each.suffixes), None)
    if known is not None and is_compressed(path) and not known.compressed:
        names = [each.name for each in FORMATS if each.compressed]
        raise UsageError(
            f"{path}: {known.name} files are not read compressed", f"decompress it; only {', '.join(names)} are"
        )
    return known
