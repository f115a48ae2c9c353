"""Messages in MCAP files have the values that mcap and rosbags read one by one, in the same order, also if damaged."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.traces.logs.foreign import library_errors
from tachk.recordings.traces.logs.message_fields import Picker
from tachk.recordings.traces.logs.trace_mcap import McapMessages
from tests.support.seeds import seeds

pytest.importorskip("mcap")
pytest.importorskip("rosbags")

PLAIN = ("bool", "byte", "char", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "float32", "float64")
SHAPES = ("", "", "", "[3]", "[]")


def definition(r: Random) -> str:
    """The type of a message with some others within it."""
    kinds: list[str] = [*PLAIN, "uint64", "string", "string"]
    parts = []
    for name in ("Inner", "Middle"):
        fields = "\n".join(f"{r.choice(kinds)}{r.choice(SHAPES)} f{n}" for n in range(r.randint(1, 4)))
        parts.append(f"{'=' * 80}\nMSG: own/msg/{name}\n{fields}")
        kinds += [f"own/msg/{name}"] * 3
    fields = "\n".join(f"{r.choice(kinds)}{r.choice(SHAPES)} f{n}" for n in range(r.randint(1, 5)))
    return "\n".join((fields, *parts))


def value(r: Random, store: Any, description: Any, long: int) -> Any:
    kind, content = description
    if kind.name == "NAME":
        return message(r, store, content, long)
    if kind.name == "BASE":
        return plain(r, content[0], long)
    inner, count = content
    count = count if kind.name == "ARRAY" else r.randint(0, long)
    values = [value(r, store, inner, long) for _ in range(count)]
    if inner[0].name == "BASE" and inner[1][0] != "string":
        return np.array(values, {"byte": "uint8", "char": "uint8"}.get(inner[1][0], inner[1][0]))
    return values


def plain(r: Random, name: str, long: int) -> Any:
    if name == "string":
        return "é" * r.randint(0, long)
    if name == "bool":
        return r.random() < 0.5
    if name.startswith("float"):
        return float(np.float32(r.choice([r.random(), float("nan"), float("inf"), -0.0])))
    return r.randint(0, 100)


def message(r: Random, store: Any, name: str, long: int) -> Any:
    return store.types[name](*(value(r, store, each, long) for _, each in store.fielddefs[name][1]))


def written(r: Random, path: Path) -> list[str]:
    """Writes a file, and gives some columns of it."""
    from mcap.writer import CompressionType, Writer
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.EMPTY)
    text = definition(r)
    store.register(get_types_from_msg(text, "own/msg/Outer"))
    columns = ["plain", "ros", "plain.a", "plain.b.c[0]", "plain.d.e", *leaves(store, "own/msg/Outer", "ros")]
    with path.open("wb") as stream:
        writer = Writer(stream, chunk_size=r.choice([1, 500, 10**6]), compression=r.choice(list(CompressionType)))
        writer.start()
        own = writer.register_schema("own/msg/Outer", "ros2msg", text.encode())
        ros = writer.register_channel("/ros", "cdr", own)
        flat = writer.register_channel("/plain", "json", writer.register_schema("x", "jsonschema", b"{}"))
        time, long = 10**18, r.choice([0, 1, 4])
        for _ in range(r.randint(1, 60)):
            time += r.choice([0, 0, 1, 10, -3])
            if r.random() < 0.6:
                data = bytes(
                    store.serialize_cdr(
                        message(r, store, "own/msg/Outer", long), "own/msg/Outer", little_endian=r.random() < 0.9
                    )
                )
                writer.add_message(ros, time, data, time - 1)
            else:
                content = {"a": r.choice([1, 2.5, None, "x", float("nan"), True]), "b": {"c": [r.random()]}, "d.e": 3}
                writer.add_message(flat, time, json.dumps(content).encode(), time - 1)
        writer.finish()  # type: ignore[no-untyped-call]
    return columns


def leaves(store: Any, name: str, path: str) -> Iterator[str]:
    for field, (kind, content) in store.fielddefs[name][1]:
        own = f"{path}.{field}"
        shape = "" if kind.name in ("NAME", "BASE") else "[1]"
        kind, content = (kind, content) if not shape else content[0]
        yield own + shape
        if kind.name == "NAME":
            yield from leaves(store, content, own + shape)


def one_by_one(path: Path, topics: list[str], pickers: dict[str, Picker]) -> Iterator[tuple[str, int, Any]]:
    from mcap.reader import make_reader

    messages = McapMessages(path, False)
    with library_errors(path, "MCAP file"), messages._opened() as stream:
        for schema, channel, stored in make_reader(stream).iter_messages(topics=topics):
            content = messages._decoder(channel, schema)(stored.data)
            yield channel.topic, stored.log_time, pickers[channel.topic](content)


def outcome(rows: Callable[[], Iterator[Any]]) -> list[str]:
    found = []
    try:
        found += [repr(row) for row in rows()]
    except UsageError as error:
        return [str(error)]
    return found


@pytest.mark.parametrize("seed", seeds(range(80)))
def test_messages_are_those_that_the_libraries_read(seed: int, tmp_path: Path) -> None:
    r = Random(seed)
    path = tmp_path / "log.mcap"
    columns = written(r, path)
    if r.random() < 0.3:
        data = bytearray(path.read_bytes())
        for _ in range(r.randint(1, 3)):
            data[r.randrange(8, len(data) - 8)] = r.randrange(256)
        path.write_bytes(bytes(data))
    topics = [["/ros", "/plain"], ["/ros"], ["/plain"]][seed % 3]
    wanted = [name if r.random() < 0.8 else f"arrived({name})" for name in columns]
    pickers = {
        topic: Picker(topic, [each for each in wanted if topic[1:] in each.replace("(", ".").split(".")[:2]])
        for topic in topics
    }
    expected = outcome(lambda: one_by_one(path, topics, pickers))
    assert outcome(lambda: McapMessages(path, False).picked(topics, pickers)) == expected
