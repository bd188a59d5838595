"""The land's pixels around a camera: tiles drawn on demand, a bounded number kept.

Each tile is a function of seed and place (its shadows also of the sun's position), so the cache
changes nothing but the time a frame takes.
"""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from functools import lru_cache
from math import floor
from threading import Lock
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from recon.geo.sun import SunPosition
from recon.sim.land.farmland import Farmland, lay_out
from recon.sim.land.farmland_raster import draw, draw_shadows
from recon.sim.land.land_part import LandPart

CELLS_M = (0.25, 1.0, 4.0, 16.0)
"""Pixel sizes of the levels: the finest for the ground below, the coarsest for the horizon."""
TILE_PX = 256
TILES_ACROSS = 6
"""Side of the square of tiles around the camera; beyond it a coarser level is fine enough."""
TILES_KEPT = 320
"""80 MB with shadows; the squares of four levels have 144 tiles."""
SUN_STEP_DEG = 2.0
"""Sun positions are rounded to this for shadows: a 10 m tree's shadow is right to 0.5 m."""

Value = TypeVar("Value")
LandImage = npt.NDArray[np.uint8]


@dataclass(frozen=True, slots=True, eq=False)
class LandSquare:
    """Pixels around the camera: red, green, blue and shadow (N, N, 4)."""

    pixels: LandImage
    west_m: float
    north_m: float
    cell_m: float

    @property
    def centre_m(self) -> tuple[float, float]:
        """East and north of the middle."""
        half_m = self.half_width_m
        return self.west_m + half_m, self.north_m - half_m

    @property
    def half_width_m(self) -> float:
        """Return the distance from the middle to an edge."""
        return len(self.pixels) * self.cell_m / 2.0


@dataclass(slots=True)
class LandTiles:
    """Draws the land of a seed by tiles; thread-safe."""

    land: Farmland
    seed: int
    _drawing: Lock = field(default_factory=Lock)
    _colours: "OrderedDict[Hashable, LandImage]" = field(default_factory=OrderedDict)
    _shadows: "OrderedDict[Hashable, LandImage]" = field(default_factory=OrderedDict)
    _squares: "OrderedDict[Hashable, LandSquare]" = field(default_factory=OrderedDict)

    def square(self, level: int, east_m: float, north_m: float, sun: SunPosition) -> LandSquare:
        """Return the pixels of a level around a place, centred on the nearest corner of tiles."""
        tile_m = CELLS_M[level] * TILE_PX
        col, row = floor(east_m / tile_m + 0.5), floor(-north_m / tile_m + 0.5)
        key = (level, row, col, _sun_step(sun))
        # One lock for all: threads that need the same tiles must not draw them twice.
        with self._drawing:
            return _kept(
                self._squares, key, len(CELLS_M), lambda: self._draw_square(level, row, col, sun)
            )

    def _draw_square(self, level: int, row: int, col: int, sun: SunPosition) -> LandSquare:
        first_row, first_col = row - TILES_ACROSS // 2, col - TILES_ACROSS // 2
        size = TILES_ACROSS * TILE_PX
        pixels: LandImage = np.empty((size, size, 4), dtype=np.uint8)
        for i in range(TILES_ACROSS):
            for j in range(TILES_ACROSS):
                at = np.s_[i * TILE_PX : (i + 1) * TILE_PX, j * TILE_PX : (j + 1) * TILE_PX]
                pixels[at] = self._tile(level, first_row + i, first_col + j, sun)
        cell_m = CELLS_M[level]
        tile_m = cell_m * TILE_PX
        return LandSquare(pixels, first_col * tile_m, -first_row * tile_m, cell_m)

    def _tile(self, level: int, row: int, col: int, sun: SunPosition) -> LandImage:
        """Return a tile's colours and shadows (TILE_PX, TILE_PX, 4)."""
        part = LandPart(row * TILE_PX, col * TILE_PX, TILE_PX, CELLS_M[level])
        colours = _kept(self._colours, part, TILES_KEPT, lambda: draw(self.land, part, self.seed))
        step = _sun_step(sun)
        stepped = SunPosition(step[0] * SUN_STEP_DEG, step[1] * SUN_STEP_DEG, sun.distance_au)
        shadows = _kept(
            self._shadows,
            (part, step),
            TILES_KEPT,
            lambda: draw_shadows(self.land, part, stepped),
        )
        return np.dstack([colours, shadows])


@lru_cache(maxsize=2)
def land_of(seed: int) -> LandTiles:
    """Return a seed's land; all cameras over it share the tiles."""
    return LandTiles(lay_out(seed), seed)


def _sun_step(sun: SunPosition) -> tuple[int, int]:
    return round(sun.azimuth_deg / SUN_STEP_DEG), round(sun.elevation_deg / SUN_STEP_DEG)


def _kept(
    store: "OrderedDict[Hashable, Value]", key: Hashable, most: int, make: Callable[[], Value]
) -> Value:
    """Return the value of a key, made if missing; the least recently used one is dropped."""
    if key in store:
        store.move_to_end(key)
        return store[key]
    store[key] = value = make()
    if len(store) > most:
        store.popitem(last=False)
    return value
