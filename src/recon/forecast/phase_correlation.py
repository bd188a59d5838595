"""How well two shade maps agree at each shift, by phase correlation.

C. D. Kuglin, D. C. Hines, The phase correlation image alignment method, Proc. Int. Conf. on
Cybernetics and Society (1975). Two steps come first. The mean of the surroundings, over visible
cells only, is subtracted from each cell, and the rest fades out towards the edge of the visible
area: that edge does not move, and would be found as a shift of zero. And small details get less
weight than large ones.
"""

from dataclasses import dataclass
from typing import TypeAlias

import cv2
import numpy as np
import numpy.typing as npt

from recon.forecast.settings import ForecastSettings
from recon.model.geo import GroundGrid
from recon.model.shade import FloatMap, MaskMap, ShadeMap

Waves: TypeAlias = npt.NDArray[np.complex64]

FADES_OVER_CELLS = 12.0
"""Width of the fading from the edge of the visible area inwards."""


@dataclass(frozen=True, slots=True, eq=False)
class ShadeSpectrum:
    """The spectrum of one shade map, kept to be compared with later ones."""

    grid: GroundGrid
    at_ns: int
    shape: tuple[int, int]
    """Rows and columns transformed: twice the grid, so that circular correlation does not join
    opposite edges."""
    waves: Waves | None
    """None without contrast."""


def spectrum_of(
    shade: ShadeMap, settings: ForecastSettings, least_contrast: float
) -> ShadeSpectrum:
    """Return the spectrum of a map's details, without waves for a map of less contrast."""
    from scipy import fft

    grid = shade.grid
    shape = fft.next_fast_len(2 * grid.rows, real=True), fft.next_fast_len(2 * grid.cols, real=True)
    waves: Waves | None = None
    if _contrast(shade) >= least_contrast:
        waves = fft.rfft2(_details(shade, settings.detail_m / grid.cell_m), shape)
    return ShadeSpectrum(grid, shade.captured_at_ns, shape, waves)


def agreement_between(
    before: ShadeSpectrum, now: ShadeSpectrum, settings: ForecastSettings
) -> FloatMap | None:
    """Return by shift, zero in the middle, the share of phases that agree in two maps of one grid;
    None without contrast."""
    if before.waves is None or now.waves is None:
        return None
    return _agreement(before.waves, now.waves, now.shape, settings.smooth_cells)


def _contrast(shade: ShadeMap) -> float:
    return float(shade.transmittance[shade.valid].std()) if shade.valid.any() else 0.0


def _details(shade: ShadeMap, blur_cells: float) -> FloatMap:
    """Return (R, C): the transmittance minus the local mean, fading out at the edge."""
    seen = shade.valid.astype(np.float32)
    direct = np.where(shade.valid, shade.transmittance, np.float32(0.0))
    means, shares = (cv2.GaussianBlur(a, (0, 0), blur_cells) for a in (direct, seen))
    # Means over visible cells only (normalised convolution): outside counts as unknown, not shade.
    details = (direct - means / np.maximum(shares, 1e-3)) * _inwards(shade.valid)
    return details.astype(np.float32)


def _inwards(valid: MaskMap) -> FloatMap:
    """Return (R, C): 0 outside and at the edge of the visible area, 1 far inside."""
    framed = cv2.copyMakeBorder(valid.astype(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
    cells = cv2.distanceTransform(framed, cv2.DIST_L2, 3)[1:-1, 1:-1]
    inside: FloatMap = np.clip(cells / FADES_OVER_CELLS, 0.0, 1.0).astype(np.float32)
    return inside


def _agreement(
    earlier: Waves, later: Waves, shape: tuple[int, int], smooth_cells: float
) -> FloatMap:
    """Return (rows, cols) of `shape`, zero shift in the middle: share of phases that agree."""
    from scipy import fft

    both = np.conj(earlier) * later
    # Gaussian low-pass: details below `smooth_cells` are noise.
    by_row, by_col = (
        np.exp(-2.0 * (np.pi * smooth_cells * np.fft.fftfreq(size)) ** 2) for size in shape
    )
    weight = np.outer(by_row, by_col[: both.shape[1]]).astype(np.float32)
    # Only phases count: strong shadows must not outweigh weak ones.
    phases = both / np.maximum(np.abs(both), np.float32(1e-12))
    found = fft.fftshift(fft.irfft2(weight * phases, shape))
    # Normalised by the value of a perfect match, in which all weights are in phase.
    shares: FloatMap = (found / (by_row.mean() * by_col.mean())).astype(np.float32)
    return shares


def by_velocity(
    surface: FloatMap, gap_s: float, cell_m: float, fastest_mps: float, step_mps: float
) -> FloatMap:
    """Return (N, N): a surface by shift, 0 in its middle, read at the shift that each velocity
    makes in a time; rows from north to south, columns from west to east; 0 off the surface."""
    half = round(fastest_mps / step_mps)
    speeds_mps = np.arange(-half, half + 1, dtype=np.float32) * np.float32(step_mps)
    cells = speeds_mps * np.float32(gap_s / cell_m)
    cols, rows = np.meshgrid(surface.shape[1] // 2 + cells, surface.shape[0] // 2 + cells)
    found = cv2.remap(surface, cols, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)
    return found.astype(np.float32, copy=False)


def between(line: FloatMap, best: int) -> float:
    """Return the sub-cell peak of a parabola through three neighbours, in [-0.5, 0.5]."""
    if best in (0, len(line) - 1):
        return 0.0
    before, at, after = (float(line[best + i]) for i in (-1, 0, 1))
    bend = before - 2.0 * at + after
    # Beside a peak that was taken out the highest value need be no peak itself.
    return min(max(0.5 * (before - after) / bend, -0.5), 0.5) if bend < 0.0 else 0.0
