"""Calibration of a lens from chessboard photos, with residuals, coverage and warnings.

1. The centre for which the boards turn about it best, on a grid around the frame's middle.
2. The linear solution for that centre (`linear_start`).
3. Robust least squares over everything (`lens_fit`); then corners that do not fit are excluded, and
   photos of which most corners were, and the rest is fitted by plain least squares.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from recon.camera.calibration.chessboard import Chessboard
from recon.camera.calibration.lens_fit import CENTRE, LensFit, Observations, fit_lens
from recon.camera.calibration.linear_start import POWERS, linear_start, turning_miss
from recon.camera.errors import CalibrationError
from recon.camera.omnidirectional import COMPARED_ANGLES_RAD, OmnidirectionalCamera
from recon.camera.radial_profile import RadialProfile
from recon.model.arrays import FloatArray

FEWEST_PHOTOS = 3
"""Fewest photos that determine the centre and the coefficients."""
CENTRE_REACH_SHARE = 0.06
"""Share of the frame's width from its middle within which the centre is searched."""
OUTLIER_SIGMAS = 6.0
LEAST_OUTLIER_PX = 1.0
LEAST_USED_SHARE = 0.5
"""Share of a photo's corners; a photo with fewer is excluded as a whole."""
LARGEST_RMS_SHARE = 0.004
"""Share of the frame's width, 5 px at 1280: beyond, the corners are of another board or lens."""
INVERSE_DEGREE = 14
"""Highest degree that the toolbox writes."""


@dataclass(frozen=True, slots=True, eq=False)
class BoardPhoto:
    """A photo's name and the pixels (N, 2) of the board's corners in it."""

    name: str
    corners_px: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class PhotoResiduals:
    """How well a photo fits: observed minus predicted (N, 2), and the corners that count (N,)."""

    name: str
    corners_px: FloatArray
    residuals_px: FloatArray
    is_used: npt.NDArray[np.bool_]

    @property
    def rms_px(self) -> float:
        """Root of the mean squared two-dimensional residual; of all corners when none is used."""
        chosen = self.residuals_px[self.is_used] if self.is_used.any() else self.residuals_px
        return float(np.sqrt(np.mean(np.sum(chosen**2, axis=1))))


@dataclass(frozen=True, slots=True, eq=False)
class LensCalibration:
    """A fitted lens, its residuals by photo, and standard deviations of its main numbers."""

    camera: OmnidirectionalCamera
    photos: tuple[PhotoResiduals, ...]
    focal_sigma_share: float
    """Uncertainty as a share of the focal length: the scale of the whole field of view."""
    centre_sigma_px: float

    @property
    def rms_px(self) -> float:
        """Root of the mean squared residual of all corners used."""
        used = [photo.residuals_px[photo.is_used] for photo in self.photos]
        return float(np.sqrt(np.mean(np.sum(np.concatenate(used) ** 2, axis=1))))

    @property
    def corners_used(self) -> FloatArray:
        """(N, 2): the pixels of all corners used."""
        return np.concatenate([photo.corners_px[photo.is_used] for photo in self.photos])


def calibrate_lens(
    board: Chessboard, photos: Sequence[BoardPhoto], rows: int, cols: int
) -> LensCalibration:
    """Return the lens that took `photos`, all of them of rows x cols pixels.

    Raises `CalibrationError` for fewer than three photos and for corners that fit no lens.
    """
    _refuse_few(len(photos))
    points_mm = board.points_mm() - board.points_mm().mean(axis=0)
    radius_px = cols / 2.0
    corners = np.stack([photo.corners_px for photo in photos])
    centre = _centre_start(corners, points_mm, rows, cols)
    depth, poses = linear_start(list(corners - centre), points_mm, radius_px)
    seen = Observations(corners, np.ones(corners.shape[:2], dtype=bool), points_mm)
    start = np.concatenate([depth, centre, np.zeros(2)])
    fit = fit_lens(seen, start, radius_px, poses, is_robust=True)
    residuals_px, lasting = fit.residuals_px.copy(), np.arange(len(photos))
    # Twice: without the worst corners the others are judged more sharply.
    for _ in range(2):
        is_used = _corners_that_fit(residuals_px)
        fits = np.asarray(is_used.any(axis=1))
        _refuse_few(int(fits.sum()))
        poses = [pose for number, pose in zip(lasting, fit.poses, strict=True) if fits[number]]
        lasting = np.flatnonzero(fits)
        seen = Observations(corners[fits], is_used[fits], points_mm)
        fit = fit_lens(seen, fit.parameters, radius_px, poses, is_robust=False)
        residuals_px[fits] = fit.residuals_px
    by_photo = tuple(
        PhotoResiduals(photo.name, photo.corners_px, left, used)
        for photo, left, used in zip(photos, residuals_px, is_used, strict=True)
    )
    return _report(by_photo, fit, rows, cols)


def _refuse_few(count: int) -> None:
    if count < FEWEST_PHOTOS:
        raise CalibrationError(
            f"expected at least {FEWEST_PHOTOS} photos with corners that fit one lens, got "
            f"{count}; take 10 to 30 photos of one flat board, in all parts of the view and at "
            "several tilts"
        )


def _centre_start(corners: FloatArray, points_mm: FloatArray, rows: int, cols: int) -> FloatArray:
    """Return the (col, row) about which the boards turn best, on a grid refined three times."""
    centre = np.array([(cols - 1) / 2.0, (rows - 1) / 2.0])
    reach_px = CENTRE_REACH_SHARE * cols
    for _ in range(3):
        steps = np.linspace(-reach_px, reach_px, 7)
        tried = [centre + np.array([right, down]) for right in steps for down in steps]
        misses = [turning_miss(corners - place, points_mm) for place in tried]
        centre = tried[int(np.argmin(misses))]
        reach_px /= 3.0
    return centre


def _corners_that_fit(residuals_px: FloatArray) -> npt.NDArray[np.bool_]:
    """Return (K, N): corners within a few scatters of the others, in photos that mostly fit."""
    sizes = np.linalg.norm(residuals_px, axis=2)
    # The median of a two-dimensional Gaussian's length is 1.18 standard deviations.
    largest_px = max(OUTLIER_SIGMAS * float(np.median(sizes)) / 1.18, LEAST_OUTLIER_PX)
    is_used: npt.NDArray[np.bool_] = sizes <= largest_px
    is_used[is_used.mean(axis=1) < LEAST_USED_SHARE] = False
    return is_used


def _report(
    residuals: tuple[PhotoResiduals, ...], fit: LensFit, rows: int, cols: int
) -> LensCalibration:
    calibration = LensCalibration(
        camera_of_fit(fit, rows, cols),
        residuals,
        float(fit.sigma[0] / abs(fit.parameters[0])),
        float(np.hypot(*fit.sigma[CENTRE : CENTRE + 2])),
    )
    if not calibration.rms_px <= LARGEST_RMS_SHARE * cols:
        raise CalibrationError(
            f"expected corners that fit a lens to {LARGEST_RMS_SHARE * cols:.1f} px, got "
            f"{calibration.rms_px:.1f} px; are all photos of one lens at one zoom, and is the "
            "board flat?"
        )
    return calibration


def camera_of_fit(fit: LensFit, rows: int, cols: int) -> OmnidirectionalCamera:
    """Return the camera in the file's form; raises `CalibrationError` where it is no lens."""
    direct = [0.0] * (max(POWERS) + 1)
    for power, coefficient in zip(POWERS, fit.parameters, strict=False):
        # The file's third axis points backwards.
        direct[power] = -float(coefficient) * fit.radius_px ** (1 - power)
    centre_col, centre_row, stretch, shear = (float(v) for v in fit.parameters[CENTRE:])
    corner_px = 1.1 * float(np.hypot(cols, rows))
    return OmnidirectionalCamera(
        direct=tuple(direct),
        inverse=inverse_polynomial(RadialProfile.over(tuple(direct), corner_px)),
        centre_row_px=centre_row,
        centre_col_px=centre_col,
        affine_c=1.0 + stretch,
        affine_d=shear,
        affine_e=shear,
        rows=rows,
        cols=cols,
    )


def inverse_polynomial(profile: RadialProfile) -> tuple[float, ...]:
    """Return coefficients, lowest power first: radius (px) by angle from the axis less 90 degrees.

    Fitted over the range of the profile, at most up to where readers compare it.
    """
    largest = min(profile.largest_angle_rad, float(COMPARED_ANGLES_RAD[-1]))
    angles = np.linspace(0.0, largest, 400)
    fitted = np.polynomial.Polynomial.fit(
        angles - np.pi / 2.0, profile.radius_px(angles), INVERSE_DEGREE
    )
    return tuple(float(value) for value in fitted.convert().coef)
