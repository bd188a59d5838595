"""A photo's own statements: time, place, camera, attitude, from EXIF and DJI's XMP.

The pixels are not decoded. A photo is hostile: sizes are bounded, and what Pillow raises on damage
becomes a `PhotoError`.
"""

import math
import re
import warnings
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from io import BytesIO
from math import isfinite
from pathlib import Path
from typing import Any, Literal

from PIL import Image, UnidentifiedImageError
from PIL.ExifTags import GPS, IFD, Base

from recon.model.errors import ReconError
from recon.model.units import NS_PER_S
from recon.product.photos.xmp import DJI, Xmp, XmpError, read_xmp

SUFFIXES = (".jpg", ".jpeg")
LARGEST_BYTES = 256 * 1024 * 1024
MOST_PIXELS = 400_000_000
START_OF_SCAN, END_OF_IMAGE = b"\xff\xda", b"\xff\xd9"

DIAGONAL_OF_FULL_FRAME_MM = 43.2666
UNIT_MM = {2: 25.4, 3: 10.0, 4: 1.0, 5: 0.001}
"""Millimetres per unit of FocalPlaneResolutionUnit."""


class PhotoError(ReconError):
    """A photo that cannot be tagged; the text names the file and the reason."""


@dataclass(frozen=True, slots=True)
class GimbalAttitude:
    """Attitude of the camera, by its gimbal: yaw clockwise from north, pitch -90 straight down,
    roll to the right, in degrees."""

    yaw_deg: float
    pitch_deg: float
    roll_deg: float | None = None


HeightReference = Literal["ellipsoid", "sea level", "not stated"]


@dataclass(frozen=True, slots=True)
class Photo:
    """What a photo's file states; None where it does not."""

    path: Path
    name: str
    """Name in all output about it: unique, without spaces."""
    cols: int
    rows: int
    orientation: int
    """EXIF orientation, 1 to 8: how to turn the pixels to be upright."""
    camera: tuple[str, str, str]
    """Make, model and serial number of the body; empty where not stated."""
    clock_ns: int
    """The camera's clock, read as UTC."""
    clock_step_s: float
    """Step of the clock: 1 where EXIF has whole seconds."""
    latitude_deg: float
    longitude_deg: float
    satellite_ns: int | None
    """UTC by the satellites, where the camera wrote it."""
    across_deg: float | None
    """Field of view along the longer side."""
    attitude: GimbalAttitude | None
    height_above_takeoff_m: float | None
    flight_yaw_deg: float | None = None
    """Heading of the aircraft's nose."""
    absolute_height_m: float | None = None
    height_reference: HeightReference = "not stated"
    """What the absolute height is above. Without RTK it is one of sea level that may be tens of
    metres off, and EXIF often calls one above the ellipsoid the same."""
    horizontal_sigma_m: float | None = None
    vertical_sigma_m: float | None = None
    """Standard deviations of the position by RTK; None where RTK gave none."""
    notes: tuple[str, ...] = ()
    """Sentences on statements that could not be read."""

    @property
    def camera_name(self) -> str:
        """Return the camera's name for a person."""
        return " ".join(part for part in self.camera if part) or "unknown camera"


def read_photo_facts(path: Path, name: str) -> Photo:
    """Return a photo's statements; raises `PhotoError`."""
    try:
        size = path.stat().st_size
        if size > LARGEST_BYTES:
            raise PhotoError(f"{path.name}: {size} bytes, limit {LARGEST_BYTES}")
        data = path.read_bytes()
    except OSError as problem:
        raise PhotoError(f"{path.name}: cannot be read: {problem.strerror}") from problem
    if not data.startswith(b"\xff\xd8"):
        raise PhotoError(f"{path.name}: expected a JPEG, got another file")
    if not _is_whole(data):
        raise PhotoError(f"{path.name}: the file is cut off: copy it from the card again")
    try:
        with warnings.catch_warnings(action="ignore"), Image.open(BytesIO(data)) as image:
            return _facts(path, name, image)
    except PhotoError:
        raise
    except UnidentifiedImageError as problem:
        raise PhotoError(f"{path.name}: expected a readable JPEG, got a damaged one") from problem
    except Exception as problem:
        # Pillow documents no closed set of errors for damaged metadata.
        text = f"{type(problem).__name__}: {problem}"
        raise PhotoError(f"{path.name}: its EXIF data is damaged ({text:.120})") from problem


def unique_names(paths: Sequence[Path]) -> dict[Path, str]:
    """Return a name for each file: its own, with its folder's before it where two have the same.

    Spaces become underscores: OpenDroneMap ignores masks with a space in their name.
    """
    plain = [re.sub(r"[^\w.-]", "_", path.name) for path in paths]
    counts = Counter(plain)
    names: dict[Path, str] = {}
    taken: set[str] = set()
    for path, name in zip(paths, plain, strict=True):
        if counts[name] > 1:
            name = re.sub(r"[^\w.-]", "_", f"{path.parent.name}_{name}")
        stem, number, unique = Path(name), 1, name
        while unique.lower() in taken:
            number += 1
            unique = f"{stem.stem}-{number}{stem.suffix}"
        taken.add(unique.lower())
        names[path] = unique
    return names


def _is_whole(data: bytes) -> bool:
    """Return whether the image's data has its end; previews inside EXIF do not count."""
    at = 2
    while at + 4 <= len(data) and data[at] == 0xFF:
        marker = data[at : at + 2]
        if marker == START_OF_SCAN:
            return data.find(END_OF_IMAGE, at) >= 0
        at += 2 + int.from_bytes(data[at + 2 : at + 4])
    return False


def _facts(path: Path, name: str, image: Any) -> Photo:
    cols, rows = image.size
    if not 0 < cols * rows <= MOST_PIXELS:
        raise PhotoError(f"{path.name}: {cols} x {rows} pixels, limit {MOST_PIXELS}")
    exif = image.getexif()
    details, gps = exif.get_ifd(IFD.Exif), exif.get_ifd(IFD.GPSInfo)
    clock_ns, step_s = _clock(path, exif, details)
    latitude_deg, longitude_deg = _place(path, gps)
    orientation = exif.get(Base.Orientation, 1)
    names = (exif.get(Base.Make), exif.get(Base.Model), details.get(Base.BodySerialNumber))
    make, model, serial = (_text(each) for each in names)
    xmp, notes = _xmp(image.info.get("xmp"))
    height_m, reference = _absolute_height(xmp, gps)
    horizontal_m, vertical_m = _rtk_sigmas_m(xmp)
    return Photo(
        path,
        name,
        cols,
        rows,
        orientation if orientation in range(1, 9) else 1,
        (make, model, serial),
        clock_ns,
        step_s,
        latitude_deg,
        longitude_deg,
        _satellite_ns(gps),
        _field_deg(details, max(cols, rows), min(cols, rows)),
        _attitude(xmp),
        xmp.number(DJI, "RelativeAltitude"),
        _angle(xmp, "FlightYawDegree", -360.0, 360.0),
        height_m,
        reference,
        horizontal_m,
        vertical_m,
        notes,
    )


def _text(value: object) -> str:
    text = value.decode("ascii", "replace") if isinstance(value, bytes) else str(value or "")
    return "".join(each for each in text if each.isprintable()).strip()[:64]


_DATE = re.compile(r"(\d{4})[:-](\d\d)[:-](\d\d)[ T](\d\d):(\d\d):(\d\d)")


def _clock(path: Path, exif: Mapping[int, Any], details: Mapping[int, Any]) -> tuple[int, float]:
    """Return the camera's clock, as if it were UTC, and its step in seconds."""
    for source, tag in ((details, Base.DateTimeOriginal), (exif, Base.DateTime)):
        found = _DATE.match(_text(source.get(tag)))
        if found is None:
            continue
        try:
            year, month, day, hour, minute, second = map(int, found.groups())
            moment = datetime(year, month, day, hour, minute, second, tzinfo=UTC)
        except ValueError:
            continue
        digits = _text(details.get(Base.SubsecTimeOriginal))
        share = int(digits[:9].ljust(9, "0")) if digits.isascii() and digits.isdigit() else None
        step_s = 1.0 if share is None else 10.0 ** -min(len(digits), 9)
        return round(moment.timestamp()) * NS_PER_S + (share or 0), step_s
    raise PhotoError(f"{path.name}: expected EXIF with the time of the photo, got none")


def _place(path: Path, gps: Mapping[int, Any]) -> tuple[float, float]:
    try:
        values = (
            _degrees(gps[GPS.GPSLatitude], gps.get(GPS.GPSLatitudeRef), "S"),
            _degrees(gps[GPS.GPSLongitude], gps.get(GPS.GPSLongitudeRef), "W"),
        )
    except (KeyError, TypeError, ValueError, ZeroDivisionError) as problem:
        raise PhotoError(f"{path.name}: expected EXIF with a position, got none") from problem
    latitude_deg, longitude_deg = values
    is_on_earth = abs(latitude_deg) <= 90.0 and abs(longitude_deg) <= 180.0
    if not is_on_earth or values == (0.0, 0.0):
        raise PhotoError(f"{path.name}: expected a position on earth, got {values}: no GNSS fix?")
    return values


def _degrees(parts: Any, side: Any, negative: str) -> float:
    degrees, minutes, seconds = (float(part) for part in parts)
    value = degrees + minutes / 60.0 + seconds / 3600.0
    if not isfinite(value):
        raise ValueError("no number")
    return -value if _text(side).upper().startswith(negative) else value


def _satellite_ns(gps: Mapping[int, Any]) -> int | None:
    day = re.fullmatch(r"(\d{4})[:-](\d\d)[:-](\d\d)", _text(gps.get(GPS.GPSDateStamp)))
    try:
        hours, minutes, seconds = (float(part) for part in gps[GPS.GPSTimeStamp])
        if day is None:
            return None
        midnight = datetime(int(day[1]), int(day[2]), int(day[3]), tzinfo=UTC)
        return round((midnight.timestamp() + 3600 * hours + 60 * minutes + seconds) * NS_PER_S)
    except (KeyError, TypeError, ValueError, ZeroDivisionError, OverflowError):
        return None


def _field_deg(details: Mapping[int, Any], longer_px: int, shorter_px: int) -> float | None:
    """Return the field of view along the longer side: by the sensor's pixels, or as on film."""
    focal_mm = _number(details.get(Base.FocalLength))
    per_unit = _number(details.get(Base.FocalPlaneXResolution))
    unit_mm = UNIT_MM.get(int(_number(details.get(Base.FocalPlaneResolutionUnit)) or 0))
    if focal_mm and per_unit and unit_mm:
        wide_mm = longer_px / per_unit * unit_mm
        if 1.0 <= wide_mm <= 100.0:
            return math.degrees(2.0 * math.atan(wide_mm / 2.0 / focal_mm))
    film_mm = _number(details.get(Base.FocalLengthIn35mmFilm))
    if not film_mm:
        return None
    # The equivalent is of the diagonal: films are 3:2, most drones' sensors 4:3.
    wide_mm = DIAGONAL_OF_FULL_FRAME_MM * longer_px / math.hypot(longer_px, shorter_px)
    return math.degrees(2.0 * math.atan(wide_mm / 2.0 / film_mm))


def _number(value: Any, least: float = 1e-9) -> float | None:
    try:
        number = float(value)
    except (TypeError, ValueError, ZeroDivisionError):
        return None
    return number if isfinite(number) and number >= least else None


def _xmp(packet: object) -> tuple[Xmp, tuple[str, ...]]:
    if not isinstance(packet, bytes):
        return Xmp(), ()
    try:
        return read_xmp(packet), ()
    except XmpError as problem:
        return Xmp(), (f"its XMP is not read: {problem}",)


def _attitude(xmp: Xmp) -> GimbalAttitude | None:
    yaw_deg = _angle(xmp, "GimbalYawDegree", -360.0, 360.0)
    pitch_deg = _angle(xmp, "GimbalPitchDegree", -90.0, 45.0)
    if yaw_deg is None or pitch_deg is None:
        return None
    return GimbalAttitude(yaw_deg, pitch_deg, _angle(xmp, "GimbalRollDegree", -360.0, 360.0))


def _angle(xmp: Xmp, name: str, least_deg: float, most_deg: float) -> float | None:
    angle_deg = xmp.number(DJI, name)
    return angle_deg if angle_deg is not None and least_deg <= angle_deg <= most_deg else None


BELOW_SEA_LEVEL, ABOVE_ELLIPSOID, BELOW_ELLIPSOID = 1, 2, 3
"""EXIF's GPSAltitudeRef; 0 is above sea level, and is what cameras write that do not know."""


def _absolute_height(xmp: Xmp, gps: Mapping[int, Any]) -> tuple[float | None, HeightReference]:
    """Return the height and what it is above: by DJI's XMP, or by EXIF."""
    height_m, kind = xmp.number(DJI, "AbsoluteAltitude"), xmp.text(DJI, "AltitudeType")
    if height_m is not None:
        return height_m, "ellipsoid" if kind == "RtkAlt" else "not stated"
    stated_m = _number(gps.get(GPS.GPSAltitude), least=0.0)
    if stated_m is None:
        return None, "not stated"
    raw = gps.get(GPS.GPSAltitudeRef, 0)
    side = raw[0] if isinstance(raw, bytes) and raw else raw
    height_m = -stated_m if side in (BELOW_SEA_LEVEL, BELOW_ELLIPSOID) else stated_m
    return height_m, "ellipsoid" if side in (ABOVE_ELLIPSOID, BELOW_ELLIPSOID) else "sea level"


RTK_NONE = 0
"""RtkFlag without any RTK solution; 16 is single point, 34 float, 50 fixed."""


def _rtk_sigmas_m(xmp: Xmp) -> tuple[float | None, float | None]:
    """Return the standard deviations across and up, as RTK gave them."""
    if xmp.number(DJI, "RtkFlag") == RTK_NONE:
        return None, None
    east, north, up = (xmp.number(DJI, f"RtkStd{name}") for name in ("Lon", "Lat", "Hgt"))
    across = [each for each in (east, north) if each is not None and each > 0.0]
    return max(across, default=None), up if up is not None and up > 0.0 else None
