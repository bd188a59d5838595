"""The demonstration's GeoJSON layers and elevation model.

Layers: a boundary, a farmyard to keep out of, trees to stay above, pads, two fields to survey. The
outlines are in metres east and north of the origin here; the files hold degrees. The ground is
flat, as in the simulator: aircraft stand and images are rendered on one plane.
"""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from rasterio.io import MemoryFile
from rasterio.transform import Affine

from recon.geo import geo_from_enu
from recon.model.geo import LocalFrame

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
"""Of a degree: a millimetre."""


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
