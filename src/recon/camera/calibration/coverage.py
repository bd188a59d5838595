"""How much of the view the corners cover, and what to warn of before a lens is flown."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from recon.camera.calibration.calibrate import LensCalibration
from recon.camera.image_circle import ImageCircle
from recon.model.arrays import FloatArray

CELLS_ACROSS = 18
"""Cells of the frame's width: about one for each corner of a board in the middle distance."""
ENOUGH_PHOTOS = 10
ENOUGH_COVERAGE = 0.6
ENOUGH_REACH = 0.85
"""Share of the radius: beyond the outermost corner the polynomial extrapolates."""
ENOUGH_RMS_SHARE = 1.0 / 1280.0
"""Share of the frame's width: sharp photos of a flat board give half of it or less."""
ENOUGH_FOCAL_SIGMA = 0.003


@dataclass(frozen=True, slots=True, eq=False)
class Coverage:
    """Which parts of the view have corners."""

    is_in_view: npt.NDArray[np.bool_]
    """(R, C) cells whose middle lies in the image circle, or in the frame without one."""
    is_covered: npt.NDArray[np.bool_]
    """(R, C) cells in view with a corner."""
    cell_px: float
    reach_deg: float
    """Angle from the axis of the outermost corner."""
    field_deg: float
    """Angle from the axis at the rim of the image circle, or at the frame's nearest edge."""
    reach_share: float
    """Outermost corner's radius over the rim's."""

    @property
    def share(self) -> float:
        """Share of the view with corners."""
        return float(self.is_covered.sum() / max(int(self.is_in_view.sum()), 1))


def coverage_of(calibration: LensCalibration, circle: ImageCircle | None) -> Coverage:
    """Return the coverage of the image circle; None: of the whole frame."""
    camera = calibration.camera
    cell_px = camera.cols / CELLS_ACROSS
    down = max(1, round(camera.rows / cell_px))
    row, col = np.mgrid[0:down, 0:CELLS_ACROSS]
    middles = (col + 0.5) * cell_px - 0.5, (row + 0.5) * camera.rows / down - 0.5
    is_in_view = np.ones(row.shape, dtype=bool) if circle is None else circle.contains(*middles)
    corners = calibration.corners_used
    at_col = np.clip(((corners[:, 0] + 0.5) / cell_px).astype(int), 0, CELLS_ACROSS - 1)
    at_row = np.clip(((corners[:, 1] + 0.5) * down / camera.rows).astype(int), 0, down - 1)
    is_covered = np.zeros(row.shape, dtype=bool)
    is_covered[at_row, at_col] = True
    centre = np.array([camera.centre_col_px, camera.centre_row_px])
    outermost_px = float(np.linalg.norm(corners - centre, axis=1).max())
    rim_px = (
        _nearest_edge_px(centre, camera.rows, camera.cols) if circle is None else circle.radius_px
    )
    profile = camera.profile
    angles = profile.angle_rad(np.minimum([outermost_px, rim_px], profile.largest_radius_px))
    reach_deg, field_deg = (float(angle) for angle in np.rad2deg(angles))
    return Coverage(
        is_in_view, is_covered & is_in_view, cell_px, reach_deg, field_deg, outermost_px / rim_px
    )


def _nearest_edge_px(centre: FloatArray, rows: int, cols: int) -> float:
    col, row = centre
    return float(min(col, row, cols - 1 - col, rows - 1 - row))


def warnings_of(calibration: LensCalibration, coverage: Coverage) -> list[str]:
    """Return one sentence for each reason not to trust the lens yet, with what to do."""
    used = sum(photo.is_used.any() for photo in calibration.photos)
    limit_px = ENOUGH_RMS_SHARE * calibration.camera.cols
    found = []
    if used < ENOUGH_PHOTOS:
        found.append(f"few photos: expected {ENOUGH_PHOTOS} or more that fit, got {used}")
    if coverage.share < ENOUGH_COVERAGE:
        found.append(
            f"poor coverage: expected corners in {ENOUGH_COVERAGE:.0%} of the view, got "
            f"{coverage.share:.0%}; hold the board in the empty parts of the picture"
        )
    if coverage.reach_share < ENOUGH_REACH:
        found.append(
            f"the rim is extrapolated: expected corners out to {ENOUGH_REACH:.0%} of the view's "
            f"radius, got {coverage.reach_share:.0%} ({coverage.reach_deg:.0f} of "
            f"{coverage.field_deg:.0f} degrees); hold the board nearer to the rim"
        )
    if calibration.focal_sigma_share > ENOUGH_FOCAL_SIGMA:
        found.append(
            f"the focal length is uncertain by {calibration.focal_sigma_share:.1%}, expected "
            f"{ENOUGH_FOCAL_SIGMA:.1%} or less; add photos with the board tilted by 20 to 40 "
            "degrees"
        )
    if calibration.rms_px > limit_px:
        found.append(
            f"large residuals: expected {limit_px:.1f} px or less, got "
            f"{calibration.rms_px:.1f} px; use sharp photos of a board that is flat"
        )
    return found
