"""Numbers of messages of ROS 2 are read at the places that earlier messages have shown."""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rosbags")

from rosbags.typesys import Stores, get_typestore

from tachk.recordings.traces.logs.cdr_layouts import CdrPicker
from tachk.recordings.traces.logs.message_fields import Picker

TYPE = "geometry_msgs/msg/PointStamped"
STORE = get_typestore(Stores.ROS2_HUMBLE)


def octets(second: int, frame: str, y: float) -> bytes:
    types = STORE.types
    header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](second, 0), frame)
    point = types["geometry_msgs/msg/Point"](0.0, y, 1.0)
    return bytes(STORE.serialize_cdr(types[TYPE](header, point), TYPE))


def test_a_message_of_each_layout_is_read_whole() -> None:
    whole: list[bytes] = []

    def read(data: bytes) -> Any:
        whole.append(data)
        return STORE.deserialize_cdr(data, TYPE)

    wanted = Picker("p", ["p.point.y", "p.header.frame_id", "p.header.stamp.sec", "p.point.none"])
    pick = CdrPicker(read, wanted, wanted.paths, STORE, TYPE)
    for frame in ("base", "lidar", "base"):
        for second in range(20):
            assert pick(octets(second, frame, second / 2)) == (second / 2, frame, second, None)
    assert len(whole) < 30


def test_a_damaged_message_is_not_read() -> None:
    wanted = Picker("p", ["p.point.y"])
    pick = CdrPicker(lambda data: STORE.deserialize_cdr(data, TYPE), wanted, wanted.paths, STORE, TYPE)
    pick(octets(1, "base", 2.0))
    with pytest.raises(Exception, match=r"CDR message size mismatch|Could not deserialize"):
        pick(octets(1, "base", 2.0)[:-8])
    damaged = bytearray(octets(1, "base", 2.0))
    damaged[12] = 200
    with pytest.raises(Exception, match="Invalid string length"):
        pick(bytes(damaged))
