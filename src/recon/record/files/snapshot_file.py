"""The file of the recovery snapshot: a checksummed payload, replaced as a whole.

    {"format":"recon-snapshot","version":2,"bytes":2210,"sha256":"9f86..."}
    <payload of that many bytes>

A write goes to a temporary file in the same folder, which is synced. Then the current file becomes
the previous one, and the temporary file the current one. Between any two of these steps, and at any
byte of the first, the current or the previous file is whole: a crash loses one write at most.
"""

import contextlib
import os
from collections.abc import Callable
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Annotated, Generic, TypeVar

import msgspec

CURRENT = "recon-snapshot.json"
PREVIOUS = "recon-snapshot.previous.json"
TEMPORARY = "recon-snapshot.tmp"
FORMAT = "recon-snapshot"
VERSION = 2
"""Grows when an older station could not read a newer snapshot's payload, or would lose what it must
not: 2 added the latch of an all stop."""
READABLE_VERSIONS = (1, VERSION)

MAX_BYTES = 32 * 1024 * 1024
"""200 missions of the longest kind are 4 MiB."""
_MAX_HEADER_BYTES = 512

T = TypeVar("T")


class _Header(msgspec.Struct, frozen=True):
    format: str
    version: int
    bytes: Annotated[int, msgspec.Meta(ge=0, le=2**52)]
    sha256: str


@dataclass(frozen=True, slots=True)
class SnapshotRead(Generic[T]):
    """The newest readable snapshot, None without any; and one sentence for each damaged file.

    `is_current_good`: the current file may replace the previous one.
    """

    value: T | None = None
    troubles: tuple[str, ...] = ()
    is_current_good: bool = False


def write_snapshot(folder: Path, payload: bytes, *, keep_current: bool) -> None:
    """Replace the snapshot in a folder and sync it to disk; raises OSError.

    `keep_current` makes the current file the previous one; False when the current one is damaged
    or missing, so that a good previous file stays.
    """
    if len(payload) > MAX_BYTES:
        raise OSError(f"expected a snapshot of up to {MAX_BYTES} bytes, got {len(payload)}")
    header = _Header(FORMAT, VERSION, len(payload), sha256(payload).hexdigest())
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    temporary = folder / TEMPORARY
    file = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    try:
        _write_all(file, msgspec.json.encode(header) + b"\n" + payload)
        os.fsync(file)
    finally:
        os.close(file)
    if keep_current:
        with contextlib.suppress(FileNotFoundError):
            os.replace(folder / CURRENT, folder / PREVIOUS)
    os.replace(temporary, folder / CURRENT)
    _sync_folder(folder)


def read_snapshot(folder: Path, decode: Callable[[bytes], T]) -> SnapshotRead[T]:
    """Return the current snapshot, or the previous one when the current file is damaged.

    `decode` turns a payload into a value and raises ValueError for one that it does not accept.
    """
    troubles: list[str] = []
    for name in (CURRENT, PREVIOUS):
        try:
            value = decode(_payload(folder / name))
        except FileNotFoundError:
            continue
        except (OSError, ValueError) as problem:
            reason = problem.strerror if isinstance(problem, OSError) else str(problem)
            troubles.append(f"recovery snapshot {folder / name} not used: {reason}")
            continue
        return SnapshotRead(value, tuple(troubles), name == CURRENT)
    return SnapshotRead(None, tuple(troubles))


def _payload(path: Path) -> bytes:
    """Return a file's payload; raises ValueError when anything about the file is wrong."""
    if path.exists() and not path.is_file():
        raise ValueError("it is not a regular file")
    with path.open("rb") as file:
        header = _header(file.readline(_MAX_HEADER_BYTES))
        # One byte more than announced, to notice a file that is too long.
        payload = file.read(header.bytes + 1)
    if len(payload) != header.bytes:
        raise ValueError(f"expected {header.bytes} bytes, got {_more(len(payload), header.bytes)}")
    if sha256(payload).hexdigest() != header.sha256:
        raise ValueError("its checksum does not match: the file is damaged")
    return payload


def _header(line: bytes) -> _Header:
    try:
        header = msgspec.json.decode(line, type=_Header)
    except (msgspec.DecodeError, UnicodeError, RecursionError) as problem:
        raise ValueError("its header is damaged") from problem
    if header.format != FORMAT:
        raise ValueError("it is not a recovery snapshot")
    if header.version not in READABLE_VERSIONS:
        raise ValueError(
            f"format version {header.version}; this station reads versions 1 to {VERSION}: start "
            "the station version that wrote it"
        )
    if header.bytes > MAX_BYTES:
        raise ValueError(f"expected up to {MAX_BYTES} bytes, the header announces {header.bytes}")
    return header


def _more(got: int, announced: int) -> str:
    return "more" if got > announced else str(got)


def _write_all(file: int, data: bytes) -> None:
    while data:
        data = data[os.write(file, data) :]


def _sync_folder(folder: Path) -> None:
    """Sync the folder's entries; Windows has no such call and journals them."""
    if os.name == "nt":
        return
    file = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(file)
    finally:
        os.close(file)
