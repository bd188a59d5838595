"""The camera's pose from ground control points, with its uncertainty."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from recon.camera.errors import PoseError
from recon.camera.omnidirectional import OmnidirectionalCamera, scale_between
from recon.camera.pose_fit import PoseFit, fit_pose, residuals_px
from recon.camera.text_files import ControlPoint
from recon.model.arrays import FloatArray
from recon.model.imagery import CameraPose

FEWEST_POINTS = 4
LARGEST_RMS_SHARE = 0.03
"""Share of the image's height. Real markings give 0.2 to 0.5 %; beyond 3 % points are swapped."""
LARGEST_POSITION_SIGMA_SHARE = 0.5
"""Share of the camera's height: less certain poses are rejected."""


@dataclass(frozen=True, slots=True)
class PointResidual:
    """Residual at one control point (observed minus predicted), in pixels and on the ground."""

    name: str
    col_px: float
    row_px: float
    east_m: float
    north_m: float

    @property
    def size_px(self) -> float:
        """Length in pixels of the camera model."""
        return float(np.hypot(self.col_px, self.row_px))

    @property
    def ground_m(self) -> float:
        """Length on the ground."""
        return float(np.hypot(self.east_m, self.north_m))


@dataclass(frozen=True, slots=True, eq=False)
class PoseSolution:
    """A solved pose and its uncertainty.

    `rms_px` is the root of the mean squared two-dimensional residual, at the model's size. Sigmas
    are standard deviations. Height and focal length are correlated: a focal length 1 % too long
    gives a height 1 % too large, which no sigma here includes.
    """

    pose: CameraPose
    rms_px: float
    residuals: tuple[PointResidual, ...]
    height_above_ground_m: float
    height_sigma_m: float
    tilt_deg: float
    """Angle between the optical axis and straight down."""
    tilt_sigma_deg: float


def pose_from_points(
    camera: OmnidirectionalCamera,
    points: Sequence[ControlPoint],
    marked_size_px: tuple[int, int],
    points_enu_m: FloatArray,
) -> PoseSolution:
    """Return the pose, in the local frame, of the camera that took the marked frame.

    `points_enu_m` (N, 3) are the places of the N points in that frame. `marked_size_px` is
    (cols, rows) of the frame the points were marked on; pixels are scaled to the model's size by
    pixel centres. Height is above the mean control point. Raises `PoseError` for fewer than four
    points and for points that fix no pose, `FrameSizeError` for another aspect ratio.
    """
    if len(points) < FEWEST_POINTS:
        raise PoseError(
            f"expected at least {FEWEST_POINTS} control points, got {len(points)}: three allow up "
            "to four poses and no check; mark more points"
        )
    pixels = _pixels_at_model_size(camera, points, marked_size_px)
    _refuse_unseen(camera, points, pixels)
    return _report(camera, points, pixels, points_enu_m, fit_pose(camera, pixels, points_enu_m))


def _pixels_at_model_size(
    camera: OmnidirectionalCamera, points: Sequence[ControlPoint], marked_size_px: tuple[int, int]
) -> FloatArray:
    scale = scale_between(marked_size_px, (camera.cols, camera.rows))
    cols, rows = marked_size_px
    for point in points:
        if point.col_px > cols - 0.5 or point.row_px > rows - 0.5:
            raise PoseError(
                f"control point {point.name}: expected a pixel inside the marked frame of {cols} x "
                f"{rows}, got column {point.col_px:g}, row {point.row_px:g}; check the frame's "
                "size and that the column comes first"
            )
    marked = np.array([(p.col_px, p.row_px) for p in points])
    return (marked + 0.5) * scale - 0.5


def _refuse_unseen(
    camera: OmnidirectionalCamera, points: Sequence[ControlPoint], pixels: FloatArray
) -> None:
    for point, is_in_range in zip(points, camera.is_in_range(pixels), strict=True):
        if not is_in_range:
            raise PoseError(
                f"control point {point.name}: expected a pixel inside the lens's field of view, "
                f"got column {point.col_px:g}, row {point.row_px:g} outside it"
            )


def _report(
    camera: OmnidirectionalCamera,
    points: Sequence[ControlPoint],
    pixels: FloatArray,
    points_enu: FloatArray,
    fit: PoseFit,
) -> PoseSolution:
    errors_px = residuals_px(camera, pixels, points_enu, fit.rotation, fit.position)
    errors_m = _ground_errors_m(camera, pixels, points_enu, fit)
    residuals = tuple(
        PointResidual(p.name, *(float(v) for v in (*px, *m)))
        for p, px, m in zip(points, errors_px, errors_m, strict=True)
    )
    rms_px = float(np.sqrt(np.mean(np.sum(errors_px**2, axis=1))))
    height_m = float(fit.position[2] - points_enu[:, 2].mean())
    # Index 5 is up: the covariance is over rotation (3) then position (3).
    height_sigma_m = float(np.sqrt(fit.covariance[5, 5]))
    _refuse_bad_fit(camera, residuals, rms_px, height_m, fit.covariance)
    tilt_deg, tilt_sigma_deg = _tilt(fit)
    return PoseSolution(
        CameraPose(fit.rotation, fit.position, fit.covariance),
        rms_px,
        residuals,
        height_m,
        height_sigma_m,
        tilt_deg,
        tilt_sigma_deg,
    )


def _ground_errors_m(
    camera: OmnidirectionalCamera, pixels: FloatArray, points_enu: FloatArray, fit: PoseFit
) -> FloatArray:
    """Return (N, 2) east, north: where each pixel's ray meets the point's height, minus the point.

    NaN for a ray that does not point down.
    """
    rays = camera.unproject(pixels) @ fit.rotation.T
    drop = np.where(rays[:, 2] < 0.0, rays[:, 2], np.nan)
    length = (points_enu[:, 2] - fit.position[2]) / drop
    hits = fit.position[:2] + rays[:, :2] * length[:, np.newaxis]
    errors: FloatArray = hits - points_enu[:, :2]
    return errors


def _refuse_bad_fit(
    camera: OmnidirectionalCamera,
    residuals: tuple[PointResidual, ...],
    rms_px: float,
    height_m: float,
    covariance: FloatArray,
) -> None:
    if not rms_px <= LARGEST_RMS_SHARE * camera.rows:
        worst = max(residuals, key=lambda r: r.size_px)
        raise PoseError(
            f"expected control points that fit to {LARGEST_RMS_SHARE * camera.rows:.1f} px, got "
            f"{rms_px:.1f} px (worst: {worst.name}, {worst.size_px:.1f} px); points are swapped, "
            "or the camera file is of another lens"
        )
    position_sigma_m = float(np.sqrt(np.trace(covariance[3:, 3:])))
    if height_m <= 0.0 or position_sigma_m > LARGEST_POSITION_SIGMA_SHARE * height_m:
        raise PoseError(
            f"expected control points that fix the camera above the ground, got a height of "
            f"{height_m:.1f} m with the position uncertain by {position_sigma_m:.1f} m; mark "
            "points that are spread out further"
        )


def _tilt(fit: PoseFit) -> tuple[float, float]:
    """Return the optical axis's angle from straight down and its sigma, in degrees."""
    axis = fit.rotation[:, 2]
    across = float(np.hypot(axis[0], axis[1]))
    tilt = float(np.arctan2(across, -axis[2]))
    if across > 0.0:
        gradient = np.array([axis[1], -axis[0]]) / across
        # Error propagation: the tilt changes only with rotation about the horizontal axis across
        # it.
        variance = float(gradient @ fit.covariance[:2, :2] @ gradient)
    else:
        variance = float(np.trace(fit.covariance[:2, :2])) / 2.0
    return float(np.rad2deg(tilt)), float(np.rad2deg(np.sqrt(variance)))
