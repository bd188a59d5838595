"""Reading MCAP files of any origin: bounded, and as far as a cut or damaged file goes.

`McapReading` goes through a file once, from its start, without its index: so it reads what a killed
process has left as well as a finished file. It never trusts a size that the file states.
"""

import struct
import zlib
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import BinaryIO

import lz4.frame
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Schema
from mcap.writer import MCAP0_MAGIC

from recon.model.errors import RecordError
from recon.model.file_kind import file_kind
from recon.record.mcap.mcap_file import CHUNK_HEAD, RECORD_HEAD

MOST_RECORD_BYTES = 512 * 1024 * 1024
"""Limit of one chunk, packed and unpacked, and of one attachment; ours are a tenth of it."""

MESSAGE_FIELDS = struct.Struct("<HIQQ")
MAGIC = MCAP0_MAGIC
UNREADABLE = (McapError, struct.error, UnicodeDecodeError, IndexError, OverflowError)
"""Raised for a record whose own lengths are wrong."""


@dataclass(frozen=True, slots=True)
class RecordMessage:
    """One message; its time in ns as the writer's clock counted."""

    topic: str
    encoding: str
    schema: str
    sequence: int
    log_ns: int
    data: bytes


@dataclass(frozen=True, slots=True)
class RecordAttachment:
    """A file inside the file."""

    name: str
    media_type: str
    data: bytes


@dataclass(frozen=True, slots=True)
class RawRecord:
    """A record of the file's top level: where it begins, and its content, None where skipped."""

    opcode: int
    at: int
    length: int
    """Length with its head of 9 bytes."""
    content: bytes | None


Opener = Callable[[Path], AbstractContextManager[BinaryIO]]
"""Opens a record for one pass; a command line shows how far it has come."""


def opened(path: Path) -> AbstractContextManager[BinaryIO]:
    """Open a record, showing nothing; raises OSError."""
    return path.open("rb")


class DamagedMcapError(RecordError):
    """Bytes that are no MCAP record: what was expected, what came, and where."""


class McapReading:
    """One pass over a file; then `trouble` has the reason of an early end, empty without one."""

    def __init__(self, file: BinaryIO, start: bytes = b"") -> None:
        """Take a file open at its start, or with its first 8 bytes read already.

        It need not be seekable. Raises `DamagedMcapError` without MCAP's first bytes.
        """
        self.trouble = ""
        self._file = file
        self._declared = Declared()
        check_magic(start or file.read(len(MAGIC)))

    def items(self) -> Iterator[RecordMessage | RecordAttachment]:
        """Yield messages and attachments in the order of the file, up to damage."""
        try:
            for record in raw_records(self._file, len(MAGIC), self._is_read):
                if record.opcode == Opcode.DATA_END:
                    return
                yield from self._items_of(record)
            self.trouble = "the file ends without MCAP's summary: it was cut, or is being written"
        except DamagedMcapError as problem:
            self.trouble = str(problem)

    @staticmethod
    def _is_read(opcode: int) -> bool:
        return opcode in _READ

    def _items_of(self, record: RawRecord) -> Iterator[RecordMessage | RecordAttachment]:
        if record.content is None:
            return
        try:
            if record.opcode == Opcode.CHUNK:
                yield from self._chunk_items(unpacked_chunk(record.content, record.at))
            else:
                yield from self._item(record.opcode, record.content)
        except UNREADABLE as problem:
            raise DamagedMcapError(f"damaged record at byte {record.at}: {problem}") from problem

    def _chunk_items(self, data: bytes) -> Iterator[RecordMessage | RecordAttachment]:
        for opcode, start, end in chunk_records(data):
            yield from self._item(opcode, data[start:end])

    def _item(self, opcode: int, content: bytes) -> Iterator[RecordMessage | RecordAttachment]:
        if opcode == Opcode.MESSAGE:
            yield self._declared.message(content)
        elif opcode == Opcode.ATTACHMENT:
            yield attachment_of(content)
        else:
            self._declared.take(opcode, content)


@dataclass(slots=True)
class Declared:
    """The channels and schemas of a file, as far as it was read, by number."""

    channels: dict[int, Channel] = field(default_factory=dict)
    schemas: dict[int, str] = field(default_factory=dict)

    def take(self, opcode: int, content: bytes) -> None:
        """Take a channel or a schema; other records change nothing."""
        if opcode == Opcode.CHANNEL:
            channel = Channel.read(ReadDataStream(BytesIO(content)))
            self.channels[channel.id] = channel
        elif opcode == Opcode.SCHEMA:
            schema = Schema.read(ReadDataStream(BytesIO(content)))
            self.schemas[schema.id] = schema.name

    def message(self, content: bytes) -> RecordMessage:
        """Return a message; raises `DamagedMcapError` for one on an unknown channel."""
        number, sequence, log_ns, _publish_ns = MESSAGE_FIELDS.unpack_from(content)
        channel = self.channels.get(number)
        if channel is None:
            raise DamagedMcapError(f"a message on channel {number}, which is not declared")
        schema, data = self.schemas.get(channel.schema_id, ""), content[MESSAGE_FIELDS.size :]
        encoding = channel.message_encoding
        return RecordMessage(channel.topic, encoding, schema, sequence, log_ns, data)


def attachment_of(content: bytes) -> RecordAttachment:
    """Return an attachment from its record."""
    found = Attachment.read(ReadDataStream(BytesIO(content)))
    return RecordAttachment(found.name, found.media_type, found.data)


def check_magic(start: bytes) -> None:
    """Raise `DamagedMcapError` unless these are MCAP's first bytes."""
    if start != MAGIC:
        raise DamagedMcapError(f"expected a flight record (MCAP), got {file_kind(start)}")


def chunk_records(data: bytes) -> Iterator[tuple[int, int, int]]:
    """Yield the records of an unpacked chunk: opcode, and where the content starts and ends.

    Raises `DamagedMcapError` for one that is longer than what is left.
    """
    at = 0
    while at < len(data):
        opcode, length = RECORD_HEAD.unpack_from(data, at)
        at += RECORD_HEAD.size
        if length > len(data) - at:
            raise DamagedMcapError(f"a record of {length} bytes in a chunk with fewer left")
        yield opcode, at, at + length
        at += length


_READ = frozenset((Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE, Opcode.CHUNK, Opcode.ATTACHMENT))


def raw_records(file: BinaryIO, at: int, is_read: Callable[[int], bool]) -> Iterator[RawRecord]:
    """Yield the records of a file's top level from byte `at` on, the file's position.

    Content is read of those that `is_read` names by opcode. Ends at the last whole record's end;
    raises `DamagedMcapError` for a record that cannot be one.
    """
    while len(head := file.read(RECORD_HEAD.size)) == RECORD_HEAD.size:
        opcode, length = RECORD_HEAD.unpack(head)
        if opcode == 0 or length > MOST_RECORD_BYTES:
            raise DamagedMcapError(
                f"damaged at byte {at}: expected a record of up to {MOST_RECORD_BYTES} bytes, got "
                f"type {opcode} of {length} bytes"
            )
        content: bytes | None = None
        if is_read(opcode):
            content = file.read(length)
            is_whole = len(content) == length
        else:
            is_whole = _skip(file, length)
        if not is_whole:
            return
        yield RawRecord(opcode, at, RECORD_HEAD.size + length, content)
        at += RECORD_HEAD.size + length


def _skip(file: BinaryIO, length: int) -> bool:
    """Skip so many bytes; return whether they are all there."""
    if not file.seekable():
        return len(file.read(length)) == length
    return length == 0 or (file.seek(length - 1, 1) >= 0 and len(file.read(1)) == 1)


def unpacked_chunk(content: bytes, at: int) -> bytes:
    """Return a chunk's records; raises `DamagedMcapError` unless size and CRC are right."""
    _first, _last, size, crc = CHUNK_HEAD.unpack_from(content)
    offset = CHUNK_HEAD.size
    (name_length,) = struct.unpack_from("<I", content, offset)
    name = content[offset + 4 : offset + 4 + min(name_length, 16)]
    packed = content[offset + 4 + name_length + 8 :]
    if size > MOST_RECORD_BYTES:
        raise DamagedMcapError(f"chunk at byte {at}: {size} bytes, limit {MOST_RECORD_BYTES}")
    try:
        data = _unpacked(name, packed, size)
    except (zstandard.ZstdError, RuntimeError, EOFError) as problem:
        raise DamagedMcapError(f"damaged chunk at byte {at}: {problem}") from problem
    if len(data) != size or (crc and zlib.crc32(data) != crc):
        raise DamagedMcapError(f"damaged chunk at byte {at}: its checksum does not match")
    return data


def _unpacked(name: bytes, packed: bytes, size: int) -> bytes:
    if name == b"zstd":
        # The frame's own statement of its size would be allocated unchecked.
        stated = zstandard.frame_content_size(packed)
        if stated not in (-1, size):
            raise DamagedMcapError(f"a chunk of {size} bytes holds a frame of {stated}")
        return zstandard.ZstdDecompressor().decompress(packed, max_output_size=max(size, 1))
    if name == b"lz4":
        return bytes(lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=size + 1))
    if name == b"":
        return packed
    raise DamagedMcapError(f"expected zstd, lz4 or no compression, got {name!a}")
