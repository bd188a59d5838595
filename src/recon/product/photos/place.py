"""Where a photo was taken: EXIF's degrees with their sides, or the signed ones of its XMP."""

import re
from dataclasses import dataclass
from math import isfinite
from typing import Any

from PIL.ExifTags import GPS

from recon.product.photos.exif import Tags, text_of
from recon.product.photos.photo_error import PhotoError
from recon.product.photos.xmp import DJI, Xmp

EXIF = "http://ns.adobe.com/exif/1.0"
AGREE_DEG = 0.002
"""EXIF and XMP nearer than this (200 m) mean one place: RTK corrects one of them by metres."""
LATITUDE, LONGITUDE = ("GpsLatitude", "Latitude"), ("GpsLongitude", "GpsLongtitude", "Longitude")
"""DJI's names; early firmware misspelt one."""

CONTRADICTION = "EXIF and XMP state different positions: the one of XMP is taken"

Degrees = tuple[float, float]
"""Latitude and longitude."""


@dataclass(frozen=True, slots=True)
class StatedPlace:
    """A photo's position, and whether plain EXIF alone gives it to any program."""

    latitude_deg: float
    longitude_deg: float
    is_in_exif: bool
    note: str = ""
    """What EXIF and XMP disagree about."""


def place_of(gps: Tags, xmp: Xmp) -> StatedPlace:
    """Return a photo's position: by EXIF where it is complete and its XMP does not contradict it.

    Raises `PhotoError` with what is missing.
    """
    signed = _by_xmp(xmp)
    stated, missing = _by_exif(gps)
    is_whole = stated is not None and not missing and _is_on_earth(stated)
    if stated is not None and is_whole and (signed is None or _is_near(stated, signed)):
        return StatedPlace(*stated, True)
    if signed is not None:
        return StatedPlace(*signed, False, CONTRADICTION if is_whole else "")
    if stated is None:
        raise PhotoError("expected EXIF with a position, got none")
    if not _is_on_earth(stated):
        raise PhotoError(f"expected a position on earth, got {stated}: no GNSS fix?")
    raise PhotoError(
        f"expected {' and '.join(missing)} beside EXIF's position: without them nobody knows on "
        "which side of the equator and of Greenwich it is; write them with exiftool"
    )


def _by_exif(gps: Tags) -> tuple[Degrees | None, list[str]]:
    """Return EXIF's position, and the tags it lacks."""
    sides = {
        "GPSLatitudeRef (N or S)": _side(gps.get(GPS.GPSLatitudeRef), "N", "S"),
        "GPSLongitudeRef (E or W)": _side(gps.get(GPS.GPSLongitudeRef), "E", "W"),
    }
    try:
        north, east = (_degrees(gps[tag]) for tag in (GPS.GPSLatitude, GPS.GPSLongitude))
    except (KeyError, TypeError, ValueError, ZeroDivisionError):
        return None, []
    signs = list(sides.values())
    place = north * (signs[0] or 1), east * (signs[1] or 1)
    return place, [name for name, sign in sides.items() if sign is None]


def _degrees(parts: Any) -> float:
    degrees, minutes, seconds = (float(part) for part in parts)
    return degrees + minutes / 60.0 + seconds / 3600.0


def _side(value: object, positive: str, negative: str) -> int | None:
    return {positive: 1, negative: -1}.get(text_of(value).upper()[:1])


def _by_xmp(xmp: Xmp) -> Degrees | None:
    north, east = xmp.number(DJI, *LATITUDE), xmp.number(DJI, *LONGITUDE)
    if north is None or east is None:
        north = _coordinate(xmp.text(EXIF, "GPSLatitude"))
        east = _coordinate(xmp.text(EXIF, "GPSLongitude"))
    if north is None or east is None or not _is_on_earth((north, east)):
        return None
    return north, east


_COORDINATE = re.compile(
    r"(\d{1,3}),(\d{1,2}(?:\.\d{1,12})?)(?:,(\d{1,2}(?:\.\d{1,12})?))?([NSEW])"
)


def _coordinate(text: str | None) -> float | None:
    """Return the degrees of `41,54.1234N` or `41,54,7.4N`, as XMP writes EXIF's."""
    found = _COORDINATE.fullmatch(text or "")
    if found is None:
        return None
    degrees, minutes, seconds = (float(part or 0.0) for part in found.groups()[:3])
    value = degrees + minutes / 60.0 + seconds / 3600.0
    return -value if found[4] in "SW" else value


def _is_on_earth(place: Degrees) -> bool:
    """Return whether a position can be one: cameras without a fix write zeros."""
    north, east = place
    is_number = isfinite(north) and isfinite(east)
    return is_number and abs(north) <= 90.0 and abs(east) <= 180.0 and place != (0.0, 0.0)


def _is_near(one: Degrees, other: Degrees) -> bool:
    return all(abs(a - b) <= AGREE_DEG for a, b in zip(one, other, strict=True))
