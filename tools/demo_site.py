"""The demonstration's site: synthetic, so that a first run needs no data.

The lens is an equisolid-angle fisheye that lights the sensor up to 66 degrees from its axis; the
imaging drone hovers 120 m over farmland and looks straight down, the top of the frame at its yaw.
Running this module writes `demo/`:

    python -m tools.demo_site
"""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from rasterio.io import MemoryFile
from rasterio.transform import Affine

from recon.camera import (
    ControlPoint,
    OmnidirectionalCamera,
    TelemetryReference,
    format_camera,
    format_control_points,
    mounted_pose,
)
from recon.geo import geo_from_enu
from recon.model.geo import GeoPoint, LocalFrame
from recon.site.load import demo_site_folder

Outline = tuple[tuple[float, float], ...]

BOUNDARY: Outline = ((-245, -240), (240, -245), (250, 60), (180, 245), (-230, 250))
FARMYARD: Outline = ((150, 60), (205, 60), (205, 120), (180, 120), (180, 95), (150, 95))
SURVEY: Mapping[str, Outline] = {
    "west field": ((-200, 20), (-60, 30), (-50, 200), (-190, 190)),
    "south-east field": ((40, -200), (190, -190), (200, -60), (90, -40)),
}
TREES: Outline = ((-200, 210), (120, 214), (120, 234), (-200, 230))
TREES_FLOOR_M = 35.0
"""Trees of 25 m and room above them."""
PADS: Mapping[str, tuple[str | None, tuple[float, float]]] = {
    "Imager": ("SIM-IMAGER", (0.0, 0.0)),
    "Drone 1": ("SIM-1", (-24.0, -8.0)),
    "Drone 2": ("SIM-2", (-4.0, -26.0)),
    "Drone 3": ("SIM-3", (20.0, -16.0)),
    "Drone 4": ("SIM-4", (-48.0, -26.0)),
    "Drone 5": ("SIM-5", (-26.0, -50.0)),
    "Drone 6": ("SIM-6", (22.0, -44.0)),
    "Drone 7": ("SIM-7", (46.0, -24.0)),
    "spare": (None, (30.0, 14.0)),
}
"""Each pad's vehicle and place: further apart than two landing vehicles must be."""
DECIMALS = 8
"""Decimals of a degree: a millimetre."""


def demo_layer_files(frame: LocalFrame) -> dict[str, str]:
    """Return the text of each layer's file around a frame's origin; the same at each call."""
    return {
        "boundary.geojson": _collection("boundary", _areas({"demo field": BOUNDARY}, frame)),
        "keep_out.geojson": _collection("keep_out", _areas({"farmyard": FARMYARD}, frame)),
        "height_zones.geojson": _collection(
            "height_zones",
            _areas({"tree line": TREES}, frame, floor_m=TREES_FLOOR_M, datum="ground"),
        ),
        "landing_pads.geojson": _collection("landing_pads", _pads(frame)),
        "survey_regions.geojson": _collection("survey_regions", _areas(SURVEY, frame)),
    }


def _collection(name: str, features: list[dict[str, Any]]) -> str:
    lines = ",\n".join(json.dumps({"type": "Feature", **feature}) for feature in features)
    return f'{{\n"type": "FeatureCollection",\n"name": "{name}",\n"features": [\n{lines}\n]\n}}\n'


def _areas(
    outlines: Mapping[str, Outline], frame: LocalFrame, **properties: object
) -> list[dict[str, Any]]:
    return [
        {
            "properties": {"name": name, **properties},
            "geometry": {
                "type": "Polygon",
                "coordinates": [_positions((*outline, outline[0]), frame)],
            },
        }
        for name, outline in outlines.items()
    ]


def _pads(frame: LocalFrame) -> list[dict[str, Any]]:
    ground_m = frame.origin.ellipsoid_height_m
    return [
        {
            "properties": {"name": name, "serial": serial, "altitude_m": ground_m},
            "geometry": {"type": "Point", "coordinates": _positions((place,), frame)[0]},
        }
        for name, (serial, place) in PADS.items()
    ]


def _positions(places: Outline, frame: LocalFrame) -> list[list[float]]:
    """Return longitude, latitude pairs."""
    points = [(east_m, north_m, 0.0) for east_m, north_m in places]
    latitudes, longitudes, _ = geo_from_enu(frame, points)
    return [
        [round(float(longitude), DECIMALS), round(float(latitude), DECIMALS)]
        for latitude, longitude in zip(latitudes, longitudes, strict=True)
    ]


ELEVATION_FILE = "ground.tif"
PIXEL_DEG = 0.0005
"""56 m north, 41 m east."""
PIXELS = 64


def demo_elevation_bytes(frame: LocalFrame) -> bytes:
    """Return a GeoTIFF in degrees of WGS84 around the origin, all at its height."""
    origin = frame.origin
    half_deg = PIXELS / 2 * PIXEL_DEG
    west_deg, north_deg = origin.longitude_deg - half_deg, origin.latitude_deg + half_deg
    heights_m = np.full((1, PIXELS, PIXELS), origin.ellipsoid_height_m, np.float32)
    with MemoryFile() as memory:
        with memory.open(
            driver="GTiff",
            count=1,
            height=PIXELS,
            width=PIXELS,
            dtype="float32",
            crs="EPSG:4326",
            transform=Affine(PIXEL_DEG, 0.0, west_deg, 0.0, -PIXEL_DEG, north_deg),
            compress="deflate",
        ) as dataset:
            dataset.write(heights_m)
        return bytes(memory.read())


ORIGIN = GeoPoint(41.9012, -93.6034, 275.0)
IMAGER_SERIAL = "SIM-IMAGER"
SERIALS = ("SIM-1", "SIM-2", "SIM-3", IMAGER_SERIAL, "SIM-4", "SIM-5", "SIM-6", "SIM-7")
"""A demonstration of four vehicles, with the imaging drone, has the first four."""
IMAGER_HEIGHT_M = 120.0
IMAGER_YAW_DEG = 20.0

ROWS, COLS = 720, 1280
CENTRE_ROW_PX, CENTRE_COL_PX = 361.2, 637.8
HALF_FIELD_RAD = float(np.deg2rad(85.0))
RADIUS_AT_HALF_FIELD_PX = 340.0
FOCAL_PX = RADIUS_AT_HALF_FIELD_PX / (2.0 * np.sin(HALF_FIELD_RAD / 2.0))
IMAGE_CIRCLE_RAD = float(np.deg2rad(66.0))
"""The lens lights the sensor up to this angle, as the lenses of real frames do."""
IMAGE_CIRCLE_RADIUS_PX = round(float(2.0 * FOCAL_PX * np.sin(IMAGE_CIRCLE_RAD / 2.0)), 1)
INVERSE_DEGREE = 9

MARKED_SIZE_PX = (3840, 2160)
MARKING_NOISE_PX = 0.5
POINTS_EAST_NORTH_M = {
    "A": (-150.0, 140.0),
    "B": (20.0, 180.0),
    "C": (170.0, 120.0),
    "D": (200.0, -40.0),
    "E": (110.0, -160.0),
    "F": (-60.0, -190.0),
    "G": (-190.0, -70.0),
    "H": (40.0, 30.0),
}
LOWEST_GO_HOME_HEIGHT_M, GO_HOME_HEIGHT_STEP_M = 40, 8
"""Lowest go-home height, above the trees' zone, and step; the imaging drone returns at 120 m."""
ENDURANCE_MIN = 25
"""The simulated battery's default."""


def demo_site_files() -> dict[str, str]:
    """Return the text of each text file of the demonstration's site; the same at each call."""
    camera = demo_camera()
    frame = LocalFrame(ORIGIN)
    return {
        "camera-model.txt": format_camera(camera),
        "GCPs.txt": format_control_points(_control_points(camera)),
        "site.toml": _site_toml(),
        **demo_layer_files(frame),
    }


def demo_camera() -> OmnidirectionalCamera:
    """Return the synthetic lens: r = 2 f sin(angle / 2), fitted by the omnidirectional model."""
    angles = np.linspace(0.0, HALF_FIELD_RAD + 0.05, 400)
    sine = np.sin(angles / 2.0)
    radii = 2.0 * FOCAL_PX * sine
    depths = FOCAL_PX * (1.0 - 2.0 * sine**2) / np.sqrt(1.0 - sine**2)
    # The model's usual form: no linear term.
    powers = np.array([0, 2, 3, 4])
    scaled, *_ = np.linalg.lstsq((radii / radii[-1])[:, np.newaxis] ** powers, -depths, rcond=None)
    direct = np.zeros(5)
    direct[powers] = scaled / radii[-1] ** powers
    direct_text = tuple(float(f"{value:.9e}") for value in direct)
    fitted_depths = -np.polynomial.polynomial.polyval(radii, direct_text)
    angles_below = np.arctan2(radii, fitted_depths) - np.pi / 2.0
    inverse = np.polynomial.Polynomial.fit(angles_below, radii, INVERSE_DEGREE).convert().coef
    return OmnidirectionalCamera(
        direct=direct_text,
        inverse=tuple(float(f"{value:.6f}") for value in inverse),
        centre_row_px=CENTRE_ROW_PX,
        centre_col_px=CENTRE_COL_PX,
        affine_c=1.0002,
        affine_d=0.0001,
        affine_e=-0.0001,
        rows=ROWS,
        cols=COLS,
    )


def demo_marked_telemetry() -> TelemetryReference:
    """Return the imaging drone's telemetry at the marked frame: level, over the origin."""
    return TelemetryReference(
        ORIGIN.latitude_deg, ORIGIN.longitude_deg, IMAGER_HEIGHT_M, IMAGER_YAW_DEG
    )


def _control_points(camera: OmnidirectionalCamera) -> tuple[ControlPoint, ...]:
    pose = mounted_pose(demo_marked_telemetry(), np.array([0.0, 0.0, IMAGER_HEIGHT_M]))
    points_enu = np.array([(*point, 0.0) for point in POINTS_EAST_NORTH_M.values()])
    marked_camera = camera.scaled_to(MARKED_SIZE_PX[1], MARKED_SIZE_PX[0])
    pixels = marked_camera.project((points_enu - pose.position_enu_m) @ pose.rotation_enu_camera)
    pixels += np.random.default_rng(20).normal(0.0, MARKING_NOISE_PX, pixels.shape)
    globe = zip(*geo_from_enu(LocalFrame(ORIGIN), points_enu), strict=True)
    return tuple(
        ControlPoint(
            name,
            round(float(col), 2),
            round(float(row), 2),
            round(float(latitude), 8),
            round(float(longitude), 8),
            round(float(height), 3),
        )
        for name, (col, row), (latitude, longitude, height) in zip(
            POINTS_EAST_NORTH_M, pixels, globe, strict=True
        )
    )


def _site_toml() -> str:
    header = f"""# The demonstration's site: a synthetic field and lens.
# Written by `python -m tools.demo_site`; docs/how-to/prepare-a-site.md explains the keys.
name = "demo field"

[origin]
latitude_deg = {ORIGIN.latitude_deg}
longitude_deg = {ORIGIN.longitude_deg}
ground_altitude_m = {ORIGIN.ellipsoid_height_m}

[limits]
max_height_above_ground_m = 130.0  # the imaging drone hovers at {IMAGER_HEIGHT_M:g} m
max_distance_from_home_m = 500.0

[imager]
serial = "{IMAGER_SERIAL}"
camera = "camera-model.txt"
control_points = "GCPs.txt"
control_points_image_size_px = [{MARKED_SIZE_PX[0]}, {MARKED_SIZE_PX[1]}]

[imager.marked_frame]
latitude_deg = {ORIGIN.latitude_deg}
longitude_deg = {ORIGIN.longitude_deg}
height_above_takeoff_m = {IMAGER_HEIGHT_M}
yaw_deg = {IMAGER_YAW_DEG}
pitch_deg = 0.0
roll_deg = 0.0

[imager.image_circle]
col_px = {CENTRE_COL_PX}
row_px = {CENTRE_ROW_PX}
radius_px = {IMAGE_CIRCLE_RADIUS_PX}

[ground_image]
width_m = 544.0
height_m = 544.0
cell_m = 1.0

[layers]
boundary = "boundary.geojson"
keep_out = "keep_out.geojson"
height_zones = "height_zones.geojson"
landing_pads = "landing_pads.geojson"
survey_regions = "survey_regions.geojson"

[elevation]
file = "{ELEVATION_FILE}"
datum = "wgs84"
"""
    return header + "".join(_vehicle_toml(serial) for serial in SERIALS)


def _vehicle_toml(serial: str) -> str:
    is_imager = serial == IMAGER_SERIAL
    name = "Imager" if is_imager else f"Drone {serial[-1]}"
    number = 0 if is_imager else int(serial[-1])
    go_home_height_m = LOWEST_GO_HOME_HEIGHT_M + number * GO_HOME_HEIGHT_STEP_M
    # The imaging drone sees the whole field: in a conflict the other vehicle is held first.
    more = "priority = 10" if is_imager else "camera_interval_s = 2.0"
    return f"""
[[vehicles]]
serial = "{serial}"
name = "{name}"
model = "simulated"
waypoint_altitude = "takeoff"
mount = "gimbal"
endurance_min = {ENDURANCE_MIN}
go_home_height_m = {go_home_height_m}
failsafe = "go_home"
{more}
"""


def main() -> None:
    """Write the files of the demonstration's site."""
    folder = demo_site_folder()
    folder.mkdir(exist_ok=True)
    for name, text in demo_site_files().items():
        (folder / name).write_text(text, encoding="utf-8")
    (folder / ELEVATION_FILE).write_bytes(demo_elevation_bytes(LocalFrame(ORIGIN)))


if __name__ == "__main__":
    main()
