"""The messages of a whole MCAP file in the order of time, as the reader of mcap gives them, chunk by chunk.

mcap holds all messages of a chunk in a heap, as chunks may overlap in time. Mostly they do not, and sorting each is
enough.
"""

from __future__ import annotations

import struct
from collections.abc import Collection, Iterator
from io import BytesIO
from itertools import pairwise
from typing import IO, Any, NamedTuple


class StoredMessage(NamedTuple):
    """Attributes:
    schema, channel: as mcap has them.
    logged, published: times in nanoseconds.
    """

    schema: Any
    channel: Any
    logged: int
    published: int
    data: bytes


_MESSAGE = struct.Struct("<BQHIQQ")
"""Opcode and length of the record, channel, number, time when it was recorded, and when it was sent."""

_RECORD = struct.Struct("<BQ")
_MESSAGE_OPCODE = 5
_HEAD = _MESSAGE.size - _RECORD.size


def read_messages(stream: IO[bytes], topics: Collection[str] | None) -> Iterator[StoredMessage]:
    """The messages of some topics, of all where that is None. Raises what mcap raises about a damaged file."""
    from mcap.reader import make_reader
    from mcap.records import Message
    from mcap.stream_reader import breakup_chunk

    reader = make_reader(stream)
    summary = reader.get_summary()
    chunks = None if summary is None else _chunks_in_order(summary, topics)
    if not chunks:
        for schema, channel, message in reader.iter_messages(topics=topics):
            yield StoredMessage(schema, channel, message.log_time, message.publish_time, message.data)
        return
    owners: dict[int, tuple[Any, Any] | None] = {}
    for index in chunks:
        chunk = _chunk(stream, index.chunk_start_offset)
        found = _messages(chunk)
        if found is None:
            records = (each for each in breakup_chunk(chunk) if isinstance(each, Message))
            found = [(each.log_time, each.channel_id, each.publish_time, each.data) for each in records]
        ordered = []
        for logged, number, published, data in found:
            if number not in owners:
                owners[number] = _owner(summary, number, topics)
            owner = owners[number]
            if owner is not None:
                ordered.append(StoredMessage(*owner, logged, published, data))
        ordered.sort(key=_logged)
        yield from ordered


def _logged(message: StoredMessage) -> int:
    return message.logged


def _chunks_in_order(summary: Any, topics: Collection[str] | None) -> list[Any] | None:
    """The chunks that may hold messages of some topics, in the order of time; None if they overlap."""
    chunks = sorted(summary.chunk_indexes, key=lambda each: (each.message_start_time, each.chunk_start_offset))
    for before, behind in pairwise(chunks):
        gap = behind.message_start_time - before.message_end_time
        if gap < 0 or (gap == 0 and before.chunk_start_offset > behind.chunk_start_offset):
            return None
    return [
        each
        for each in chunks
        if topics is None
        or not each.message_index_offsets
        or any(summary.channels[channel].topic in topics for channel in each.message_index_offsets)
    ]


def _owner(summary: Any, number: int, topics: Collection[str] | None) -> tuple[Any, Any] | None:
    """The schema and the channel of messages; None if their topic is none of some."""
    channel = summary.channels[number]
    if topics is not None and channel.topic not in topics:
        return None
    return None if channel.schema_id == 0 else summary.schemas[channel.schema_id], channel


def _chunk(stream: IO[bytes], offset: int) -> Any:
    from mcap.data_stream import ReadDataStream
    from mcap.records import Chunk

    stream.seek(offset + _RECORD.size)
    return Chunk.read(ReadDataStream(stream))


def _messages(chunk: Any) -> list[tuple[int, int, int, bytes]] | None:
    """The time, the channel, the time of sending and the content of each message; None where something is wrong."""
    from mcap.data_stream import ReadDataStream
    from mcap.records import Channel, Schema
    from mcap.stream_reader import get_chunk_data_stream

    stream, size = get_chunk_data_stream(chunk)
    content = stream.read(size)
    others: dict[int, Any] = {3: Schema, 4: Channel}
    found: list[tuple[int, int, int, bytes]] = []
    place, unpack, head = 0, _MESSAGE.unpack_from, _MESSAGE.size
    while place < size:
        if place + _RECORD.size > size:
            return None
        opcode, length = _RECORD.unpack_from(content, place)
        end = place + _RECORD.size + length
        if end > size or (opcode == _MESSAGE_OPCODE and length < _HEAD):
            return None
        if opcode == _MESSAGE_OPCODE:
            _, _, channel, _, logged, published = unpack(content, place)
            found.append((logged, channel, published, content[place + head : end]))
        elif opcode in others:
            record = ReadDataStream(BytesIO(content[place + _RECORD.size : end]))
            try:
                others[opcode].read(record)
            except Exception:  # whatever it is about: mcap says what
                return None
            if record.count != length:
                return None
        place = end
    return found
