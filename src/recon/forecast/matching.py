"""How well two shade maps match when one is moved by a velocity: their mean square difference.

Phase correlation gives small details the weight of large ones, so a fine pattern that stands still
(of the ground, of the places of sensors) may have the highest peak. The difference of the maps
themselves cannot be misled so: what moved must explain the later map better than what stood still.
Maps are averaged to coarse cells before, and compared where both are known, the more the surer and
the finer they are there (normalised as by D. Padfield, Masked object registration in the Fourier
domain, IEEE Trans. Image Process. 21, 2012).
"""

from dataclasses import dataclass
from typing import TypeAlias

import cv2
import numpy as np
import numpy.typing as npt

from recon.forecast.motion import ShadowMotion
from recon.forecast.phase_correlation import between, by_velocity
from recon.forecast.settings import ForecastSettings
from recon.model.shade import FloatMap, ShadeMap
from recon.model.units import ns_to_seconds

Waves: TypeAlias = npt.NDArray[np.complex64]

MOST_CELLS_ACROSS = 64
"""Coarse cells along a map's longer side: velocities are found to a fraction of their size."""
LEAST_OVERLAP = 0.25
"""Share of the known cells that must lie in both maps: fewer agree by chance."""


@dataclass(frozen=True, slots=True, eq=False)
class MatchedMap:
    """The spectra of a coarse map, weighted by confidence, kept to be compared with later ones."""

    at_ns: int
    cell_m: float
    shape: tuple[int, int]
    """Rows and columns transformed: twice the coarse map's."""
    light: Waves
    squares: Waves
    seen: Waves
    deviations: Waves
    """Squares of the deviation from the map's own mean."""
    cells: float
    """Sum of the squared weights of its cells."""


@dataclass(frozen=True, slots=True, eq=False)
class Mismatch:
    """Sums over pairs of maps, (M, M) by velocity: rows from north to south, columns from west to
    east; 0 where they overlap little."""

    difference: FloatMap
    """The mean square difference of the later map from the earlier one moved by a velocity."""
    variance: FloatMap
    """What that were if they had nothing in common."""


def matched_map(shade: ShadeMap) -> MatchedMap:
    """Return a map's spectra."""
    from scipy import fft

    grid = shade.grid
    factor = max(1, round(max(grid.rows, grid.cols) / MOST_CELLS_ACROSS))
    size = max(1, grid.cols // factor), max(1, grid.rows // factor)
    far_m = np.where(shade.valid, shade.metres_per_pixel, np.float32(1.0))
    known = np.where(shade.valid, shade.confidence / far_m**2, np.float32(0.0))
    known /= max(1e-9, float(known.max()))
    direct = np.where(shade.valid, shade.transmittance, np.float32(0.0)) * known
    weighted, seen = (
        cv2.resize(each, size, interpolation=cv2.INTER_AREA) for each in (direct, known)
    )
    light = weighted / np.maximum(seen, np.float32(1e-3))
    mean = weighted.sum() / max(1e-3, float(seen.sum()))
    shape = fft.next_fast_len(2 * size[1], real=True), fft.next_fast_len(2 * size[0], real=True)
    parts = (weighted, weighted * light, seen, seen * (light - mean) ** 2)
    light_w, squares, seen_w, deviations = (
        fft.rfft2(each.astype(np.float32), shape) for each in parts
    )
    return MatchedMap(
        at_ns=shade.captured_at_ns,
        cell_m=grid.cell_m * grid.cols / size[0],
        shape=shape,
        light=light_w,
        squares=squares,
        seen=seen_w,
        deviations=deviations,
        cells=float((seen**2).sum()),
    )


def mismatch_by_velocity(
    before: MatchedMap, now: MatchedMap, settings: ForecastSettings
) -> Mismatch:
    """Return the mismatch of one pair, weighted by the time between its maps."""
    from scipy import fft

    shape, then, later = now.shape, before, now
    both = np.stack(
        [
            np.conj(then.squares) * later.seen
            + np.conj(then.seen) * later.squares
            - 2.0 * np.conj(then.light) * later.light,
            np.conj(then.deviations) * later.seen + np.conj(then.seen) * later.deviations,
            np.conj(then.seen) * later.seen,
        ]
    )
    sums = fft.fftshift(fft.irfft2(both, shape), axes=(1, 2))
    gap_s = ns_to_seconds(now.at_ns - before.at_ns)
    fastest_mps, step_mps = settings.fastest_mps, settings.match_step_mps
    difference, variance, overlap = (
        by_velocity(each.astype(np.float32), gap_s, now.cell_m, fastest_mps, step_mps)
        for each in sums
    )
    is_enough = overlap >= LEAST_OVERLAP * min(before.cells, now.cells)
    # Longer pairs tell velocities better apart.
    weight = np.float32(gap_s) * is_enough / np.maximum(overlap, np.float32(1e-3))
    return Mismatch(*((each * weight).astype(np.float32) for each in (difference, variance)))


@dataclass(frozen=True, slots=True, eq=False)
class Explained:
    """What share of the maps' changes each velocity leaves unexplained."""

    left: FloatMap
    """(M, M): 1 where moved maps have nothing in common with later ones; infinite if not known."""
    settings: ForecastSettings

    @staticmethod
    def of(sums: Mismatch, settings: ForecastSettings) -> "Explained":
        """Return it of sums; velocities that move most of the view out of it are not known."""
        is_known = sums.variance > settings.least_match_share * sums.variance.max()
        left = np.where(is_known, sums.difference / np.where(is_known, sums.variance, 1.0), np.inf)
        return Explained(left.astype(np.float32), settings)

    @property
    def at_rest(self) -> float:
        """What standing still leaves unexplained."""
        middle = self.left.shape[0] // 2
        return float(self.left[middle, middle])

    @property
    def best(self) -> ShadowMotion | None:
        """The velocity that leaves least; None if that is not clearly less than rest does, or if it
        is hardly a motion."""
        row, col = (
            int(each) for each in np.unravel_index(int(self.left.argmin()), self.left.shape)
        )
        least, last = float(self.left[row, col]), self.left.shape[0] - 1
        if (
            not least < (1.0 - self.settings.least_explained) * self.at_rest
            or not 0 < min(row, col) <= max(row, col) < last
        ):
            return None
        around = self.left[row - 1 : row + 2, col - 1 : col + 2]
        if not np.isfinite(around).all():
            return None
        right = col - last // 2 + between(-around[1], 1)
        down = row - last // 2 + between(-around[:, 1], 1)
        step_mps = self.settings.match_step_mps
        found = ShadowMotion(right * step_mps, -down * step_mps)
        return found if found.speed_mps >= self.settings.slowest_match_mps else None

    def has(self, motion: ShadowMotion, of_best: float) -> bool:
        """Return whether a velocity explains this share of what the best one does, and enough."""
        middle = self.left.shape[0] // 2
        col = middle + motion.east_mps / self.settings.match_step_mps
        row = middle - motion.north_mps / self.settings.match_step_mps
        if not (0 <= round(row) <= 2 * middle and 0 <= round(col) <= 2 * middle):
            return False
        found = self.at_rest - float(self.left[round(row), round(col)])
        best = self.at_rest - float(self.left.min())
        return found > 0.0 and found >= of_best * best
