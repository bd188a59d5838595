"""Survey cameras of one's own: `cameras.toml` in a site's folder, or a file like it.

[[cameras]]
name = "a6000-16mm"
image_px = [6000, 4000]      # across and along the flight
sensor_mm = [23.5, 15.6]     # with focal_mm; or diagonal_deg alone
focal_mm = 16.0
timer_s = [1.0, 2.0, 5.0]    # the intervals that its timer can be set to
shutter = "mechanical"       # or "global", "rolling"
"""

from pathlib import Path
from typing import Annotated, Any

from msgspec import Meta, Struct

from recon.model.errors import SiteError
from recon.model.survey_camera import CameraModel, Shutter, of_diagonal, of_sensor
from recon.site.reading import convert, read_toml, refuse_non_finite
from recon.site.schema import Pixels

CAMERAS_FILE = "cameras.toml"
LARGEST_BYTES = 64 * 1024
MOST_OBLONG = 1.03
"""One side of a pixel over the other: makers round a sensor's size to a tenth of a millimetre."""
MOST_CAMERAS = 50

Millimetres = Annotated[float, Meta(ge=0.1, le=1_000.0)]
Interval = Annotated[float, Meta(ge=0.1, le=60.0)]
Name = Annotated[
    str,
    Meta(
        min_length=1,
        max_length=40,
        pattern=r"^[a-z0-9][a-z0-9.-]*$",
        description="a name of 1 to 40 lower-case letters, digits, hyphens and dots",
    ),
]


class SurveyCameraTable(Struct, frozen=True, forbid_unknown_fields=True):
    """One of [[cameras]]."""

    name: Name
    image_px: tuple[Pixels, Pixels]
    timer_s: Annotated[list[Interval], Meta(min_length=1, max_length=40)]
    sensor_mm: tuple[Millimetres, Millimetres] | None = None
    focal_mm: Millimetres | None = None
    diagonal_deg: Annotated[float, Meta(ge=5.0, le=150.0)] | None = None
    shutter: Shutter = "rolling"


class _File(Struct, frozen=True, forbid_unknown_fields=True):
    cameras: list[dict[str, Any]]


def read_survey_cameras(folder: Path) -> dict[str, CameraModel]:
    """Return the folder's own cameras by name, none without the file. Raises `SiteError`."""
    path = folder / CAMERAS_FILE
    return read_cameras_file(path) if path.is_file() else {}


def read_cameras_file(path: Path) -> dict[str, CameraModel]:
    """Return the cameras of a file by name. Raises `SiteError`."""
    data = read_toml(path, LARGEST_BYTES, "a file of cameras")
    refuse_non_finite(path, data, "")
    tables = convert(path, data, _File, "").cameras
    if len(tables) > MOST_CAMERAS:
        raise SiteError(f"{path}: expected at most {MOST_CAMERAS} cameras, got {len(tables)}")
    cameras: dict[str, CameraModel] = {}
    for number, table in enumerate(tables, start=1):
        key = f"cameras (entry {number})"
        model = _model(path, key, convert(path, table, SurveyCameraTable, key))
        if model.key in cameras:
            raise SiteError(f"{path}: {key}.name: expected each name once, got {model.key!a} again")
        cameras[model.key] = model
    return cameras


def _model(path: Path, key: str, table: SurveyCameraTable) -> CameraModel:
    by_sensor = table.sensor_mm is not None and table.focal_mm is not None
    has_part = table.sensor_mm is not None or table.focal_mm is not None
    if by_sensor == (table.diagonal_deg is not None) or has_part != by_sensor:
        raise SiteError(f"{path}: {key}: expected sensor_mm and focal_mm, or diagonal_deg alone")
    if table.sensor_mm is not None and table.focal_mm is not None:
        _refuse_oblong(f"{path}: {key}", table.image_px, table.sensor_mm)
        optics = of_sensor(*table.image_px, table.sensor_mm, table.focal_mm)
    else:
        assert table.diagonal_deg is not None
        optics = of_diagonal(*table.image_px, table.diagonal_deg)
    timer_s = tuple(sorted(set(table.timer_s)))
    return CameraModel(table.name, table.name, *optics, timer_s, table.shutter, path.name)


def _refuse_oblong(place: str, image_px: tuple[int, int], sensor_mm: tuple[float, float]) -> None:
    across_um, along_um = (1000.0 * mm / px for mm, px in zip(sensor_mm, image_px, strict=True))
    if max(across_um, along_um) > MOST_OBLONG * min(across_um, along_um):
        raise SiteError(
            f"{place}: expected square pixels, got {across_um:.2f} x {along_um:.2f} micrometres by "
            "image_px and sensor_mm; of a cropped photo, give the part of the sensor that it shows"
        )
