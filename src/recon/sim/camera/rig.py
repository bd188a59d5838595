"""The pose of the imaging drone's camera: as telemetry gives it, and the true one."""

from dataclasses import dataclass
from math import radians

import numpy as np

from recon.camera import OmnidirectionalCamera, TelemetryReference, displaced_pose
from recon.geo import shift_east_north_m
from recon.model.arrays import FloatArray
from recon.model.geo import LocalFrame
from recon.model.imagery import CameraPose
from recon.model.vehicle import Mount
from recon.sim.camera.settings import HoverSettings
from recon.sim.world.keyframes import gaussian, number


@dataclass(frozen=True, slots=True, eq=False)
class CameraRig:
    """A camera, and its pose in `frame` when the aircraft is at `marked`.

    The origin of `frame` lies on the (flat) ground; the pose moves with the aircraft.
    """

    camera: OmnidirectionalCamera
    frame: LocalFrame
    marked_pose: CameraPose
    marked: TelemetryReference
    mount: Mount = Mount.GIMBAL

    def pose_at(self, truth: TelemetryReference) -> CameraPose:
        """Return the camera's pose when the aircraft is truly at `truth`."""
        shift_m = shift_east_north_m(self.frame, self.marked, truth)
        return displaced_pose(self.marked_pose, self.marked, truth, shift_m, self.mount)


WOBBLE, MOUNT, DRIFT = 100, 110, 120
"""Random streams of the imaging drone's camera; each has three axes."""


def true_pose(pose: CameraPose, settings: HoverSettings, seed: int, time_s: float) -> CameraPose:
    """Return the true pose at a time; `pose` is the one computed from telemetry and marking.

    They differ by the gimbal's residual motion, its levelling error, and GNSS and barometer drift.
    """
    lean_rad = np.array(
        [
            radians(settings.mount_error_deg) * number((seed, MOUNT + axis), 0)
            + radians(settings.wobble_deg)
            * _value((seed, WOBBLE + axis), time_s, settings.wobble_s)
            for axis in range(3)
        ]
    )
    drift = [_value((seed, DRIFT + axis), time_s, settings.drift_s) for axis in range(3)]
    shift_m = np.array(drift) * (settings.drift_m, settings.drift_m, settings.drift_up_m)
    # The lean is about the camera's own axes, so it is applied first (from the right).
    return CameraPose(pose.rotation_enu_camera @ _rotation(lean_rad), pose.position_enu_m + shift_m)


def _value(stream: tuple[int, ...], time_s: float, lifetime_s: float) -> float:
    return float(gaussian(stream, np.array([time_s]), lifetime_s)[0])


def _rotation(vector_rad: FloatArray) -> FloatArray:
    """Return the rotation about a vector by its length in radians (Rodrigues' formula)."""
    angle = float(np.linalg.norm(vector_rad))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = vector_rad / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    rotation: FloatArray = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    return rotation
