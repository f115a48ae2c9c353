"""Traces in MCAP files, read by mcap; messages are JSON, or those of ROS, which rosbags decodes."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any

from tachk.diagnostics.diagnostic import UsageError
from tachk.runtime.logs.foreign import not_installed, reading
from tachk.runtime.logs.messages import LOG_TIME, SAMPLES, MessageRecording, WithSummary
from tachk.runtime.trace_header import agreed_unit

PUBLISH_TIME = "publish_time"
"""The time when a message was sent, in place of the name of a field."""


@dataclass(frozen=True, eq=False)
class McapMessages(WithSummary[dict[str, bool]]):
    """Attributes:
    published: times are those when messages were sent, not when they were recorded.
    """

    path: Path
    published: bool
    _decoders: dict[int, Callable[[bytes], Any]] = field(default_factory=dict, repr=False)

    def _read_summary(self) -> tuple[dict[str, bool], int | None]:
        """The topics, whether their messages can be decoded, and the time of the last message."""
        with self._reading() as reader:
            summary = reader.get_summary()
            if summary is not None and summary.statistics is not None:
                channels = [(each, summary.schemas.get(each.schema_id)) for each in summary.channels.values()]
                end = None if self.published else summary.statistics.message_end_time
            else:  # the recorder was stopped before it wrote what the file holds
                known = {channel.id: (channel, schema) for schema, channel, _ in reader.iter_messages()}
                channels, end = list(known.values()), None
        return {channel.topic: _is_known(channel, schema) for channel, schema in channels}, end

    def decoded(self, topics: Collection[str]) -> Iterator[tuple[str, int, Any]]:
        with self._reading() as reader:
            for schema, channel, message in reader.iter_messages(topics=list(topics)):
                time = message.publish_time if self.published else message.log_time
                yield channel.topic, time, self._decoder(channel, schema)(message.data)

    def samples(self) -> Iterator[tuple[str, Any]]:
        for topic, known in self._summary[0].items():
            with suppress(UsageError):  # whoever asks for the topic will be told
                messages = self.decoded([topic]) if known else iter(())
                yield from ((topic, content) for _, _, content in islice(messages, SAMPLES))

    @contextmanager
    def _reading(self) -> Iterator[Any]:
        from mcap.reader import make_reader

        with reading(self.path, "MCAP file"), self.path.open("rb") as stream:
            yield make_reader(stream)

    def _decoder(self, channel: Any, schema: Any) -> Callable[[bytes], Any]:
        if channel.id not in self._decoders:
            self._decoders[channel.id] = _decoder(channel, schema, f"{self.path}: {channel.topic}")
        return self._decoders[channel.id]


def open_mcap(path: Path, time: str | None, unit: str | None) -> MessageRecording:
    """Opens a file. Raises UsageError, also where mcap is not installed.

    Args:
        time: ``log_time``, which is what None means, ``publish_time``, or a field such as ``header.stamp``.
    """
    try:
        import mcap.reader  # noqa: F401
    except ModuleNotFoundError:
        raise not_installed("MCAP files", "mcap", "mcap") from None
    agreed_unit("s", unit, str(path))
    return MessageRecording(
        str(path), McapMessages(path, time == PUBLISH_TIME), None if time in (LOG_TIME, PUBLISH_TIME) else time
    )


def _is_known(channel: Any, schema: Any) -> bool:
    return channel.message_encoding == "json" or (
        schema is not None and (channel.message_encoding, schema.encoding) in _ROS
    )


_ROS = {("cdr", "ros2msg"), ("cdr", "ros2idl"), ("ros1", "ros1msg")}
"""How messages of ROS and their schemas are encoded."""


def _decoder(channel: Any, schema: Any, what: str) -> Callable[[bytes], Any]:
    if channel.message_encoding == "json":
        return json.loads
    if not _is_known(channel, schema):
        raise UsageError(
            f"{what} has messages in the encoding {channel.message_encoding!r}", "JSON and messages of ROS are read"
        )
    try:
        from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
    except ModuleNotFoundError:
        raise not_installed("messages of ROS", "rosbags", "mcap") from None
    store = get_typestore(Stores.EMPTY)
    name = schema.name if schema.name.count("/") == 2 else schema.name.replace("/", "/msg/")
    text = schema.data.decode()
    store.register(get_types_from_idl(text) if schema.encoding == "ros2idl" else get_types_from_msg(text, name))
    read = store.deserialize_ros1 if channel.message_encoding == "ros1" else store.deserialize_cdr
    return lambda data: read(data, name)
