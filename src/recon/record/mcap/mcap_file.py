"""Writing one MCAP file so that it can be cut anywhere: whole chunks, each synced to disk.

The library's writer keeps what the index needs inside itself, so a file that it did not finish can
only be written anew. Here the same `McapIndex` is filled by the writer, and from the file by a
repair (`mcap_repair`), and either appends the summary. Records are those of the `mcap` library.
"""

import os
import struct
import zlib
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    MessageIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from mcap.writer import MCAP0_MAGIC

from recon.record.mcap.items import COMPRESSION

PROFILE = "recon"
ABOUT_NAME, STEPS_TOPIC = "recon/about.json", "/recon/steps"
"""Written by the station; read by it for a replay, and after the flight without it."""
KEYFRAMES_TOPIC = "/recon/keyframes"
"""The station's state every two seconds: a replay in the console starts from one of them."""

CHUNK_BYTES = 4 * 1024 * 1024
"""A raw frame of 1280 x 720 and what comes with it: a seek unpacks little."""

RECORD_HEAD = struct.Struct("<BQ")
MESSAGE_HEAD = struct.Struct("<BQHIQQ")
MESSAGE_FIXED_BYTES = 22
CHUNK_HEAD = struct.Struct("<QQQI")
"""Head of a chunk: first and last time, size and CRC of its content."""


def compressor() -> zstandard.ZstdCompressor:
    """Return the compressor of chunks."""
    return zstandard.ZstdCompressor(level=COMPRESSION)


@dataclass(slots=True)
class McapIndex:
    """What the summary at the end of a file lists."""

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    chunks: list[ChunkIndex] = field(default_factory=list)
    attachments: list[AttachmentIndex] = field(default_factory=list)
    message_counts: dict[int, int] = field(default_factory=lambda: defaultdict(int))

    def end_of_file(self, at: int) -> bytes:
        """Return everything after the last chunk of a file whose data end at byte `at`."""
        data_end = RecordBuilder()
        DataEnd(0).write(data_end)
        start = at + data_end.count
        builder = RecordBuilder()
        offsets: list[SummaryOffset] = []
        groups: tuple[tuple[Opcode, list[McapRecord]], ...] = (
            (Opcode.SCHEMA, list(self.schemas.values())),
            (Opcode.CHANNEL, list(self.channels.values())),
            (Opcode.STATISTICS, [self._statistics()]),
            (Opcode.CHUNK_INDEX, list(self.chunks)),
            (Opcode.ATTACHMENT_INDEX, list(self.attachments)),
        )
        for opcode, records in groups:
            begins = builder.count
            for each in records:
                each.write(builder)
            if records:
                length = builder.count - begins
                offset = SummaryOffset(
                    group_opcode=opcode, group_start=start + begins, group_length=length
                )
                offsets.append(offset)
        offsets_at = start + builder.count
        for offset in offsets:
            offset.write(builder)
        summary = _taken(builder)
        footer = struct.pack("<BQQQ", Opcode.FOOTER, 20, start, offsets_at)
        last = RecordBuilder()
        crc = zlib.crc32(footer, zlib.crc32(summary))
        Footer(summary_start=start, summary_offset_start=offsets_at, summary_crc=crc).write(last)
        return _taken(data_end) + summary + _taken(last) + MCAP0_MAGIC

    def _statistics(self) -> Statistics:
        return Statistics(
            attachment_count=len(self.attachments),
            channel_count=len(self.channels),
            channel_message_counts=dict(self.message_counts),
            chunk_count=len(self.chunks),
            message_count=sum(self.message_counts.values()),
            message_end_time=max((each.message_end_time for each in self.chunks), default=0),
            message_start_time=min((each.message_start_time for each in self.chunks), default=0),
            metadata_count=0,
            schema_count=len(self.schemas),
        )


@dataclass(slots=True)
class _ChunkInHand:
    """Messages that are not written yet."""

    parts: list[bytes] = field(default_factory=list)
    size: int = 0
    first_ns: int = 0
    last_ns: int = 0
    indexes: dict[int, list[tuple[int, int]]] = field(default_factory=dict)

    def add(self, channel_id: int, sequence: int, log_ns: int, data: bytes) -> None:
        length = MESSAGE_FIXED_BYTES + len(data)
        head = MESSAGE_HEAD.pack(
            Opcode.MESSAGE, length, channel_id, sequence & 0xFFFFFFFF, log_ns, log_ns
        )
        self.first_ns = min(self.first_ns, log_ns) if self.parts else log_ns
        self.last_ns = max(self.last_ns, log_ns)
        self.indexes.setdefault(channel_id, []).append((log_ns, self.size))
        self.parts += (head, data)
        self.size += len(head) + len(data)


def chunk_record(
    data: bytes, first_ns: int, last_ns: int, compress: Callable[[bytes], bytes]
) -> tuple[bytes, int]:
    """Return the record of a chunk, and the size of its compressed content."""
    packed = compress(data)
    head = CHUNK_HEAD.pack(first_ns, last_ns, len(data), zlib.crc32(data))
    kind = struct.pack("<I4s", 4, b"zstd")
    length = len(head) + len(kind) + 8 + len(packed)
    record = b"".join(
        (
            RECORD_HEAD.pack(Opcode.CHUNK, length),
            head,
            kind,
            struct.pack("<Q", len(packed)),
            packed,
        )
    )
    return record, len(packed)


class McapFile:
    """One file being written, by one thread. Nothing is in the file before `flush`.

    A write that fails raises OSError and leaves the file as it was; what was to be written waits
    for the next `flush`.
    """

    def __init__(self, path: Path, library: str) -> None:
        """Create the file, for its owner alone; raises OSError, also where there is one."""
        self.path = path
        self._file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
        self._index = McapIndex()
        self._chunk = _ChunkInHand()
        self._compress = compressor().compress
        self._size = 0
        header = RecordBuilder()
        Header(PROFILE, library).write(header)
        self._unwritten = bytearray(MCAP0_MAGIC + _taken(header))

    @property
    def size(self) -> int:
        """Bytes in the file."""
        return self._size

    @property
    def descriptor(self) -> int:
        """The open file's descriptor."""
        return self._file

    def add_schema(self, name: str, encoding: str, data: bytes) -> int:
        """Register a schema; return its id."""
        schema = Schema(len(self._index.schemas) + 1, data, encoding, name)
        self._index.schemas[schema.id] = schema
        self._unwritten += _record_bytes(schema)
        return schema.id

    def add_channel(self, topic: str, encoding: str, schema_id: int = 0) -> int:
        """Register a channel; return its id."""
        number = len(self._index.channels) + 1
        channel = Channel(number, topic, encoding, {}, schema_id)
        self._index.channels[number] = channel
        self._unwritten += _record_bytes(channel)
        return number

    def add_attachment(self, name: str, media_type: str, data: bytes, at_ns: int) -> None:
        """Add a file of its own inside this one."""
        attachment = Attachment(at_ns, at_ns, name, media_type, data)
        record = _record_bytes(attachment)
        offset, size = self._size + len(self._unwritten), len(data)
        self._index.attachments.append(
            AttachmentIndex(offset, len(record), at_ns, at_ns, size, name, media_type)
        )
        self._unwritten += record

    def add_message(self, channel_id: int, sequence: int, log_ns: int, data: bytes) -> None:
        """Add a message to the open chunk; its time is in ns, from 0 up."""
        self._chunk.add(channel_id, sequence, max(0, log_ns), data)

    @property
    def is_chunk_full(self) -> bool:
        """Whether the open chunk should be written."""
        return self._chunk.size >= CHUNK_BYTES

    def flush(self) -> None:
        """Write what was added, and sync it; raises OSError."""
        self._close_chunk()
        self._append(bytes(self._unwritten))
        self._unwritten.clear()

    def finish(self) -> None:
        """Write the rest and the summary, and close; raises OSError."""
        try:
            self.flush()
            self._append(self._index.end_of_file(self._size))
        finally:
            self.abandon()

    def abandon(self) -> None:
        """Close the file as it is."""
        os.close(self._file)

    def _append(self, data: bytes) -> None:
        written = 0
        try:
            while written < len(data):
                written += os.pwrite(self._file, data[written:], self._size + written)
            os.fsync(self._file)
        except OSError:
            os.ftruncate(self._file, self._size)
            raise
        self._size += written

    def _close_chunk(self) -> None:
        chunk = self._chunk
        if not chunk.parts:
            return
        data = b"".join(chunk.parts)
        at = self._size + len(self._unwritten)
        record, packed_bytes = chunk_record(data, chunk.first_ns, chunk.last_ns, self._compress)
        index, offsets = message_indexes(chunk.indexes, at + len(record))
        self._unwritten += record + index
        for channel_id, entries in chunk.indexes.items():
            self._index.message_counts[channel_id] += len(entries)
        self._index.chunks.append(
            ChunkIndex(
                chunk_length=len(record),
                chunk_start_offset=at,
                compression="zstd",
                compressed_size=packed_bytes,
                message_end_time=chunk.last_ns,
                message_index_length=len(index),
                message_index_offsets=offsets,
                message_start_time=chunk.first_ns,
                uncompressed_size=len(data),
            )
        )
        self._chunk = _ChunkInHand()


def message_indexes(
    entries: dict[int, list[tuple[int, int]]], at: int
) -> tuple[bytes, dict[int, int]]:
    """Return the index records of a chunk's messages, at byte `at`, and each channel's offset."""
    builder = RecordBuilder()
    offsets = {}
    for channel_id, records in entries.items():
        offsets[channel_id] = at + builder.count
        MessageIndex(channel_id, records).write(builder)
    return _taken(builder), offsets


def _record_bytes(record: McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return _taken(builder)


def _taken(builder: RecordBuilder) -> bytes:
    return bytes(builder.end())  # type: ignore[no-untyped-call]
