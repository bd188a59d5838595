"""Repair of a file whose writer was killed: what is whole stays, index and end are written again.

The file is not copied: everything after the last intact chunk is cut off, and the summary appended.
A power cut may leave a record whose bytes never reached the disk, so chunks are checked from the
last one backwards until one is intact. Each chunk was synced before the next one was begun.
"""

import os
import struct
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Attachment, AttachmentIndex, Channel, ChunkIndex, Schema
from mcap.writer import MCAP0_MAGIC

from recon.model.errors import RecordError
from recon.record.mcap.mcap_file import CHUNK_HEAD, RECORD_HEAD, McapIndex, message_indexes
from recon.record.mcap.mcap_read import (
    UNREADABLE,
    DamagedMcapError,
    RawRecord,
    raw_records,
    unpacked_chunk,
)

_FOOTER_BYTES = RECORD_HEAD.size + 20


@dataclass(slots=True)
class _FoundChunk:
    """A chunk and the indexes of its messages, as found in the file."""

    at: int
    length: int
    end: int
    """End of the indexes behind it."""
    offsets: dict[int, int] = field(default_factory=dict)
    counts: dict[int, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class RepairedFile:
    """What a repair has cut off."""

    path: Path
    lost_bytes: int


def is_finished(path: Path) -> bool:
    """Return whether a file has MCAP's end; raises OSError."""
    with path.open("rb") as file:
        size = file.seek(0, os.SEEK_END)
        tail_bytes = _FOOTER_BYTES + len(MCAP0_MAGIC)
        if size < len(MCAP0_MAGIC) + tail_bytes:
            return False
        file.seek(-tail_bytes, os.SEEK_END)
        tail = file.read()
    opcode, length = RECORD_HEAD.unpack_from(tail)
    return tail.endswith(MCAP0_MAGIC) and (opcode, length) == (Opcode.FOOTER, 20)


def repair(path: Path) -> RepairedFile | None:
    """Finish a file that was cut anywhere; None where nothing was to do.

    Raises `RecordError` for a file that is no record, and OSError.
    """
    if is_finished(path):
        return None
    with path.open("r+b") as file:
        if file.read(len(MCAP0_MAGIC)) != MCAP0_MAGIC:
            raise RecordError(f"{path}: expected an MCAP file, got other bytes")
        found = _Found(file.fileno())
        try:
            for record in raw_records(file, len(MCAP0_MAGIC), _is_read):
                if record.opcode == Opcode.DATA_END:
                    break
                found.take(record)
        except (DamagedMcapError, *UNREADABLE):
            pass  # what came before is whole
        size = file.seek(0, os.SEEK_END)
        end = found.cut_to_intact()
        os.ftruncate(file.fileno(), end)
        tail = found.last_indexes(end)
        file.seek(end)
        file.write(tail)
        file.write(found.index().end_of_file(end + len(tail)))
        file.flush()
        os.fsync(file.fileno())
    return RepairedFile(path, size - end)


def _is_read(opcode: int) -> bool:
    return opcode in (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.ATTACHMENT, Opcode.MESSAGE_INDEX)


class _Found:
    """The content of a file, in its order."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._chunks: list[_FoundChunk] = []
        self._others: list[tuple[int, Schema | Channel | AttachmentIndex]] = []
        self._end = len(MCAP0_MAGIC)
        self._last_data: bytes | None = None

    def take(self, record: RawRecord) -> None:
        end = record.at + record.length
        if record.opcode == Opcode.CHUNK:
            self._chunks.append(_FoundChunk(record.at, record.length, end))
        elif record.opcode == Opcode.MESSAGE_INDEX and self._chunks:
            assert record.content is not None
            self._take_index(self._chunks[-1], record.content, record.at, end)
        elif record.content is not None:
            self._others.append((record.at, _other(record)))
        self._end = end

    @staticmethod
    def _take_index(chunk: _FoundChunk, content: bytes, at: int, end: int) -> None:
        channel_id, entry_bytes = struct.unpack_from("<HI", content)
        chunk.offsets[channel_id] = at
        chunk.counts[channel_id] = entry_bytes // 16
        chunk.end = end

    def cut_to_intact(self) -> int:
        """Drop damaged chunks at the end; return where the file is to be cut.

        It is cut behind the last chunk itself, for its indexes may be missing in part: what stood
        behind declares channels that no message uses.
        """
        data = None
        while self._chunks and (data := self._data_of(self._chunks[-1])) is None:
            self._end = self._chunks.pop().at
        if not self._chunks:
            return self._end
        last = self._chunks[-1]
        last.offsets, last.counts, last.end = {}, {}, last.at + last.length
        self._last_data = data
        self._others = [each for each in self._others if each[0] < last.at]
        return last.end

    def _data_of(self, chunk: _FoundChunk) -> bytes | None:
        content = os.pread(self._descriptor, chunk.length, chunk.at)[RECORD_HEAD.size :]
        try:
            return unpacked_chunk(content, chunk.at)
        except (DamagedMcapError, struct.error):
            return None

    def last_indexes(self, at: int) -> bytes:
        """Return the indexes of the last chunk's messages, to be written at byte `at`."""
        if self._last_data is None:
            return b""
        entries = _entries(self._last_data)
        data, offsets = message_indexes(entries, at)
        last = self._chunks[-1]
        last.offsets, last.end = offsets, at + len(data)
        last.counts = {channel_id: len(each) for channel_id, each in entries.items()}
        return data

    def index(self) -> McapIndex:
        """Return the index of what the file holds now."""
        index = McapIndex()
        for _at, other in self._others:
            if isinstance(other, Schema):
                index.schemas[other.id] = other
            elif isinstance(other, Channel):
                index.channels[other.id] = other
            else:
                index.attachments.append(other)
        for chunk in self._chunks:
            index.chunks.append(self._chunk_index(chunk))
            for channel_id, count in chunk.counts.items():
                index.message_counts[channel_id] += count
        return index

    def _chunk_index(self, chunk: _FoundChunk) -> ChunkIndex:
        start = chunk.at + RECORD_HEAD.size
        head = os.pread(self._descriptor, CHUNK_HEAD.size, start)
        first_ns, last_ns, size, _crc = CHUNK_HEAD.unpack(head)
        # Our own chunks: the name "zstd" and two sizes precede the content.
        packed_bytes = chunk.length - RECORD_HEAD.size - CHUNK_HEAD.size - 16
        return ChunkIndex(
            chunk_length=chunk.length,
            chunk_start_offset=chunk.at,
            compression="zstd",
            compressed_size=packed_bytes,
            message_end_time=last_ns,
            message_index_length=chunk.end - chunk.at - chunk.length,
            message_index_offsets=chunk.offsets,
            message_start_time=first_ns,
            uncompressed_size=size,
        )


def _other(record: RawRecord) -> Schema | Channel | AttachmentIndex:
    assert record.content is not None
    stream = ReadDataStream(BytesIO(record.content))
    if record.opcode == Opcode.SCHEMA:
        schema: Schema = Schema.read(stream)
        return schema
    if record.opcode == Opcode.CHANNEL:
        channel: Channel = Channel.read(stream)
        return channel
    each: Attachment = Attachment.read(stream)
    return AttachmentIndex(
        record.at,
        record.length,
        each.log_time,
        each.create_time,
        len(each.data),
        each.name,
        each.media_type,
    )


def _entries(data: bytes) -> dict[int, list[tuple[int, int]]]:
    """Return time and offset of each message in a chunk's records, by channel."""
    entries: dict[int, list[tuple[int, int]]] = {}
    at = 0
    while at + RECORD_HEAD.size <= len(data):
        opcode, length = RECORD_HEAD.unpack_from(data, at)
        if opcode == Opcode.MESSAGE:
            channel_id, _sequence, log_ns = struct.unpack_from("<HIQ", data, at + RECORD_HEAD.size)
            entries.setdefault(channel_id, []).append((log_ns, at))
        at += RECORD_HEAD.size + length
    return entries
