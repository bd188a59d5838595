"""Reading a site's folder: site.toml and the files it names."""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec

from recon.model.airspace import FlightLimits
from recon.model.errors import SiteError
from recon.model.geo import GeoPoint, GroundGrid, LatLon, LocalFrame
from recon.model.survey_camera import CameraModel, SurveyCameraError, camera_named
from recon.model.vehicle import AltitudeReference, Failsafe, Mount, VehicleProfile
from recon.site.consistency import (
    refuse_high_go_home_heights,
    refuse_misplaced_pads,
    refuse_sunken_pads,
    refuse_sunken_zones,
)
from recon.site.elevation import ElevationTable, read_elevation
from recon.site.failsafe import failsafe_from_tables
from recon.site.imager import imager_from_table
from recon.site.layers import read_layers
from recon.site.reading import convert, read_toml, refuse_non_finite
from recon.site.schema import (
    FetchTable,
    GroundImageTable,
    ImagerTable,
    LayersTable,
    LimitsTable,
    OriginTable,
    RehearsalTable,
    SiteTable,
    TileServerTable,
    VehicleTable,
)
from recon.site.site import Imager, Layers, Site
from recon.site.survey_cameras import read_survey_cameras
from recon.site.weather_file import read_weather

PLACEHOLDER_SERIAL = "00000"
"""Sent by apps before they know their aircraft's serial."""

APP_PRESETS: dict[str, dict[str, Any]] = {
    "legacy": {"max_waypoints": 25},
}
"""Limits of older companion apps: they read 25 waypoints, 1,011 bytes, at once."""

_PLAIN_KEYS = (
    "name",
    "number",
    "model",
    "camera",
    "max_waypoints",
    "battery_factor",
    "video_latency_s",
    "video_latency_sigma_s",
    "packet_gap_s",
    "go_home_height_m",
    "camera_interval_s",
    "priority",
)


def profile_from_table(table: VehicleTable, place: str) -> VehicleProfile:
    """Return the profile; given keys override the app's preset, which overrides the defaults.

    `place` leads the message of the `SiteError` that a placeholder serial raises.
    """
    if table.serial == PLACEHOLDER_SERIAL:
        raise SiteError(
            f"{place}.serial: expected an aircraft's own serial, got the placeholder "
            f"{PLACEHOLDER_SERIAL!r} that apps send before they know it"
        )
    values: dict[str, Any] = dict(APP_PRESETS[table.app]) if table.app else {}
    given = ((key, getattr(table, key)) for key in _PLAIN_KEYS)
    values.update({key: value for key, value in given if value is not None})
    if table.waypoint_altitude is not None:
        values["waypoint_altitude"] = AltitudeReference(table.waypoint_altitude)
    if table.mount is not None:
        values["mount"] = Mount(table.mount)
    if table.failsafe is not None:
        values["failsafe"] = Failsafe(table.failsafe)
    if table.endurance_min is not None:
        values["endurance_s"] = 60.0 * table.endurance_min
    if table.pad is not None:
        pad = table.pad
        values["pad"] = GeoPoint(pad.latitude_deg, pad.longitude_deg, pad.altitude_m)
    return replace(VehicleProfile(table.serial), **values)


def limits_from_table(table: LimitsTable, place: str) -> FlightLimits:
    """Return the limits; `place` leads the `SiteError` for limits that contradict each other."""
    given = {
        key: value for key, value in msgspec.structs.asdict(table).items() if value is not None
    }
    limits = FlightLimits(**given)
    low_m, high_m = limits.min_height_above_ground_m, limits.max_height_above_ground_m
    if low_m >= high_m:
        raise SiteError(
            f"{place}.min_height_above_ground_m: expected less than max_height_above_ground_m, "
            f"{high_m:g} m, got {low_m:g} m"
        )
    return limits


SITE_FILE = "site.toml"
LARGEST_FILE_BYTES = 256 * 1024
MOST_CELLS = 4096 * 4096
MOST_VEHICLES = 64
MOST_IMAGERS = 4
"""Frames of more would come faster than one worker reads them."""


def load_site(folder: Path) -> Site:
    """Return the site of a folder with a site.toml.

    The files it names must lie in the folder: a name that leads out of it (absolute, by .. or by a
    symbolic link) is refused, so that a folder from elsewhere reads nothing else. Raises
    `SiteError`.
    """
    path = folder / SITE_FILE
    data = _read_site_file(path)
    refuse_non_finite(path, data, "")
    table = convert(path, data, SiteTable, "")
    origin = convert(path, table.origin, OriginTable, "origin")
    frame = LocalFrame(
        GeoPoint(origin.latitude_deg, origin.longitude_deg, origin.ground_altitude_m)
    )
    ground = convert(path, table.ground_image or {}, GroundImageTable, "ground_image")
    grid = _ground_grid(path, ground, frame)
    profiles = _profiles(path, table.vehicles)
    imagers = _imagers(path, table.imager, frame)
    for serial in imagers:
        profiles.setdefault(serial, VehicleProfile(serial))
    layers = read_layers(path, convert(path, table.layers, LayersTable, "layers"), frame)
    _give_pads(path, layers, profiles)
    limits = limits_from_table(
        convert(path, table.limits, LimitsTable, "limits"), f"{path}: limits"
    )
    failsafe = failsafe_from_tables(path, table.failsafe)
    _tile_server(path, table)
    convert(path, table.fetch, FetchTable, "fetch")
    convert(path, table.rehearsal, RehearsalTable, "rehearsal")
    cameras = read_survey_cameras(folder)
    _refuse_unknown_cameras(path, profiles, cameras)
    site = Site(
        table.name, frame, grid, imagers, profiles, layers, limits, failsafe, cameras=cameras
    )
    place = LatLon(origin.latitude_deg, origin.longitude_deg)
    site = replace(site, weather=read_weather(folder, place))
    refuse_high_go_home_heights(str(path), profiles, limits)
    refuse_misplaced_pads(path, site)
    if table.elevation is not None:
        elevation = convert(path, table.elevation, ElevationTable, "elevation")
        model, source = read_elevation(path, elevation, site.airspace)
        site = replace(site, elevation=model, elevation_file=elevation.file, terrain_source=source)
        refuse_sunken_pads(path, site)
    refuse_sunken_zones(path, site)
    return site


def read_tile_server(folder: Path) -> TileServerTable | None:
    """Return the tile server of a site's folder; None without one. Raises `SiteError`."""
    path = folder / SITE_FILE
    return _tile_server(path, convert(path, _read_site_file(path), SiteTable, ""))


def read_fetch_table(folder: Path) -> FetchTable:
    """Return where a site's folder fetches heights and weather from. Raises `SiteError`."""
    path = folder / SITE_FILE
    table = convert(path, _read_site_file(path), SiteTable, "")
    return convert(path, table.fetch, FetchTable, "fetch")


def read_rehearsal(folder: Path) -> RehearsalTable:
    """Return the sky and wind that a site's folder is rehearsed under. Raises `SiteError`."""
    path = folder / SITE_FILE
    table = convert(path, _read_site_file(path), SiteTable, "")
    return convert(path, table.rehearsal, RehearsalTable, "rehearsal")


def _tile_server(path: Path, table: SiteTable) -> TileServerTable | None:
    if table.tile_server is None:
        return None
    return convert(path, table.tile_server, TileServerTable, "tile_server")


def _imagers(
    path: Path, tables: dict[str, Any] | list[dict[str, Any]] | None, frame: LocalFrame
) -> dict[str, Imager]:
    """Return the imaging drones of [imager], or of several [[imager]], by serial."""
    listed = tables if isinstance(tables, list) else [] if tables is None else [tables]
    if len(listed) > MOST_IMAGERS:
        raise SiteError(
            f"{path}: imager: expected {MOST_IMAGERS} imaging drones or fewer, got {len(listed)}"
        )
    imagers: dict[str, Imager] = {}
    for number, table in enumerate(listed):
        key = f"imager[{number}]" if isinstance(tables, list) else "imager"
        imager = imager_from_table(path, convert(path, table, ImagerTable, key), frame)
        if imager.serial in imagers:
            raise SiteError(
                f"{path}: {key}.serial: expected each imaging drone once, got {imager.serial} twice"
            )
        imagers[imager.serial] = imager
    return imagers


def _read_site_file(path: Path) -> dict[str, Any]:
    try:
        return read_toml(path, LARGEST_FILE_BYTES, "a site file")
    except SiteError as problem:
        if isinstance(problem.__cause__, FileNotFoundError | NotADirectoryError):
            raise SiteError(
                f"{path}: Folder or {SITE_FILE} not found; make a site with recon site new "
                f"{path.parent} --at LAT,LON --ground-above-sea-level HEIGHT"
            ) from problem
        raise


def _ground_grid(path: Path, table: GroundImageTable, frame: LocalFrame) -> GroundGrid:
    rows = _whole_cells(path, "height_m", table.height_m, table.cell_m)
    cols = _whole_cells(path, "width_m", table.width_m, table.cell_m)
    if rows * cols > MOST_CELLS:
        raise SiteError(
            f"{path}: ground_image: expected at most {MOST_CELLS} cells, got {cols} x {rows}; "
            "use larger cells or a smaller area"
        )
    return GroundGrid(frame, -table.width_m / 2.0, table.height_m / 2.0, table.cell_m, rows, cols)


def _whole_cells(path: Path, key: str, length_m: float, cell_m: float) -> int:
    cells = round(length_m / cell_m)
    if cells < 1 or not math.isclose(cells * cell_m, length_m, rel_tol=1e-9):
        raise SiteError(
            f"{path}: ground_image.{key}: expected a whole number of cells of {cell_m:g} m, "
            f"got {length_m:g} m"
        )
    return cells


def _profiles(path: Path, tables: list[dict[str, Any]]) -> dict[str, VehicleProfile]:
    if len(tables) > MOST_VEHICLES:
        raise SiteError(
            f"{path}: vehicles: expected at most {MOST_VEHICLES} vehicles, got {len(tables)}"
        )
    profiles: dict[str, VehicleProfile] = {}
    for number, data in enumerate(tables, start=1):
        key = f"vehicles (entry {number})"
        profile = profile_from_table(convert(path, data, VehicleTable, key), f"{path}: {key}")
        if profile.serial in profiles:
            raise SiteError(
                f"{path}: {key}.serial: expected each serial once, got {profile.serial!r} again"
            )
        profiles[profile.serial] = profile
    _refuse_shared_names(path, profiles)
    _refuse_shared_numbers(path, profiles)
    return profiles


def _refuse_shared_names(path: Path, profiles: Mapping[str, VehicleProfile]) -> None:
    """Raise `SiteError` for a name that stands for two vehicles."""
    names = set(profiles)
    for number, profile in enumerate(profiles.values(), start=1):
        name = profile.display_name
        if name != profile.serial and name in names:
            raise SiteError(
                f"{path}: vehicles (entry {number}).name: expected a name that no other vehicle "
                f"has as its name or serial, got {name!a} again"
            )
        names.add(name)


def _refuse_shared_numbers(path: Path, profiles: Mapping[str, VehicleProfile]) -> None:
    """Raise `SiteError` for a number that stands for two vehicles."""
    names: dict[int, str] = {}
    for entry, profile in enumerate(profiles.values(), start=1):
        number = profile.number
        if number is None:
            continue
        if number in names:
            raise SiteError(
                f"{path}: vehicles (entry {entry}).number: expected a number that no other vehicle "
                f"has, got {number}, the number of {names[number]!a}"
            )
        names[number] = profile.display_name


def _refuse_unknown_cameras(
    path: Path, profiles: Mapping[str, VehicleProfile], own: Mapping[str, CameraModel]
) -> None:
    """Raise `SiteError` for a survey camera that neither the table nor the site has."""
    for entry, profile in enumerate(profiles.values(), start=1):
        if profile.camera is None:
            continue
        try:
            camera_named(profile.camera, own.values())
        except SurveyCameraError as problem:
            raise SiteError(
                f"{path}: vehicles (entry {entry}).camera: expected a survey camera. {problem}"
            ) from problem


def _give_pads(path: Path, layers: Layers, profiles: dict[str, VehicleProfile]) -> None:
    """Add the layer's pads to the profiles of their vehicles."""
    given: set[str] = set()
    for pad in layers.landing_pads:
        if pad.serial is None:
            continue
        place = f"{path}: layers.landing_pads: pad {pad.name!a}"
        profile = profiles.get(pad.serial)
        if profile is None:
            raise SiteError(f"{place}: expected a vehicle's serial, got the unknown {pad.serial!a}")
        if profile.pad is not None:
            where = "the layer" if pad.serial in given else "[[vehicles]]"
            raise SiteError(f"{place}: expected one pad for {pad.serial!a}, got another in {where}")
        given.add(pad.serial)
        profiles[pad.serial] = replace(profile, pad=pad.place)


def demo_site_folder() -> Path:
    """Return the folder of the demonstration's site, inside the package."""
    return Path(__file__).parent / "demo"


def own_folder(folder: Path | None) -> Path | None:
    """Return a site's folder, in which files may be kept; None for the demonstration's, which is a
    part of the package."""
    is_own = folder is not None and folder.resolve() != demo_site_folder().resolve()
    return folder if is_own else None
