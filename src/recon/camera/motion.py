"""The camera's pose now: the marked frame's pose, moved by the change of telemetry since.

Only differences of telemetry are used, so a constant error of position, height or compass cancels.
What remains (drift of barometer, GNSS and compass) is unknown here: a moved pose has no covariance.
"""

from math import cos, hypot, radians, sin

import numpy as np

from recon.model.arrays import FloatArray
from recon.model.imagery import CameraPose, TelemetryReference
from recon.model.vehicle import Mount

POSITION_ERROR_M, HEADING_ERROR_DEG, TILT_ERROR_DEG = 3.0, 2.0, 1.0
"""Standard errors of an aircraft's GNSS, of its compass, and of a gimbal's straight down."""


def displaced_pose(
    marked_pose: CameraPose,
    marked: TelemetryReference,
    now: TelemetryReference,
    shift_m: FloatArray,
    mount: Mount,
) -> CameraPose:
    """Return the camera's pose at `now`, given its pose when telemetry was `marked`.

    `shift_m` (2,) is the aircraft's displacement east and north since (`recon.geo`'s
    `shift_east_north_m`). The camera turns with the aircraft's yaw, and on a fixed mount also with
    pitch and roll (a gimbal compensates them). The lever arm between aircraft and camera is
    neglected.
    """
    # Relative rotation in the local frame: constant errors of the compass cancel.
    turn = _body_rotation(now, mount) @ _body_rotation(marked, mount).T
    climb_m = now.height_above_takeoff_m - marked.height_above_takeoff_m
    return CameraPose(
        rotation_enu_camera=turn @ marked_pose.rotation_enu_camera,
        position_enu_m=marked_pose.position_enu_m + np.append(shift_m, climb_m),
    )


def placing_error_m(height_m: float, away_m: float) -> float:
    """Return the standard error on the ground of a camera that telemetry alone places.

    `away_m` is the distance from the point below it, where an error of direction is longer.
    """
    sight_m2 = height_m**2 + away_m**2
    return hypot(
        POSITION_ERROR_M,
        radians(HEADING_ERROR_DEG) * away_m,
        radians(TILT_ERROR_DEG) * sight_m2 / height_m,
    )


def _body_rotation(telemetry: TelemetryReference, mount: Mount) -> FloatArray:
    """Return the rotation (3, 3) from forward-right-down to east-north-up."""
    is_fixed = mount is Mount.FIXED
    yaw, pitch, roll = np.deg2rad(
        [
            telemetry.yaw_deg,
            telemetry.pitch_deg if is_fixed else 0.0,
            telemetry.roll_deg if is_fixed else 0.0,
        ]
    )
    cy, sy, cp, sp, cr, sr = (f(a) for a in (yaw, pitch, roll) for f in (np.cos, np.sin))
    about_down = np.array([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]])
    about_right = np.array([[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]])
    about_forward = np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
    # Telemetry angles are in north-east-down, poses in east-north-up.
    enu_from_ned = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    rotation: FloatArray = enu_from_ned @ about_down @ about_right @ about_forward
    return rotation


def mounted_pose(
    telemetry: TelemetryReference, position_enu_m: FloatArray, tilt_deg: float = 0.0
) -> CameraPose:
    """Return the pose of a camera pointing down, the top of the frame towards the yaw.

    `tilt_deg` is the angle from straight down to its axis, towards the aircraft's front.
    """
    forward, right, down = _body_rotation(telemetry, Mount.GIMBAL).T
    tilt = radians(tilt_deg)
    axis = cos(tilt) * down + sin(tilt) * forward
    top = cos(tilt) * forward - sin(tilt) * down
    return CameraPose(np.stack([right, -top, axis], axis=1), position_enu_m)
