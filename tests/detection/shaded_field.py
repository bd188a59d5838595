"""A field of known texture under shadows of known shape that drift: truth by construction.

Nothing here is the simulator's: fields, shadows and camera are drawn for these tests alone.
"""

from dataclasses import dataclass, field
from functools import lru_cache

import cv2
import numpy as np

from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.imagery import CameraPose, GroundImage
from recon.model.units import seconds_to_ns

FRAME = LocalFrame(GeoPoint(44.5, -92.9, 320.0))
LOOKS_DOWN = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
GRID = GroundGrid(FRAME, -256.0, 256.0, 2.0, 256, 256)
FIELD = GroundGrid(FRAME, -256.0, 256.0, 4.0, 128, 128)
SEEN_RADIUS_M = 240.0
HEIGHT_M = 120.0
SKY_M, SKY_CELL_M = 4096.0, 8.0
"""Shadows repeat after this far: further than any test lets them drift."""


def centres(grid: GroundGrid) -> tuple[np.ndarray, np.ndarray]:
    """(R, C) east and (R, C) north of the cells' middles."""
    east = grid.west_m + (np.arange(grid.cols) + 0.5) * grid.cell_m
    north = grid.north_m - (np.arange(grid.rows) + 0.5) * grid.cell_m
    east_m, north_m = np.meshgrid(east, north)
    return east_m, north_m


def smooth_noise(rng: np.random.Generator, cells: int, blur_cells: float) -> np.ndarray:
    """(cells, cells) periodic noise of mean 0 and deviation 1 without details under the blur."""
    waves = np.hypot(np.fft.fftfreq(cells)[:, np.newaxis], np.fft.rfftfreq(cells))
    spectrum = np.fft.rfft2(rng.standard_normal((cells, cells)))
    spectrum *= np.exp(-((np.pi * blur_cells * waves) ** 2) * 2.0)
    spectrum[0, 0] = 0.0
    noise = np.fft.irfft2(spectrum, (cells, cells))
    return noise / noise.std()


@dataclass(slots=True)
class DriftingShade:
    """Round soft shadows; `cover` of the ground lies in them, on the whole."""

    seed: int
    cover: float = 0.35
    velocity_mps: tuple[float, float] = (6.0, 3.0)
    size_m: float = 60.0
    softness: float = 0.5
    _sky: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        rng = np.random.default_rng(self.seed)
        noise = smooth_noise(rng, int(SKY_M / SKY_CELL_M), self.size_m / SKY_CELL_M)
        edge = np.quantile(noise, 1.0 - self.cover)
        ramp = np.clip((noise - edge) / self.softness + 0.5, 0.0, 1.0)
        self._sky = (1.0 - ramp).astype(np.float32)

    def transmittance(self, grid: GroundGrid, time_s: float) -> np.ndarray:
        """(R, C): the direct beam's share at the cells' middles."""
        east_m, north_m = centres(grid)
        col = np.mod(east_m - self.velocity_mps[0] * time_s, SKY_M) / SKY_CELL_M
        row = np.mod(north_m - self.velocity_mps[1] * time_s, SKY_M) / SKY_CELL_M
        maps = (col.astype(np.float32), row.astype(np.float32))
        return cv2.remap(self._sky, *maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)


@dataclass(frozen=True, slots=True)
class Land:
    """Plots of different crops and soils with patches and rows: reflectance at each cell."""

    seed: int
    contrast: float = 1.0
    """1: the brightest plot is some five times as bright as the darkest."""

    @lru_cache(maxsize=8)  # noqa: B019
    def reflectance(self, grid: GroundGrid) -> np.ndarray:
        """(R, C) in (0, 1)."""
        rng = np.random.default_rng(self.seed)
        east_m, north_m = centres(grid)
        plots = rng.uniform(-0.8, 0.8, (12, 12))
        column = np.floor(east_m / rng.uniform(70.0, 130.0)).astype(int) % 12
        row = np.floor(north_m / rng.uniform(50.0, 110.0)).astype(int) % 12
        patches = smooth_noise(rng, 512, 6.0)
        at = np.mod(north_m / 2.0, 512).astype(int), np.mod(east_m / 2.0, 512).astype(int)
        rows = np.sin(2.0 * np.pi * east_m / 7.0)
        log = self.contrast * (plots[row, column] + 0.15 * patches[at] + 0.08 * rows)
        return 0.22 * np.exp(log)


@dataclass(slots=True)
class Imager:
    """A camera over the field: exposure, noise, what it sees, where it hovers."""

    diffuse_share: float = 0.25
    noise_levels: float = 2.5
    exposure: float = 2.2
    offset_m: tuple[float, float] = (0.0, 0.0)
    """How far frames are placed wrongly."""
    grid: GroundGrid = GRID
    serial: str = "IMAGER"

    def see(
        self, land: Land, shade: DriftingShade, time_s: float, gain: float = 1.0
    ) -> GroundImage:
        """Return the frame taken at a time, on this camera's grid."""
        wrong = GroundGrid(
            self.grid.frame,
            self.grid.west_m + self.offset_m[0],
            self.grid.north_m + self.offset_m[1],
            self.grid.cell_m,
            self.grid.rows,
            self.grid.cols,
        )
        direct = shade.transmittance(wrong, time_s)
        lit = self.diffuse_share + (1.0 - self.diffuse_share) * direct
        light = land.reflectance(wrong) * lit * self.exposure * gain
        tint = np.stack([1.05 * np.ones_like(lit), np.ones_like(lit), 0.6 + 0.2 * (1.0 - direct)])
        levels = 255.0 * np.clip(light * tint, 0.0, 1.0) ** (1.0 / 2.2)
        rng = np.random.default_rng([round(time_s * 1000.0), land.seed, shade.seed])
        noise = rng.normal(0.0, self.noise_levels, levels.shape)
        rgb = np.clip(np.rint(levels + noise), 0, 255).astype(np.uint8).transpose(1, 2, 0)
        return self.image(rgb, time_s)

    def image(self, rgb: np.ndarray, time_s: float) -> GroundImage:
        """Return an image on this camera's grid."""
        east_m, north_m = centres(self.grid)
        valid = np.hypot(east_m, north_m) < SEEN_RADIUS_M
        return GroundImage(
            grid=self.grid,
            frame_id=round(time_s * 10),
            captured_at_ns=seconds_to_ns(time_s),
            rgb=np.where(valid[..., np.newaxis], rgb, 0).astype(np.uint8),
            valid=valid,
            pose=CameraPose(LOOKS_DOWN, np.array([0.0, 0.0, HEIGHT_M])),
            serial=self.serial,
        )


FOOTPRINT = np.hypot(*centres(FIELD)) < SEEN_RADIUS_M - 8.0
"""Cells of the field that are seen in every frame, placed wrongly by some metres or not."""


def shade_iou(is_sunlit: np.ndarray, valid: np.ndarray, is_shade: np.ndarray) -> float:
    """Of the footprint that is shade or called so: the share that is both; unknown is wrong."""
    called = valid & ~is_sunlit
    wrong = ~valid | (called != is_shade)
    either = (called | is_shade | wrong) & FOOTPRINT
    return float((called & is_shade & FOOTPRINT).sum() / max(1, either.sum()))
