"""What `recon tag` reads, and what it says about files that it leaves out."""

import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from recon.cli.output import printable
from recon.cli.progress import progress_over, usable_cores
from recon.model.errors import RecordError
from recon.product.photos.card import Card
from recon.product.photos.copies import without_copies
from recon.product.photos.names import unique_names
from recon.product.photos.photo import Photo, read_photo_facts
from recon.product.photos.photo_error import PhotoError
from recon.product.timing import Timed

MOST_NAMED = 5
"""Photos named for one reason; all are in the table."""
COPY = "a copy, which counts once, of"


def refuse_photos_below(out: Path, photos: Sequence[Path]) -> None:
    """Raise `RecordError` where the folder to write is the cards' own: it is never read again."""
    whole = out.resolve()
    for path in photos:
        if whole in path.resolve().parents:
            raise RecordError(f"--out: expected a folder without photos, got {out} with {path}")


def read_photos(paths: Sequence[Path]) -> tuple[list[Photo], dict[str, str]]:
    """Return the photos without copies, and by name why others are none; raises `RecordError`."""
    names, photos, refused = unique_names(paths), list[Photo](), dict[str, str]()

    def read(path: Path) -> Photo | str:
        try:
            return read_photo_facts(path, names[path])
        except PhotoError as problem:
            return str(problem)

    with ThreadPoolExecutor(usable_cores()) as pool:
        for path, found in zip(
            paths, progress_over(pool.map(read, paths), "reading photos", len(paths)), strict=True
        ):
            if isinstance(found, str):
                refused[names[path]] = found
            else:
                photos.append(found)
    try:
        photos, copies = without_copies(photos)
    except OSError as problem:
        raise RecordError(f"{problem.filename}: {problem.strerror}") from problem
    refused.update({name: f"{COPY} {first}" for name, first in copies.items()})
    return photos, refused


def print_clocks(timed: Timed) -> None:
    """Print the cameras' clocks and what they warn of."""
    for clock in timed.clocks:
        print(printable(str(clock)))
    for warning in timed.warnings:
        warn(warning)


def print_left(card: Card) -> None:
    """Print what was left alone, by reason."""
    for reason, paths in card.left.items():
        print(printable(f"left out: {_listed([path.name for path in paths])}: {reason}"))


def print_refused(refused: Mapping[str, str]) -> None:
    """Print each reason once; copies together, for each has its own photo."""
    copies = [name for name, reason in sorted(refused.items()) if reason.startswith(COPY)]
    if copies:
        print(f"left out: {_listed(copies)}: copies of other photos, which count once")
    rest = {name: reason for name, reason in refused.items() if name not in copies}
    print_grouped("not tagged: ", rest)


def _listed(names: Sequence[str]) -> str:
    """Return how many there are, with the first names."""
    more = len(names) - MOST_NAMED
    return ", ".join(names[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")


def print_grouped(before: str, refused: Mapping[str, str]) -> None:
    """Print each reason once, with some of the photos."""
    by_reason: dict[str, list[str]] = {}
    for name, reason in sorted(refused.items()):
        by_reason.setdefault(reason.removeprefix(f"{name}: "), []).append(name)
    for reason, names in by_reason.items():
        warn(f"{before}{_listed(names)}: {reason}")


def warn(text: str) -> None:
    """Print a warning."""
    print(f"warning: {printable(text)}", file=sys.stderr)
