"""Scaramuzza's omnidirectional polynomial camera ("A Toolbox for Easily Calibrating
Omnidirectional Cameras", IROS 2006), vectorised.

Axes of rays here: x right (along the image's columns), y down (along its rows), z forward along the
optical axis. Pixels are (col, row) with the origin at the centre of the upper-left pixel.

The calibration file differs: its first image axis is the row, its second the column, and its third
axis points backwards (f is negative at the centre). So file x = our y, file y = our x,
file z = -our z, and with u' = (row, col) - centre and A = [[c, d], [e, 1]]:

    A^-1 u' = r (cos, sin),    ray = (r cos, r sin, f(r)) in the file's axes.
"""

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from recon.camera.errors import CalibrationError, FrameSizeError
from recon.camera.radial_profile import RadialProfile
from recon.model.arrays import FloatArray

INVERSE_MISMATCH_SHARE = 0.005
"""Allowed difference of the two polynomials, as a share of the image's width."""

COMPARED_ANGLES_RAD = np.deg2rad(np.linspace(0.0, 85.0, 86))

NEAR_AXIS_RAD = 0.3


@dataclass(frozen=True, slots=True)
class OmnidirectionalCamera:
    """A lens and the size of the images it was calibrated at.

    `direct` and `inverse` are the file's polynomials, lowest power first. The inverse one is an
    approximation: it must agree with the direct one and is kept for writing the file, but only the
    direct one is used. Raises `CalibrationError` for invalid numbers.
    """

    direct: tuple[float, ...]
    inverse: tuple[float, ...]
    centre_row_px: float
    centre_col_px: float
    affine_c: float
    affine_d: float
    affine_e: float
    rows: int
    cols: int
    profile: RadialProfile = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        _refuse_bad_geometry(self)
        # The profile must reach the farthest corner of the frame, edges of pixels included.
        corner = max(
            float(np.hypot(*self._sensor_offsets(np.array([[col, row]]))).max())
            for col in (-0.5, self.cols - 0.5)
            for row in (-0.5, self.rows - 0.5)
        )
        object.__setattr__(self, "profile", RadialProfile.over(self.direct, corner))
        _refuse_foreign_inverse(self)

    @property
    def largest_angle_rad(self) -> float:
        """Largest angle from the axis, in radians, at which rays are projected."""
        return self.profile.largest_angle_rad

    @property
    def pixels_per_radian(self) -> float:
        """Pixels per radian near the axis; a fisheye's hardly change over most of its field."""
        return float(self.profile.radius_px(np.array([NEAR_AXIS_RAD]))[0]) / NEAR_AXIS_RAD

    def project(self, rays: npt.ArrayLike) -> FloatArray:
        """Return pixels (N, 2) as (col, row) of rays (N, 3) of any length.

        Rays beyond `largest_angle_rad`, of length zero or not finite give NaN. A pixel may still
        lie outside the frame: see `is_in_frame`.
        """
        directions = np.atleast_2d(np.asarray(rays, dtype=np.float64))
        is_seen = np.isfinite(directions).all(axis=1) & (directions != 0.0).any(axis=1)
        directions = np.where(is_seen[:, np.newaxis], directions, (0.0, 0.0, 1.0))
        pixels = self.project_beyond_range(directions)
        angle = np.arctan2(np.hypot(directions[:, 0], directions[:, 1]), directions[:, 2])
        # A tolerance of rounding, so that the outermost valid ray is kept.
        is_seen &= angle <= self.largest_angle_rad + 1e-12
        pixels[~is_seen] = np.nan
        return pixels

    def project_beyond_range(self, rays: FloatArray, *, fast: bool = False) -> FloatArray:
        """Return pixels (..., 2) of rays (..., 3), continued smoothly beyond the valid range.

        For optimisers and interpolation, which need values on both sides of the edge. `fast` takes
        the radius from a table, accurate to 0.01 px.
        """
        right, down, forward = rays[..., 0], rays[..., 1], rays[..., 2]
        across = np.hypot(right, down)
        angle = np.arctan2(across, forward)
        radius = self.profile.table_radius_px(angle) if fast else self.profile.radius_px(angle)
        # On the axis the direction is undefined and the radius is 0: any divisor will do.
        divisor = np.where(across > 0.0, across, 1.0)
        sensor_row, sensor_col = radius * (down / divisor), radius * (right / divisor)
        pixels = np.empty((*across.shape, 2))
        pixels[..., 0] = self.affine_e * sensor_row + sensor_col + self.centre_col_px
        pixels[..., 1] = self.affine_c * sensor_row + self.affine_d * sensor_col
        pixels[..., 1] += self.centre_row_px
        return pixels

    def unproject(self, pixels: npt.ArrayLike) -> FloatArray:
        """Return unit rays (N, 3) of pixels (N, 2) as (col, row); NaN outside the valid range."""
        points = np.atleast_2d(np.asarray(pixels, dtype=np.float64))
        sensor_row, sensor_col = self._sensor_offsets(points)
        radius = np.hypot(sensor_row, sensor_col)
        is_valid = self.is_in_range(points)
        rays = np.stack(
            [sensor_col, sensor_row, self.profile.depth_px(np.where(is_valid, radius, 0.0))], axis=1
        )
        rays[~is_valid] = np.nan
        unit_rays: FloatArray = rays / np.linalg.norm(rays, axis=1, keepdims=True)
        return unit_rays

    def is_in_frame(self, pixels: FloatArray) -> npt.NDArray[np.bool_]:
        """Return (N,) whether pixels (N, 2) lie within the frame; False for NaN."""
        col, row = pixels[:, 0], pixels[:, 1]
        is_inside: npt.NDArray[np.bool_] = (
            (col >= -0.5) & (col <= self.cols - 0.5) & (row >= -0.5) & (row <= self.rows - 0.5)
        )
        return is_inside

    def is_in_range(self, pixels: FloatArray) -> npt.NDArray[np.bool_]:
        """Return (...) whether pixels (..., 2) have a ray, inside the frame or not."""
        radius = np.hypot(*self._sensor_offsets(pixels))
        is_near: npt.NDArray[np.bool_] = radius <= self.profile.largest_radius_px * (1.0 + 1e-12)
        return is_near

    def scaled_to(self, rows: int, cols: int) -> "OmnidirectionalCamera":
        """Return the same lens for frames of another size: pixel u becomes (u + 0.5) s - 0.5.

        Raises `FrameSizeError` for another aspect ratio: such a frame was cropped or stretched in
        an unknown way.
        """
        if (rows, cols) == (self.rows, self.cols):
            return self
        return _scaled(self, rows, cols)

    def _sensor_offsets(self, pixels: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return offsets along rows and columns, with centre and affine part undone."""
        col = pixels[..., 0] - self.centre_col_px
        row = pixels[..., 1] - self.centre_row_px
        determinant = self.affine_c - self.affine_d * self.affine_e
        return (
            (row - self.affine_d * col) / determinant,
            (self.affine_c * col - self.affine_e * row) / determinant,
        )


@lru_cache(maxsize=16)
def _scaled(camera: OmnidirectionalCamera, rows: int, cols: int) -> OmnidirectionalCamera:
    scale = scale_between((camera.cols, camera.rows), (cols, rows))
    return OmnidirectionalCamera(
        # f(r) has the unit of r: coefficient k scales with scale^(1 - k).
        direct=tuple(a * scale ** (1 - power) for power, a in enumerate(camera.direct)),
        inverse=tuple(a * scale for a in camera.inverse),
        centre_row_px=(camera.centre_row_px + 0.5) * scale - 0.5,
        centre_col_px=(camera.centre_col_px + 0.5) * scale - 0.5,
        affine_c=camera.affine_c,
        affine_d=camera.affine_d,
        affine_e=camera.affine_e,
        rows=rows,
        cols=cols,
    )


def scale_between(from_size_px: tuple[int, int], to_size_px: tuple[int, int]) -> float:
    """Return the factor from one (cols, rows) to another; `FrameSizeError` if not possible."""
    from_cols, from_rows = from_size_px
    to_cols, to_rows = to_size_px
    is_positive = min(from_cols, from_rows, to_cols, to_rows) > 0
    if not is_positive or to_cols * from_rows != to_rows * from_cols:
        raise FrameSizeError(
            f"expected a frame of {from_cols} x {from_rows} pixels or a multiple with the same "
            f"aspect ratio, got {to_cols} x {to_rows}; send frames that are neither cropped nor "
            "stretched, or use the calibration made for this size"
        )
    return to_cols / from_cols


def _refuse_bad_geometry(camera: OmnidirectionalCamera) -> None:
    numbers = (
        *camera.direct,
        *camera.inverse,
        camera.centre_row_px,
        camera.centre_col_px,
        camera.affine_c,
        camera.affine_d,
        camera.affine_e,
    )
    if not np.isfinite(numbers).all():
        raise CalibrationError("camera: expected finite numbers only, got NaN or infinity")
    if camera.rows < 2 or camera.cols < 2:
        raise CalibrationError(
            f"image size: expected at least 2 x 2, got {camera.cols} x {camera.rows}"
        )
    if not (-0.5 <= camera.centre_row_px <= camera.rows - 0.5) or not (
        -0.5 <= camera.centre_col_px <= camera.cols - 0.5
    ):
        raise CalibrationError(
            f"centre: expected a point inside {camera.cols} x {camera.rows}, got row "
            f"{camera.centre_row_px}, column {camera.centre_col_px}; the file gives the row first"
        )
    determinant = camera.affine_c - camera.affine_d * camera.affine_e
    if not 0.5 <= determinant <= 2.0 or max(abs(camera.affine_d), abs(camera.affine_e)) > 0.5:
        raise CalibrationError(
            "affine: expected c near 1 and d, e near 0, got "
            f"c = {camera.affine_c}, d = {camera.affine_d}, e = {camera.affine_e}"
        )


def _refuse_foreign_inverse(camera: OmnidirectionalCamera) -> None:
    """Raise `CalibrationError` when the polynomials are of different lenses: a mistyped file."""
    is_covered = camera.largest_angle_rad >= COMPARED_ANGLES_RAD
    angles = COMPARED_ANGLES_RAD[is_covered]
    with np.errstate(over="ignore", invalid="ignore"):
        from_inverse = np.polynomial.polynomial.polyval(angles - np.pi / 2.0, camera.inverse)
    misses = np.abs(from_inverse - camera.profile.radius_px(angles))
    worst = int(np.argmax(misses))
    if not misses[worst] <= INVERSE_MISMATCH_SHARE * camera.cols:
        raise CalibrationError(
            "inverse polynomial: expected radii that agree with the direct polynomial to "
            f"{INVERSE_MISMATCH_SHARE * camera.cols:.1f} px, got {misses[worst]:.1f} px apart at "
            f"{np.rad2deg(angles[worst]):.0f} degrees from the axis; one of the two is wrong"
        )
