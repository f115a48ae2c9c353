"""Traces in ROS bags, read by rosbags: folders of ROS 2 with ``metadata.yaml``, and ``.bag`` files of ROS 1."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

from tachk.base.optional_packages import optional_packages
from tachk.recordings.traces.logs.foreign import library_errors
from tachk.recordings.traces.logs.messages import LOG_TIME, SAMPLES, Enumerations, MessageRecording, WithSummary
from tachk.recordings.traces.trace_header import agreed_unit


@dataclass(frozen=True, eq=False)
class BagMessages(WithSummary[Collection[str]]):
    """The messages of a bag."""

    path: Path

    def _read_summary(self) -> tuple[Collection[str], int | None]:
        with self._opened_file() as reader:
            return tuple(reader.topics), reader.end_time - 1 if reader.message_count else None

    def decoded(self, topics: Collection[str]) -> Iterator[tuple[str, int, Any]]:
        with self._opened_file() as reader:
            for connection, time, raw in reader.messages([each for each in reader.connections if each.topic in topics]):
                yield connection.topic, time, reader.deserialize(raw, connection.msgtype)

    def samples(self) -> Iterator[tuple[str, Any]]:
        with self._opened_file() as reader:
            for connection in list(reader.connections):
                for _, _, raw in islice(reader.messages([connection]), SAMPLES):
                    yield connection.topic, reader.deserialize(raw, connection.msgtype)

    @property
    def warnings(self) -> tuple[str, ...]:
        return ()

    def constants(self) -> Mapping[str, Mapping[str, int | float | str]]:
        with self._opened_file() as reader:
            return {each.topic: constants_of(reader.typestore, each.msgtype) for each in reader.connections}

    def enumerations(self, topics: Collection[str]) -> Mapping[str, Enumerations]:
        with self._opened_file() as reader:
            connections = [each for each in reader.connections if each.topic in topics]
            return {each.topic: enumerations_of(reader.typestore, each.msgtype) for each in connections}

    @contextmanager
    def _opened_file(self) -> Iterator[Any]:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore

        with (
            library_errors(self.path, "ROS bag"),
            AnyReader([self.path], default_typestore=get_typestore(Stores.LATEST)) as reader,
        ):
            yield reader


def constants_of(store: Any, name: str) -> dict[str, int | float | str]:
    """The constants of a message type of ROS, and of the types of its fields."""
    found: dict[str, int | float | str] = {}
    waiting, seen = [name], set()
    while waiting:
        kind = waiting.pop()
        if kind in seen or kind not in store.fielddefs:
            continue
        seen.add(kind)
        constants, fields = store.fielddefs[kind]
        for constant, _, value in constants:
            found.setdefault(constant, value)
        waiting += [each for _, field in fields for each in _types_in(field)]
    return found


def enumerations_of(store: Any, name: str, within: tuple[str, ...] = ()) -> dict[str, Mapping[str, int]]:
    """The fields of a message type of ROS whose values its constants name, by their paths.

    ROS does not say which constants belong to which field. Those of whole numbers belong to the field of the same
    message and type with which their names begin (``POWER_SUPPLY_HEALTH_GOOD`` to ``power_supply_health``), or to the
    only field of their type.
    """
    if name in within or name not in store.fielddefs:
        return {}
    constants, fields = store.fielddefs[name]
    found: dict[str, Mapping[str, int]] = {}
    plain = {field: kind[1][0] for field, kind in fields if isinstance(kind[1], tuple) and isinstance(kind[1][0], str)}
    for constant, kind, value in constants:
        own = [field for field, other in plain.items() if other == kind]
        begun = [field for field in own if constant.lower().startswith(f"{field.lower()}_")]
        owner = max(begun, key=len) if begun else own[0] if len(own) == 1 else None
        if owner is not None and isinstance(value, int) and not isinstance(value, bool):
            found[f".{owner}"] = {**found.get(f".{owner}", {}), constant: value}
    for field, (_, described) in fields:
        is_plain = isinstance(described, str)
        inner = described if is_plain else described[0][1]
        if isinstance(inner, str):
            parts = enumerations_of(store, inner, (*within, name))
            found |= {f".{field}{'' if is_plain else '[]'}{path}": values for path, values in parts.items()}
    return found


def _types_in(field: Any) -> Iterator[str]:
    """The names of message types in the description of a field by rosbags: pairs of a kind and what belongs to it."""
    if isinstance(field, str):
        yield field
    elif isinstance(field, tuple):
        for part in field:
            yield from _types_in(part)


def open_bag(path: Path, time: str | None, unit: str | None) -> MessageRecording:
    """Opens a bag. Raises UsageError, also where rosbags is not installed.

    Args:
        time: ``log_time``, which is what None means, or a field such as ``header.stamp``.
    """
    with optional_packages():
        import rosbags.highlevel  # noqa: F401
    agreed_unit("s", unit, str(path))
    return MessageRecording(str(path), BagMessages(path), None if time == LOG_TIME else time)
