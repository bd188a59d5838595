"""Lay real frames on the ground with their control points drawn, to be looked at.

    RECON_DATA=... python benches/camera/picture.py OUT_DIR

For each site of $RECON_DATA/fisheye: red crosses where the control points are on the globe. Roads
and the edges of plots must be straight, and the crosses must sit on what was marked.
"""

import os
import sys
from pathlib import Path

import cv2
import numpy as np

from recon.camera import (
    GroundProjector,
    decode_jpeg,
    load_camera,
    load_control_points,
    pose_from_points,
)
from recon.geo import enu_from_points
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame

CELL_M = 0.5
SIDE_CELLS = 1200


def draw(site: Path, camera_file: Path, out: Path) -> None:
    camera = load_camera(camera_file)
    points = load_control_points(site / "GCPs.txt")
    latitude, longitude, height = np.mean(
        [(p.latitude_deg, p.longitude_deg, p.ellipsoid_height_m) for p in points], axis=0
    )
    frame = LocalFrame(GeoPoint(latitude, longitude, height))
    points_enu_m = enu_from_points(frame, [point.place for point in points])
    solution = pose_from_points(camera, points, (3840, 2160), points_enu_m)
    east_m, north_m, _ = solution.pose.position_enu_m
    half_m = SIDE_CELLS * CELL_M / 2.0
    grid = GroundGrid(frame, east_m - half_m, north_m + half_m, CELL_M, SIDE_CELLS, SIDE_CELLS)
    rgb = decode_jpeg((site / "RefFrame.jpeg").read_bytes())
    laid, valid = GroundProjector(grid, camera).lay_pixels(rgb, solution.pose)
    for point, enu in zip(points, points_enu_m, strict=True):
        at = (round((enu[0] - grid.west_m) / CELL_M), round((grid.north_m - enu[1]) / CELL_M))
        cv2.drawMarker(laid, at, (255, 0, 0), cv2.MARKER_CROSS, 25, 2)
        cv2.putText(laid, point.name, (at[0] + 8, at[1] - 8), 0, 0.8, (255, 255, 0), 2)
    cv2.imwrite(str(out / f"{site.name}.png"), cv2.cvtColor(laid, cv2.COLOR_RGB2BGR))
    print(
        f"{site.name}: RMS {solution.rms_px:.2f} px, height {solution.height_above_ground_m:.1f} "
        f"+- {solution.height_sigma_m:.1f} m, tilt {solution.tilt_deg:.1f} "
        f"+- {solution.tilt_sigma_deg:.1f} deg, {valid.mean():.0%} of the grid seen"
    )


def main() -> None:
    fisheye = Path(os.environ["RECON_DATA"]) / "fisheye"
    out = Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    for site in sorted(path.parent for path in fisheye.glob("*/GCPs.txt")):
        draw(site, fisheye / "camera-model.txt", out)


if __name__ == "__main__":
    main()
