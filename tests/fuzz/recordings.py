"""Sound recordings in binary formats, made by the libraries for them; none where a library is missing."""

from __future__ import annotations

import io
import json
import tempfile
from pathlib import Path

import numpy as np


def mcap(compression: str = "NONE", chunked: bool = True) -> bytes:
    import mcap.writer as writers

    out = io.BytesIO()
    writer = writers.Writer(out, compression=writers.CompressionType[compression], use_chunking=chunked)
    writer.start()
    plain = writer.register_channel("/a", "json", writer.register_schema("o", "jsonschema", b"{}"))
    text = b"uint8 ERROR=2\nuint8 level\n"
    status = writer.register_channel("/s", "cdr", writer.register_schema("x/msg/S", "ros2msg", text))
    for number in range(4):
        time = 10**18 + number * 10**9
        writer.add_message(plain, log_time=time, publish_time=5, data=json.dumps({"x": number}).encode())
        writer.add_message(status, log_time=time, publish_time=5, data=bytes([0, 1, 0, 0, number % 3]))
    writer.finish()
    return out.getvalue()


def hdf5() -> bytes:
    import h5py

    out = io.BytesIO()
    with h5py.File(out, "w") as file:
        file["time"], file["x"] = np.array([0.0, 1, 2]), np.array([1.0, 2, np.inf])
        file["imu/gyro"], file["imu/t"] = np.ones((3, 2)), np.array([0, 1, 3])
        kind = h5py.enum_dtype({"SLOW": 0, "FAST": 2}, basetype="u1")
        file.create_dataset("mode", data=np.array([0, 2, 1], "u1"), dtype=kind)
    return out.getvalue()


def parquet() -> bytes:
    import pyarrow
    import pyarrow.parquet

    out = io.BytesIO()
    columns = {"time": [0, 1, 2], "x": [1.0, float("inf"), None], "s": ["a", "b", None]}
    pyarrow.parquet.write_table(pyarrow.table(columns), out)
    return out.getvalue()


def bag() -> bytes:
    """A bag of ROS 1."""
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    kind = store.types["std_msgs/msg/Float64"]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.bag"
        with Writer(path) as writer:
            connection = writer.add_connection("/x", kind.__msgtype__, typestore=store)
            for number in range(4):
                message = store.serialize_ros1(kind(data=number / 2), kind.__msgtype__)
                writer.write(connection, 10**18 + number * 10**9, message)
        return path.read_bytes()
