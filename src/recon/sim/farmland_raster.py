"""Drawing farmland into a raster: RGB, row 0 north, centred on the origin."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from recon.model.imagery import RgbImage
from recon.sim.farmland import MEADOW, Farmland, FloatArray, Plot, Tree
from recon.sim.noise import FloatImage, tileable_noise

GRAVEL = (168.0, 160.0, 145.0)
DIRT = (150.0, 133.0, 106.0)
VERGE = (116.0, 127.0, 80.0)
WATER = (88.0, 101.0, 98.0)
CROWN = (58.0, 76.0, 44.0)

HEADLAND_M = 16.0
TRAMLINE_M = 24.0
SHADOW_DARKENS = 0.62
SHADOW_EAST, SHADOW_NORTH = -0.7, 0.7
"""Tree shadows fall to the north-west: a morning's sun."""

SMALLEST_CROWN_PX = 0.6
NOISE_CELLS = 512


@dataclass(frozen=True, slots=True, eq=False)
class Raster:
    """Pixels of `cell_m`; the raster's centre is the origin."""

    rgb: RgbImage
    cell_m: float

    @property
    def half_width_m(self) -> float:
        """From the centre to an edge."""
        return len(self.rgb) * self.cell_m / 2.0


def draw(land: Farmland, size: int, cell_m: float, seed: int) -> Raster:
    """Return the land as (size, size) pixels of `cell_m`."""
    canvas = _Canvas(size, cell_m, seed)
    canvas.pixels[:] = VERGE
    for plot in land.plots:
        canvas.draw_plot(plot)
    for track in land.tracks:
        canvas.fill(track, DIRT)
    canvas.draw_creek(land)
    canvas.draw_roads(land)
    canvas.add_grain()
    canvas.draw_trees(land.trees)
    return Raster(np.clip(canvas.pixels, 0.0, 255.0).astype(np.uint8), cell_m)


class _Canvas:
    def __init__(self, size: int, cell_m: float, seed: int) -> None:
        self.size = size
        self.cell_m = cell_m
        self.half_m = size * cell_m / 2.0
        self.pixels: FloatImage = np.empty((size, size, 3), dtype=np.float32)
        centres = (np.arange(size, dtype=np.float32) + 0.5) * cell_m - self.half_m
        self.east_m, self.north_m = centres, -centres
        self._patches = self._noise(seed + 1, tile_m=900.0, smallest_cells=3.0, slope=1.6)
        self._grain = self._noise(seed + 2, tile_m=NOISE_CELLS * 0.8, smallest_cells=1.0, slope=0.7)

    def _noise(self, seed: int, tile_m: float, smallest_cells: float, slope: float) -> FloatImage:
        """Return noise fixed to the ground, at this raster's pixels."""
        tile = tileable_noise(NOISE_CELLS, seed, smallest_cells, slope)
        per_m = NOISE_CELLS / tile_m
        if self.cell_m * per_m > 1.0:
            # Details finer than a pixel average out.
            tile = cv2.blur(tile, (k := max(1, round(self.cell_m * per_m)), k)).astype(np.float32)
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

    def _slices(self, box: tuple[float, float, float, float]) -> tuple[slice, slice]:
        west, south, east, north = (round(edge / self.cell_m) for edge in box)
        half = self.size // 2
        rows = slice(max(0, half - north), max(0, half - south))
        return rows, slice(max(0, half + west), max(0, half + east))

    def fill(self, box: tuple[float, float, float, float], colour: tuple[float, ...]) -> None:
        self.pixels[self._slices(box)] = colour

    def draw_plot(self, plot: Plot) -> None:
        rows, cols = self._slices((plot.west_m, plot.south_m, plot.east_m, plot.north_m))
        area = self.pixels[rows, cols]
        if area.size == 0:
            return
        area[:] = plot.colour
        light = plot.patchiness * self._patches[rows, cols]
        north, east = self.north_m[rows, np.newaxis], self.east_m[np.newaxis, cols]
        if plot.row_contrast > 0.0:
            light += self._crop_rows(plot, east, north)
        area += light[:, :, np.newaxis] * np.array([1.0, 0.95, 0.75], dtype=np.float32)

    def _crop_rows(self, plot: Plot, east: FloatImage, north: FloatImage) -> FloatImage:
        """Return the light and dark of crop rows: across on the headlands, tramlines between."""
        u, v = (east, north) if plot.rows_run_north else (north, east)
        low, high = (
            (plot.south_m, plot.north_m) if plot.rows_run_north else (plot.west_m, plot.east_m)
        )
        is_headland = (v < low + HEADLAND_M) | (v > high - HEADLAND_M)
        visible = max(0.0, 1.0 - 2.0 * self.cell_m / plot.row_spacing_m)
        wave = 2.0 * np.pi / plot.row_spacing_m
        stripes = np.where(is_headland, np.sin(wave * v), np.sin(wave * u))
        to_tramline = np.abs(np.mod(u, TRAMLINE_M) - TRAMLINE_M / 2.0)
        tramline = np.clip(1.0 - to_tramline / max(1.0, self.cell_m), 0.0, 1.0)
        tramline = np.where(is_headland, 0.0, tramline) * min(1.0, 1.0 / self.cell_m)
        shade: FloatImage = (
            plot.row_contrast * (visible * stripes - 1.6 * tramline) - 3.0 * is_headland
        ).astype(np.float32)
        return shade

    def draw_roads(self, land: Farmland) -> None:
        far = land.half_width_m
        for width_m, colour in ((14.0, VERGE), (7.0, GRAVEL)):
            for east in land.roads_east_m:
                self.fill((east - width_m / 2, -far, east + width_m / 2, far), colour)
            for north in land.roads_north_m:
                self.fill((-far, north - width_m / 2, far, north + width_m / 2), colour)

    def draw_creek(self, land: Farmland) -> None:
        points = self._pixels_of(land.creek_m)
        for width_m, colour in ((46.0, MEADOW), (8.0, WATER)):
            thickness = max(1, round(width_m / self.cell_m))
            cv2.polylines(self.pixels, [points], False, colour, thickness, cv2.LINE_AA)

    def draw_trees(self, trees: tuple[Tree, ...]) -> None:
        seen = [tree for tree in trees if self._is_seen(tree)]
        shadow = self._discs(seen, shift=1.3)
        shadow = cv2.GaussianBlur(shadow, (0, 0), 0.9).astype(np.float32)
        self.pixels *= (1.0 - (1.0 - SHADOW_DARKENS) * shadow)[:, :, np.newaxis]
        cover = cv2.GaussianBlur(self._discs(seen), (0, 0), 0.8).astype(np.float32)
        light = 5.0 * self._grain + self._discs(seen, shades=True)
        crowns = light[:, :, np.newaxis] + np.array(CROWN, dtype=np.float32)
        self.pixels += cover[:, :, np.newaxis] * (crowns - self.pixels)

    def _is_seen(self, tree: Tree) -> bool:
        is_large_enough = tree.radius_m > SMALLEST_CROWN_PX * self.cell_m
        return is_large_enough and max(abs(tree.east_m), abs(tree.north_m)) < self.half_m

    def _discs(self, trees: list[Tree], shift: float = 0.0, shades: bool = False) -> FloatImage:
        """Return an image with a disc per crown, of 1 or of its shade, shifted by some radii."""
        image = np.zeros((self.size, self.size), dtype=np.float32)
        if not trees:
            return image
        centres = np.array([(tree.east_m, tree.north_m) for tree in trees])
        radii = np.array([[tree.radius_m] for tree in trees])
        points = self._pixels_of(centres + shift * radii * (SHADOW_EAST, SHADOW_NORTH))
        for tree, point in zip(trees, points.tolist(), strict=True):
            radius = max(1, round(tree.radius_m / self.cell_m))
            cv2.circle(image, point, radius, tree.shade if shades else 1.0, -1, cv2.LINE_AA)
        return image

    def add_grain(self) -> None:
        self.pixels += (2.6 * self._grain + 1.5 * self._patches)[:, :, np.newaxis]

    def _pixels_of(self, points_m: FloatArray) -> npt.NDArray[np.int32]:
        cols = (points_m[:, 0] + self.half_m) / self.cell_m - 0.5
        rows = (self.half_m - points_m[:, 1]) / self.cell_m - 0.5
        return np.rint(np.stack([cols, rows], axis=1)).astype(np.int32)
