"""A finished run of OpenDroneMap by construction: a hill, tilted cameras, a lens with distortion.

The files are written as OpenDroneMap writes them: OpenSfM reconstructs in a frame of east, north
and up about a reference place; for the report and the surface model all is moved to UTM by one
linear map, taken at that place.
"""

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pyproj
import rasterio
from rasterio.transform import Affine
from tests.product.made_flight import FRAME, HEIGHT_M, sun
from tests.product.mosaic.made_mosaic import MadeMosaic, painted

from recon.geo import enu_from_geo, geo_from_enu
from recon.model.geo import GeoPoint, LocalFrame
from recon.product.mosaic.pixels import Box

FloatArray = npt.NDArray[np.float64]

COLS, ROWS_PX = 320, 240
UTM = "EPSG:32615"
REFERENCE = GeoPoint(41.9004, -93.6007, 301.0)
DSM_CELL_M = 0.5
FOCAL, FOCAL_Y, AXIS = 0.77, 0.771, (0.004, -0.003)
K1, K2, K3, P1, P2 = -0.06, 0.02, -0.004, 0.0008, -0.0005
CAMERA_ID = "made camera 320 240 brown 0.85"
ORIGIN_M = FRAME.origin.ellipsoid_height_m


def hill_m(east_m: FloatArray, north_m: FloatArray) -> FloatArray:
    """The surface above the site's origin, as a height above the ellipsoid."""
    away = (east_m - 20.0) ** 2 + (north_m + 10.0) ** 2
    return 9.0 * np.exp(-away / (2.0 * 35.0**2)) + 0.02 * east_m


def up_m(east_m: FloatArray, north_m: FloatArray) -> FloatArray:
    """The same above the tangent plane at the origin."""
    return hill_m(east_m, north_m) - (east_m**2 + north_m**2) / (2.0 * 6.371e6)


@cache
def rays_of_pixels() -> FloatArray:
    """The rays (N, 3) of all pixels, right, down and forward, row by row."""
    pixels = np.stack(np.meshgrid(np.arange(COLS), np.arange(ROWS_PX)), axis=-1)
    matrix = np.array(
        [
            [FOCAL * COLS, 0.0, (COLS - 1) / 2.0 + AXIS[0] * COLS],
            [0.0, FOCAL_Y * COLS, (ROWS_PX - 1) / 2.0 + AXIS[1] * COLS],
            [0.0, 0.0, 1.0],
        ]
    )
    points = pixels.reshape(-1, 1, 2).astype(float)
    often = (cv2.TERM_CRITERIA_COUNT, 40, 1e-9)
    rays = cv2.undistortPoints(points, matrix, np.array([K1, K2, P1, P2, K3]), criteria=often)[:, 0]
    return np.column_stack([rays, np.ones(len(rays))])


@dataclass(slots=True)
class MadeOdm:
    """The cameras as they truly were, in the site's frame."""

    made: MadeMosaic
    folder: Path

    def pose(self, index: int) -> tuple[FloatArray, FloatArray]:
        """The place, and the rotation from the site's axes to the camera's."""
        aim = self.made.photos[index].view.aim
        random = np.random.default_rng(index)
        tilt, _ = cv2.Rodrigues(np.deg2rad(random.uniform(-4.0, 4.0, 3)))
        place = np.array([aim.east_m, aim.north_m, HEIGHT_M]) + random.uniform(-2.0, 2.0, 3)
        return place, tilt @ aim.rotation.T

    def read(self, index: int, shrink: int, box: Box) -> npt.NDArray[np.uint8]:
        """Paint a photo."""
        assert shrink == 1
        place, to_camera = self.pose(index)
        ways = rays_of_pixels() @ to_camera
        ground = np.broadcast_to(place[:2], (len(ways), 2))
        for _ in range(8):
            fall = place[2] - up_m(ground[:, 0], ground[:, 1])
            ground = place[:2] + ways[:, :2] * (fall / -ways[:, 2])[:, np.newaxis]
        shade = sun(ground[:, 0], ground[:, 1], self.made.at_s(index))
        top, left, bottom, right = box
        return painted(ground, shade).reshape(ROWS_PX, COLS, 3)[top:bottom, left:right]

    def write(self, *, has_report: bool = True) -> None:
        """Write the folder."""
        for part in ("odm_report", "odm_dem", "opensfm"):
            (self.folder / part).mkdir(parents=True, exist_ok=True)
        self._write_surface()
        names = ("focal_x", "focal_y", "c_x", "c_y", "k1", "k2", "k3", "p1", "p2")
        numbers = (FOCAL, FOCAL_Y, *AXIS, K1, K2, K3, P1, P2)
        camera = {"projection_type": "brown", "width": COLS, "height": ROWS_PX}
        camera |= dict(zip(names, numbers, strict=True))
        (self.folder / "cameras.json").write_text(json.dumps({CAMERA_ID: camera}))
        if has_report:
            shots = {"type": "FeatureCollection", "features": list(self._features())}
            (self.folder / "odm_report" / "shots.geojson").write_text(json.dumps(shots))
            return
        reference = {"latitude": REFERENCE.latitude_deg, "longitude": REFERENCE.longitude_deg}
        reference["altitude"] = REFERENCE.ellipsoid_height_m
        part = {"cameras": {}, "reference_lla": reference, "points": {"1": {"color": [1, 2, 3]}}}
        part["shots"] = dict(self._shots())
        (self.folder / "opensfm" / "reconstruction.json").write_text(json.dumps([part]))

    def _topocentric(self, index: int) -> tuple[FloatArray, FloatArray]:
        """A camera's place and rotation in OpenSfM's frame, by points a metre apart."""
        place, to_camera = self.pose(index)
        ends = place + np.vstack([np.zeros(3), np.eye(3)])
        there = enu_from_geo(LocalFrame(REFERENCE), *geo_from_enu(FRAME, ends))
        turn = (there[1:] - there[0]).T
        return there[0], to_camera @ turn.T

    def _shots(self):
        for index, timed in enumerate(self.made.photos):
            place, to_camera = self._topocentric(index)
            rotation = cv2.Rodrigues(to_camera)[0].ravel()
            yield (
                timed.photo.name,
                {
                    "camera": f"v2 {CAMERA_ID}",
                    "rotation": rotation.tolist(),
                    "translation": (-to_camera @ place).tolist(),
                },
            )

    def _features(self):
        linear, offset = self._to_utm()
        for index, timed in enumerate(self.made.photos):
            place, to_camera = self._topocentric(index)
            rotation = cv2.Rodrigues(to_camera @ np.linalg.inv(linear))[0].ravel()
            properties = {
                "filename": timed.photo.name,
                "camera": f"v2 {CAMERA_ID}",
                "focal": FOCAL,
                "width": COLS,
                "height": ROWS_PX,
                "capture_time": 0,
                "translation": (linear @ place + offset).tolist(),
                "rotation": rotation.tolist(),
            }
            yield {"type": "Feature", "properties": properties, "geometry": None}

    def _to_utm(self) -> tuple[FloatArray, FloatArray]:
        there = np.vstack([np.eye(3), np.zeros(3)])
        latitude, longitude, height = geo_from_enu(LocalFrame(REFERENCE), there)
        to_map = pyproj.Transformer.from_crs("EPSG:4326", UTM, always_xy=True)
        x, y = to_map.transform(longitude, latitude)
        points = np.column_stack([x, y, height])
        return (points[:3] - points[3]).T, points[3]

    def _write_surface(self) -> None:
        to_map = pyproj.Transformer.from_crs("EPSG:4326", UTM, always_xy=True)
        origin = FRAME.origin
        middle = to_map.transform(origin.longitude_deg, origin.latitude_deg)
        side = 540
        west, north = (round(middle[0]) - 135.0, round(middle[1]) + 135.0)
        steps = (np.arange(side) + 0.5) * DSM_CELL_M
        x, y = np.meshgrid(west + steps, north - steps)
        longitude, latitude = to_map.transform(x, y, direction="INVERSE")
        heights = np.full(x.size, ORIGIN_M)
        enu = enu_from_geo(FRAME, latitude.ravel(), longitude.ravel(), heights)
        values = ORIGIN_M + hill_m(enu[:, 0], enu[:, 1]).reshape(x.shape)
        values[:4] = -9999.0
        with rasterio.open(
            self.folder / "odm_dem" / "dsm.tif", "w", driver="GTiff", width=side, height=side,
            count=1, dtype="float32", nodata=-9999.0, crs=UTM, tiled=True,
            transform=Affine(DSM_CELL_M, 0.0, west, 0.0, -DSM_CELL_M, north),
        ) as dataset:  # fmt: skip
            dataset.write(values.astype(np.float32), 1)
