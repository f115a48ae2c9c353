"""Files that end too early: what is there is read, with a warning and no wrong value, or the file is refused."""

from __future__ import annotations

import gzip
import io
import json
from collections.abc import Callable
from pathlib import Path
from random import Random

import numpy as np
import pytest
from click.testing import CliRunner

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.cli.main import app
from tachk.recordings.traces.trace_files import open_trace

COUNT = 30
CUTS = 12
VALUES = [number + 1.0 for number in range(COUNT)]
CAPTURE = Path(__file__).parents[3] / "data/captures/full_window.pcap"


def mcap(folder: Path) -> bytes:
    writers = pytest.importorskip("mcap.writer")
    out = io.BytesIO()
    writer = writers.Writer(out, compression=writers.CompressionType.ZSTD, chunk_size=200)
    writer.start()
    channel = writer.register_channel("/a", "json", writer.register_schema("o", "jsonschema", b"{}"))
    for number, value in enumerate(VALUES):
        writer.add_message(channel, log_time=number * 10**9, publish_time=0, data=json.dumps({"x": value}).encode())
    writer.finish()
    return out.getvalue()


def parquet(folder: Path) -> bytes:
    pyarrow, files = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    out = io.BytesIO()
    files.write_table(pyarrow.table({"time": list(range(COUNT)), "a.x": VALUES}), out, row_group_size=7)
    return out.getvalue()


def hdf5(folder: Path) -> bytes:
    h5py = pytest.importorskip("h5py")
    out = io.BytesIO()
    with h5py.File(out, "w") as file:
        for name, values in (("a/time", np.arange(COUNT)), ("a/x", np.array(VALUES))):
            file.create_dataset(name, data=values, chunks=(7,), compression="gzip")
    return out.getvalue()


def mdf(folder: Path) -> bytes:
    asammdf = pytest.importorskip("asammdf")
    with asammdf.MDF(version="4.10") as file:
        file.append([asammdf.Signal(np.array(VALUES), np.arange(COUNT) * 1.0, name="a.x")])
        file.save(folder / "whole.mf4")
    return (folder / "whole.mf4").read_bytes()


def bag(folder: Path) -> bytes:
    rosbag, typesys = pytest.importorskip("rosbags.rosbag1"), pytest.importorskip("rosbags.typesys")
    store = typesys.get_typestore(typesys.Stores.ROS1_NOETIC)
    kind = store.types["geometry_msgs/msg/Point"]
    with rosbag.Writer(folder / "whole.bag") as writer:
        connection = writer.add_connection("/a", kind.__msgtype__, typestore=store)
        for number, value in enumerate(VALUES):
            writer.write(connection, number * 10**9, store.serialize_ros1(kind(value, 0.0, 0.0), kind.__msgtype__))
    return (folder / "whole.bag").read_bytes()


def database(folder: Path) -> bytes:
    """A bag of ROS 2 in SQLite."""
    rosbag, typesys = pytest.importorskip("rosbags.rosbag2"), pytest.importorskip("rosbags.typesys")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    kind = store.types["geometry_msgs/msg/Point"]
    with rosbag.Writer(folder / "bag", version=8) as writer:
        connection = writer.add_connection("/a", kind.__msgtype__, typestore=store)
        for number, value in enumerate(VALUES):
            writer.write(connection, number * 10**9, store.serialize_cdr(kind(value, 0.0, 0.0), kind.__msgtype__))
    return next((folder / "bag").glob("*.db3")).read_bytes()


def table() -> bytes:
    return ("time,a.x\n" + "".join(f"{number},{value}\n" for number, value in enumerate(VALUES))).encode()


def dump() -> bytes:
    changes = "".join(f"#{number}\nr{value} !\n" for number, value in enumerate(VALUES))
    return f"$timescale 1 s $end\n$var real 64 ! a.x $end\n$enddefinitions $end\n{changes}".encode()


def by_gzip(data: bytes) -> bytes:
    return gzip.compress(data, 0)  # stored, so that parts of it can be read


KINDS: dict[str, Callable[[Path], bytes]] = {
    "a.mcap": mcap,
    "a.parquet": parquet,
    "a.h5": hdf5,
    "a.mf4": mdf,
    "a.bag": bag,
    "a.db3": database,
    "a.csv.gz": lambda _: by_gzip(table()),
    "a.vcd.gz": lambda _: by_gzip(dump()),
    "a.mcap.gz": lambda folder: by_gzip(mcap(folder)),
}
PARTLY_READ = ("a.mcap", "a.csv.gz", "a.vcd.gz", "a.mcap.gz")


@pytest.mark.parametrize("name", KINDS)
def test_a_file_that_is_cut_anywhere(name: str, tmp_path: Path) -> None:
    content, path = KINDS[name](tmp_path), tmp_path / name
    path.write_bytes(content)
    whole = open_trace(path).read(["a.x"])
    assert (whole.columns["a.x"].tolist(), whole.warnings) == (VALUES, ())
    read = 0
    for size in sorted({*Random(name).sample(range(len(content)), CUTS), 0, 1, len(content) - 1}):
        path.write_bytes(content[:size])
        try:
            trace = open_trace(path).read(["a.x"])
        except (UsageError, InputError):
            continue
        read += 1
        assert trace.columns["a.x"].tolist() == VALUES[: trace.rows], size
        assert trace.times.tolist() == whole.times.tolist()[: trace.rows], size
        assert trace.warnings or trace.rows == COUNT, size  # the checksum behind all rows may be missing
    assert (read > CUTS // 3) == (name in PARTLY_READ)


@pytest.mark.parametrize("name", KINDS)
def test_the_command_rejects_what_it_cannot_read(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(KINDS[name](tmp_path)[:25])
    result = CliRunner().invoke(app, ["monitor", "G (a.x > 0)", str(path)])
    assert (result.exit_code, "error" in result.output) == (2, True)


def test_a_capture_that_is_cut_anywhere(tmp_path: Path) -> None:
    content, path = CAPTURE.read_bytes(), tmp_path / "a.pcap"
    whole = open_trace(CAPTURE)
    names = [name for name in whole.columns if name.endswith(".sent")]
    expected = whole.read(names)
    for size in Random(1).sample(range(200, len(content)), CUTS):
        path.write_bytes(content[:size])
        known = open_trace(path)
        trace = known.read([name for name in names if name in known.columns])
        assert trace.packets is not None
        assert expected.packets is not None
        assert trace.packets.tolist() == expected.packets.tolist()[: trace.rows]
        for name, values in trace.columns.items():
            assert values.tolist() == expected.columns[name].tolist()[: trace.rows]


def test_zstandard_that_ends_between_two_blocks(tmp_path: Path) -> None:
    zstandard = pytest.importorskip("zstandard")
    rows = [f"{number},{number * 7919 % 1000003}\n" for number in range(40000)]
    packed = zstandard.compress(("time,x\n" + "".join(rows)).encode())
    path = tmp_path / "a.csv.zst"
    path.write_bytes(packed + zstandard.compress(b"40000,1\n"))
    assert open_trace(path).read(["x"]).rows == 40001
    refused, read = 0, 0
    for size in range(0, len(packed), len(packed) // 9):
        path.write_bytes(packed[:size])
        try:
            trace = open_trace(path).read(["x"])
        except UsageError:
            refused += 1
            continue
        assert trace.warnings
        assert trace.columns["x"].tolist() == [number * 7919 % 1000003 for number in range(trace.rows)]
        read += 1
    assert min(refused, read) > 1


def test_the_last_instant_of_a_dump_that_is_cut_off_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "a.vcd"
    head = "$timescale 1 s $end\n$var wire 1 ! a $end\n$var wire 1 ab b $end\n$enddefinitions $end\n"
    path.write_text(f"{head}#0\n0!\n0ab\n#5\n#7\n1!\n1a")
    trace = open_trace(path).read()
    assert (trace.times.tolist(), trace.columns["a"].tolist()) == ([0, 5], [0, 0])
    assert trace.warnings
    assert tachk.monitor("G (a == b)", path).truth is tachk.Truth.TRUE  # at 7 `b` may have changed, too
    path.write_text(f"{head}#0\n0!\n0ab\n#5\n#7\n1!\n1ab\n#")
    assert open_trace(path).read().columns["a"].tolist() == [0, 1]
