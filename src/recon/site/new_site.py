"""A new site's folder: origin, limits, field, and simulated drones to rehearse with."""

import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import ceil, isfinite
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from recon.geo.geoid import geoid_height_m
from recon.model.errors import SiteError
from recon.model.geo import GeoPoint, LocalFrame
from recon.site.drawing import stage_drawing
from recon.site.field_layers import USUAL_MARGIN_M, FieldLayers, field_layers, square_field
from recon.site.load import LARGEST_FILE_BYTES, MOST_VEHICLES, SITE_FILE, demo_site_folder
from recon.site.reading import read_bounded
from recon.site.schema import RehearsalTable
from recon.site.toml_lines import key_line

MOST_LETTERS = 64
"""Longest name in site.toml."""
CAMERA_FILE = "camera-model.txt"
IMAGER_SERIAL, IMAGER_NAME = "SIM-IMAGER", "Imager"

USUAL_DISTANCE_M = 500.0
LOWEST_GO_HOME_HEIGHT_M, GO_HOME_HEIGHT_STEP_M = 38, 8
HIGHEST_GO_HOME_HEIGHT_M = 94
"""Highest go-home height: below the imaging drone, which hovers 110 m above the field."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NewSiteFields:
    """What a new site has beside its origin."""

    name: str
    drones: int
    """Simulated survey drones."""
    has_imager: bool = True
    """Whether there is an imaging drone beside them."""
    regions: Mapping[str, Mapping[str, Any]] | None = None
    """The fields, as GeoJSON polygons by name; empty: a square around the origin; None: the site
    has no layers yet."""
    margin_m: float = USUAL_MARGIN_M
    """Distance from the fields to the boundary."""
    rehearsal: RehearsalTable = field(default_factory=RehearsalTable)

    @property
    def vehicles(self) -> dict[str, str]:
        """The names of the simulated vehicles, by serial."""
        drones = {f"SIM-{number}": f"Drone {number}" for number in range(1, self.drones + 1)}
        return {**drones, **({IMAGER_SERIAL: IMAGER_NAME} if self.has_imager else {})}

    def __post_init__(self) -> None:
        most = MOST_VEHICLES - self.has_imager
        _require(0 <= self.drones <= most, f"0 to {most} drones", self.drones)
        if not self.name.isprintable() or not 0 < len(self.name) <= MOST_LETTERS:
            raise SiteError(
                f"expected a name of 1 to {MOST_LETTERS} printable letters, got {self.name!a}"
            )


def make_site(folder: Path, origin: GeoPoint, asked: NewSiteFields) -> Path:
    """Write a site into a folder, which is made if missing; return its site.toml.

    Raises `SiteError` for a folder that has one already, and for values that no site has.
    """
    path = folder / SITE_FILE
    _require(abs(origin.latitude_deg) <= 90.0, "a latitude of -90 to 90", origin.latitude_deg)
    _require(abs(origin.longitude_deg) <= 180.0, "a longitude of -180 to 180", origin.longitude_deg)
    _require(isfinite(origin.ellipsoid_height_m), "a finite altitude", origin.ellipsoid_height_m)
    if path.exists():
        raise SiteError(f"{path} exists already; choose another folder")
    try:
        # Whole or not at all: what a start would refuse leaves no folder that looks like a site.
        with TemporaryDirectory(prefix="recon-new-site-") as staged:
            _write(Path(staged), origin, asked)
            folder.mkdir(parents=True, exist_ok=True)
            for each in Path(staged).iterdir():
                shutil.copyfile(each, folder / each.name)
    except OSError as problem:
        raise SiteError(f"{path} cannot be written: {problem.strerror or problem}") from problem
    return path


def layers_of(origin: GeoPoint, asked: NewSiteFields) -> FieldLayers:
    """Return the layers that a site would have. Raises `SiteError`."""
    frame = LocalFrame(origin)
    if asked.regions is None:
        return FieldLayers((), 0.0)
    regions = asked.regions or {asked.name: square_field(frame)}
    return field_layers(frame, regions, asked.vehicles, asked.margin_m)


def _write(folder: Path, origin: GeoPoint, asked: NewSiteFields) -> None:
    drawn = layers_of(origin, asked)
    (folder / SITE_FILE).write_text(_text(origin, asked, drawn.farthest_m), encoding="utf-8")
    if asked.has_imager:
        shutil.copyfile(demo_site_folder() / CAMERA_FILE, folder / CAMERA_FILE)
    for name, content in stage_drawing(folder, drawn.features).files.items():
        if content is not None:
            (folder / name).write_bytes(content)


def point_above_sea_level(latitude_deg: float, longitude_deg: float, height_m: float) -> GeoPoint:
    """Return a place whose height is known above sea level. Raises `SiteError` off the globe."""
    _require(abs(latitude_deg) <= 90.0, "a latitude of -90 to 90", latitude_deg)
    _require(abs(longitude_deg) <= 180.0, "a longitude of -180 to 180", longitude_deg)
    sea_level_m = geoid_height_m(latitude_deg, longitude_deg)
    return GeoPoint(latitude_deg, longitude_deg, round(height_m + sea_level_m, 2))


def _require(is_met: bool, expected: str, got: float) -> None:
    if not is_met:
        raise SiteError(f"expected {expected}, got {got:g}")


def _text(origin: GeoPoint, asked: NewSiteFields, farthest_m: float) -> str:
    sky = asked.rehearsal
    # A limit that restricts no flight inside the boundary, in round numbers.
    limit_m = max(USUAL_DISTANCE_M, 50.0 * ceil(farthest_m / 50.0))
    header = f"""# docs/how-to/prepare-a-site.md explains the keys.
{key_line("name", asked.name)}
[origin]
latitude_deg = {origin.latitude_deg!r}
longitude_deg = {origin.longitude_deg!r}
ground_altitude_m = {origin.ellipsoid_height_m!r}  # above the WGS84 ellipsoid, not above sea level

[limits]
max_height_above_ground_m = 120.0
max_distance_from_home_m = {limit_m!r}

[layers]
"""
    rehearsal = f"""
# What follows is simulated, to rehearse with `recon demo --site`: clouds and wind, drones, and an
# imaging drone with its camera. Replace it before you fly real ones.
[rehearsal]
cloud_cover_percent = {sky.cloud_cover_percent!r}
wind_mps = {sky.wind_mps!r}  # 10 m above the ground
wind_from_deg = {sky.wind_from_deg!r}  # where it comes from, clockwise from north
"""
    drones = "".join(map(_drone, range(1, asked.drones + 1)))
    imager = IMAGER_TEXT if asked.has_imager else ""
    return header + (rehearsal + drones + imager if asked.vehicles else "")


IMAGER_TEXT = f"""
[[vehicles]]
serial = "{IMAGER_SERIAL}"
name = "{IMAGER_NAME}"
model = "simulated"
waypoint_altitude = "takeoff"
endurance_min = 25
go_home_height_m = 30
failsafe = "go_home"
priority = 10

[imager]
serial = "{IMAGER_SERIAL}"
camera = "{CAMERA_FILE}"
placed_by = "telemetry"

[imager.image_circle]
col_px = 637.8
row_px = 361.2
radius_px = 274.1

[ground_image]
width_m = 544.0
height_m = 544.0
cell_m = 1.0
"""


def imager_files(folder: Path) -> dict[str, bytes]:
    """Return the files of a site's folder with a simulated imaging drone. Raises `SiteError`."""
    text = read_bounded(folder / SITE_FILE, LARGEST_FILE_BYTES, "a site file").decode()
    camera = (demo_site_folder() / CAMERA_FILE).read_bytes()
    return {SITE_FILE: f"{text.rstrip()}\n{IMAGER_TEXT}".encode(), CAMERA_FILE: camera}


def _drone(number: int) -> str:
    height_m = LOWEST_GO_HOME_HEIGHT_M + (number - 1) * GO_HOME_HEIGHT_STEP_M
    return f"""
[[vehicles]]
serial = "SIM-{number}"
name = "Drone {number}"
model = "simulated"
waypoint_altitude = "takeoff"
endurance_min = 25
go_home_height_m = {min(height_m, HIGHEST_GO_HOME_HEIGHT_M)}
failsafe = "go_home"
camera_interval_s = 2.0
"""
