"""Where the lens's rays meet the ground, level or rolling."""

from dataclasses import dataclass

import numpy as np

from recon.model.imagery import CameraPose
from recon.sim.camera.lens import Lens
from recon.sim.land.noise import FloatImage
from recon.sim.world.relief import Relief

STEEPEST_TANGENT = 60.0
"""Rays flatter than 1 in 60 meet no ground: there is haze only."""
LEAST_HEIGHT_M = 0.1
"""A camera on the ground looks from here."""
RELIEF_STEPS = 4
"""Of the iteration from the level plane to the ground: slopes are gentle, so few are enough."""
RELIEF_TANGENT = 8.0
"""Flatter rays meet the ground as if it were level: hills hide each other there."""


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """What the lattice's rays meet, (r, c) each."""

    east_m: FloatImage
    north_m: FloatImage
    distance_m: FloatImage
    """Along the ray; infinite where there is no ground."""
    footprint_m: FloatImage
    """Length on the ground of one pixel's step, along the steeper direction."""
    rays: FloatImage
    """Unit vectors (r, c, 3), east, north, up."""

    @property
    def sees_ground(self) -> FloatImage:
        """1 where there is ground, 0 above the horizon."""
        return np.isfinite(self.distance_m).astype(np.float32)


def look(lens: Lens, pose: CameraPose, relief: Relief | None) -> Look:
    """Return where the lens's lattice looks from a pose."""
    rays = lens.rays @ pose.rotation_enu_camera.T.astype(np.float32)
    across = np.hypot(rays[:, :, 0], rays[:, :, 1])
    tangent = np.where(rays[:, :, 2] < -1e-6, across / np.maximum(-rays[:, :, 2], 1e-6), np.inf)
    is_ground = tangent < STEEPEST_TANGENT
    tangent = np.minimum(tangent, STEEPEST_TANGENT).astype(np.float32)
    towards = (rays[:, :, :2] / np.maximum(across, 1e-9)[:, :, np.newaxis]).astype(np.float32)
    height_m = _heights_m(pose, tangent, towards, relief)
    level_m = height_m * tangent
    east, north = _places(pose, level_m, towards)
    distance_m = np.where(is_ground, height_m * np.hypot(1.0, tangent), np.inf)
    return Look(
        east,
        north,
        distance_m.astype(np.float32),
        (height_m * (1.0 + tangent**2) * lens.radians_per_px).astype(np.float32),
        rays,
    )


def _places(
    pose: CameraPose, level_m: FloatImage, towards: FloatImage
) -> tuple[FloatImage, FloatImage]:
    east = pose.position_enu_m[0] + towards[:, :, 0] * level_m
    north = pose.position_enu_m[1] + towards[:, :, 1] * level_m
    return east.astype(np.float32), north.astype(np.float32)


def _heights_m(
    pose: CameraPose, tangent: FloatImage, towards: FloatImage, relief: Relief | None
) -> FloatImage:
    """Return how high the camera is above the ground that each ray meets."""
    above_m = np.full_like(tangent, max(float(pose.position_enu_m[2]), LEAST_HEIGHT_M))
    if relief is None:
        return above_m
    height_m = above_m
    for _ in range(RELIEF_STEPS):
        ground_m = relief.height_m(*_places(pose, height_m * tangent, towards))
        height_m = np.maximum(above_m - ground_m, LEAST_HEIGHT_M).astype(np.float32)
    return np.where(tangent < RELIEF_TANGENT, height_m, above_m).astype(np.float32)
