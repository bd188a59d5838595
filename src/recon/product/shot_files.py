"""The files of shots, each with the time and pose of its shot's leading one."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from recon.product.photos.photo import Photo
from recon.product.photos.shots import CameraShot
from recon.product.timing import TimedPhoto

MAIN = "odm"
FOLDERS = {
    "visible": MAIN,
    "band": f"{MAIN}-bands",
    "zoom": f"{MAIN}-zoom",
    "thermal": f"{MAIN}-thermal",
}
"""Project folders by kind of file: no software makes one mosaic of several kinds."""


@dataclass(slots=True)
class ShotFiles:
    """All files that are tagged, those of a shot one after the other, and why the rest are not."""

    photos: list[TimedPhoto] = field(default_factory=list)
    shot: dict[str, str] = field(default_factory=dict)
    """By a file's name the name of its shot's leading file."""
    refused: dict[str, str] = field(default_factory=dict)

    def shot_of(self, timed: TimedPhoto) -> str:
        """Return the name of the leading file of a file's shot."""
        return self.shot[timed.photo.name]

    def leads(self, timed: TimedPhoto) -> bool:
        """Return whether a file is the leading one of its shot."""
        return self.shot_of(timed) == timed.photo.name

    @property
    def leading(self) -> list[TimedPhoto]:
        """The leading files, one of each shot."""
        return [each for each in self.photos if self.leads(each)]

    def of(self, leads: Iterable[str]) -> list[TimedPhoto]:
        """Return the files of some shots."""
        wanted = frozenset(leads)
        return [each for each in self.photos if self.shot[each.photo.name] in wanted]

    def folder_of_each(self) -> dict[str, str]:
        """Return the project folder of each kind; without pictures in colour the first kind that is
        there is the main one."""
        kinds = {each.photo.kind for each in self.photos}
        first = next((kind for kind in FOLDERS if kind in kinds), "visible")
        return FOLDERS | {first: MAIN}


def files_of(
    leads: Sequence[TimedPhoto],
    shots: Sequence[CameraShot],
    refused: Mapping[str, str],
    across_deg: float | None,
) -> ShotFiles:
    """Return the files of shots whose leading files have a pose, or are refused with a reason.

    `across_deg` is what a person states of the leading camera.
    """
    found = ShotFiles()
    others = {shot.lead.name: shot.others for shot in shots}
    for lead in leads:
        found.photos.append(lead)
        found.shot[lead.photo.name] = lead.photo.name
        for photo in others[lead.photo.name]:
            _add(found, lead, photo, across_deg)
    for name, reason in refused.items():
        found.refused.update({photo.name: reason for photo in others.get(name, ())})
    return found


def _add(found: ShotFiles, lead: TimedPhoto, photo: Photo, stated_deg: float | None) -> None:
    field_deg = photo.across_deg
    if photo.kind == lead.photo.kind and stated_deg is not None:
        field_deg = stated_deg
    if field_deg is None:
        found.refused[photo.name] = (
            "it goes with another photo, but EXIF states no focal length for it: tag such files "
            "alone, with --field"
        )
        return
    view = replace(lead.view, across_deg=field_deg, cols=photo.cols, rows=photo.rows)
    found.photos.append(replace(lead, photo=photo, view=view))
    found.shot[photo.name] = lead.photo.name
