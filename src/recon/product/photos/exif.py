"""A photo's clock, satellites' time and height, from EXIF."""

import re
from collections.abc import Mapping
from datetime import UTC, datetime
from math import isfinite
from typing import Any, Literal

from PIL.ExifTags import GPS, Base

from recon.model.units import NS_PER_S
from recon.product.photos.photo_error import PhotoError
from recon.product.photos.xmp import DJI, Xmp

Tags = Mapping[int, Any]
CAMERA_SERIAL = 0xC62F
"""TIFF tag of DNG, which MicaSense writes too."""
HeightReference = Literal["ellipsoid", "sea level", "not stated"]


def serial_of(exif: Tags, details: Tags, xmp: Xmp) -> str:
    """Return the serial number of a camera, or of its aircraft; empty where none is stated."""
    stated = details.get(Base.BodySerialNumber) or exif.get(CAMERA_SERIAL)
    names = "CameraSerialNumber", "DroneSerialNumber"
    return text_of(stated) or text_of(xmp.text(DJI, *names))


def text_of(value: object) -> str:
    """Return what can be printed of a tag's text, at most 64 characters."""
    text = value.decode("ascii", "replace") if isinstance(value, bytes) else str(value or "")
    return "".join(each for each in text if each.isprintable()).strip()[:64]


_DATE = re.compile(r"(\d{4})[:-](\d\d)[:-](\d\d)[ T](\d\d):(\d\d):(\d\d)")


def clock_of(exif: Tags, details: Tags) -> tuple[int, float]:
    """Return the camera's clock, as if it were UTC, and its step in seconds.

    Raises `PhotoError` without a time.
    """
    for source, tag in ((details, Base.DateTimeOriginal), (exif, Base.DateTime)):
        second_ns = _second_ns(text_of(source.get(tag)))
        if second_ns is None:
            continue
        digits = text_of(details.get(Base.SubsecTimeOriginal))
        share = int(digits[:9].ljust(9, "0")) if digits.isascii() and digits.isdigit() else None
        step_s = 1.0 if share is None else 10.0 ** -min(len(digits), 9)
        return second_ns + (share or 0), step_s
    raise PhotoError("expected EXIF with the time of the photo, got none")


def _second_ns(text: str) -> int | None:
    """Return the whole second that a text begins with, as if it were UTC; None for another text."""
    found = _DATE.match(text)
    if found is None:
        return None
    try:
        year, month, day, hour, minute, second = map(int, found.groups())
        moment = datetime(year, month, day, hour, minute, second, tzinfo=UTC)
    except ValueError:
        return None
    return round(moment.timestamp()) * NS_PER_S


def satellite_ns(gps: Tags, xmp: Xmp) -> int | None:
    """Return UTC by the satellites, by EXIF or DJI's XMP; None where it is not stated."""
    exposed_ns = _second_ns(xmp.text(DJI, "UTCAtExposure") or "")
    if exposed_ns is not None:
        return exposed_ns
    day = re.fullmatch(r"(\d{4})[:-](\d\d)[:-](\d\d)", text_of(gps.get(GPS.GPSDateStamp)))
    try:
        hours, minutes, seconds = (float(part) for part in gps[GPS.GPSTimeStamp])
        if day is None:
            return None
        midnight = datetime(int(day[1]), int(day[2]), int(day[3]), tzinfo=UTC)
        return round((midnight.timestamp() + 3600 * hours + 60 * minutes + seconds) * NS_PER_S)
    except (KeyError, TypeError, ValueError, ZeroDivisionError, OverflowError):
        return None


def number_of(value: Any, least: float = 1e-9) -> float | None:
    """Return a tag's finite number from `least` on; None where it is none."""
    try:
        number = float(value)
    except (TypeError, ValueError, ZeroDivisionError):
        return None
    return number if isfinite(number) and number >= least else None


BELOW_SEA_LEVEL, ABOVE_ELLIPSOID, BELOW_ELLIPSOID = 1, 2, 3
"""EXIF's GPSAltitudeRef; 0 is above sea level, and is what cameras write that do not know."""


def absolute_height(xmp: Xmp, gps: Tags) -> tuple[float | None, HeightReference]:
    """Return the height and what it is above: by DJI's XMP, or by EXIF."""
    height_m, kind = xmp.number(DJI, "AbsoluteAltitude"), xmp.text(DJI, "AltitudeType")
    if height_m is not None:
        return height_m, "ellipsoid" if kind == "RtkAlt" else "not stated"
    stated_m = number_of(gps.get(GPS.GPSAltitude), least=0.0)
    if stated_m is None:
        return None, "not stated"
    raw = gps.get(GPS.GPSAltitudeRef, 0)
    side = raw[0] if isinstance(raw, bytes) and raw else raw
    height_m = -stated_m if side in (BELOW_SEA_LEVEL, BELOW_ELLIPSOID) else stated_m
    return height_m, "ellipsoid" if side in (ABOVE_ELLIPSOID, BELOW_ELLIPSOID) else "sea level"
