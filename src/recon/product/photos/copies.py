"""Copies of one photo on a card: each counts once."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from hashlib import blake2b, file_digest

from recon.product.photos.photo import Photo


def without_copies(photos: Sequence[Photo]) -> tuple[list[Photo], dict[str, str]]:
    """Return the photos without copies, and by a copy's name that of the photo it repeats.

    A copy has the same content. Where the camera states its serial number, the same statements of
    moment, place, exposure and lens are as good, for software that edits a photo leaves these
    alone; with a clock in whole seconds the file's name too has to be the same. Raises OSError.
    """
    alike: dict[object, list[Photo]] = defaultdict(list)
    for photo in photos:
        alike[_statement(photo)].append(photo)
    copies: dict[str, str] = {}
    for group in alike.values():
        if len(group) > 1:
            copies.update(_copies(group))
    return [each for each in photos if each.name not in copies], copies


def _statement(photo: Photo) -> object:
    place = photo.latitude_deg, photo.longitude_deg
    picture = photo.cols, photo.rows, photo.across_deg, photo.exposure_s, photo.kind, photo.band
    return photo.camera, photo.clock_ns, place, picture


def _copies(group: Sequence[Photo]) -> dict[str, str]:
    first_by_mark: dict[object, str] = {}
    copies: dict[str, str] = {}
    for photo in group:
        marks = list(_marks(photo))
        first = next((first_by_mark[mark] for mark in marks if mark in first_by_mark), None)
        if first is not None:
            copies[photo.name] = first
        first_by_mark.update(dict.fromkeys(marks, first or photo.name))
    return copies


def _marks(photo: Photo) -> Iterator[object]:
    if photo.camera[2]:
        yield photo.path.stem if photo.clock_step_s == 1.0 else "moment"
    with photo.path.open("rb") as file:
        yield file_digest(file, blake2b).digest()
