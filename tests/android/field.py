"""A field for eight companions: pads in a row, 20 m apart, beside a region to survey."""

import json
from pathlib import Path

from recon.geo import geo_from_enu
from recon.model.geo import GeoPoint, LocalFrame

ORIGIN = GeoPoint(41.9012, -93.6034, 275.0)
SPACING_M = 20.0
VEHICLES = 8
GO_HOME_M = 24
"""Of the first vehicle; the others are 8 m apart, as the companions'."""
BOUNDARY = ((-250.0, -250.0), (350.0, -250.0), (350.0, 350.0), (-250.0, 350.0))
REGION = ((-20.0, 60.0), (160.0, 60.0), (160.0, 240.0), (-20.0, 240.0))


def serial(number: int) -> str:
    """Return the serial of a vehicle, counted from 1."""
    return f"SIM-{number}"


def write_site(folder: Path) -> Path:
    """Write the site's files into a folder and return it."""
    frame = LocalFrame(ORIGIN)
    layers = {
        "boundary.geojson": [_area("field", BOUNDARY, frame)],
        "survey_regions.geojson": [_area("block", REGION, frame)],
        "landing_pads.geojson": [_pad(number, frame) for number in range(1, VEHICLES + 1)],
    }
    for name, features in layers.items():
        text = json.dumps({"type": "FeatureCollection", "features": features})
        (folder / name).write_text(text, encoding="utf-8")
    (folder / "site.toml").write_text(_site_toml(), encoding="utf-8")
    return folder


def _site_toml() -> str:
    vehicles = "".join(
        f"""
[[vehicles]]
serial = "{serial(number)}"
model = "simulated"
waypoint_altitude = "takeoff"
mount = "gimbal"
endurance_min = 25
go_home_height_m = {GO_HOME_M + 8 * (number - 1)}
failsafe = "go_home"
camera_interval_s = 2.0
"""
        for number in range(1, VEHICLES + 1)
    )
    return f"""name = "companions"
[origin]
latitude_deg = {ORIGIN.latitude_deg}
longitude_deg = {ORIGIN.longitude_deg}
ground_altitude_m = {ORIGIN.ellipsoid_height_m}
[layers]
boundary = "boundary.geojson"
landing_pads = "landing_pads.geojson"
survey_regions = "survey_regions.geojson"
{vehicles}"""


def _area(
    name: str, outline: tuple[tuple[float, float], ...], frame: LocalFrame
) -> dict[str, object]:
    ring = [_position(east_m, north_m, frame) for east_m, north_m in (*outline, outline[0])]
    return {
        "type": "Feature",
        "properties": {"name": name},
        "geometry": {"type": "Polygon", "coordinates": [ring]},
    }


def _pad(number: int, frame: LocalFrame) -> dict[str, object]:
    return {
        "type": "Feature",
        "properties": {
            "name": f"pad {number}",
            "serial": serial(number),
            "altitude_m": ORIGIN.ellipsoid_height_m,
        },
        "geometry": {
            "type": "Point",
            "coordinates": _position(SPACING_M * (number - 1), 0.0, frame),
        },
    }


def _position(east_m: float, north_m: float, frame: LocalFrame) -> list[float]:
    latitudes, longitudes, _ = geo_from_enu(frame, [(east_m, north_m, 0.0)])
    return [float(longitudes[0]), float(latitudes[0])]
