"""Shadows of trees and roofs, drawn into pixels by the sun's position."""

from math import cos, radians, sin, tan

import cv2
import numpy as np
import numpy.typing as npt

from recon.sim.land.farmland import Building, Farmland, FloatArray, Tree
from recon.sim.land.land_index import index_of
from recon.sim.land.land_part import (
    FRACTION_BITS,
    MARGIN_PX,
    Part,
    fixed_point,
    is_near,
    seen_trees,
    slices,
)
from recon.sim.world import SunPosition

LOWEST_SHADOW_SUN_DEG = 12.0
"""Shadows of trees are drawn as if the sun stood here at least: lower, they cover all."""
CROWN_SHADES_ITSELF = 70
"""Of 255: leaves shade leaves."""


def draw_shadows(land: Farmland, part: Part, sun: SunPosition) -> npt.NDArray[np.uint8]:
    """Return how much of the sun's beam trees and roofs keep off the ground, (size, size), /255."""
    index, wide = index_of(land), part.with_margin()
    image = np.zeros((wide.size, wide.size), dtype=np.uint8)
    elevation = radians(max(sun.elevation_deg, LOWEST_SHADOW_SUN_DEG))
    azimuth = radians(sun.azimuth_deg)
    per_height = np.array([-sin(azimuth), -cos(azimuth)]) / tan(elevation)
    buildings, trees = index.buildings.within(wide.box_m), seen_trees(index, wide)
    for building in buildings:
        _shade_of_roof(image, wide, building, per_height)
    for tree in trees:
        _shade_of_tree(image, wide, tree, per_height)
    # What is seen of a roof or a crown from above is its lit top.
    for building in buildings:
        rows, cols = slices(wide, building.box_m)
        image[rows, cols] = 0
    for tree in trees:
        _light_on_crown(image, wide, tree)
    soft = cv2.GaussianBlur(image, (0, 0), 0.9)
    return soft[MARGIN_PX:-MARGIN_PX, MARGIN_PX:-MARGIN_PX].astype(np.uint8, copy=True)


def _shade_of_roof(
    image: npt.NDArray[np.uint8], part: Part, building: Building, per_height: FloatArray
) -> None:
    at = building
    base = np.array([(e, n) for e in (at.west_m, at.east_m) for n in (at.south_m, at.north_m)])
    ends = np.concatenate([base, base + at.height_m * per_height]).astype(np.float32)
    hull = cv2.convexHull(ends).reshape(-1, 2).astype(np.float64)
    corners = fixed_point(part, hull)
    if is_near(corners, part):
        cv2.fillConvexPoly(image, corners, 255, cv2.LINE_AA, FRACTION_BITS)


def _shade_of_tree(
    image: npt.NDArray[np.uint8], part: Part, tree: Tree, per_height: FloatArray
) -> None:
    """Draw a crown's shadow: a disc from the crown's foot to its top."""
    foot = np.array([tree.east_m, tree.north_m])
    shifts = np.outer([0.3, 0.7], tree.height_m * per_height)
    points = fixed_point(part, foot + shifts)
    width = max(1, round(1.7 * tree.radius_m / part.cell_m))
    if is_near(points, part, width):
        ends = [tuple(point) for point in points.tolist()]
        cv2.line(image, ends[0], ends[1], 255, width, cv2.LINE_AA, FRACTION_BITS)


def _light_on_crown(image: npt.NDArray[np.uint8], part: Part, tree: Tree) -> None:
    points = fixed_point(part, np.array([(tree.east_m, tree.north_m)]))
    radius = max(1, round(tree.radius_m / part.cell_m * 2**FRACTION_BITS))
    if is_near(points, part, 2 + radius // 2**FRACTION_BITS):
        at = (int(points[0, 0]), int(points[0, 1]))
        cv2.circle(image, at, radius, CROWN_SHADES_ITSELF, -1, cv2.LINE_AA, FRACTION_BITS)
