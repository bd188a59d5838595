"""Draws farmland and its shadows into pixels.

A part's pixels depend on the land, the seed and the part only: noise is sampled from periodic tiles
fixed to the ground, and each part is drawn with a margin, so that neighbours fit without seams.
"""

from functools import lru_cache
from math import cos, radians, sin, tan

import cv2
import numpy as np
import numpy.typing as npt

from recon.geo.sun import SunPosition
from recon.model.arrays import FloatArray
from recon.model.imagery import RgbImage
from recon.sim.land.farmland import MEADOW, POND_EDGE_M, Box, Building, Farmland, Plot, Pond, Tree
from recon.sim.land.land_part import (
    FRACTION_BITS,
    MARGIN_PX,
    LandPart,
    fixed_point,
    index_of,
    is_near,
    slices,
    visible_trees,
)
from recon.sim.world.keyframes import FloatImage

GRAVEL = (168.0, 160.0, 145.0)
DIRT = (150.0, 133.0, 106.0)
VERGE = (116.0, 127.0, 80.0)
WATER = (88.0, 101.0, 98.0)
CROWN = (58.0, 76.0, 44.0)

HEADLAND_M = 16.0
TRAMLINE_M = 24.0
PLANT_ROW_M = 0.75
"""Distance between rows of maize or soybeans; visible from low heights only."""
WETTEST_DARKENS = 0.34
"""Loss of pixel value from dry to saturated soil: about half of the light."""
WET_ABOVE, WET_OVER = 0.5, 1.1
"""Start and width of wetness, in standard deviations of a noise field with 400 m structures."""

POND_CORNERS = 40
DARKER_SLOPE = 0.88
"""Brightness of the roof slope that faces away from the noon sun."""
NOISE_CELLS = 512


def draw(land: Farmland, part: LandPart, seed: int) -> RgbImage:
    """Return the land's colours in full sun, without shadows, (size, size, 3)."""
    index = index_of(land)
    canvas = _Canvas(part.with_margin(), seed)
    box = canvas.part.box_m
    canvas.pixels[:] = VERGE
    for plot in index.plots.within(box):
        canvas.draw_plot(plot)
    for track in index.tracks.within(box):
        canvas.fill(track, DIRT)
    # Later objects cover earlier ones: plots, tracks, water, roads, yards, then what is high.
    canvas.draw_creek(land)
    for pond in index.ponds.within(box):
        canvas.draw_pond(pond)
    canvas.draw_roads(land)
    for yard in index.yards.within(box):
        canvas.fill(yard, GRAVEL)
    canvas.add_grain()
    for building in index.buildings.within(box):
        canvas.draw_roof(building)
    canvas.draw_trees(visible_trees(index, canvas.part))
    inner = canvas.pixels[MARGIN_PX:-MARGIN_PX, MARGIN_PX:-MARGIN_PX]
    return np.clip(inner, 0.0, 255.0).astype(np.uint8)


@lru_cache(maxsize=32)
def noise_tile(
    seed: int, smallest_cells: float, slope: float, blur_px: int, size: int = NOISE_CELLS
) -> FloatImage:
    """Return a noise tile (size, size); details finer than a pixel are averaged out."""
    tile = tileable_noise(size, seed, smallest_cells, slope)
    if blur_px <= 1:
        return tile
    wrapped = np.pad(tile, blur_px, mode="wrap")
    blurred = cv2.blur(wrapped, (blur_px, blur_px))[blur_px:-blur_px, blur_px:-blur_px]
    inner: FloatImage = blurred.astype(np.float32, copy=True)
    return inner


class _Canvas:
    def __init__(self, part: LandPart, seed: int) -> None:
        self.part, self.cell_m = part, part.cell_m
        self.pixels: FloatImage = np.empty((part.size, part.size, 3), dtype=np.float32)
        numbers = np.arange(part.size, dtype=np.float64)
        self.east_m = ((numbers + part.col + 0.5) * part.cell_m).astype(np.float32)
        self.north_m = (-(numbers + part.row + 0.5) * part.cell_m).astype(np.float32)
        self._patches = self._noise(seed + 1, tile_m=900.0, smallest_cells=3.0, slope=1.6)
        self._grain = self._noise(seed + 2, tile_m=NOISE_CELLS * 0.8, smallest_cells=1.0, slope=0.7)
        self._wet = self._noise(seed + 3, tile_m=2_600.0, smallest_cells=2.0, slope=1.5)
        if part.cell_m <= 0.5:
            self._grain += 0.8 * self._noise(seed + 4, NOISE_CELLS * 0.25, 1.0, 0.6)

    def _noise(self, seed: int, tile_m: float, smallest_cells: float, slope: float) -> FloatImage:
        """Return noise (size, size), fixed to the ground, at this part's pixels."""
        per_m = NOISE_CELLS / tile_m
        tile = noise_tile(seed, smallest_cells, slope, max(1, round(self.cell_m * per_m)))
        cols, rows = np.meshgrid(
            np.mod(self.east_m * per_m, NOISE_CELLS), np.mod(self.north_m * per_m, NOISE_CELLS)
        )
        sampled = cv2.remap(
            tile,
            cols.astype(np.float32),
            rows.astype(np.float32),
            cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_WRAP,
        )
        return sampled.astype(np.float32, copy=False)

    def fill(self, box: Box, colour: tuple[float, ...]) -> None:
        self.pixels[slices(self.part, box)] = colour

    def draw_plot(self, plot: Plot) -> None:
        rows, cols = slices(self.part, plot.box_m)
        area = self.pixels[rows, cols]
        if area.size == 0:
            return
        area[:] = plot.colour
        light = plot.patchiness * self._patches[rows, cols]
        north, east = self.north_m[rows, np.newaxis], self.east_m[np.newaxis, cols]
        if plot.row_contrast > 0.0:
            light += self._crop_rows(plot, east, north)
        area += light[:, :, np.newaxis] * np.array([1.0, 0.95, 0.75], dtype=np.float32)
        wet = np.clip((self._wet[rows, cols] - WET_ABOVE) / WET_OVER, 0.0, 1.0)
        area *= (1.0 - WETTEST_DARKENS * plot.bareness * wet)[:, :, np.newaxis]

    def _crop_rows(self, plot: Plot, east: FloatImage, north: FloatImage) -> FloatImage:
        """Return the brightness pattern of crop rows: across on headlands, with tramlines."""
        u, v = (east, north) if plot.rows_run_north else (north, east)
        low, high = (
            (plot.south_m, plot.north_m) if plot.rows_run_north else (plot.west_m, plot.east_m)
        )
        is_headland = (v < low + HEADLAND_M) | (v > high - HEADLAND_M)
        stripes = self._stripes(plot.row_spacing_m, u, v, is_headland) + self._stripes(
            PLANT_ROW_M, u, v, is_headland
        )
        to_tramline = np.abs(np.mod(u, TRAMLINE_M) - TRAMLINE_M / 2.0)
        tramline = np.clip(1.0 - to_tramline / max(1.0, self.cell_m), 0.0, 1.0)
        tramline = np.where(is_headland, 0.0, tramline) * min(1.0, 1.0 / self.cell_m)
        shade: FloatImage = (
            plot.row_contrast * (stripes - 1.6 * tramline) - 3.0 * is_headland
        ).astype(np.float32)
        return shade

    def _stripes(
        self, spacing_m: float, u: FloatImage, v: FloatImage, is_headland: npt.NDArray[np.bool_]
    ) -> FloatImage:
        """Return waves of a spacing; they fade out as pixels become too coarse (no aliasing)."""
        # Half a wavelength per pixel is the limit; fade out before it is reached.
        visible = max(0.0, 1.0 - 2.0 * self.cell_m / spacing_m)
        if visible == 0.0:
            return np.zeros((1, 1), dtype=np.float32)
        wave = np.float32(2.0 * np.pi / spacing_m)
        across, along = visible * np.sin(wave * v), visible * np.sin(wave * u)
        stripes: FloatImage = np.where(is_headland, across, along).astype(np.float32)
        return stripes

    def draw_roads(self, land: Farmland) -> None:
        far = land.half_width_m
        for width_m, colour in ((14.0, VERGE), (7.0, GRAVEL)):
            for east in land.roads_east_m:
                self.fill((east - width_m / 2, -far, east + width_m / 2, far), colour)
            for north in land.roads_north_m:
                self.fill((-far, north - width_m / 2, far, north + width_m / 2), colour)

    def draw_creek(self, land: Farmland) -> None:
        west, _, east, _ = self.part.box_m
        near = (land.creek_m[:, 0] > west - 60.0) & (land.creek_m[:, 0] < east + 60.0)
        points = fixed_point(self.part, land.creek_m[near])
        for width_m, colour in ((46.0, MEADOW), (8.0, WATER)):
            thickness = max(1, round(width_m / self.cell_m))
            cv2.polylines(
                self.pixels, [points], False, colour, thickness, cv2.LINE_8, FRACTION_BITS
            )

    def draw_pond(self, pond: Pond) -> None:
        angles = np.linspace(0.0, 2.0 * np.pi, POND_CORNERS, endpoint=False)
        turned = radians(pond.turned_deg)
        for wider_m, colour in ((POND_EDGE_M, MEADOW), (0.0, WATER)):
            along = (pond.across_m + wider_m) * np.cos(angles)
            aside = (pond.along_m + wider_m) * np.sin(angles)
            east = pond.east_m + along * cos(turned) + aside * sin(turned)
            north = pond.north_m - along * sin(turned) + aside * cos(turned)
            outline = fixed_point(self.part, np.stack([east, north], axis=1))
            cv2.fillConvexPoly(self.pixels, outline, colour, cv2.LINE_8, FRACTION_BITS)

    def draw_roof(self, building: Building) -> None:
        """Draw two slopes; the north or west one is darker."""
        at, colour = building, np.array(building.colour)
        self.fill((at.west_m, at.south_m, at.east_m, at.north_m), tuple(colour))
        east, north = (at.west_m + at.east_m) / 2.0, (at.south_m + at.north_m) / 2.0
        runs_north = at.north_m - at.south_m > at.east_m - at.west_m
        box = (at.west_m, at.south_m, east, at.north_m)
        box = box if runs_north else (at.west_m, north, at.east_m, at.north_m)
        self.fill(box, tuple(DARKER_SLOPE * colour))

    def draw_trees(self, trees: list[Tree]) -> None:
        if not trees:
            return
        cover = cv2.GaussianBlur(self._discs(trees), (0, 0), 0.8).astype(np.float32)
        light = 5.0 * self._grain + self._discs(trees, shades=True)
        crowns = light[:, :, np.newaxis] + np.array(CROWN, dtype=np.float32)
        self.pixels += cover[:, :, np.newaxis] * (crowns - self.pixels)

    def _discs(self, trees: list[Tree], shades: bool = False) -> FloatImage:
        """Return an image with a disc per crown, of value 1 or of the crown's shade."""
        image = np.zeros((self.part.size, self.part.size), dtype=np.float32)
        points = fixed_point(self.part, np.array([(t.east_m, t.north_m) for t in trees]))
        for tree, point in zip(trees, points.tolist(), strict=True):
            radius = max(1, round(tree.radius_m / self.cell_m * 2**FRACTION_BITS))
            value = tree.shade if shades else 1.0
            cv2.circle(image, point, radius, value, -1, cv2.LINE_8, FRACTION_BITS)
        return image

    def add_grain(self) -> None:
        self.pixels += (2.6 * self._grain + 1.5 * self._patches)[:, :, np.newaxis]


LOWEST_SHADOW_SUN_DEG = 12.0
"""Shadows are drawn for at least this elevation: lower, they would cover everything."""
CROWN_SHADES_ITSELF = 70
"""Opacity of 255: shade of leaves on leaves."""


def draw_shadows(land: Farmland, part: LandPart, sun: SunPosition) -> npt.NDArray[np.uint8]:
    """Return the share of the beam blocked by trees and roofs, (size, size) uint8, of 255."""
    index, wide = index_of(land), part.with_margin()
    image = np.zeros((wide.size, wide.size), dtype=np.uint8)
    elevation = radians(max(sun.elevation_deg, LOWEST_SHADOW_SUN_DEG))
    azimuth = radians(sun.azimuth_deg)
    per_height = np.array([-sin(azimuth), -cos(azimuth)]) / tan(elevation)
    buildings, trees = index.buildings.within(wide.box_m), visible_trees(index, wide)
    for building in buildings:
        _shade_of_roof(image, wide, building, per_height)
    for tree in trees:
        _shade_of_tree(image, wide, tree, per_height)
    # Roofs and crowns lie above the shadows on the ground: draw their lit tops last.
    for building in buildings:
        rows, cols = slices(wide, building.box_m)
        image[rows, cols] = 0
    for tree in trees:
        _light_on_crown(image, wide, tree)
    soft = cv2.GaussianBlur(image, (0, 0), 0.9)
    return soft[MARGIN_PX:-MARGIN_PX, MARGIN_PX:-MARGIN_PX].astype(np.uint8, copy=True)


def _shade_of_roof(
    image: npt.NDArray[np.uint8], part: LandPart, building: Building, per_height: FloatArray
) -> None:
    at = building
    base = np.array([(e, n) for e in (at.west_m, at.east_m) for n in (at.south_m, at.north_m)])
    ends = np.concatenate([base, base + at.height_m * per_height]).astype(np.float32)
    hull = cv2.convexHull(ends).reshape(-1, 2).astype(np.float64)
    corners = fixed_point(part, hull)
    if is_near(corners, part):
        cv2.fillConvexPoly(image, corners, 255, cv2.LINE_AA, FRACTION_BITS)


def _shade_of_tree(
    image: npt.NDArray[np.uint8], part: LandPart, tree: Tree, per_height: FloatArray
) -> None:
    """Draw a crown's shadow: a thick line, the disc swept over the crown's height."""
    foot = np.array([tree.east_m, tree.north_m])
    shifts = np.outer([0.3, 0.7], tree.height_m * per_height)
    points = fixed_point(part, foot + shifts)
    width = max(1, round(1.7 * tree.radius_m / part.cell_m))
    if is_near(points, part, width):
        ends = [tuple(point) for point in points.tolist()]
        cv2.line(image, ends[0], ends[1], 255, width, cv2.LINE_AA, FRACTION_BITS)


def _light_on_crown(image: npt.NDArray[np.uint8], part: LandPart, tree: Tree) -> None:
    points = fixed_point(part, np.array([(tree.east_m, tree.north_m)]))
    radius = max(1, round(tree.radius_m / part.cell_m * 2**FRACTION_BITS))
    if is_near(points, part, 2 + radius // 2**FRACTION_BITS):
        at = (int(points[0, 0]), int(points[0, 1]))
        cv2.circle(image, at, radius, CROWN_SHADES_ITSELF, -1, cv2.LINE_AA, FRACTION_BITS)


def tileable_noise(size: int, seed: int, smallest_cells: float, slope: float) -> FloatImage:
    """Return (size, size) noise of mean 0 and standard deviation 1, periodic in both directions.

    Its spectrum falls with the wave number to the power `-slope` and ends at details of
    `smallest_cells` cells.
    """
    spectrum = np.fft.rfft2(np.random.default_rng(seed).standard_normal((size, size)))
    waves = np.hypot(np.fft.fftfreq(size)[:, np.newaxis], np.fft.rfftfreq(size)[np.newaxis, :])
    waves[0, 0] = 1.0
    spectrum *= waves**-slope * np.exp(-((waves * smallest_cells) ** 2))
    spectrum[0, 0] = 0.0
    noise = np.fft.irfft2(spectrum, (size, size))
    unit: FloatImage = (noise / noise.std()).astype(np.float32)
    return unit
