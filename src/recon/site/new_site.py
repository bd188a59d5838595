"""A new site's folder: an origin, limits, and drones to rehearse with; the rest is drawn."""

from math import isfinite
from pathlib import Path

from recon.geo.geoid import geoid_height_m
from recon.model.errors import SiteError
from recon.model.geo import GeoPoint
from recon.site.load import MOST_VEHICLES, SITE_FILE

MOST_LETTERS = 64
"""Longest name in site.toml."""

LOWEST_GO_HOME_HEIGHT_M, GO_HOME_HEIGHT_STEP_M = 30, 8
HIGHEST_GO_HOME_HEIGHT_M = 118
"""Highest go-home height, below the default height limit."""


def make_site(folder: Path, name: str, origin: GeoPoint, drones: int) -> Path:
    """Write site.toml into a folder, which is made if missing; return the file.

    Raises `SiteError` for a folder that has one already, and for values that no site has.
    """
    path = folder / SITE_FILE
    _require(abs(origin.latitude_deg) <= 90.0, "a latitude of -90 to 90", origin.latitude_deg)
    _require(abs(origin.longitude_deg) <= 180.0, "a longitude of -180 to 180", origin.longitude_deg)
    _require(isfinite(origin.ellipsoid_height_m), "a finite altitude", origin.ellipsoid_height_m)
    _require(0 <= drones <= MOST_VEHICLES, f"0 to {MOST_VEHICLES} drones", drones)
    if not name.isprintable() or not 0 < len(name) <= MOST_LETTERS:
        raise SiteError(f"expected a name of 1 to {MOST_LETTERS} printable letters, got {name!a}")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with path.open("x", encoding="utf-8") as file:
            file.write(_text(name, origin, drones))
    except FileExistsError as problem:
        raise SiteError(f"{path} exists already; choose another folder") from problem
    except OSError as problem:
        raise SiteError(f"{path} cannot be written: {problem.strerror or problem}") from problem
    return path


def point_above_sea_level(latitude_deg: float, longitude_deg: float, height_m: float) -> GeoPoint:
    """Return a place whose height is known above sea level. Raises `SiteError` off the globe."""
    _require(abs(latitude_deg) <= 90.0, "a latitude of -90 to 90", latitude_deg)
    _require(abs(longitude_deg) <= 180.0, "a longitude of -180 to 180", longitude_deg)
    sea_level_m = geoid_height_m(latitude_deg, longitude_deg)
    return GeoPoint(latitude_deg, longitude_deg, round(height_m + sea_level_m, 2))


def _require(is_met: bool, expected: str, got: float) -> None:
    if not is_met:
        raise SiteError(f"expected {expected}, got {got:g}")


def _text(name: str, origin: GeoPoint, drones: int) -> str:
    quoted = name.replace("\\", "\\\\").replace('"', '\\"')
    header = f"""# docs/how-to/prepare-a-site.md explains the keys.
name = "{quoted}"

[origin]
latitude_deg = {origin.latitude_deg!r}
longitude_deg = {origin.longitude_deg!r}
ground_altitude_m = {origin.ellipsoid_height_m!r}  # above the WGS84 ellipsoid, not above sea level

[limits]
max_height_above_ground_m = 120.0
max_distance_from_home_m = 500.0

[layers]
"""
    rehearse = """
# Simulated drones, to rehearse with `recon demo --site`. Replace them before you fly real ones.
"""
    return header + (rehearse if drones else "") + "".join(map(_drone, range(1, drones + 1)))


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
