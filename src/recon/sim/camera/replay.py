"""A real field in the simulator: one real frame, with the pose it was taken from.

The folder holds `RefFrame.jpeg` and `GCPs.txt`; the camera is `camera-model.txt` there or one
folder up. The frame does not change when the simulated aircraft moves.
"""

from pathlib import Path

import numpy as np

from recon.camera import (
    CameraError,
    ControlPoint,
    OmnidirectionalCamera,
    TelemetryReference,
    jpeg_size,
    load_camera,
    load_control_points,
    pose_from_points,
)
from recon.geo import enu_from_points, geo_from_enu
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.imagery import CameraPose
from recon.sim.camera.frames import StillFrame, read_frame
from recon.sim.camera.rig import CameraRig
from recon.sim.errors import ReplayError

FRAME_FILE = "RefFrame.jpeg"
POINTS_FILE = "GCPs.txt"
CAMERA_FILE = "camera-model.txt"


def load_replay(folder: Path) -> tuple[CameraRig, StillFrame]:
    """Return the imaging drone's rig over a real field, and its frame; raises `ReplayError`."""
    for name in (FRAME_FILE, POINTS_FILE):
        if not (folder / name).is_file():
            raise ReplayError(f"{folder}: expected a folder with {name}, got none")
    try:
        camera = load_camera(_camera_file(folder))
        points = load_control_points(folder / POINTS_FILE)
        rows, cols = jpeg_size((folder / FRAME_FILE).read_bytes())
        rig = _rig(camera, points, (cols, rows))
    except CameraError as problem:
        raise ReplayError(f"{folder}: {problem}") from problem
    except OSError as problem:
        raise ReplayError(f"{folder}: expected readable files, got: {problem}") from problem
    return rig, StillFrame(read_frame(folder / FRAME_FILE, camera.rows, camera.cols))


def _camera_file(folder: Path) -> Path:
    inside = folder / CAMERA_FILE
    return inside if inside.is_file() else folder.resolve().parent / CAMERA_FILE


def _rig(
    camera: OmnidirectionalCamera,
    points: tuple[ControlPoint, ...],
    marked_size_px: tuple[int, int],
) -> CameraRig:
    """Return the rig; the local frame's origin is the mean of the control points, on the ground."""
    origin = GeoPoint(
        float(np.mean([p.latitude_deg for p in points])),
        float(np.mean([p.longitude_deg for p in points])),
        float(np.mean([p.ellipsoid_height_m for p in points])),
    )
    frame = LocalFrame(origin)
    points_enu_m = enu_from_points(frame, [point.place for point in points])
    solution = pose_from_points(camera, points, marked_size_px, points_enu_m)
    return rig_over(camera, frame, solution.pose)


def rig_over(camera: OmnidirectionalCamera, frame: LocalFrame, pose: CameraPose) -> CameraRig:
    """Return a rig whose marked frame was taken from `pose`, the aircraft pointing north.

    Any heading would do: only changes of heading turn the camera.
    """
    latitude, longitude, _ = geo_from_enu(frame, (*pose.position_enu_m[:2], 0.0))
    height_m = float(pose.position_enu_m[2])
    marked = TelemetryReference(float(latitude[0]), float(longitude[0]), height_m, 0.0)
    return CameraRig(camera, frame, pose, marked)
