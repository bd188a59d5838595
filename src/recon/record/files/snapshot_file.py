"""The file of the recovery snapshot: a checksummed payload, replaced as a whole.

A write goes to a temporary file in the same folder, which is synced. Then the current file becomes
the previous one, and the temporary file the current one. Between any two of these steps, and at any
byte of the first, the current or the previous file is whole: a crash loses one write at most.
"""

import contextlib
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from recon.record.files.checked_file import CheckedFormat

CURRENT = "recon-snapshot.json"
PREVIOUS = "recon-snapshot.previous.json"
TEMPORARY = "recon-snapshot.tmp"
SNAPSHOT = CheckedFormat("recon-snapshot", "recovery snapshot", 2, 32 * 1024 * 1024)
"""The version grows when an older station could not read a newer snapshot's payload, or would lose
what it must not: 2 added the latch of an all stop. 200 missions of the longest kind are 4 MiB."""

T = TypeVar("T")


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
    content = SNAPSHOT.encode(payload)
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    temporary = folder / TEMPORARY
    file = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    try:
        _write_all(file, content)
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
            value = decode(SNAPSHOT.read(folder / name))
        except FileNotFoundError:
            continue
        except (OSError, ValueError) as problem:
            reason = problem.strerror if isinstance(problem, OSError) else str(problem)
            troubles.append(f"recovery snapshot {folder / name} not used: {reason}")
            continue
        return SnapshotRead(value, tuple(troubles), name == CURRENT)
    return SnapshotRead(None, tuple(troubles))


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
