"""Replacing several small files of a folder together, with undo.

Theory of operation. Each change has a folder of its own in `history/`, named by a rising number,
with the files as they were before it and a manifest:

    0007.new/         being written: a crash here has changed nothing
    0007.unfinished/  complete, and the folder's files are being replaced one by one
    0007/             the change is complete

The manifest also has digests of the files as the change left them: what was edited by hand since
then is not lost by an undo, because `changed_since` names it.

A crash while files are replaced leaves `.unfinished`, and `finish_interrupted` puts the old files
back. Undo is the same on purpose: it renames the newest change to `.unfinished` and puts its files
back. So the folder never stays half old and half new.
"""

import json
import os
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from recon.model.errors import RecordError
from recon.record.files.atomic_file import replace_file

HISTORY_FOLDER = "history"
CHANGES_KEPT = 20
MANIFEST = "manifest.json"
UNFINISHED = ".unfinished"
FILE_MODE = 0o644

Files = Mapping[str, bytes | None]
"""Contents by name inside the folder; None: no such file."""


@dataclass(frozen=True, slots=True)
class SavedChange:
    """A change that can be undone."""

    number: int
    what: str
    by: str
    utc: str


def replace_files(folder: Path, files: Files, *, what: str, by: str, utc: str) -> None:
    """Replace these files, all of them or none. Raises OSError; then none is replaced."""
    finish_interrupted(folder)
    before = {name: _content(folder / name) for name in files}
    number = max((change.number for change in _changes(folder)), default=0) + 1
    entry = folder / HISTORY_FOLDER / f"{number:04}"
    unfinished = entry.with_name(entry.name + UNFINISHED)
    after = {name: _digest(content) for name, content in files.items()}
    about = {"what": what, "by": by, "utc": utc, "after": after}
    _write_entry(entry, unfinished, before, about)
    try:
        _put(folder, files)
    except OSError:
        finish_interrupted(folder)
        raise
    os.replace(unfinished, entry)
    for change in _changes(folder)[:-CHANGES_KEPT]:
        shutil.rmtree(folder / HISTORY_FOLDER / f"{change.number:04}", ignore_errors=True)


def last_change(folder: Path) -> SavedChange | None:
    """Return the newest change, which `undo` would take back; None without one."""
    changes = _changes(folder)
    return changes[-1] if changes else None


def files_before(folder: Path, change: SavedChange) -> Files:
    """Return the files as they were before a change. Raises RecordError."""
    return _read_entry(folder, folder / HISTORY_FOLDER / f"{change.number:04}")


def changed_since(folder: Path, change: SavedChange) -> list[str]:
    """Return the files of a change that are not as it left them. Raises RecordError or OSError."""
    after = _manifest(folder / HISTORY_FOLDER / f"{change.number:04}").get("after")
    left = after if isinstance(after, dict) else {}
    names = files_before(folder, change)
    return [name for name in names if _digest(_content(folder / name)) != left.get(name, "")]


def undo(folder: Path, change: SavedChange) -> None:
    """Put the files back as they were before the newest change. Raises RecordError or OSError."""
    entry = folder / HISTORY_FOLDER / f"{change.number:04}"
    _read_entry(folder, entry)  # One that cannot be read stays a change, and blocks no start.
    os.replace(entry, entry.with_name(entry.name + UNFINISHED))
    finish_interrupted(folder)


def finish_interrupted(folder: Path) -> bool:
    """Put back the old files of a change that a crash has interrupted; return whether one was.

    Raises OSError, or RecordError for a change that was edited by hand.
    """
    history = folder / HISTORY_FOLDER
    if not history.is_dir():
        return False
    for part in history.glob("*.new"):
        shutil.rmtree(part, ignore_errors=True)
    interrupted = sorted(history.glob(f"*{UNFINISHED}"), reverse=True)
    for entry in interrupted:
        _put(folder, _read_entry(folder, entry))
        shutil.rmtree(entry)
    return bool(interrupted)


def _write_entry(entry: Path, unfinished: Path, before: Files, about: Mapping[str, object]) -> None:
    """Write a change's folder, whole or not at all."""
    new = entry.with_name(entry.name + ".new")
    shutil.rmtree(new, ignore_errors=True)
    new.mkdir(parents=True)
    names = list(before)
    for index, content in enumerate(before.values()):
        if content is not None:
            replace_file(new / str(index), content, FILE_MODE)
    absent = [name for name, content in before.items() if content is None]
    manifest = {**about, "files": names, "absent": absent}
    replace_file(new / MANIFEST, json.dumps(manifest, indent=1).encode(), FILE_MODE)
    os.replace(new, unfinished)


def _read_entry(folder: Path, entry: Path) -> Files:
    manifest = _manifest(entry)
    try:
        names, absent = list(manifest["files"]), set(manifest["absent"])
        for name in names:
            _refuse_outside(folder, name)
        return {
            name: None if name in absent else (entry / str(index)).read_bytes()
            for index, name in enumerate(names)
        }
    except (OSError, KeyError, TypeError, ValueError) as problem:
        raise _unreadable(entry) from problem


def _manifest(entry: Path) -> dict[str, Any]:
    try:
        manifest = json.loads((entry / MANIFEST).read_bytes())
    except (OSError, ValueError, RecursionError) as problem:
        raise _unreadable(entry) from problem
    if not isinstance(manifest, dict):
        raise _unreadable(entry)
    return manifest


def _unreadable(entry: Path) -> RecordError:
    return RecordError(f"{entry}: expected an earlier version of files, got something else")


def _refuse_outside(folder: Path, name: str) -> None:
    """A folder may come from elsewhere: its history names no file outside it."""
    if not (folder / name).resolve().is_relative_to(folder.resolve()):
        raise RecordError(f"{folder}: expected a file inside the folder, got {name!a}")


def _put(folder: Path, files: Files) -> None:
    for name, content in files.items():
        _refuse_outside(folder, name)
        path = folder / name
        if content is None:
            path.unlink(missing_ok=True)
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            replace_file(path, content, FILE_MODE)


def _changes(folder: Path) -> list[SavedChange]:
    """Return the complete changes, the oldest first; unreadable ones are excluded."""
    changes = []
    for entry in (folder / HISTORY_FOLDER).glob("[0-9]*"):
        try:
            manifest = _manifest(entry)
            number = int(entry.name)
            about = (manifest["what"], manifest["by"], manifest["utc"])
        except (RecordError, ValueError, KeyError):
            continue
        changes.append(SavedChange(number, *(str(part) for part in about)))
    return sorted(changes, key=lambda change: change.number)


def _digest(content: bytes | None) -> str | None:
    return None if content is None else sha256(content).hexdigest()


def _content(path: Path) -> bytes | None:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return None
