"""Shots: what one release of the shutter left in several files.

A multispectral camera writes a file for each band, one with a thermal sensor a second picture. They
share an identity, or a name but for its end, or only moment and place.
"""

import re
from bisect import bisect_left
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, hypot, radians

from recon.model.units import M_PER_DEG, NS_PER_S
from recon.product.photos.band import Kind, name_and_role
from recon.product.photos.photo import Photo

ORDER: dict[Kind, int] = {"visible": 0, "band": 1, "zoom": 2, "thermal": 3}
"""Which file leads a shot: the first of these has its clock, place and attitude."""
NAMED_WITHIN_NS = 2 * NS_PER_S
"""Files of one shot are written one after the other, each with its own second."""
UNNAMED_WITHIN_NS = NS_PER_S
UNNAMED_WITHIN_M = 3.0
DJI_NAME = re.compile(r"DJI_\d{14}_(\d{4,5})")
"""With a time, which may differ by a second between the files of a shot."""


@dataclass(frozen=True, slots=True)
class CameraShot:
    """One release of the shutter: its leading file, and those beside it."""

    lead: Photo
    others: tuple[Photo, ...] = ()

    @property
    def files(self) -> tuple[Photo, ...]:
        """The leading file and those beside it."""
        return (self.lead, *self.others)


def shots_of(photos: Sequence[Photo]) -> list[CameraShot]:
    """Return the shots of photos, by the time of their leading files; each photo is in one."""
    groups = [part for group in _by_statement(photos) for part in _in_time(group)]
    groups = [part for group in groups for part in _one_of_each(group)]
    leading = [group for group in groups if _has_visible(group)]
    _join([group for group in groups if not _has_visible(group)], leading)
    return sorted(map(_shot, leading), key=lambda shot: (shot.lead.clock_ns, shot.lead.name))


def _by_statement(photos: Sequence[Photo]) -> list[list[Photo]]:
    """Return photos by the identity of their shot, or by folder and name."""
    groups: dict[object, list[Photo]] = defaultdict(list)
    for photo in photos:
        groups[photo.capture or (photo.path.parent, _base(photo))].append(photo)
    return list(groups.values())


def _base(photo: Photo) -> str:
    base, _role = name_and_role(photo.path.stem)
    numbered = DJI_NAME.fullmatch(base)
    return base if numbered is None else numbered[1]


def _in_time(group: Sequence[Photo]) -> list[list[Photo]]:
    """Return a group's parts that lie apart in time: a card's numbers begin again."""
    parts: list[list[Photo]] = []
    for photo in sorted(group, key=lambda each: (each.clock_ns, each.name)):
        if parts and photo.clock_ns - parts[-1][0].clock_ns <= NAMED_WITHIN_NS:
            parts[-1].append(photo)
        else:
            parts.append([photo])
    return parts


def _one_of_each(group: Sequence[Photo]) -> list[list[Photo]]:
    """Return a group's parts with one file of each kind and band."""
    parts: list[list[Photo]] = []
    for photo in group:
        part = next((part for part in parts if _lacks(part, photo)), None)
        if part is None:
            parts.append([photo])
        else:
            part.append(photo)
    return parts


def _lacks(group: Sequence[Photo], photo: Photo) -> bool:
    return all(_role(each) != _role(photo) for each in group)


def _role(photo: Photo) -> tuple[Kind, str]:
    return photo.kind, photo.band.name if photo.band else ""


def _has_visible(group: Sequence[Photo]) -> bool:
    return any(photo.kind == "visible" for photo in group)


def _join(rest: Sequence[list[Photo]], leading: list[list[Photo]]) -> None:
    """Add groups without a picture in colour to the one at their moment and place; those that find
    none lead themselves (changes `leading`)."""
    leading.sort(key=lambda group: group[0].clock_ns)
    clocks = [group[0].clock_ns for group in leading]
    alone: list[list[Photo]] = []
    for group in sorted(rest, key=lambda group: (group[0].clock_ns, group[0].name)):
        first, clock_ns = group[0], group[0].clock_ns
        begin = bisect_left(clocks, clock_ns - UNNAMED_WITHIN_NS)
        end = bisect_left(clocks, clock_ns + UNNAMED_WITHIN_NS + 1)
        fitting = [
            each
            for each in (*leading[begin:end], *alone[-1:])
            if _are_together(each[0], first) and all(_lacks(each, photo) for photo in group)
        ]
        if fitting:
            nearest = min(
                fitting,
                key=lambda each: (abs(each[0].clock_ns - clock_ns), _apart_m(each[0], first)),
            )
            nearest.extend(group)
        else:
            alone.append(group)
    leading.extend(alone)


def _are_together(one: Photo, other: Photo) -> bool:
    is_near = abs(one.clock_ns - other.clock_ns) <= UNNAMED_WITHIN_NS
    return is_near and one.camera[0] == other.camera[0] and _apart_m(one, other) <= UNNAMED_WITHIN_M


def _apart_m(one: Photo, other: Photo) -> float:
    north_deg = one.latitude_deg - other.latitude_deg
    east_deg = (one.longitude_deg - other.longitude_deg) * cos(radians(one.latitude_deg))
    return M_PER_DEG * hypot(north_deg, east_deg)


def _shot(group: Sequence[Photo]) -> CameraShot:
    def order(photo: Photo) -> tuple[int, float, str]:
        wavelength_nm = photo.band.wavelength_nm if photo.band else None
        return ORDER[photo.kind], wavelength_nm or 0.0, photo.name

    lead, *others = sorted(group, key=order)
    return CameraShot(lead, tuple(others))
