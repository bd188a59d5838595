"""A flight record opened for seeking: any chunk by its time, also in a file that was cut.

Opening reads the heads of all records and skips the chunks, so it takes a second for two hours of
frames, and needs no summary. Every read is bounded as in `mcap_read`.
"""

import os
import struct
from bisect import bisect_right
from collections.abc import Collection, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from mcap.exceptions import McapError
from mcap.opcode import Opcode

from recon.model.errors import RecordError
from recon.record.files.file_lock import lock_file
from recon.record.mcap.mcap_file import CHUNK_HEAD, RECORD_HEAD
from recon.record.mcap.mcap_read import (
    MAGIC,
    MESSAGE_FIELDS,
    DamagedMcapError,
    Declared,
    RecordAttachment,
    RecordMessage,
    attachment_of,
    check_magic,
    chunk_records,
    raw_records,
    unpacked_chunk,
)

_READ = frozenset((Opcode.SCHEMA, Opcode.CHANNEL, Opcode.ATTACHMENT))


@dataclass(frozen=True, slots=True)
class _Chunk:
    at: int
    length: int
    first_ns: int
    last_ns: int
    """Latest time in this chunk and all earlier ones."""


class RecordFile:
    """A file's chunks by time; used by one thread, and closed by it.

    `trouble` has the reason of an early end, empty without one.
    """

    def __init__(self, path: Path) -> None:
        """Open a file; raises OSError, and `RecordError` for one that is no MCAP file."""
        self.path = path
        self.trouble = ""
        self.attachments: dict[str, RecordAttachment] = {}
        self._declared = Declared()
        self._chunks: list[_Chunk] = []
        self._file = path.open("rb")
        # Nobody removes or repairs what is read here; a file being written has its writer's lock.
        with suppress(OSError):
            lock_file(self._file.fileno(), shared=True)
        try:
            self._scan()
        except BaseException:
            self._file.close()
            raise
        self._firsts = [chunk.first_ns for chunk in self._chunks]
        self._lasts = [chunk.last_ns for chunk in self._chunks]

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    @property
    def topics(self) -> set[str]:
        """The topics that it declares."""
        return {channel.topic for channel in self._declared.channels.values()}

    @property
    def chunk_count(self) -> int:
        """How many chunks the file has."""
        return len(self._chunks)

    @property
    def last_ns(self) -> int:
        """The time of the last message; 0 without any."""
        return self._lasts[-1] if self._lasts else 0

    def chunk_before(self, at_ns: int) -> int:
        """Return the last chunk that begins at or before a time; 0 without one."""
        return max(0, bisect_right(self._firsts, at_ns) - 1)

    def chunk_reaching(self, at_ns: int) -> int:
        """Return the first chunk with messages at or after a time; the last one without any."""
        return min(bisect_right(self._lasts, at_ns - 1), max(0, len(self._chunks) - 1))

    def messages(
        self, first: int, past: int | None = None, topics: Collection[str] | None = None
    ) -> Iterator[RecordMessage]:
        """Yield the messages of chunks `first` up to before `past`, of all topics or of some.

        Raises `RecordError` for a damaged chunk.
        """
        wanted = None
        if topics is not None:
            wanted = {n for n, each in self._declared.channels.items() if each.topic in topics}
        for chunk in self._chunks[first:past]:
            self._file.seek(chunk.at + RECORD_HEAD.size)
            content = self._file.read(chunk.length - RECORD_HEAD.size)
            try:
                yield from self._of_chunk(unpacked_chunk(content, chunk.at), wanted)
            except struct.error as problem:
                raise DamagedMcapError(f"damaged chunk at byte {chunk.at}: {problem}") from problem

    def _of_chunk(self, data: bytes, wanted: Collection[int] | None) -> Iterator[RecordMessage]:
        for opcode, start, end in chunk_records(data):
            if opcode == Opcode.MESSAGE:
                number, *_ = MESSAGE_FIELDS.unpack_from(data, start)
                if wanted is None or number in wanted:
                    yield self._declared.message(data[start:end])

    def _scan(self) -> None:
        try:
            check_magic(self._file.read(len(MAGIC)))
        except DamagedMcapError as problem:
            raise DamagedMcapError(f"{self.path}: {problem}") from problem
        try:
            for record in raw_records(self._file, len(MAGIC), _READ.__contains__):
                if record.opcode == Opcode.DATA_END:
                    return
                if record.opcode == Opcode.CHUNK:
                    self._add_chunk(record.at, record.length)
                elif record.content is not None:
                    self._add(record.opcode, record.content)
            self.trouble = "the file ends without MCAP's summary: it was cut, or is being written"
        except DamagedMcapError as problem:
            self.trouble = str(problem)
        except (McapError, struct.error, UnicodeDecodeError, IndexError) as problem:
            raise RecordError(f"{self.path}: a record's head is damaged: {problem}") from problem

    def _add_chunk(self, at: int, length: int) -> None:
        self._file.seek(at + RECORD_HEAD.size)
        first_ns, last_ns, *_ = CHUNK_HEAD.unpack(self._file.read(CHUNK_HEAD.size))
        self._file.seek(at + length, os.SEEK_SET)
        before_ns = self._chunks[-1].last_ns if self._chunks else 0
        self._chunks.append(_Chunk(at, length, first_ns, max(before_ns, last_ns)))

    def _add(self, opcode: int, content: bytes) -> None:
        if opcode == Opcode.ATTACHMENT:
            item = attachment_of(content)
            self.attachments.setdefault(item.name, item)
        else:
            self._declared.take(opcode, content)
