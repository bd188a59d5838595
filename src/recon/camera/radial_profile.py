"""Radius in the image as a function of a ray's angle from the optical axis, and its inverse.

Scaramuzza's direct polynomial gives, for a point at radius r (pixels) from the centre, the ray
(r, depth(r)) with depth(r) = -f(r): the angle from the optical axis is atan2(r, depth(r)). The
inverse takes a start from a dense table and refines it by Newton's method, so project and unproject
are inverses of each other to rounding.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from recon.camera.errors import CalibrationError
from recon.model.arrays import FloatArray

TABLE_ROWS = 4096
"""Radii in the table: linear interpolation alone is accurate to about 0.0001 px."""

NEWTON_STEPS = 2
"""Newton steps: each squares the error of the table; two reach rounding."""

LEAST_SLOPE_SHARE = 0.2
"""Share of the angle per pixel at the centre. With less, the polynomial is about to fold back: no
lens does, and near the fold a radius does not determine the angle."""

LARGEST_ANGLE_RAD = float(np.deg2rad(100.0))
"""No supported lens sees farther from its axis; beyond it a polynomial extrapolates."""


@dataclass(frozen=True, slots=True, eq=False)
class RadialProfile:
    """Radius <-> angle of a lens, strictly increasing over [0, `largest_radius_px`]."""

    polynomial: tuple[float, ...]
    """Direct polynomial, lowest power first: f(r) = a0 + a1 r + a2 r^2 + ..."""
    largest_radius_px: float
    largest_angle_rad: float
    _radii_px: FloatArray
    _angles_rad: FloatArray

    @classmethod
    def over(cls, polynomial: tuple[float, ...], corner_radius_px: float) -> Self:
        """Return the profile up to the image's corner, or as far as the polynomial is valid.

        It ends where the angle stops growing or passes 100 degrees. Raises `CalibrationError` when
        the polynomial is invalid from the centre on.
        """
        if not polynomial or not np.isfinite(polynomial).all() or polynomial[0] >= 0.0:
            raise CalibrationError(
                "direct polynomial: expected finite coefficients with a negative first one "
                f"(the lens's focal length in pixels, negated), got {polynomial}"
            )
        radii = np.linspace(0.0, corner_radius_px, TABLE_ROWS)
        with np.errstate(over="ignore", invalid="ignore"):
            angles = np.arctan2(radii, -np.polynomial.polynomial.polyval(radii, polynomial))
        # Valid as long as the angle grows with the radius, and not much slower than at the centre.
        steps = np.diff(angles)
        is_sound = np.append(True, steps > LEAST_SLOPE_SHARE * max(steps[0], 0.0))
        is_sound &= angles <= LARGEST_ANGLE_RAD
        count = TABLE_ROWS if is_sound.all() else int(np.argmin(is_sound))
        if count < TABLE_ROWS // 20:
            raise CalibrationError(
                "direct polynomial: expected rays that lean further out with growing radius, but "
                f"beyond {radii[max(count - 1, 0)]:.1f} px they do not; check the coefficients"
            )
        radii, angles = radii[:count].copy(), angles[:count].copy()
        return cls(polynomial, float(radii[-1]), float(angles[-1]), radii, angles)

    def depth_px(self, radius_px: FloatArray) -> FloatArray:
        """Return the forward component of the ray whose outward component is `radius_px`."""
        depth: FloatArray = np.zeros_like(radius_px)
        for coefficient in reversed(self.polynomial):
            depth = depth * radius_px - coefficient
        return depth

    def angle_rad(self, radius_px: FloatArray) -> FloatArray:
        """Return the angle from the axis at these radii (not checked against the range)."""
        return np.arctan2(radius_px, self.depth_px(radius_px))

    def radius_px(self, angle_rad: FloatArray) -> FloatArray:
        """Return the radius at these angles; beyond the range it continues as a straight line.

        The continuation lets optimisers and interpolation work across the edge; callers mask it by
        `largest_angle_rad`.
        """
        inside = np.minimum(angle_rad, self.largest_angle_rad)
        radius = np.interp(inside, self._angles_rad, self._radii_px)
        slope = np.polynomial.polynomial.polyder(self.polynomial)
        sine, cosine = np.sin(inside), np.cos(inside)
        for _ in range(NEWTON_STEPS):
            # Newton on g(r) = r cos(a) - depth(r) sin(a), which has no singularity at 90 degrees.
            miss = radius * cosine - self.depth_px(radius) * sine
            rate = cosine + np.polynomial.polynomial.polyval(radius, slope) * sine
            radius = radius - miss / rate
        return radius + (angle_rad - inside) * self._edge_slope()

    def table_radius_px(self, angle_rad: FloatArray) -> FloatArray:
        """Return `radius_px` from the table alone: faster, accurate to 0.01 px."""
        inside = np.minimum(angle_rad, self.largest_angle_rad)
        radius = np.interp(inside, self._angles_rad, self._radii_px)
        return radius + (angle_rad - inside) * self._edge_slope()

    def steepest_px_per_rad(self) -> float:
        """Return the largest number of pixels that one radian covers."""
        return float((np.diff(self._radii_px) / np.diff(self._angles_rad)).max())

    def _edge_slope(self) -> float:
        """Return pixels per radian at the outer end."""
        rise = self._radii_px[-1] - self._radii_px[-2]
        return float(rise / (self._angles_rad[-1] - self._angles_rad[-2]))
