"""A picture of a calibration: corners, residuals and coverage over the frame, and by angle."""

import cv2
import numpy as np

from recon.camera.calibration.calibrate import LensCalibration, PhotoResiduals
from recon.camera.calibration.coverage import Coverage
from recon.camera.image_circle import ImageCircle
from recon.model.imagery import RgbImage

Color = tuple[int, int, int]

WIDTH_PX = 1280
PLOT_PX = 300
MARGIN_PX = 60
PAPER: Color = (255, 255, 255)
INK: Color = (40, 40, 40)
GRID: Color = (205, 205, 205)
EMPTY: Color = (255, 226, 214)
"""Cells of the view without a corner."""
COVERED: Color = (222, 240, 222)
EXCLUDED: Color = (200, 30, 30)
LINES: tuple[Color, ...] = (
    *((31, 119, 180), (255, 127, 14), (44, 160, 44), (148, 103, 189)),
    *((140, 86, 75), (227, 119, 194), (90, 90, 90), (23, 170, 190)),
)
"""One after the other by photo."""
ARROW_SHARE = 0.03
"""Share of the width: arrow length of a corner with three times the overall residual."""


def residual_picture(
    calibration: LensCalibration, coverage: Coverage, circle: ImageCircle | None
) -> RgbImage:
    """Return (rows, 1280, 3): above, the frame; below, residuals by angle from the axis.

    An arrow leads from a corner's predicted pixel to the observed one, lengthened; red ones were
    excluded. Tinted cells have no corner.
    """
    scale = WIDTH_PX / calibration.camera.cols
    rows = max(1, round(calibration.camera.rows * scale))
    picture = np.full((rows + PLOT_PX, WIDTH_PX, 3), 255, dtype=np.uint8)
    _draw_cells(picture[:rows], coverage)
    if circle is not None:
        _draw_circle(picture[:rows], circle.scaled(scale))
    longer = ARROW_SHARE * WIDTH_PX / (3.0 * max(calibration.rms_px, 1e-9))
    for number, photo in enumerate(calibration.photos):
        _draw_arrows(picture[:rows], photo, scale, longer, LINES[number % len(LINES)])
    text = (
        f"rms {calibration.rms_px:.2f} px, {coverage.share:.0%} of the view covered; arrows: "
        f"residuals {longer / scale:.0f} times as long, red: excluded"
    )
    _write(picture, text, (10, 24))
    _draw_plot(picture[rows:], calibration, coverage)
    return picture


def _draw_cells(picture: RgbImage, coverage: Coverage) -> None:
    rows, cols = coverage.is_in_view.shape
    edges_down = np.linspace(0, picture.shape[0], rows + 1).astype(int)
    edges_across = np.linspace(0, picture.shape[1], cols + 1).astype(int)
    for row in range(rows):
        for col in range(cols):
            cell = picture[
                edges_down[row] : edges_down[row + 1], edges_across[col] : edges_across[col + 1]
            ]
            if coverage.is_in_view[row, col]:
                cell[1:, 1:] = COVERED if coverage.is_covered[row, col] else EMPTY


def _draw_circle(picture: RgbImage, circle: ImageCircle) -> None:
    middle = round(circle.centre_col_px), round(circle.centre_row_px)
    cv2.circle(picture, middle, round(circle.radius_px), INK, 1, cv2.LINE_AA)


def _draw_arrows(
    picture: RgbImage, photo: PhotoResiduals, scale: float, longer: float, color: Color
) -> None:
    observed = (photo.corners_px + 0.5) * scale - 0.5
    shifts = np.clip(photo.residuals_px * longer, -WIDTH_PX, WIDTH_PX)
    for pixel, shift, is_used in zip(observed, shifts, photo.is_used, strict=True):
        chosen = color if is_used else EXCLUDED
        start = round(pixel[0]), round(pixel[1])
        end = round(pixel[0] + shift[0]), round(pixel[1] + shift[1])
        cv2.circle(picture, start, 2, chosen, -1, cv2.LINE_AA)
        cv2.line(picture, start, end, chosen, 1, cv2.LINE_AA)


def _draw_plot(picture: RgbImage, calibration: LensCalibration, coverage: Coverage) -> None:
    """Residuals along the radius by angle: a wave would show that the polynomial does not fit."""
    rows, cols = picture.shape[:2]
    camera = calibration.camera
    centre = np.array([camera.centre_col_px, camera.centre_row_px])
    largest_deg: float = max(coverage.field_deg, coverage.reach_deg, 1.0)
    largest_px: float = max(4.0 * calibration.rms_px, 1e-6)
    left, right, top, bottom = MARGIN_PX, cols - 20, 36, rows - 40
    middle = (top + bottom) / 2.0

    def across(angle_deg: float) -> int:
        return int(left + (right - left) * float(angle_deg) / largest_deg)

    def down(residual_px: float) -> int:
        shown = float(np.clip(residual_px / largest_px, -1.0, 1.0))
        return int(middle - shown * (bottom - top) / 2.0)

    for angle_deg in range(0, int(largest_deg) + 1, 10):
        cv2.line(picture, (across(angle_deg), top), (across(angle_deg), bottom), GRID, 1)
        _write(picture, f"{angle_deg}", (across(angle_deg) - 8, bottom + 18))
    for residual_px in (-largest_px, 0.0, largest_px):
        cv2.line(picture, (left, down(residual_px)), (right, down(residual_px)), GRID, 1)
        _write(picture, f"{residual_px:+.1f}", (8, down(residual_px) + 5))
    for number, photo in enumerate(calibration.photos):
        offsets = photo.corners_px - centre
        radii = np.linalg.norm(offsets, axis=1)
        outward = np.sum(photo.residuals_px * offsets, axis=1) / np.maximum(radii, 1e-9)
        within = np.minimum(radii, camera.profile.largest_radius_px)
        angles = np.rad2deg(camera.profile.angle_rad(within))
        for angle, residual, is_used in zip(angles, outward, photo.is_used, strict=True):
            color = LINES[number % len(LINES)] if is_used else EXCLUDED
            cv2.circle(picture, (across(angle), down(residual)), 2, color, -1, cv2.LINE_AA)
    _write(picture, "residual outward (px) by angle from the axis (degrees)", (left, 20))


def _write(picture: RgbImage, text: str, at: tuple[int, int]) -> None:
    cv2.putText(picture, text, at, cv2.FONT_HERSHEY_SIMPLEX, 0.5, INK, 1, cv2.LINE_AA)
