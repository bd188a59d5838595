"""A photo's own statements: time, place, camera, attitude, from EXIF and DJI's XMP.

The pixels are not decoded. A photo is hostile: sizes are bounded, and what Pillow raises on damage
becomes a `PhotoError`.
"""

import warnings
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

from PIL import Image, JpegImagePlugin, TiffImagePlugin, UnidentifiedImageError
from PIL.ExifTags import GPS, IFD, Base

from recon.product.photos import tiff
from recon.product.photos.band import (
    Kind,
    Panel,
    PhotoBand,
    band_of,
    capture_of,
    exposure_s_of,
    irradiance_of,
    kind_of,
    name_and_role,
    panel_of,
)
from recon.product.photos.exif import (
    HeightReference,
    Tags,
    absolute_height,
    clock_of,
    satellite_ns,
    serial_of,
    text_of,
)
from recon.product.photos.jpeg import START_OF_IMAGE, whole_jpeg
from recon.product.photos.lens import field_deg
from recon.product.photos.look import Look, look_of
from recon.product.photos.photo_error import PhotoError
from recon.product.photos.place import place_of
from recon.product.photos.xmp import DJI, Xmp, XmpError, read_xmp

LARGEST_BYTES = 256 * 1024 * 1024
MOST_PIXELS = 400_000_000


@dataclass(frozen=True, slots=True)
class GimbalAttitude:
    """Attitude of the camera, by its gimbal: yaw clockwise from north, pitch -90 straight down,
    roll to the right, in degrees."""

    yaw_deg: float
    pitch_deg: float
    roll_deg: float | None = None


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
    kind: Kind = "visible"
    band: PhotoBand | None = None
    capture: str = ""
    """Identity of the shot, which all files of one release of the shutter share."""
    exposure_s: float | None = None
    """Exposure time."""
    irradiance: float | None = None
    """By the camera's sun sensor, in its own unit."""
    look: Look | None = None
    """How it looks in small, where that is cheap to know."""
    size_bytes: int | None = None
    panel: Panel | None = None
    """The reflectance panel that the camera itself found on it."""
    is_plain: bool = True
    """Whether plain EXIF, and RTK's XMP attributes, state position, height and accuracy: what most
    programs read."""
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
    if data.startswith(START_OF_IMAGE):
        whole = whole_jpeg(data)
        if whole is None:
            raise PhotoError(f"{path.name}: the file is cut off: copy it from the card again")
        data = whole
    elif not data.startswith(tiff.SIGNATURES):
        raise PhotoError(f"{path.name}: expected a JPEG or TIFF, got another file")
    try:
        with warnings.catch_warnings(action="ignore"), _opened(data) as image:
            return _facts(path, name, image, data)
    except PhotoError as problem:
        raise PhotoError(f"{path.name}: {problem}") from problem
    except UnidentifiedImageError as problem:
        raise PhotoError(
            f"{path.name}: expected a readable JPEG or TIFF, got a damaged one"
        ) from problem
    except Exception as problem:
        # Pillow documents no closed set of errors for damaged metadata.
        text = f"{type(problem).__name__}: {problem}"
        raise PhotoError(f"{path.name}: its EXIF data is damaged ({text:.120})") from problem


def _opened(data: bytes) -> Any:
    # Named, so that Pillow loads no further plugin, and no other format is taken.
    formats = JpegImagePlugin.JpegImageFile.format, TiffImagePlugin.TiffImageFile.format
    image = Image.open(BytesIO(data), formats=formats)
    if image.format == TiffImagePlugin.TiffImageFile.format:
        tiff.refuse_cut_off(image, len(data))
    return image


def _facts(path: Path, name: str, image: Any, data: bytes) -> Photo:
    cols, rows = image.size
    if not 0 < cols * rows <= MOST_PIXELS:
        raise PhotoError(f"{cols} x {rows} pixels, limit {MOST_PIXELS}")
    exif = image.getexif()
    details, gps = exif.get_ifd(IFD.Exif), exif.get_ifd(IFD.GPSInfo)
    xmp, notes = _xmp(image.info.get("xmp"))
    clock_ns, step_s = clock_of(exif, details)
    place = place_of(gps, xmp)
    orientation = exif.get(Base.Orientation, 1)
    make, model = (text_of(exif.get(tag)) for tag in (Base.Make, Base.Model))
    role = name_and_role(path.stem)[1]
    band = band_of(exif, details, xmp, role)
    height_m, reference = absolute_height(xmp, gps)
    horizontal_m, vertical_m = _rtk_sigmas_m(xmp)
    return Photo(
        path,
        name,
        cols,
        rows,
        orientation if orientation in range(1, 9) else 1,
        (make, model, serial_of(exif, details, xmp)),
        clock_ns,
        step_s,
        place.latitude_deg,
        place.longitude_deg,
        satellite_ns(gps, xmp),
        field_deg(exif, details, cols, rows),
        _attitude(xmp),
        xmp.number(DJI, "RelativeAltitude"),
        _angle(xmp, "FlightYawDegree", -360.0, 360.0),
        height_m,
        reference,
        horizontal_m,
        vertical_m,
        kind_of(xmp, band, role, (cols, rows), make),
        band,
        capture_of(xmp),
        exposure_s_of(details, xmp),
        irradiance_of(xmp),
        look_of(image, data, band.black_level or 0.0 if band else 0.0),
        len(data),
        panel_of(xmp),
        place.is_in_exif and _is_plain(xmp, gps, height_m, (horizontal_m, vertical_m)),
        (*notes, *filter(None, [place.note])),
    )


def _xmp(packet: object) -> tuple[Xmp, tuple[str, ...]]:
    if not isinstance(packet, bytes):
        return Xmp(), ()
    try:
        return read_xmp(packet), ()
    except XmpError as problem:
        return Xmp(), (f"its XMP is not read: {problem}",)


def _attitude(xmp: Xmp) -> GimbalAttitude | None:
    yaw_deg = _angle(xmp, "GimbalYawDegree", -360.0, 360.0)
    pitch_deg = _angle(xmp, "GimbalPitchDegree", -120.0, 90.0)
    if yaw_deg is None or pitch_deg is None:
        return None
    return GimbalAttitude(yaw_deg, pitch_deg, _angle(xmp, "GimbalRollDegree", -360.0, 360.0))


def _angle(xmp: Xmp, name: str, least_deg: float, most_deg: float) -> float | None:
    angle_deg = xmp.number(DJI, name)
    return angle_deg if angle_deg is not None and least_deg <= angle_deg <= most_deg else None


def _is_plain(
    xmp: Xmp, gps: Tags, height_m: float | None, sigmas_m: tuple[float | None, float | None]
) -> bool:
    has_height = (
        height_m is None or GPS.GPSAltitude in gps or (DJI, "AbsoluteAltitude") in xmp.plain
    )
    has_accuracy = sigmas_m == (None, None) or (DJI, "RtkStdHgt") in xmp.plain
    return has_height and has_accuracy


RTK_NONE = 0
"""RtkFlag without any RTK solution; 16 is single point, 34 float, 50 fixed."""


def _rtk_sigmas_m(xmp: Xmp) -> tuple[float | None, float | None]:
    """Return the standard deviations across and up, as RTK gave them."""
    if xmp.number(DJI, "RtkFlag") == RTK_NONE:
        return None, None
    east, north, up = (xmp.number(DJI, f"RtkStd{name}") for name in ("Lon", "Lat", "Hgt"))
    across = [each for each in (east, north) if each is not None and each > 0.0]
    return max(across, default=None), up if up is not None and up > 0.0 else None
