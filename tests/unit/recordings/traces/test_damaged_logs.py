"""Logs as robots leave them: cut off by a crash, recorded before a clock was set, compressed, with infinite values."""

import gzip
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.recordings.traces.logs.joined import with_decimals
from tachk.recordings.traces.trace_files import open_trace
from tachk.recordings.traces.trace_vcd import open_vcd

SECOND = 10**9
BEGIN = 1_764_000_000 * SECOND


def mcap_file(path: Path, times: list[int], compression: str = "NONE", chunked: bool = True) -> Path:
    writers = pytest.importorskip("mcap.writer")
    with path.open("wb") as stream:
        writer = writers.Writer(stream, compression=writers.CompressionType[compression], use_chunking=chunked)
        writer.start()
        schema = writer.register_schema("object", "jsonschema", b"{}")
        channel = writer.register_channel("/a", "json", schema)
        for number, time in enumerate(times):
            writer.add_message(channel, log_time=time, publish_time=0, data=json.dumps({"x": number}).encode())
        writer.finish()
    return path


@pytest.mark.parametrize("compression", ["NONE", "ZSTD", "LZ4"])
@pytest.mark.parametrize("chunked", [True, False])
def test_mcap_without_its_end(tmp_path: Path, compression: str, chunked: bool) -> None:
    times = [BEGIN + number * SECOND for number in range(40)]
    content = mcap_file(tmp_path / "a.mcap", times, compression, chunked).read_bytes()
    cut = tmp_path / "cut.mcap"
    most = 0
    for size in range(150, len(content), 97):
        cut.write_bytes(content[:size])
        try:
            trace = open_trace(cut).read(["a.x"])
        except UsageError:
            continue  # nothing is there yet
        assert trace.columns["a.x"].tolist() == list(range(trace.rows))
        assert trace.warnings == (f"{cut} is cut off: what follows its last whole message is left out",)
        most = max(most, trace.rows)
    assert most == 40
    assert open_trace(tmp_path / "a.mcap").read(["a.x"]).warnings == ()


def test_zeros_behind_the_last_message(tmp_path: Path) -> None:
    content = mcap_file(tmp_path / "a.mcap", [BEGIN, BEGIN + SECOND], chunked=False).read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(content[: content.rindex(b'{"x": 1}') + 8] + bytes(4096))
    assert open_trace(cut).read(["a.x"]).columns["a.x"].tolist() == [0, 1]


def test_a_bag_without_metadata(tmp_path: Path) -> None:
    bag = tmp_path / "bag"
    bag.mkdir()
    with pytest.raises(UsageError, match="is a folder, not a trace"):
        open_trace(bag)
    mcap_file(bag / "bag_0.mcap", [BEGIN, BEGIN + SECOND])
    assert open_trace(bag).read(["a.x"]).rows == 2
    mcap_file(bag / "bag_1.mcap", [BEGIN])
    with pytest.raises(UsageError, match="several files") as error:
        open_trace(bag)
    assert "ros2 bag reindex" in (error.value.help or "")


def test_times_of_messages_beyond_what_can_be_counted(tmp_path: Path) -> None:
    path = mcap_file(tmp_path / "a.mcap", [BEGIN, BEGIN + SECOND, 2**64 - 1])
    with pytest.raises(UsageError, match="message 3 of /a is at 18446744073709551615 ns"):
        open_trace(path).read(["a.x"])
    path = mcap_file(tmp_path / "b.mcap", [0, BEGIN, BEGIN + SECOND])
    with pytest.raises(UsageError, match="row 0 is at 1970-01-01T00:00:00Z, row 1 at 2025-11-24T16:00:00Z") as error:
        tachk.monitor("G (a.x < 6)", path)
    assert "--decimals" in (error.value.help or "")
    assert tachk.monitor("G (a.x < 6)", path, decimals=3).truth is tachk.Truth.TRUE


@pytest.mark.parametrize(
    ("name", "text", "rows"),
    [
        ("a.csv", "time,x,y\n0,1,2\n1,2,3\n2,", 2),
        ("a.csv", "time,x\n0,1\n1,2\n2,3e", 2),
        ("a.csv", 'time,s\n0,1\n1,2\n1.5,"ab', 2),
        ("a.jsonl", '{"t": 0, "x": 1}\n{"t": 1, "x": 2}\n{"t": 2, "x', 2),
    ],
)
def test_a_half_written_last_line(tmp_path: Path, name: str, text: str, rows: int) -> None:
    path = tmp_path / name
    path.write_text(text)
    report = tachk.monitor("G true" if "s\n" in text[:7] else "G (x < 9)", path)
    assert report.record.trace.rows == rows
    number = len(text.splitlines())
    assert report.to_dict()["notes"] == [f"{path} is cut off: line {number}, which is half written, is left out"]
    path.write_text(text + "\n")
    with pytest.raises(InputError):
        tachk.monitor("G (x < 9)", path)


@pytest.mark.parametrize("name", ["a.csv", "a.jsonl", "a.vcd"])
def test_compressed_and_torn(tmp_path: Path, name: str) -> None:
    text = {
        "a.csv": "time,x\n" + "".join(f"{n},{n * 7919 % 1013}\n" for n in range(3000)),
        "a.jsonl": "".join(f'{{"t": {n}, "x": {n * 7919 % 1013}}}\n' for n in range(3000)),
        "a.vcd": "$timescale 1 s $end $var integer 32 ! x $end $enddefinitions $end\n"
        + "".join(f"#{n}\nb{n * 7919 % 1013:b} !\n" for n in range(3000)),
    }[name]
    (tmp_path / name).write_text(text)
    packed = tmp_path / f"{name}.gz"
    packed.write_bytes(gzip.compress(text.encode()))
    plain, same = (open_trace(path).read(["x"]) for path in (tmp_path / name, packed))
    assert (plain.columns["x"] == same.columns["x"]).all()
    assert not same.warnings
    packed.write_bytes(packed.read_bytes()[: packed.stat().st_size // 2])
    torn = open_trace(packed).read(["x"])
    assert 0 < torn.rows < 3000
    assert (torn.columns["x"][:-1] == plain.columns["x"][: torn.rows - 1]).all()
    assert "is cut off" in torn.warnings[0]


def test_zstandard(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    zstandard = pytest.importorskip("zstandard")
    path = tmp_path / "a.csv.zst"
    path.write_bytes(zstandard.compress(b"time,x\n0,1\n1,2\n"))
    assert open_trace(path).read().rows == 2
    inner = mcap_file(tmp_path / "a.mcap", [BEGIN, BEGIN + SECOND])
    (tmp_path / "b.mcap.zst").write_bytes(zstandard.compress(inner.read_bytes()))
    assert open_trace(tmp_path / "b.mcap.zst").read(["a.x"]).rows == 2
    monkeypatch.setitem(sys.modules, "zstandard", None)
    monkeypatch.setitem(sys.modules, "compression.zstd", None)
    with pytest.raises(UsageError) as error:
        open_trace(path)
    assert error.value.help == "pip install zstandard"


def test_what_is_not_read_compressed(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="HDF5 files are not read compressed"):
        open_trace(tmp_path / "a.h5.gz")


def test_parquet_that_is_cut_off(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    arrow = pytest.importorskip("pyarrow")
    path = tmp_path / "a.parquet"
    parquet.write_table(arrow.table({"time": [0, 1], "x": [1.0, 2.0]}), path)
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.raises(UsageError, match="is cut off: a Parquet file says at its end"):
        open_trace(path)


def test_a_capture_that_is_cut_off(tmp_path: Path) -> None:
    source = Path(__file__).parents[3] / "data" / "captures"
    whole = next(path for path in sorted(source.glob("*.pcap")) if open_trace(path).columns)
    path = tmp_path / "a.pcap"
    path.write_bytes(whole.read_bytes()[:-5])
    trace = open_trace(path).read([])
    assert "is cut off: the file ends inside packet" in trace.warnings[0]
    assert trace.rows == open_trace(whole).read([]).rows - 1


@pytest.mark.parametrize("word", ["inf", "+inf", "Infinity", "-inf", "-Infinity", "INF"])
def test_infinite_values(tmp_path: Path, word: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(f"time,x\n0,3\n1,{word}\n2,4\n")
    assert open_trace(path).read().columns["x"].tolist() == [3, float(word), 4]
    lines = tmp_path / "a.jsonl"
    written = "-Infinity" if "-" in word else "Infinity"
    lines.write_text(f'{{"t": 0, "x": 3}}\n{{"t": 1, "x": {written}}}\n{{"t": 2, "x": NaN}}\n')
    assert open_trace(lines).read().columns["x"].tolist() == [3, float(word), float(word)]
    dump = tmp_path / "a.vcd"
    dump.write_text(f"$timescale 1 s $end $var real 64 ! x $end $enddefinitions $end\n#0\nr3 !\n#1\nr{word} !\n#2\n")
    assert open_trace(dump).read().columns["x"].tolist() == [3, float(word), float(word)]


@pytest.mark.parametrize(
    ("told", "separator"),
    [
        ('"sep=\t"', "\t"),
        ("sep=\t", "\t"),
        (r"sep=\t", "\t"),
        ('"sep=;"', ";"),
        ("sep=;", ";"),
        ('"sep=;";', ";"),
        ("SEP=,", ","),
    ],
)
def test_the_line_that_gives_a_spreadsheet_its_separator(tmp_path: Path, told: str, separator: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(f"{told}\r\n" + "".join(f"{a}{separator}{b}\r\n" for a, b in (("time", "x"), (0, 1), (2, 3))))
    assert open_trace(path).read().columns["x"].tolist() == [1, 3]


def test_what_is_no_csv_is_named(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    for content, message in (
        (b'{"time": 0, "x": 1}\n', "has JSON"),
        (gzip.compress(b"time,x\n"), "compressed by gzip"),
    ):
        path.write_bytes(content)
        with pytest.raises(UsageError, match=message):
            open_trace(path)


def test_spreadsheets(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("sep=;\ntime;x\n0;1,5\n0,5;-2,25\n")
    trace = open_trace(path).read()
    assert (trace.columns["x"].tolist(), [float(trace.clock(int(tick))) for tick in trace.times]) == (
        [1.5, -2.25],
        [0, 0.5],
    )
    path.write_text("time;x\n0;1,000\n1;12,345\n")  # thousands, or decimals: nobody can tell
    with pytest.raises(InputError):
        open_trace(path).read()


def test_empty_cells_before_the_first_value(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time,x,y\n0,,5\n1,2,\n2,3,1\n")
    trace = open_trace(path).read()
    assert (trace.origin, trace.columns["x"].tolist(), trace.columns["y"].tolist()) == (1, [2, 3], [5, 1])
    assert open_trace(path).read(["y"]).origin == 0
    path.write_text("time,x\n0,\n")
    with pytest.raises(UsageError, match="column 'x' never has a value"):
        open_trace(path).read()


@pytest.mark.parametrize(
    "text",
    [
        "$timescale 1ms $end $var wire 1 ! p $end $enddefinitions $end #0 1! #" + 4301 * "9",
        "$timescale " + 4301 * "1" + "ms $end $var wire 1 ! p $end $enddefinitions $end #0 1!",
        "$timescale 1ms $end $var wire " + 4301 * "1" + " ! p $end $enddefinitions $end #0 1!",
        "$timescale 1ms $end $var wire 1 ! p[" + 4301 * "1" + "] $end $enddefinitions $end #0 1!",
    ],
)
def test_numbers_of_many_digits_in_dumps(tmp_path: Path, text: str) -> None:
    path = tmp_path / "a.vcd"
    path.write_text(text)
    with pytest.raises(InputError) as error:
        open_vcd(path).read()
    assert error.value.diagnostics[0].code == "E0917"


@pytest.mark.parametrize("time", ["1" + 5000 * "0", "1e999999999", "1e-999999999"])
def test_numbers_of_many_digits_in_lines(tmp_path: Path, time: str) -> None:
    path = tmp_path / "a.jsonl"
    path.write_text(f'{{"t": {time}, "x": 1}}\n{{"t": 2, "x": 1}}\n')
    with pytest.raises(InputError):
        open_trace(path)
    path.write_text(f'{{"t": 0, "x": {5000 * "1"}}}\n')
    with pytest.raises(InputError):
        open_trace(path)


def test_constants_of_messages_by_name(tmp_path: Path) -> None:
    writers = pytest.importorskip("mcap.writer")
    typesys = pytest.importorskip("rosbags.typesys")
    text = "uint8 OK=0\nuint8 ERROR=2\nstring NAME=abc\nuint8 level\nstring name\n"
    store = typesys.get_typestore(typesys.Stores.EMPTY)
    store.register(typesys.get_types_from_msg(text, "x/msg/Status"))
    path = tmp_path / "a.mcap"
    with path.open("wb") as stream:
        writer = writers.Writer(stream)
        writer.start()
        schema = writer.register_schema("x/msg/Status", "ros2msg", text.encode())
        channel = writer.register_channel("/status", "cdr", schema)
        for number, level in enumerate((0, 2, 0)):
            data = bytes(store.serialize_cdr(store.types["x/msg/Status"](level=level, name="abc"), "x/msg/Status"))
            writer.add_message(channel, log_time=BEGIN + number * SECOND, publish_time=0, data=data)
        writer.finish()
    formulas = ["F[1 s, 1 s] status.level == ERROR", "G (status.level != status.OK)", "G (status.name == NAME)"]
    report = tachk.monitor(formulas, path)
    assert [verdict.truth.word for verdict in report] == ["true", "false", "true"]
    assert "ERROR" in report[0].formula


def test_enumerations_of_hdf5_by_name(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["time"] = np.array([0.0, 1.0, 2.0])
        kind = h5py.enum_dtype({"SLOW": 0, "NORMAL": 1, "FAST": 2}, basetype="u1")
        file.create_dataset("mode", data=np.array([0, 2, 1], "u1"), dtype=kind)
    report = tachk.monitor(["F mode == FAST", "G (mode <= mode.NORMAL)", "G (mode < 3)"], path)
    assert [verdict.truth.word for verdict in report] == ["true", "false", "true"]


def test_protocol_buffers(tmp_path: Path) -> None:
    writers = pytest.importorskip("mcap_protobuf.writer")
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    file: Any = descriptor_pb2.FileDescriptorProto(name="s.proto", package="s", syntax="proto3")
    enum = file.enum_type.add(name="Mode")
    for number, name in enumerate(("SLOW", "FAST")):
        enum.value.add(name=name, number=number)
    kind = file.message_type.add(name="State")
    kind.field.add(name="speed", number=1, type=1, label=1)
    kind.field.add(name="mode", number=2, type=14, type_name=".s.Mode", label=1)
    kind.field.add(name="parts", number=3, type=5, label=3)
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    state = message_factory.GetMessageClass(pool.FindMessageTypeByName("s.State"))
    path = tmp_path / "a.mcap"
    with path.open("wb") as stream, writers.Writer(stream) as writer:
        for number in range(3):
            message = state(speed=number * 1.5, mode=number % 2, parts=[number, 7])
            writer.write_message("/state", message, log_time=BEGIN + number * SECOND, publish_time=0)
    formulas = ["G (state.speed <= 3)", 'F[1 s, 1 s] state.mode == "FAST"', "G (state.parts[1] == 7)"]
    assert [verdict.truth.word for verdict in tachk.monitor(formulas, path)] == ["true", "true", "true"]


def test_whole_traces_with_decimals_of_any_format(tmp_path: Path) -> None:
    trace = with_decimals(open_trace({"time": [0.25, 1.26], "x": [1, 2]}), 1).read()
    assert [float(trace.clock(int(tick))) for tick in trace.times] == [0.3, 1.3]


def test_a_dump_that_ends_in_a_name(tmp_path: Path) -> None:
    path = tmp_path / "a.vcd"
    for text in ("$var wire 1 ! p", "$scope module a", "$timescale 1", "$var wire 1 !", "$comment a"):
        path.write_text(text)
        with pytest.raises(InputError):
            open_vcd(path)


def test_records_that_claim_to_be_long(tmp_path: Path) -> None:
    content = bytearray(mcap_file(tmp_path / "a.mcap", [BEGIN, BEGIN + SECOND], chunked=False).read_bytes())
    name = content.index(b"jsonschema") - 4
    content[name : name + 4] = b"\xff\xff\xff\xff"
    (tmp_path / "b.mcap").write_bytes(content)
    with pytest.raises(UsageError):
        open_trace(tmp_path / "b.mcap").read(["a.y"])
