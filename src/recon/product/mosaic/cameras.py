"""Cameras of photos: where each is, how it looks, and on which pixel it shows a place.

Pixels count from the middle of the upper left one, as in `footprint`. Distortion is Brown's, as
OpenSfM and OpenCV have it: radial k1, k2, k3 and tangential p1, p2, of rays before the focal length
applies.
"""

from dataclasses import dataclass, field
from math import radians, tan

import cv2
import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.model.arrays import BoolArray, FloatArray
from recon.product.footprint import PhotoView

EDGE_POINTS = 16
"""Points along each edge of a picture, for the outline of the ground it shows."""
LARGEST_SLOPE = 2.0
"""Rays are used as far from the axis as this tangent, 63 degrees: beyond, ground is far off."""


@dataclass(frozen=True, slots=True)
class PhotoLens:
    """A lens in pixels; without distortion if not stated."""

    focal_px: tuple[float, float]
    centre_px: tuple[float, float]
    """Column and row of the axis."""
    radial: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tangential: tuple[float, float] = (0.0, 0.0)
    reach: float = field(init=False)
    """Tangent up to which distortion moves farther rays farther out; beyond, it folds back."""

    def __post_init__(self) -> None:
        slopes = np.linspace(0.0, LARGEST_SLOPE, 401)
        k1, k2, k3 = self.radial
        squared = slopes**2
        moved = slopes * (1.0 + squared * (k1 + squared * (k2 + squared * k3)))
        folds = np.flatnonzero(np.diff(moved) <= 0.0)
        object.__setattr__(self, "reach", float(slopes[folds[0]] if len(folds) else slopes[-1]))

    @property
    def has_distortion(self) -> bool:
        """Whether any coefficient is not zero."""
        return any((*self.radial, *self.tangential))

    def pixels(self, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return columns and rows of rays (x, y, 1), right and down; NaN beyond the reach."""
        squared = x * x + y * y
        with np.errstate(invalid="ignore"):
            within = squared <= self.reach**2
        if self.has_distortion:
            (k1, k2, k3), (p1, p2) = self.radial, self.tangential
            stretch = 1.0 + squared * (k1 + squared * (k2 + squared * k3))
            both = 2.0 * x * y
            x, y = (
                x * stretch + p1 * both + p2 * (squared + 2.0 * x * x),
                y * stretch + p2 * both + p1 * (squared + 2.0 * y * y),
            )
        cols = np.where(within, self.focal_px[0] * x + self.centre_px[0], np.nan)
        rows = np.where(within, self.focal_px[1] * y + self.centre_px[1], np.nan)
        return cols, rows

    def rays(self, pixels: FloatArray) -> FloatArray:
        """Return rays (N, 2), right and down over forward, of pixels (N, 2)."""
        found = (pixels - self.centre_px) / self.focal_px
        if not self.has_distortion:
            return np.asarray(found)
        coefficients = np.array([*self.radial[:2], *self.tangential, self.radial[2]])
        back = cv2.undistortPoints(found[:, np.newaxis], np.eye(3), coefficients)
        return back[:, 0].astype(np.float64)


@dataclass(frozen=True, slots=True, eq=False)
class Camera:
    """A photo's camera in the site's frame: east, north, up of its origin in metres."""

    place_m: FloatArray
    """(3,)"""
    rotation: FloatArray
    """(3, 3): from the camera's right, down, forward to east, north, up."""
    lens: PhotoLens
    cols: int
    rows: int

    def project(self, ground_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return columns and rows of places (..., 3), beyond the picture too; NaN behind it."""
        right, down, forward = np.moveaxis((ground_m - self.place_m) @ self.rotation, -1, 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = np.where(forward > 0.0, forward, np.nan)
            return self.lens.pixels(right / depth, down / depth)

    def shows(self, ground_m: FloatArray, around_m: float = 0.0) -> BoolArray:
        """Return which places (...) of (..., 3) lie on the picture, with all around them."""
        cols, rows = self.project(ground_m)
        with np.errstate(divide="ignore", invalid="ignore"):
            depth_m = (ground_m - self.place_m) @ self.rotation[:, 2]
            beside = around_m * max(self.lens.focal_px) / depth_m
            is_on = (cols >= beside) & (cols <= self.cols - 1.0 - beside)
            return np.asarray(is_on & (rows >= beside) & (rows <= self.rows - 1.0 - beside))

    def off_nadir_deg(self, ground_m: FloatArray) -> FloatArray:
        """Return the angles (...) between the vertical and the rays to places (..., 3)."""
        off = self.place_m - ground_m
        angles = np.arctan2(np.hypot(off[..., 0], off[..., 1]), off[..., 2])
        return np.asarray(np.rad2deg(angles))

    def footprint(self, lowest_m: float, highest_m: float) -> shapely.Geometry:
        """Return all ground that it may show, where that lies between two heights."""
        steps = np.linspace(0.0, 1.0, EDGE_POINTS, endpoint=False)[:, np.newaxis]
        corners = np.array([[0, 0], [self.cols, 0], [self.cols, self.rows], [0, self.rows]]) - 0.5
        ends = np.roll(corners, -1, axis=0)
        edge = np.concatenate([a + steps * (b - a) for a, b in zip(corners, ends, strict=True)])
        rays = np.column_stack([self.lens.rays(edge), np.ones(len(edge))]) @ self.rotation.T
        # A ray along the horizon or above it ends where the steepest that is used does.
        steepness = np.hypot(rays[:, 0], rays[:, 1]) / LARGEST_SLOPE
        fall = np.maximum(-rays[:, 2], np.maximum(steepness, 1e-9))
        places = [
            self.place_m[:2] + rays[:, :2] * (max(self.place_m[2] - up_m, 0.1) / fall)[:, None]
            for up_m in (lowest_m, highest_m)
        ]
        return shapely.MultiPoint(np.concatenate(places)).convex_hull

    def metres_per_pixel(self, up_m: float) -> float:
        """Return the size of a pixel on level ground of a height, straight below."""
        return float(self.place_m[2] - up_m) / max(self.lens.focal_px)


def camera_of_view(view: PhotoView, up_m: float) -> Camera:
    """Return the camera of a view at a height above the site's origin, without distortion."""
    focal_px = max(view.cols, view.rows) / 2.0 / tan(radians(view.across_deg) / 2.0)
    centre_px = (view.cols - 1) / 2.0, (view.rows - 1) / 2.0
    place_m = np.array([view.aim.east_m, view.aim.north_m, up_m])
    lens = PhotoLens((focal_px, focal_px), centre_px)
    return Camera(place_m, view.aim.rotation, lens, view.cols, view.rows)
