"""What is in an MCAP file whose recorder was stopped before it had written the end, or that is cut off in a chunk."""

from __future__ import annotations

import struct
from collections.abc import Collection, Iterator
from contextlib import suppress
from io import SEEK_END, BytesIO
from typing import IO, Any

from tachk.base.job import check_job

_MAGIC = b"\x89MCAP0\r\n"
_CHUNK = 6
_CHUNK_HEAD = struct.Struct("<BQQQQI")
"""Opcode and length of the record, first and last time, size and checksum of what is in it."""


def is_whole(stream: IO[bytes]) -> bool:
    """Whether a file ends as MCAP says; it is then at its beginning."""
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
