"""A finished run of OpenDroneMap by construction: true cameras, and the true ground as surface."""

import json
from pathlib import Path

import cv2
import numpy as np
import pyproj
import rasterio
from rasterio.transform import Affine

from recon.geo import enu_from_geo
from studies.survey_photos import SurveyFlown
from studies.true_mosaic import camera_of

CELL_M = 0.5
HALF_M = 400.0
CAMERA = "true camera"


def write_odm(flown: SurveyFlown, folder: Path) -> Path:
    """Write what a run of OpenDroneMap leaves of a flight's photos, into a folder; return it."""
    for part in ("odm_dem", "opensfm"):
        (folder / part).mkdir(parents=True, exist_ok=True)
    cols, shots = flown.settings.cols, {}
    rows = flown.settings.camera.rows_of(cols)
    for shot in flown.shots.values():
        camera = camera_of(flown, shot)
        to_camera = camera.rotation.T
        shots[shot.name] = {
            "camera": f"v2 {CAMERA}",
            "rotation": cv2.Rodrigues(to_camera)[0].ravel().tolist(),
            "translation": (-to_camera @ camera.place_m).tolist(),
        }
        # OpenSfM's lengths are in the longer side of the picture.
        focal = camera.lens.focal_px[0] / cols
    lens = {"projection_type": "perspective", "width": cols, "height": rows, "focal": focal}
    origin = flown.flight.frame.origin
    reference = {
        "latitude": origin.latitude_deg,
        "longitude": origin.longitude_deg,
        "altitude": origin.ellipsoid_height_m,
    }
    run = [{"cameras": {}, "shots": shots, "reference_lla": reference, "points": {}}]
    (folder / "cameras.json").write_text(json.dumps({CAMERA: lens}), encoding="utf-8")
    (folder / "opensfm" / "reconstruction.json").write_text(json.dumps(run), encoding="utf-8")
    _write_surface(flown, folder / "odm_dem" / "dsm.tif")
    return folder


def _write_surface(flown: SurveyFlown, path: Path) -> None:
    """Write the ground's heights above the ellipsoid, in UTM."""
    frame = flown.flight.frame
    origin = frame.origin
    zone = int((origin.longitude_deg + 180.0) // 6.0) + 1
    utm = f"EPSG:{(32600 if origin.latitude_deg >= 0.0 else 32700) + zone}"
    to_map = pyproj.Transformer.from_crs("EPSG:4326", utm, always_xy=True)
    middle = to_map.transform(origin.longitude_deg, origin.latitude_deg)
    west, north, side = middle[0] - HALF_M, middle[1] + HALF_M, round(2.0 * HALF_M / CELL_M)
    steps = (np.arange(side) + 0.5) * CELL_M
    x, y = (part.ravel() for part in np.meshgrid(west + steps, north - steps))
    longitude, latitude = to_map.transform(x, y, direction="INVERSE")
    level = enu_from_geo(frame, latitude, longitude, np.full(x.size, origin.ellipsoid_height_m))
    # The relief is above the tangent plane, from which the ellipsoid has fallen by `level`.
    up_m = 0.0 if flown.relief is None else flown.relief.height_m(level[:, 0], level[:, 1])
    heights_m = origin.ellipsoid_height_m + up_m - level[:, 2]
    with rasterio.open(
        path, "w", driver="GTiff", width=side, height=side, count=1, dtype="float32",
        nodata=-9999.0, crs=utm, tiled=True,
        transform=Affine(CELL_M, 0.0, west, 0.0, -CELL_M, north),
    ) as dataset:  # fmt: skip
        dataset.write(heights_m.reshape(side, side).astype(np.float32), 1)
