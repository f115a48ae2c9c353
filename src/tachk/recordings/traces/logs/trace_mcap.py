"""Traces in MCAP files, read by mcap; messages are JSON, those of ROS, which rosbags decodes, or protocol buffers."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import cached_property
from io import SEEK_END, BufferedReader, BytesIO, FileIO
from itertools import islice
from os import fstat
from pathlib import Path
from typing import IO, Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import check_job
from tachk.base.optional_packages import optional_packages
from tachk.recordings.traces.compressed import is_compressed, open_bytes
from tachk.recordings.traces.logs.foreign import library_errors
from tachk.recordings.traces.logs.mcap_chunks import StoredMessage, read_messages
from tachk.recordings.traces.logs.message_fields import NO_COLUMNS, Picker, Values
from tachk.recordings.traces.logs.messages import LOG_TIME, SAMPLES, Enumerations, MessageRecording, WithSummary
from tachk.recordings.traces.logs.trace_rosbag import constants_of, enumerations_of
from tachk.recordings.traces.trace import cut_off_warning
from tachk.recordings.traces.trace_header import agreed_unit

_MAGIC = b"\x89MCAP0\r\n"
_CHUNK = 6
_CHUNK_HEAD = struct.Struct("<BQQQQI")
"""Opcode and length of the record, first and last time, size and checksum of what is in it."""


def is_whole(stream: IO[bytes]) -> bool:
    """True if a file ends as MCAP says; it is then at its beginning."""
    size = stream.seek(0, SEEK_END)
    stream.seek(max(0, size - len(_MAGIC)))
    ends = stream.read()
    stream.seek(0)
    return ends == _MAGIC and size > 2 * len(_MAGIC)


def salvaged(stream: IO[bytes], topics: Collection[str] | None) -> Iterator[tuple[Any, Any, Any]]:
    """Schema, channel and message, for each whole message of some topics up to the place where the file is cut off.

    Raises what mcap raises about a file that does not begin as MCAP does.
    """
    from mcap.records import Channel, Message, Schema

    schemas: dict[int, Any] = {}
    channels: dict[int, Any] = {}
    for record in _records(stream):
        check_job()
        if isinstance(record, Schema):
            schemas[record.id] = record
        elif isinstance(record, Channel):
            channels[record.id] = record
        elif isinstance(record, Message) and record.channel_id in channels:
            channel = channels[record.channel_id]
            if topics is None or channel.topic in topics:
                yield schemas.get(channel.schema_id), channel, record


def _records(stream: IO[bytes]) -> Iterator[Any]:
    from mcap.data_stream import ReadDataStream
    from mcap.records import Chunk
    from mcap.stream_reader import StreamReader, breakup_chunk, read_magic

    size = stream.seek(0, SEEK_END)
    stream.seek(0)
    if size < len(_MAGIC) and _MAGIC.startswith(stream.read()):
        return
    stream.seek(0)
    read_magic(ReadDataStream(stream))
    records = iter(StreamReader(stream, skip_magic=True, emit_chunks=True, record_size_limit=size).records)
    while True:
        place = stream.tell()
        try:
            record = next(records, None)
            inner = breakup_chunk(record) if isinstance(record, Chunk) else [record]
        except Exception:  # whatever it is about: here the file is cut off
            stream.seek(place)
            yield from _of_cut_chunk(stream.read())
            return
        if record is None:
            return
        yield from inner


def _of_cut_chunk(record: bytes) -> Iterator[Any]:
    """The whole records in the beginning of a chunk; none if it is something else."""
    from mcap.stream_reader import StreamReader

    if len(record) < _CHUNK_HEAD.size + 4 or record[0] != _CHUNK:
        return
    (length,) = struct.unpack_from("<I", record, _CHUNK_HEAD.size)
    begin = _CHUNK_HEAD.size + 4 + length
    compression = record[begin - length : begin].decode("ascii", "replace")
    content = _decompressed(compression, record[begin + 8 :])
    records = StreamReader(BytesIO(content), skip_magic=True, record_size_limit=len(content)).records
    with suppress(Exception):  # the last one is cut off
        yield from records


def _decompressed(compression: str, data: bytes) -> bytes:
    """As much as can be had of what is cut off."""
    if compression == "":
        return data
    if compression == "zstd":
        from zstandard import ZstdDecompressor

        with suppress(Exception):
            return ZstdDecompressor().decompressobj().decompress(data)
    if compression == "lz4":
        from lz4.frame import LZ4FrameDecompressor

        with suppress(Exception):
            return bytes(LZ4FrameDecompressor().decompress(data))
    return b""


PUBLISH_TIME = "publish_time"
"""The time when a message was sent, in place of the name of a field."""

_LARGE = 1 << 20


class _Careful(BufferedReader):
    """A file whose reads end where it ends: a damaged one claims to have records of any length, for
    which memory would be taken."""

    def read(self, size: int | None = -1, /) -> bytes:
        if size is not None and size > _LARGE:
            size = min(size, max(0, fstat(self.fileno()).st_size - self.tell()))
        return super().read(size)


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
        from mcap.reader import make_reader

        with self._opened() as stream:
            summary = make_reader(stream).get_summary() if self._is_whole else None
            if summary is not None and summary.statistics is not None:
                channels = [(each, summary.schemas.get(each.schema_id)) for each in summary.channels.values()]
                end = None if self.published else summary.statistics.message_end_time
                return {channel.topic: _is_known(channel, schema) for channel, schema in channels}, end
        # The recorder was stopped before it wrote what the file holds.
        known = {channel.id: (channel, schema) for schema, channel, *_ in self._messages(None)}
        if not known and not self._is_whole:
            raise UsageError(f"{self.path} is cut off before its first message")
        return {channel.topic: _is_known(channel, schema) for channel, schema in known.values()}, None

    def decoded(self, topics: Collection[str]) -> Iterator[tuple[str, int, Any]]:
        for schema, channel, logged, sent, data in self._messages(list(topics)):
            with library_errors(self.path, "MCAP file"):
                content = self._decoder(channel, schema)(data)
            yield channel.topic, sent if self.published else logged, content

    def picked(self, topics: Collection[str], pickers: Mapping[str, Picker]) -> Iterator[tuple[str, int, Values]]:
        readers: dict[int, Callable[[bytes], Values]] = {}
        for schema, channel, logged, sent, data in self._messages(list(topics)):
            pick = pickers.get(channel.topic, NO_COLUMNS)
            try:
                if channel.id not in readers:
                    readers[channel.id] = self._reader(channel, schema, pick)
                values = readers[channel.id](data)
            except Exception:  # each library has errors of its own
                with library_errors(self.path, "MCAP file"):
                    content = self._decoder(channel, schema)(data)
                values = pick(content)
            yield channel.topic, sent if self.published else logged, values

    def _reader(self, channel: Any, schema: Any, pick: Picker) -> Callable[[bytes], Values]:
        read = self._decoder(channel, schema)
        if channel.message_encoding != "cdr":
            return lambda data: pick(read(data))
        from tachk.recordings.traces.logs.cdr_layouts import CdrPicker

        return CdrPicker(read, pick, pick.paths, *_typestore(schema))

    def samples(self) -> Iterator[tuple[str, Any]]:
        for topic, known in self._summary[0].items():
            with suppress(UsageError):  # reading the topic itself will raise it
                messages = self.decoded([topic]) if known else iter(())
                yield from ((topic, content) for _, _, content in islice(messages, SAMPLES))

    @property
    def warnings(self) -> tuple[str, ...]:
        """A warning if the file is cut off."""
        if self._is_whole:
            return ()
        return (cut_off_warning(str(self.path), "what follows its last whole message is left out"),)

    def constants(self) -> Mapping[str, Mapping[str, int | float | str]]:
        found: dict[str, Mapping[str, int | float | str]] = {}
        for topic, (encoding, schema) in self._types.items():
            with library_errors(self.path, "MCAP file"):
                if (encoding, schema.encoding) in _ROS:
                    found[topic] = constants_of(*_typestore(schema))
                elif (encoding, schema.encoding) == _PROTOBUF:
                    found[topic] = dict(_enumerators(_protobuf_decoder(encoding, schema)(b"").DESCRIPTOR))
        return found

    def enumerations(self, topics: Collection[str]) -> Mapping[str, Enumerations]:
        found: dict[str, Enumerations] = {}
        for topic, (encoding, schema) in self._types.items():
            if topic in topics and (encoding, schema.encoding) in _ROS:
                with library_errors(self.path, "MCAP file"):
                    found[topic] = enumerations_of(*_typestore(schema))
        return found

    @cached_property
    def _types(self) -> dict[str, tuple[str, Any]]:
        """The encoding of the messages of each topic, and their schema."""
        from mcap.reader import make_reader

        with self._opened() as stream:
            summary = make_reader(stream).get_summary() if self._is_whole else None
            if summary is not None:
                channels = [(each, summary.schemas.get(each.schema_id)) for each in summary.channels.values()]
            else:
                channels = list(
                    {channel.id: (channel, schema) for schema, channel, *_ in self._messages(None)}.values()
                )
        return {channel.topic: (channel.message_encoding, schema) for channel, schema in channels if schema is not None}

    def _messages(self, topics: Collection[str] | None) -> Iterator[StoredMessage]:
        with self._opened() as stream:
            if self._is_whole:
                yield from read_messages(stream, topics)
            else:
                for schema, channel, message in salvaged(stream, topics):
                    yield StoredMessage(schema, channel, message.log_time, message.publish_time, message.data)

    @cached_property
    def _is_whole(self) -> bool:
        """True if the file ends as it should."""
        with self._opened() as stream:
            return is_whole(stream)

    @cached_property
    def _content(self) -> bytes:
        """The content of a compressed file, in which a reader cannot go back."""
        with open_bytes(self.path) as stream:
            return stream.read()

    @contextmanager
    def _opened(self) -> Iterator[IO[bytes]]:
        with (
            library_errors(self.path, "MCAP file"),
            BytesIO(self._content) if is_compressed(self.path) else _Careful(FileIO(self.path)) as stream,
        ):
            try:
                yield stream
            except MemoryError:
                raise UsageError(f"{self.path} has a chunk that claims to be larger than the memory") from None

    def _decoder(self, channel: Any, schema: Any) -> Callable[[bytes], Any]:
        if channel.id not in self._decoders:
            self._decoders[channel.id] = _decoder(channel, schema, f"{self.path}: {channel.topic}")
        return self._decoders[channel.id]


def open_mcap(path: Path, time: str | None, unit: str | None) -> MessageRecording:
    """Opens a file. Raises UsageError, also where mcap is not installed.

    Args:
        time: ``log_time``, which is what None means, ``publish_time``, or a field such as ``header.stamp``.
    """
    with optional_packages():
        import mcap.reader  # noqa: F401
    agreed_unit("s", unit, str(path))
    return MessageRecording(
        str(path), McapMessages(path, time == PUBLISH_TIME), None if time in (LOG_TIME, PUBLISH_TIME) else time
    )


def _is_known(channel: Any, schema: Any) -> bool:
    encodings = (channel.message_encoding, None if schema is None else schema.encoding)
    return channel.message_encoding == "json" or encodings in _ROS or encodings == _PROTOBUF


_ROS = {("cdr", "ros2msg"), ("cdr", "ros2idl"), ("ros1", "ros1msg")}
"""The encodings of messages of ROS and of their schemas."""

_PROTOBUF = ("protobuf", "protobuf")


def _decoder(channel: Any, schema: Any, what: str) -> Callable[[bytes], Any]:
    if channel.message_encoding == "json":
        return _json
    if not _is_known(channel, schema):
        raise UsageError(
            f"{what} has messages in the encoding {channel.message_encoding!r}",
            "JSON, messages of ROS and protocol buffers are read",
        )
    if channel.message_encoding == "protobuf":
        decoded = _protobuf_decoder(channel.message_encoding, schema)
        return lambda data: _fields(decoded(data))
    store, name = _typestore(schema)
    read = store.deserialize_ros1 if channel.message_encoding == "ros1" else store.deserialize_cdr
    return lambda data: read(data, name)


_scan: Callable[[str, int], tuple[Any, int]] = json.JSONDecoder().scan_once  # type: ignore[attr-defined]


def _json(data: bytes) -> Any:
    """As `json.loads`, and quicker where nothing stands around the value."""
    if data.startswith(b'{"'):  # so it is UTF-8
        try:
            text = data.decode("utf-8", "surrogatepass")
            value, end = _scan(text, 0)
            if end == len(text):
                return value
        except (ValueError, StopIteration, RecursionError):  # json.loads says what is wrong
            pass
    return json.loads(data)


def _typestore(schema: Any) -> tuple[Any, str]:
    """The type of a schema as rosbags knows it, and its name."""
    with optional_packages():
        from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
    store = get_typestore(Stores.EMPTY)
    name = schema.name if schema.name.count("/") == 2 else schema.name.replace("/", "/msg/")
    text = schema.data.decode()
    store.register(get_types_from_idl(text) if schema.encoding == "ros2idl" else get_types_from_msg(text, name))
    return store, name


def _protobuf_decoder(encoding: str, schema: Any) -> Callable[[bytes], Any]:
    """The function that reads a message as the class that the library makes of the schema."""
    with optional_packages():
        from mcap_protobuf.decoder import DecoderFactory
    read: Callable[[bytes], Any] | None = DecoderFactory().decoder_for(encoding, schema)
    assert read is not None
    return read


def _enumerators(message: Any, prefix: str = "", within: tuple[str, ...] = ()) -> Iterator[tuple[str, str]]:
    """The names of the values of all enumerations in a type of protocol buffers, which are texts in its messages:
    alone, and behind that of their field, ``mode.FAST``."""
    if message.full_name in within:
        return
    for each in message.fields:
        if each.enum_type is not None:
            for name in each.enum_type.values_by_name:
                yield name, name
                yield f"{prefix}{each.name}.{name}", name
        elif each.message_type is not None:
            yield from _enumerators(each.message_type, f"{prefix}{each.name}.", (*within, message.full_name))


def _fields(message: Any) -> dict[str, Any]:
    """The fields of a protocol buffer: values of enumerations as their names, what is not there is left out."""
    found: dict[str, Any] = {}
    for each in message.DESCRIPTOR.fields:
        value = getattr(message, each.name)
        if each.message_type is not None and each.message_type.GetOptions().map_entry:
            inner = each.message_type.fields_by_name["value"]
            found[each.name] = {str(key): _field(inner, element) for key, element in value.items()}
        elif _is_repeated(each):
            found[each.name] = [_field(each, element) for element in value]
        elif not each.has_presence or message.HasField(each.name):
            found[each.name] = _field(each, value)
    return found


def _is_repeated(field: Any) -> bool:
    stated = getattr(field, "is_repeated", None)  # a property of protobuf 6
    return bool(field.label == field.LABEL_REPEATED if stated is None else stated)


def _field(field: Any, value: Any) -> Any:
    if field.message_type is not None:
        return _fields(value)
    if field.enum_type is not None:
        known = field.enum_type.values_by_number.get(value)
        return value if known is None else known.name
    return value
