"""Records of MCAP files, of which a file may not be what it declares: sizes, and what they unpack to, are limited."""

from __future__ import annotations

import math
import os
import struct
from collections.abc import Iterable, Iterator, Set
from io import BytesIO
from itertools import islice
from typing import IO, TYPE_CHECKING

if TYPE_CHECKING:
    from mcap.records import Channel, Chunk, McapRecord
    from mcap.summary import Summary

MOST_RECORD = 64 * 1024 * 1024  # bytes, also of an unpacked chunk
_MOST_UNPACKED, _MOST_RATIO = 256 * 1024 * 1024, 200  # bytes that a file may unpack to, plus so many times its size
_RECORD = struct.Struct("<BQ")  # kind and length
_SCHEMA, _CHANNEL, _MESSAGE = 3, 4, 5
_MOST_SUMMARY = 64 * 1024 * 1024
_MOST_METADATA = 1000
_TAIL = 37  # bytes of the last record and the magic
PER_RECORD = 300  # bytes of memory besides its data


def read_records(
    file: IO[bytes], complete: bool, begin: int, topics: Set[str] | None, channels: dict[int, Channel]
) -> Iterator[tuple[float, McapRecord | None]]:
    """Yield the records of a file, each with the time that no later message is older than."""
    from mcap.records import Chunk
    from mcap.stream_reader import StreamReader

    left = _MOST_UNPACKED + _MOST_RATIO * os.fstat(file.fileno()).st_size
    summary = read_summary(file)[0] if complete else None
    indexes = summary.chunk_indexes if summary is not None else []
    if summary is not None:
        yield from ((0.0, each) for each in (*summary.schemas.values(), *summary.channels.values()))
    wanted = {number for number, each in channels.items() if topics is None or each.topic in topics}
    starts: Iterable[tuple[float, int]] = sorted(
        (each.message_start_time, each.chunk_start_offset)
        for each in indexes
        if each.message_end_time >= begin
        and not (each.message_index_offsets and wanted.isdisjoint(each.message_index_offsets))
    )
    for start, offset in starts if indexes else [(0.0 if complete else math.inf, 0)]:
        file.seek(offset)
        stream = StreamReader(file, skip_magic=offset > 0, emit_chunks=True, record_size_limit=MOST_RECORD)
        for record in islice(stream.records, 1 if indexes else None):
            yield start, None
            if not isinstance(record, Chunk):
                yield start, record
                continue
            data = _unpack(record)
            left -= len(data)
            for inner in _split_chunk(data):
                left -= PER_RECORD
                yield start, inner
                if left < 0:
                    raise ValueError("it unpacks to too much")


def _split_chunk(data: bytes) -> Iterator[McapRecord | None]:
    """Yield the records of a chunk, None for one of another kind."""
    from mcap.data_stream import ReadDataStream
    from mcap.records import Channel, Message, Schema

    place = 0
    while place < len(data):
        opcode, length = _RECORD.unpack_from(data, place)
        place += _RECORD.size + length
        stream = ReadDataStream(BytesIO(data[place - length : place]))
        if opcode == _MESSAGE:
            yield Message.read(stream, length)
        elif opcode in (_SCHEMA, _CHANNEL):
            yield (Schema if opcode == _SCHEMA else Channel).read(stream)
        else:
            yield None


def _unpack(chunk: Chunk) -> bytes:
    """Return the content of a chunk, of the size that it declares. Raises ValueError, and errors of decompressors."""
    size = chunk.uncompressed_size
    if size > MOST_RECORD:
        raise ValueError(f"a chunk of {size:,} bytes, expected at most {MOST_RECORD:,}")
    if chunk.compression == "zstd":
        from zstandard import ZstdDecompressor

        data = ZstdDecompressor(max_window_size=MOST_RECORD).stream_reader(chunk.data).read(size + 1)
    elif chunk.compression == "lz4":
        from lz4.frame import LZ4FrameDecompressor  # type: ignore[import-untyped]

        data = LZ4FrameDecompressor().decompress(chunk.data, max_length=size + 1)
    else:
        data = chunk.data
    if len(data) != size:
        raise ValueError(f"a chunk that does not have the {size:,} bytes that it declares")
    return data


def read_summary(file: IO[bytes]) -> tuple[Summary | None, dict[str, dict[str, str]]]:
    """Return what the end of a file says of it, None where it says nothing, and its metadata; no chunk is unpacked.

    Raises ValueError, and errors of the library.
    """
    from mcap.records import Channel, ChunkIndex, Footer, Metadata, MetadataIndex, Schema, Statistics
    from mcap.stream_reader import StreamReader
    from mcap.summary import Summary

    def records(place: int) -> Iterator[McapRecord]:
        file.seek(place)
        return StreamReader(file, skip_magic=True, emit_chunks=True, record_size_limit=MOST_RECORD).records

    size = file.seek(-_TAIL, os.SEEK_END) + _TAIL
    footer = next(records(size - _TAIL))
    if not isinstance(footer, Footer):
        raise ValueError("its end is missing")
    if not footer.summary_start:
        return None, {}
    if size - footer.summary_start > _MOST_SUMMARY:
        raise ValueError("its index is too large")
    summary = Summary()
    for record in records(footer.summary_start):
        if isinstance(record, Statistics):
            summary.statistics = record
        elif isinstance(record, Schema):
            summary.schemas[record.id] = record
        elif isinstance(record, Channel):
            summary.channels[record.id] = record
        elif isinstance(record, ChunkIndex):
            summary.chunk_indexes.append(record)
        elif isinstance(record, MetadataIndex):
            summary.metadata_indexes.append(record)
    first = (next(records(each.offset)) for each in summary.metadata_indexes[:_MOST_METADATA])
    return summary, {each.name: dict(each.metadata) for each in first if isinstance(each, Metadata)}
