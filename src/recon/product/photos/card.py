"""Which files below the folders of a person are photos of a flight, and what the others are."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from recon.model.errors import RecordError

SUFFIXES = (".jpg", ".jpeg", ".tif", ".tiff")
MARK = ".recon-written"
"""File in each folder that Recon writes: nothing below it is read as a photo."""
EARLIER_MARK = ".recon-tagged"
PROGRESS = "progress.jsonl"
"""Tells such a folder of still earlier versions, beside its masks."""
SYSTEM_FOLDERS = frozenset(
    ("__macosx", "$recycle.bin", "system volume information", "lost.dir", "@eadir")
)
THUMBNAILS = "thm"
"""Folder of a DJI card's previews."""
MASK = "_mask"
SYSTEM_FILES = frozenset(("thumbs.db", "desktop.ini"))

SYSTEM, PREVIEWS, OWN, MASKS = (
    "files of the computer's or card's system",
    "previews of the camera",
    "written by Recon",
    "masks",
)
UNREADABLE = "cannot be opened"


@dataclass(slots=True)
class Card:
    """Photos, and by reason the files and folders that were left alone."""

    photos: list[Path] = field(default_factory=list)
    left: dict[str, list[Path]] = field(default_factory=dict)

    def leave(self, reason: str, path: Path) -> None:
        """Note a file or folder as left alone."""
        self.left.setdefault(reason, []).append(path)


def card_of(images: Sequence[Path]) -> Card:
    """Return the photos in files and folders, each once; raises `RecordError` without any.

    A file that is named itself is taken whatever it is called, but nothing that Recon has written.
    """
    card = Card()
    for path in images:
        owner = next((each for each in (path, *path.resolve().parents) if is_own(each)), None)
        if owner is not None:
            raise RecordError(
                f"{path}: expected photos, got what Recon wrote to {owner}: name the folder "
                "with the cards"
            )
        if path.is_dir():
            _search(path, card)
        elif path.is_file():
            card.photos.append(path)
        else:
            raise RecordError(f"{path}: expected a photo or a folder, got no such file")
    card.photos = _once(card.photos)
    if not card.photos:
        raise RecordError(f"expected photos ({', '.join(SUFFIXES)}), got none")
    return card


def begin_own(folder: Path) -> None:
    """Make a folder that Recon writes, with its mark; raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / MARK).touch()


def is_own(folder: Path) -> bool:
    """Return whether Recon has written a folder."""
    if any((folder / mark).is_file() for mark in (MARK, EARLIER_MARK)):
        return True
    return (folder / PROGRESS).is_file() and (folder / "masks").is_dir()


def _search(top: Path, card: Card) -> None:
    def unreadable(problem: OSError) -> None:
        card.leave(UNREADABLE, Path(problem.filename or top))

    for name, folders, files in os.walk(top, onerror=unreadable):
        here = Path(name)
        reasons = {each: _reason_against_folder(here / each) for each in sorted(folders)}
        for each, reason in reasons.items():
            if reason:
                card.leave(reason, here / each)
        folders[:] = [each for each, reason in reasons.items() if not reason]
        for each in sorted(files):
            reason = _reason_against_file(each)
            if reason:
                card.leave(reason, here / each)
            else:
                card.photos.append(here / each)


def _reason_against_folder(folder: Path) -> str:
    name = folder.name.lower()
    if name in SYSTEM_FOLDERS or name.startswith("."):
        return SYSTEM
    if name == THUMBNAILS:
        return PREVIEWS
    return OWN if is_own(folder) else ""


def _reason_against_file(name: str) -> str:
    stem, suffix = os.path.splitext(name.lower())
    # A Mac writes `._NAME` with its own attributes beside each file on a card.
    if name.startswith(".") or name.lower() in SYSTEM_FILES:
        return SYSTEM
    if suffix not in SUFFIXES:
        return f"no photos that Recon reads ({suffix or 'without a suffix'})"
    return MASKS if stem.endswith(MASK) else ""


def _once(paths: Sequence[Path]) -> list[Path]:
    """Return paths without those that lead to a file again, as a folder within another does."""
    found: dict[Path, Path] = {}
    for path in paths:
        found.setdefault(path.resolve(), path)
    return list(found.values())
