"""A payload in a file with a checksum, read as untrusted input.

{"format":"recon-snapshot","version":2,"bytes":2210,"sha256":"9f86..."}
<payload of that many bytes>
"""

from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Annotated

import msgspec

_MAX_HEADER_BYTES = 512


@dataclass(frozen=True, slots=True)
class CheckedFormat:
    """One kind of file: its name in the header, its name in sentences, and its newest version."""

    format: str
    noun: str
    version: int
    max_bytes: int

    def encode(self, payload: bytes) -> bytes:
        """Return a file's content; raises OSError for a payload that is too large."""
        if len(payload) > self.max_bytes:
            raise OSError(
                f"expected a {self.noun} of up to {self.max_bytes} bytes, got {len(payload)}"
            )
        header = _Header(self.format, self.version, len(payload), sha256(payload).hexdigest())
        return msgspec.json.encode(header) + b"\n" + payload

    def read(self, path: Path) -> bytes:
        """Return a file's payload; raises OSError, or ValueError when anything is wrong with it."""
        if path.exists() and not path.is_file():
            raise ValueError("it is not a regular file")
        with path.open("rb") as file:
            header = self._header(file.readline(_MAX_HEADER_BYTES))
            # One byte more than announced, to notice a file that is too long.
            payload = file.read(header.bytes + 1)
        if len(payload) != header.bytes:
            got = "more" if len(payload) > header.bytes else str(len(payload))
            raise ValueError(f"expected {header.bytes} bytes, got {got}")
        if sha256(payload).hexdigest() != header.sha256:
            raise ValueError("its checksum does not match: the file is damaged")
        return payload

    def _header(self, line: bytes) -> "_Header":
        try:
            header = msgspec.json.decode(line, type=_Header)
        except (msgspec.DecodeError, UnicodeError, RecursionError) as problem:
            raise ValueError("its header is damaged") from problem
        if header.format != self.format:
            raise ValueError(f"it is not a {self.noun}")
        if not 1 <= header.version <= self.version:
            reads = "version 1" if self.version == 1 else f"versions 1 to {self.version}"
            raise ValueError(
                f"format version {header.version}; this station reads {reads}: start "
                "the station version that wrote it"
            )
        if header.bytes > self.max_bytes:
            raise ValueError(
                f"expected up to {self.max_bytes} bytes, the header announces {header.bytes}"
            )
        return header


class _Header(msgspec.Struct, frozen=True):
    format: str
    version: int
    bytes: Annotated[int, msgspec.Meta(ge=0, le=2**52)]
    sha256: str
