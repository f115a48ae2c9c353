"""Values that a file has names for are written and reported by these names."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError
from tachk.recordings.traces.logs.named_values import enumerations
from tachk.recordings.traces.trace_files import open_trace
from tachk.report.monitor.html import monitor_to_html
from tachk.report.monitor.json import monitor_to_json

SECOND = 10**9


@pytest.fixture
def hdf5(tmp_path: Path) -> Path:
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        kind = h5py.enum_dtype({"OFF": -1, "SLOW": 0, "NORMAL": 1, "FAST": 2}, basetype="i1")
        for group in ("left", "right"):
            file[f"{group}/time"] = np.array([0.0, 1.0, 2.0])
            file.create_dataset(f"{group}/mode", data=np.array([0, 2, -1], "i1"), dtype=kind)
        file["left/gear"] = np.array([0, 2, 1])
    return path


def seen(report: Any) -> list[str]:
    """What stands in the reports; text and JSON say the same."""
    text = [line.strip().partition(": ")[2] for line in str(report).splitlines() if " seen at " in line]
    verdicts: Any = json.loads(json.dumps(monitor_to_json(report.record)))["results"]
    lines = [line for each in verdicts for line in (each["finding"] or {"explanation": []})["explanation"]]
    assert text == [line.partition(": ")[2] for line in lines if line.startswith("seen at ")]
    return text


def test_enumerations_of_hdf5_in_findings(hdf5: Path) -> None:
    report = tachk.monitor(["G left.mode == SLOW", "G (left.gear < 2)", "G (right.mode != OFF)"], hdf5)
    assert [verdict.truth.word for verdict in report] == ["false"] * 3
    assert seen(report) == ["left.mode = FAST", "left.gear = 2", "right.mode = OFF"]
    assert "`left.mode == SLOW` is false at 1" in str(report)
    assert "left.mode = FAST" in monitor_to_html(report.record)


def test_enumerations_of_hdf5_as_texts(hdf5: Path) -> None:
    formulas = ['F[1, 1] left.mode == "FAST"', 'G ("OFF" != right.mode)', "F left.mode == right.mode"]
    report = tachk.monitor([*formulas, "F left.mode < SLOW"], hdf5)
    assert [verdict.truth.word for verdict in report] == ["true", "false", "true", "true"]
    assert report[0].formula == 'F[1, 1] (left.mode == "FAST")'
    with pytest.raises(InputError, match=r'`left.mode` has no value that is called "FASR"') as error:
        tachk.monitor('G (left.mode == "FASR")', hdf5)
    assert error.value.diagnostics[0].help == "did you mean `FAST`?"


def test_names_within_formulas_that_others_name(hdf5: Path, tmp_path: Path) -> None:
    file = tmp_path / "a.stl"
    file.write_text('slow: left.mode == SLOW\nfast: left.mode == "FAST"\nq: G (slow || fast)\n')
    report = tachk.monitor(file, hdf5)
    assert report["q"].truth.word == "false"
    assert "left.mode = OFF" in seen(report)


def test_mining_with_names_of_values(hdf5: Path) -> None:
    assert tachk.mine("G (left.gear <= X || left.mode == OFF)", hdf5, over={"X": (0, 5)}).value == 2


def ros_log(path: Path, text: str, messages: list[dict[str, Any]]) -> Path:
    writers, typesys = pytest.importorskip("mcap.writer"), pytest.importorskip("rosbags.typesys")
    store = typesys.get_typestore(typesys.Stores.EMPTY)
    store.register(typesys.get_types_from_msg(text, "x/msg/Status"))
    with path.open("wb") as stream:
        writer = writers.Writer(stream)
        writer.start()
        schema = writer.register_schema("x/msg/Status", "ros2msg", text.encode())
        channel = writer.register_channel("/status", "cdr", schema)
        for number, content in enumerate(messages):
            values = {**content, "inner": [store.types["x/msg/Inner"](b=each) for each in content["inner"]]}
            message = store.types["x/msg/Status"](**values)
            data = bytes(store.serialize_cdr(message, "x/msg/Status"))
            writer.add_message(channel, log_time=number * SECOND, publish_time=0, data=data)
        writer.finish()
    return path


STATUS = f"""uint8 OK=0
uint8 ERROR=2
int16 STATE_RUNNING=1
int16 STATE_HELD=2
int16 OTHER=7
float32 LIMIT=0.5
int32 ADD=0
int32 MODIFY=0
int32 DELETE=2
int16 state
int16 state_before
uint8 level
int32 action
float32 x
x/Inner[] inner
{80 * "="}
MSG: x/Inner
byte LOW=3
byte b
"""


@pytest.fixture
def ros(tmp_path: Path) -> Path:
    first = {"state": 1, "state_before": 2, "level": 0, "action": 2, "x": 0.25, "inner": [3, 4]}
    return ros_log(tmp_path / "a.mcap", STATUS, [first, {**first, "state": 2, "level": 2, "action": 0, "x": 1.0}])


def test_constants_of_ros_in_findings(ros: Path) -> None:
    names = ("state", "state_before", "level", "action", "inner[1].b", "x")
    found = enumerations(open_trace(ros), [f"status.{name}" for name in names])
    running = {"STATE_RUNNING": 1, "STATE_HELD": 2}
    assert found == {
        "status.state": running,
        "status.level": {"OK": 0, "ERROR": 2},
        "status.action": {"ADD": 0, "MODIFY": 0, "DELETE": 2},
        "status.inner[1].b": {"LOW": 3},
    }
    formulas = [
        "G status.state == STATE_RUNNING",
        'G (status.level == "OK")',
        "G status.action == DELETE",
        "G (status.inner[0].b != LOW)",
        "G (status.state_before == STATE_RUNNING)",
        "G (status.x < LIMIT)",
    ]
    report = tachk.monitor(formulas, ros)
    assert [verdict.truth.word for verdict in report] == ["false"] * 6
    assert seen(report) == [
        "status.state = STATE_HELD",
        "status.level = ERROR",
        "status.action = 0",  # has two names
        "status.inner[0].b = LOW",
        "status.state_before = 2",  # nobody says that it is a state
        "status.x = 1",
    ]


def test_column_that_formulas_compare_with_constants(tmp_path: Path) -> None:
    text = "int32 ARROW=0\nint32 CUBE=1\nint32 ADD=0\nint32 type\nint32 action\nx/Inner[] inner\n"
    text += f"{80 * '='}\nMSG: x/Inner\nbyte b\n"
    log = ros_log(tmp_path / "a.mcap", text, [{"type": n, "action": 0, "inner": []} for n in (0, 1)])
    report = tachk.monitor(["G (status.type == ARROW)", "G (status.type != CUBE)", "G (status.action != ADD)"], log)
    assert seen(report) == ["status.type = CUBE", "status.type = CUBE", "status.action = ADD"]


def test_enumerations_of_protocol_buffers(tmp_path: Path) -> None:
    writers = pytest.importorskip("mcap_protobuf.writer")
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    file: Any = descriptor_pb2.FileDescriptorProto(name="s.proto", package="s", syntax="proto3")
    enum = file.enum_type.add(name="Mode")
    for number, name in enumerate(("SLOW", "FAST")):
        enum.value.add(name=name, number=number)
    kind = file.message_type.add(name="State")
    kind.field.add(name="mode", number=2, type=14, type_name=".s.Mode", label=1)
    kind.field.add(name="next", number=3, type=11, type_name=".s.State", label=1)
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    state = message_factory.GetMessageClass(pool.FindMessageTypeByName("s.State"))
    path = tmp_path / "a.mcap"
    with path.open("wb") as stream, writers.Writer(stream) as writer:
        for number in range(3):
            message = state(mode=number % 2, next=state(mode=1))
            writer.write_message("/state", message, log_time=number * SECOND, publish_time=0)
    formulas = ["F[1 s, 1 s] state.mode == FAST", 'G (state.next.mode == "FAST")', "G (state.mode != state.mode.SLOW)"]
    report = tachk.monitor(formulas, path)
    assert [verdict.truth.word for verdict in report] == ["true", "true", "false"]
    assert seen(report) == ['state.mode = "SLOW"']


def test_constants_in_bags(tmp_path: Path) -> None:
    pytest.importorskip("rosbags.typesys")
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg("uint8 OK=0\nuint8 ERROR=2\nuint8 level\n", "x/msg/Status"))
    with Writer(tmp_path / "bag", version=9) as writer:
        connection = writer.add_connection("/status", "x/msg/Status", typestore=store)
        for number, level in enumerate((0, 2, 0)):
            message = store.types["x/msg/Status"](level=level)
            writer.write(connection, number * SECOND, store.serialize_cdr(message, "x/msg/Status"))
    report = tachk.monitor(['G (status.level != "ERROR")', "G (status.level < 1)"], tmp_path / "bag")
    assert seen(report) == ["status.level = ERROR", "status.level = ERROR"]
