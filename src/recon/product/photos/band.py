"""What a camera of several lenses says of one file: what it shows, its band, its sun sensor."""

import re
from dataclasses import dataclass
from typing import Literal

from PIL.ExifTags import Base

from recon.product.photos.exif import Tags, number_of
from recon.product.photos.xmp import DJI, Xmp

CAMERA = "http://pix4d.com/camera/1.0"
MICASENSE = "http://micasense.com/MicaSense/1.0"
DLS = "http://micasense.com/DLS/1.0"
FLIR = "http://ns.flir.com/xmp/1.0"

Kind = Literal["visible", "zoom", "band", "thermal"]

THERMAL_BANDS = frozenset(("lwir", "thermal", "infrared"))
THERMAL_FROM_NM = 5_000.0
THERMAL_SIZES = frozenset(((640, 512), (336, 256), (320, 256), (1280, 1024)))
"""Sizes of pictures from thermal sensors, which are 5:4: no other camera of a drone has them."""
SMALL_PX = 1280
COLOURS = frozenset(("rgb", "redgreenblue"))
BLACK_LEVEL = 0xC61A
"""TIFF tag of DNG."""
US_PER_S = 1e6
CALIBRATION = (1.0, 2.0)
"""Pix4D's mark of a photo of a panel; 1 says that the panel's values could not be read."""
ROLE = re.compile(
    r"(?P<base>.+?)_(?P<role>[DVWZST]|MS_[A-Z]{1,4}|RGB|GRE|GRN|RED|REG|NIR|(?<=\d_)\d{1,2})", re.I
)
"""Names of files of one shot: DJI's (_D and _MS_NIR, _V, _W, _Z, _T), Parrot's, MicaSense's."""


@dataclass(frozen=True, slots=True)
class PhotoBand:
    """One band of a multispectral camera; None where the file does not state it."""

    name: str
    wavelength_nm: float | None = None
    """Central wavelength."""
    width_nm: float | None = None
    """Full width at half maximum."""
    black_level: float | None = None
    gain: float | None = None


@dataclass(frozen=True, slots=True)
class Panel:
    """A calibrated reflectance panel on a photo."""

    serial: str = ""
    albedo: float | None = None
    """Share of the light that it reflects in this band, as the file states it."""


def panel_of(xmp: Xmp) -> Panel | None:
    """Return the panel that a camera found on its photo, which it marks as one for calibration."""
    if xmp.number(CAMERA, "CalibrationPicture") not in CALIBRATION:
        return None
    serial = xmp.text(CAMERA, "PanelSerial") or xmp.text(MICASENSE, "PanelSerial") or ""
    return Panel(serial[:64], next(iter(xmp.numbers(CAMERA, "Albedo")), None))


def name_and_role(stem: str) -> tuple[str, str]:
    """Return what the names of a shot's files share, and the role that a name gives its file."""
    found = ROLE.fullmatch(stem)
    return (stem, "") if found is None else (found["base"], found["role"].upper())


def band_of(exif: Tags, details: Tags, xmp: Xmp, role: str) -> PhotoBand | None:
    """Return a file's band, by its XMP or else by its name; None for pictures in colour."""
    name = "".join(xmp.values.get((CAMERA, "BandName"), ())) or xmp.text(FLIR, "BandName") or ""
    if not name:
        name = role.removeprefix("MS_") if role.startswith("MS_") or len(role) == 3 else ""
    name = re.sub(r"[^A-Za-z0-9]", "", name)
    if not name or name.lower() in COLOURS:
        return None
    levels = exif.get(BLACK_LEVEL, details.get(BLACK_LEVEL))
    each = levels if isinstance(levels, tuple) else (levels,)
    black = [level for level in map(number_of, each) if level is not None]
    iso = number_of(details.get(Base.ISOSpeedRatings))
    return PhotoBand(
        name[:32],
        next(iter(xmp.numbers(CAMERA, "CentralWavelength")), None),
        next(iter(xmp.numbers(CAMERA, "WavelengthFWHM")), None),
        sum(black) / len(black) if black else xmp.number(CAMERA, "BlackCurrent"),
        xmp.number(DJI, "SensorGain") or (iso / 100.0 if iso else None),
    )


def kind_of(xmp: Xmp, band: PhotoBand | None, role: str, size: tuple[int, int], make: str) -> Kind:
    """Return what a file shows: by its XMP, its band, its name, or a thermal sensor's size."""
    source = (xmp.text(DJI, "ImageSource") or "").lower()
    is_small = max(size) <= SMALL_PX
    is_thermal = "infrared" in source or (role == "T" and is_small)
    is_thermal |= size in THERMAL_SIZES and make.lower() in ("dji", "flir", "autel robotics")
    if band is not None:
        is_thermal |= band.name.lower() in THERMAL_BANDS
        is_thermal |= (band.wavelength_nm or 0.0) > THERMAL_FROM_NM
    if is_thermal:
        return "thermal"
    if band is not None:
        return "band"
    return "zoom" if "zoom" in source or role == "Z" else "visible"


def capture_of(xmp: Xmp) -> str:
    """Return the identity that the files of one shot share; empty where none is stated."""
    return (
        xmp.text(DJI, "CaptureUUID")
        or xmp.text(MICASENSE, "CaptureId")
        or xmp.text(CAMERA, "CaptureUUID", "ImageUniqueID")
        or ""
    )


def irradiance_of(xmp: Xmp) -> float | None:
    """Return the irradiance by the camera's sun sensor, of level ground where it states that.

    Units are the sensor's own: only values of one camera's band compare.
    """
    for space in (CAMERA, DLS):
        found = xmp.number(space, "HorizontalIrradiance", "SpectralIrradiance", "Irradiance")
        if found is not None and found > 0.0:
            return found * (xmp.number(space, "IrradianceScaleToSIUnits") or 1.0)
    found = xmp.number(DJI, "Irradiance")
    return found if found is not None and found > 0.0 else None


def exposure_s_of(details: Tags, xmp: Xmp) -> float | None:
    """Return the exposure time; DJI's XMP states microseconds."""
    stated = number_of(details.get(Base.ExposureTime))
    in_us = xmp.number(DJI, "ExposureTime")
    return stated or (in_us / US_PER_S if in_us is not None and in_us > 0.0 else None)
