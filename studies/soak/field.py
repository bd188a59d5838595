"""The site of a soak: two regions, an imaging drone over each quarter, pads for all; its faults."""

import json
from dataclasses import replace
from pathlib import Path

from recon.camera import format_control_points, load_control_points
from recon.geo import enu_from_points, point_from_enu
from recon.model.geo import GeoPoint, LocalFrame
from recon.site import demo_site_folder

ORIGIN = GeoPoint(41.9012, -93.6034, 275.0)
FRAME = LocalFrame(ORIGIN)
HALF_M = 560.0
REGIONS_M = {
    "west": ((-450.0, -300.0), (-60.0, -300.0), (-60.0, 300.0), (-450.0, 300.0)),
    "east": ((60.0, -300.0), (450.0, -300.0), (450.0, 300.0), (60.0, 300.0)),
}
IMAGERS_M = ((-250.0, -150.0), (250.0, -150.0), (-250.0, 150.0), (250.0, 150.0))
PADS_TO_A_ROW, PAD_SPACING_M, FIRST_PAD_M = 8, 25.0, (-90.0, -380.0)
LOWEST_GO_HOME_M, GO_HOME_STEP_M = 40.0, 8.0
"""Each its own, which the checklist demands: 32 vehicles fill 300 m."""
IMAGER_HEIGHT_M = 120.0
CIRCLE = "col_px = 637.8\nrow_px = 361.2\nradius_px = 274.1\n"
"""Of the demonstration's lens, as its site.toml states."""

LINK_FAULTS = (
    ("half-open", 5, 30),
    ("restart", 1, 10),
    ("second-link", 5, 20),
    ("bursts", 5, 30),
    ("corrupted-bytes", 2, 10),
    ("telemetry-dropout", 1, 8),
    ("slow-reader", 5, 30),
    ("delayed-acks", 5, 30),
)
"""Name, and least and most seconds."""


def drones_and_imagers(vehicles: int) -> tuple[list[str], list[str]]:
    """Return the serials of a fleet, as the simulator counts it: up to four are imaging drones."""
    imagers = min(len(IMAGERS_M), max(1, vehicles // 4))
    return (
        [f"SIM-{number}" for number in range(1, vehicles - imagers + 1)],
        ["SIM-IMAGER", *(f"SIM-IMAGER-{number}" for number in range(2, imagers + 1))],
    )


def write_site(folder: Path, vehicles: int) -> None:
    """Write the folder of a site for so many vehicles."""
    folder.mkdir()
    demo = demo_site_folder()
    (folder / "camera-model.txt").write_bytes((demo / "camera-model.txt").read_bytes())
    drones, imagers = drones_and_imagers(vehicles)
    tables = [_head()]
    for serial, place_m in zip(imagers, IMAGERS_M, strict=False):
        (folder / f"{serial}.txt").write_text(_points(demo / "GCPs.txt", place_m), "ascii")
        tables.append(_imager(serial, place_m))
    tables += [_vehicle(serial, number) for number, serial in enumerate(drones, 1)]
    tables += [_vehicle(serial, 0, "priority = 10\n") for serial in imagers]
    (folder / "site.toml").write_text("\n".join(tables), "ascii")
    corners_m = ((-HALF_M, -HALF_M), (HALF_M, -HALF_M), (HALF_M, HALF_M), (-HALF_M, HALF_M))
    _write(folder / "boundary.geojson", [_area("boundary", corners_m)])
    _write(folder / "survey_regions.geojson", [_area(*each) for each in REGIONS_M.items()])
    pads = [_pad(serial, _pad_m(number)) for number, serial in enumerate(drones)]
    pads += [_pad(s, place_m) for s, place_m in zip(imagers, IMAGERS_M, strict=False)]
    _write(folder / "landing_pads.geojson", pads)


def write_faults(path: Path, minutes: float, per_hour: float) -> None:
    """Write random faults of the links, for every vehicle, from the first minute on."""
    tables = [
        f'[[chance]]\nname = "{name}"\nper_hour = {per_hour}\nduration_s = [{least}, {most}]\n'
        f"from_s = 60.0\nuntil_s = {max(61.0, 60.0 * minutes)}\n"
        for name, least, most in LINK_FAULTS
    ]
    path.write_text("\n".join(tables), "ascii")


def _head() -> str:
    return f"""name = "soak"
[origin]
latitude_deg = {ORIGIN.latitude_deg}
longitude_deg = {ORIGIN.longitude_deg}
ground_altitude_m = {ORIGIN.ellipsoid_height_m}
[limits]
max_height_above_ground_m = 300.0
max_distance_from_home_m = 1200.0
[ground_image]
width_m = 1000.0
height_m = 800.0
cell_m = 2.0
[layers]
boundary = "boundary.geojson"
landing_pads = "landing_pads.geojson"
survey_regions = "survey_regions.geojson"
"""


def _imager(serial: str, place_m: tuple[float, float]) -> str:
    latitude_deg, longitude_deg = _degrees(place_m)
    return f"""[[imager]]
serial = "{serial}"
control_points = "{serial}.txt"
control_points_image_size_px = [3840, 2160]
[imager.marked_frame]
latitude_deg = {latitude_deg}
longitude_deg = {longitude_deg}
height_above_takeoff_m = {IMAGER_HEIGHT_M}
yaw_deg = 20.0
[imager.image_circle]
{CIRCLE}"""


def _vehicle(serial: str, number: int, more: str = "") -> str:
    go_home_m = LOWEST_GO_HOME_M + GO_HOME_STEP_M * number
    return f"""[[vehicles]]
serial = "{serial}"
model = "simulated"
waypoint_altitude = "takeoff"
mount = "gimbal"
endurance_min = 25
go_home_height_m = {go_home_m}
failsafe = "go_home"
camera_interval_s = 2.0
{more}"""


def _points(demo: Path, place_m: tuple[float, float]) -> str:
    """Return the demonstration's control points around another place: its pose, moved as much."""
    points = load_control_points(demo)
    enu_m = enu_from_points(FRAME, [point.place for point in points])
    enu_m[:, :2] += place_m
    places = [point_from_enu(FRAME, each) for each in enu_m]
    return format_control_points(
        [
            replace(
                point,
                latitude_deg=place.latitude_deg,
                longitude_deg=place.longitude_deg,
                ellipsoid_height_m=place.ellipsoid_height_m,
            )
            for point, place in zip(points, places, strict=True)
        ]
    )


def _pad_m(number: int) -> tuple[float, float]:
    row, place = divmod(number, PADS_TO_A_ROW)
    return (FIRST_PAD_M[0] + PAD_SPACING_M * place, FIRST_PAD_M[1] - PAD_SPACING_M * row)


def _degrees(place_m: tuple[float, float]) -> tuple[float, float]:
    place = point_from_enu(FRAME, (*place_m, 0.0))
    return round(place.latitude_deg, 8), round(place.longitude_deg, 8)


def _pad(serial: str, place_m: tuple[float, float]) -> dict[str, object]:
    facts = {"name": f"pad {serial}", "serial": serial, "altitude_m": ORIGIN.ellipsoid_height_m}
    return _feature(facts, "Point", [*reversed(_degrees(place_m))])


def _area(name: str, corners_m: tuple[tuple[float, float], ...]) -> dict[str, object]:
    ring = [[*reversed(_degrees(corner))] for corner in (*corners_m, corners_m[0])]
    return _feature({"name": name}, "Polygon", [ring])


def _feature(facts: dict[str, object], kind: str, places: object) -> dict[str, object]:
    geometry = {"type": kind, "coordinates": places}
    return {"type": "Feature", "properties": facts, "geometry": geometry}


def _write(path: Path, features: list[dict[str, object]]) -> None:
    text = json.dumps({"type": "FeatureCollection", "features": features})
    path.write_text(text, encoding="ascii")
