"""Frames, camera poses and images on the ground."""

from dataclasses import dataclass
from enum import Enum
from typing import Self, TypeAlias

import numpy as np
import numpy.typing as npt

from recon.model.geo import GroundGrid, LatLon
from recon.model.units import is_finite
from recon.model.vehicle import Attitude

RgbImage: TypeAlias = npt.NDArray[np.uint8]
FloatArray: TypeAlias = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One camera frame; exactly one of `rgb` (H, W, 3) uint8 and `jpeg` is set.

    Image packets carry no time: `captured_at_ns` is the receive time less the vehicle's latency.
    """

    id: int
    serial: str
    received_at_ns: int
    captured_at_ns: int
    captured_sigma_s: float
    rgb: RgbImage | None = None
    jpeg: bytes | None = None


@dataclass(frozen=True, slots=True, eq=False)
class CameraPose:
    """Where a camera is and looks: ray_enu = rotation_enu_camera @ ray_camera.

    `covariance` is (6, 6): rotation vector (rad, in ENU), then position (m, ENU);
    None when unknown.
    """

    rotation_enu_camera: FloatArray
    position_enu_m: FloatArray
    covariance: FloatArray | None = None


@dataclass(frozen=True, slots=True)
class TelemetryReference:
    """Position and attitude of the aircraft by telemetry, at one moment.

    Height is above takeoff (barometric); yaw clockwise from north, pitch nose up, roll right side
    down, as in core telemetry (ICD 3.1.1).
    """

    latitude_deg: float
    longitude_deg: float
    height_above_takeoff_m: float
    yaw_deg: float
    pitch_deg: float = 0.0
    roll_deg: float = 0.0

    @classmethod
    def from_report(
        cls,
        position: LatLon | None,
        height_above_takeoff_m: float | None,
        attitude: Attitude | None,
    ) -> Self | None:
        """Return the reference of a telemetry report, None when a part is missing or not finite."""
        if position is None or height_above_takeoff_m is None or attitude is None:
            return None
        values = (
            position.latitude_deg,
            position.longitude_deg,
            height_above_takeoff_m,
            attitude.yaw_deg,
            attitude.pitch_deg,
            attitude.roll_deg,
        )
        return cls(*values) if is_finite(*values) else None


@dataclass(frozen=True, slots=True)
class Outlook:
    """What a camera on its aircraft shows, whatever the aircraft's place and heading."""

    field_rad: float
    """Angle from the lens's axis to the rim that all frames show."""
    tilt_rad: float = 0.0
    """Angle from straight down to the axis."""
    off_front_deg: float = 0.0
    """Direction of the tilt, clockwise from the aircraft's front."""
    pixels_per_radian: float = 250.0
    """Resolution near the axis."""


class Registration(Enum):
    """How a ground image was georeferenced."""

    UNREGISTERED = "unregistered"
    """Placed by the marked frame's pose and telemetry: errors of metres are possible."""
    REGISTERED = "registered"
    """Aligned with a reference frame by its content."""
    LOST = "lost"
    """Placed as if unregistered, since no frame of the last seconds could be aligned."""


@dataclass(frozen=True, slots=True, eq=False)
class GroundImage:
    """An orthorectified frame: `rgb` (R, C, 3) uint8, `valid` (R, C) bool, on `grid`."""

    grid: GroundGrid
    frame_id: int
    captured_at_ns: int
    rgb: RgbImage
    valid: npt.NDArray[np.bool_]
    pose: CameraPose
    registration: Registration = Registration.UNREGISTERED
    registration_residual_m: float | None = None
    """Median distance on the ground between features and their places in the reference frame; None
    unless registered."""
    serial: str = ""
    """The vehicle that took it; empty when unknown."""
    toward_sun_enu: FloatArray | None = None
    """Unit vector (3,) to the sun at capture; None when unknown or the sun is below the horizon."""
    exposure_locked: bool = False
    """Whether the pilot locked exposure and white balance, by the site's file."""
    pixels_per_radian: float = 250.0
    """Resolution of the lens near its axis; by default a fisheye of 170 degrees at 1280 columns."""
