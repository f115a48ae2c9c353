"""Files that other libraries write and read: MCAP, ROS bags, HDF5, MDF. A test runs where its library is installed."""

from __future__ import annotations

import builtins
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.optional_packages import MissingPackageError
from tachk.recordings.traces.logs import trace_mdf
from tachk.recordings.traces.trace_files import open_trace

SECOND = 10**9
BEGIN = 1_700_000_000 * SECOND


def truths(formulas: list[str], trace: object, **options: Any) -> list[str]:
    return [verdict.truth.word for verdict in tachk.monitor(formulas, trace, **options)]  # type: ignore[arg-type]


def write_mcap(path: Path, events: list[tuple[str, int, object]]) -> Path:
    writer_module = pytest.importorskip("mcap.writer")
    with path.open("wb") as stream:
        writer = writer_module.Writer(stream)
        writer.start()
        schema = writer.register_schema("object", "jsonschema", b'{"type": "object"}')
        topics = dict.fromkeys(topic for topic, _, _ in events)
        channels = {topic: writer.register_channel(topic, "json", schema) for topic in topics}
        for topic, time, content in events:
            data = content if isinstance(content, bytes) else json.dumps(content).encode()
            writer.add_message(channels[topic], log_time=time, publish_time=time - SECOND // 2, data=data)
        writer.finish()
    return path


MESSAGES: list[tuple[str, int, object]] = [
    ("/car/drive", BEGIN, {"speed": 3.0, "mode": "auto", "on": True, "at": {"x": 1, "y": [1, 2]}, "stamp": 10}),
    ("/brake", BEGIN + SECOND, {"force": 0, "stamp": "1970-01-01T00:00:10.25Z"}),
    (
        "/car/drive",
        BEGIN + 2 * SECOND,
        {"speed": 9.5, "mode": "manual", "on": False, "at": {"x": 2, "y": [3, 4]}, "stamp": 12.5},
    ),
    ("/brake", BEGIN + 3 * SECOND, {"force": 2, "stamp": 13}),
    ("/car/drive", BEGIN + 4 * SECOND, {"speed": 1.0, "a.b": 7, "stamp": 14}),
    ("/last", BEGIN + 9 * SECOND, {"x": 1}),
]


def test_fields_of_messages_of_json_are_columns_and_only_those_requested_are_read(tmp_path: Path) -> None:
    path = write_mcap(tmp_path / "log.mcap", [*MESSAGES, ("/image", BEGIN + 5 * SECOND, b"no json")])
    formulas = [
        "G (car.drive.speed > 9 -> F[0, 1 s] brake.force >= 2)",
        'F[2 s, 2 s] (car.drive.mode == "manual" && car.drive.at.y[1] == 4)',
        "G (car.drive.on -> car.drive.at.x == 1)",
        "G[0, 8 s] car.drive.speed < 10",
        "G[0, 8.5 s] car.drive.speed < 10",
    ]
    assert truths(formulas, path) == ["true", "true", "true", "true", "undetermined"]
    trace = open_trace(path).read(["car.drive.speed", "brake.force"])
    assert (trace.origin, trace.unit) == (BEGIN // SECOND + 1, "s")
    assert [float(each) for each in trace.columns["car.drive.speed"]] == [3, 9.5, 9.5, 1, 1]
    assert [float(trace.clock(tick) - trace.origin) for tick in trace.times] == [0, 1, 2, 3, 8]
    assert open_trace(path).read(["car.drive.a.b"]).columns["car.drive.a.b"][0] == 7


def test_the_time_of_a_message_is_when_it_was_recorded_or_sent_or_what_it_says(tmp_path: Path) -> None:
    path = write_mcap(tmp_path / "log.mcap", MESSAGES)
    columns = ["car.drive.speed", "brake.force"]
    assert open_trace(path, time="log_time").read(columns).origin == BEGIN // SECOND + 1
    assert float(open_trace(path, time="publish_time").read(columns).origin) == BEGIN // SECOND + 0.5
    stamped = open_trace(path, time="stamp").read(columns)
    assert [float(stamped.clock(tick)) for tick in stamped.times] == [10.25, 12.5, 13, 14]
    with pytest.raises(UsageError, match="a message of /last has no time 'stamp'"):
        open_trace(path, time="stamp").read(["last.x"])


def test_what_messages_say_of_their_time_may_be_out_of_order(tmp_path: Path) -> None:
    """A message that was recorded later may have been stamped earlier."""
    stamps = [(10, 1), (12, 3), (11, 2), (14, 4)]
    events = [("/a", BEGIN + number * SECOND, {"x": x, "t": stamp}) for number, (stamp, x) in enumerate(stamps)]
    path = write_mcap(tmp_path / "log.mcap", events)
    formulas = ["F[0, 0] x == 1", "F[1 s, 1 s] x == 2", "F[2 s, 2 s] x == 3", "F[4 s, 4 s] x == 4"]
    assert truths([text.replace("x ==", "a.x ==") for text in formulas], path, time="t") == ["true"] * 4


def test_what_is_wrong_in_a_file_of_messages_is_reported(tmp_path: Path) -> None:
    path = write_mcap(tmp_path / "log.mcap", MESSAGES)
    with pytest.raises(UsageError, match="has no column 'car\\.drive\\.sped'") as error:
        open_trace(path).read(["car.drive.sped"])
    assert error.value.help == "did you mean 'car.drive.speed'?"
    with pytest.raises(UsageError, match="are in s, not in ms"):
        open_trace(path, unit="ms")
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(path.read_bytes()[:200])
    with pytest.raises(UsageError, match="is cut off before its first message"):
        open_trace(cut).read(["brake.force"])
    with pytest.raises(UsageError, match="there is no file"):
        open_trace(tmp_path / "none.mcap").read(["brake.force"])
    write_mcap(path, [("/a", BEGIN, {"b.c": 1}), ("/a/b", BEGIN, {"c": 1})])
    with pytest.raises(UsageError, match=r"'a\.b\.c' is a field of both /a and /a/b"):
        open_trace(path).read(["a.b.c"])


def ros_messages(store: Any) -> list[tuple[str, str, int, Any]]:
    types = store.types
    stamps = [types["builtin_interfaces/msg/Time"](sec=5 + number, nanosec=250_000_000) for number in range(3)]
    headers = [types["std_msgs/msg/Header"](stamp=stamp, frame_id="base") for stamp in stamps]
    scan = types["sensor_msgs/msg/LaserScan"]
    scans = [
        scan(header, 0.0, 1.0, 0.1, 0.0, 0.1, 0.0, 9.0, np.array([1, 2 + n], np.float32), np.array([], np.float32))
        for n, header in enumerate(headers)
    ]
    speed = types["std_msgs/msg/Float64"]
    return [
        ("/scan", "sensor_msgs/msg/LaserScan", BEGIN, scans[0]),
        ("/speed", "std_msgs/msg/Float64", BEGIN + SECOND, speed(1.5)),
        ("/scan", "sensor_msgs/msg/LaserScan", BEGIN + 2 * SECOND, scans[1]),
        ("/scan", "sensor_msgs/msg/LaserScan", BEGIN + 3 * SECOND, scans[2]),
    ]


ROS_FORMULAS = [
    "G (scan.ranges[1] >= 2)",
    'G (scan.header.frame_id == "base")',
    "F (scan.ranges[1] == 4 && speed.data == 1.5)",
]


@pytest.mark.parametrize("storage", ["SQLITE3", "MCAP"])
def test_bags_of_ros_2_are_read_from_their_folder(tmp_path: Path, storage: str) -> None:
    pytest.importorskip("rosbags.typesys")
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    messages = ros_messages(store)
    bag = tmp_path / "bag"
    with Writer(bag, version=9, storage_plugin=StoragePlugin[storage]) as writer:
        topics = {topic: kind for topic, kind, _, _ in messages}
        connections = {topic: writer.add_connection(topic, kind, typestore=store) for topic, kind in topics.items()}
        for topic, kind, time, message in messages:
            writer.write(connections[topic], time, store.serialize_cdr(message, kind))
    assert truths(ROS_FORMULAS, bag) == ["true", "true", "true"]
    trace = open_trace(bag).read(["scan.ranges[1]"])
    assert [trace.clock(tick) for tick in trace.times] == [BEGIN // SECOND + second for second in (0, 2, 3)]
    trace = open_trace(bag, time="header.stamp").read(["scan.ranges[1]"])
    assert [float(trace.clock(tick)) for tick in trace.times] == [5.25, 6.25, 7.25]
    if storage == "MCAP":
        pytest.importorskip("mcap.reader")
        (single,) = bag.glob("*.mcap")
        assert truths(ROS_FORMULAS, single) == ["true", "true", "true"]
        assert truths(["F (scan.header.stamp.sec == 7)"], single, time="header.stamp") == ["true"]
    (bag / "metadata.yaml").write_text("{}")
    with pytest.raises(UsageError, match="is not a readable ROS bag"):
        open_trace(bag).read(["scan.ranges[1]"])


def test_bags_of_ros_1_are_read(tmp_path: Path) -> None:
    pytest.importorskip("rosbags.typesys")
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    number = store.types["std_msgs/msg/Int32"]
    bag = tmp_path / "log.bag"
    with Writer(bag) as writer:
        connection = writer.add_connection("/n", "std_msgs/msg/Int32", typestore=store)
        for second in range(3):
            raw = store.serialize_ros1(number(second), "std_msgs/msg/Int32")
            writer.write(connection, BEGIN + second * SECOND, raw)
    assert truths(["G[0, 2 s] n.data <= 2", "F[2 s, 2 s] n.data == 2"], bag) == ["true", "true"]


def test_data_sets_of_hdf5_are_columns_with_the_time_of_their_group(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "log.h5"
    with h5py.File(path, "w") as file:
        file["time"] = np.array([0.0, 0.1, 0.2, 0.4])
        file["time"].attrs["units"] = "s"
        file["speed"] = np.array([1.0, 2.0, np.nan, 4.0])
        file["force"] = np.arange(8.0).reshape(4, 2)
        file["mode"] = np.array([b"auto", b"auto", b"manual", b"manual"])
        file["note"] = ["a", "b", "c", "d"]
        file["pose"] = np.array([(1, True), (2, False), (3, False), (4, True)], dtype=[("x", "i4"), ("ok", "?")])
        file["serial"] = "ABC"
        file["cloud"] = np.zeros((4, 2, 2))
        slow = file.create_group("slow")
        slow["Timestamp"] = np.array([100, 300])
        slow["Timestamp"].attrs["unit"] = b"ms"
        slow["heat"] = np.array([20, 30])
        file["deep/er/same"] = np.array([0, 1, 1, 0])
    recording = open_trace(path)
    assert recording.columns == (
        "force[0]", "force[1]", "mode", "note", "pose.x", "pose.ok", "speed", "deep.er.same", "slow.heat",
    )  # fmt: skip
    formulas = [
        'G (mode == "manual" -> force[1] >= 5 && pose.x >= 3)',
        'F[0.2 s, 0.2 s] (speed == 2 && note == "c" && !pose.ok && deep.er.same)',
        "G (slow.heat > 25 -> speed == 2 || speed == 4)",
    ]
    assert truths(formulas, path) == ["true", "true", "true"]
    trace = recording.read(["speed", "slow.heat"])
    assert [float(trace.clock(tick)) for tick in trace.times] == [0.1, 0.2, 0.3, 0.4]
    assert recording.read(["speed"]).origin == 0
    assert truths(["G (slow.heat < 30)"], path, time="slow/Timestamp") == ["false"]


def test_hdf5_without_times_is_rejected_with_advice(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "log.h5"
    with h5py.File(path, "w") as file:
        file["clock"] = [0, 1]
        file["x"] = [0, 1]
    with pytest.raises(UsageError, match="no data set called time, t or timestamp"):
        open_trace(path)
    assert truths(["F x"], path, time="clock") == ["true"]
    path.write_text("no")
    with pytest.raises(UsageError, match="is not a readable HDF5 file"):
        open_trace(path)


def test_channels_of_mdf_are_columns_and_groups_have_their_own_rates(tmp_path: Path) -> None:
    asammdf = pytest.importorskip("asammdf")
    path = tmp_path / "log.mf4"
    fast = np.arange(5) / 10
    with asammdf.MDF() as file:
        file.append(
            [
                asammdf.Signal(np.array([0, 10, 20, 30, 40], "u2"), fast, name="Speed"),
                asammdf.Signal(np.array([b"P", b"D", b"D", b"R", b"P"]), fast, name="Gear", encoding="utf-8"),
            ]
        )
        file.append([asammdf.Signal(np.array([1.5, 2.5]), np.array([0.15, 0.9]), name="Oil")])
        file.append([asammdf.Signal(np.array([7, 8]), np.array([0.0, 0.5]), name="Speed")])
        file.save(path, overwrite=True)
    recording = open_trace(path)
    assert recording.columns == ("Speed", "Gear", "Oil", "Speed_2")
    formulas = ['G (Gear == "R" -> Speed == 30)', "F[0.5 s, 0.5 s] Speed_2 == 8", "G (Speed < 50)"]
    assert truths(formulas, path) == ["true", "true", "true"]
    trace = recording.read(["Oil", "Speed"])
    assert [float(trace.clock(tick)) for tick in trace.times] == [0.15, 0.2, 0.3, 0.4, 0.9]
    assert float(recording.read(["Speed"]).end) / recording.read(["Speed"]).ticks_per_unit == 0.9
    with pytest.raises(UsageError, match="has no column 'speed'"):
        recording.read(["speed"])
    path.write_text("no")
    with pytest.raises(UsageError, match="is not a readable MDF file"):
        open_trace(path)


@pytest.mark.parametrize(("version", "ending"), [("4.10", "mf4"), ("3.30", "mdf")])
def test_mdf_in_pieces_is_the_same_trace(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, version: str, ending: str
) -> None:
    asammdf = pytest.importorskip("asammdf")
    path = tmp_path / f"log.{ending}"
    times = np.arange(3000) / 100
    with asammdf.MDF(version=version) as file:
        words = np.array([b"P", b"long"])[np.arange(3000) // 1700]
        file.append(
            [
                asammdf.Signal(np.arange(3000) / 7, times, name="Speed"),
                asammdf.Signal(words, times, name="Gear", encoding="utf-8"),
            ]
        )
        file.save(path, overwrite=True, compression=2)
    whole = open_trace(path).read()
    monkeypatch.setattr(trace_mdf, "_PIECE", 1000)
    pieces = open_trace(path).read()
    assert np.array_equal(whole.times, pieces.times)
    assert whole.labels == pieces.labels == ("P", "long")
    assert all(np.array_equal(whole.columns[name], pieces.columns[name]) for name in ("Speed", "Gear"))


def test_a_damaged_mdf_file_has_no_records_behind_its_end(tmp_path: Path) -> None:
    """A compressed block claims to be larger than the file."""
    asammdf = pytest.importorskip("asammdf")
    path = tmp_path / "drive.mf4"
    with asammdf.MDF(version="4.10") as file:
        file.append([asammdf.Signal(np.zeros(2000), np.arange(2000) / 10, name="Speed")])
        file.save(path, compression=2)
    octets = bytearray(path.read_bytes())
    begin = octets.index(b"##DZ")
    octets[begin + 40 : begin + 48] = (1 << 62).to_bytes(8, "little")
    path.write_bytes(octets)
    with pytest.raises(UsageError, match="lies behind the end of the file"):
        open_trace(path).read()


@pytest.mark.parametrize(("version", "ending"), [("4.10", "mf4"), ("3.30", "mdf")])
def test_a_damaged_mdf_file_does_not_make_its_reader_read_other_memory(
    tmp_path: Path, version: str, ending: str
) -> None:
    asammdf = pytest.importorskip("asammdf")
    path = tmp_path / f"log.{ending}"
    with asammdf.MDF(version=version) as file:
        file.append([asammdf.Signal(np.arange(5), np.arange(5) / 10, name="Speed")])
        file.save(path, overwrite=True)
    assert open_trace(path).read().rows == 5
    with asammdf.MDF(path) as file:
        channel = file.groups[0].channels[1]
        offset = 24 + 8 * getattr(channel, "links_nr", 0) + 4 if ending == "mf4" else 186  # of its place in a record
        address = channel.address
    octets = bytearray(path.read_bytes())
    octets[address + offset : address + offset + 2] = b"\x00\x7f"
    path.write_bytes(octets)
    with pytest.raises(UsageError, match="channel 'Speed' lies behind the end of its records"):
        open_trace(path)


@pytest.mark.parametrize(
    ("file", "library", "extra"),
    [("a.mcap", "mcap", "mcap"), ("a.bag", "rosbags", "mcap"), ("a.h5", "h5py", "hdf5"), ("a.mf4", "asammdf", "mdf")],
)
def test_without_the_library_the_message_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, file: str, library: str, extra: str
) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any, **more: Any) -> Any:
        if name.split(".")[0] == library:
            raise ModuleNotFoundError(name, name=library)
        return real(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(MissingPackageError, match=f"^{library} is not installed; ") as error:
        open_trace(tmp_path / file)
    assert error.value.help == f'pip install "tachk[{extra}]"'
