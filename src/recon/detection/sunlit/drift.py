"""What exposure and white balance do from frame to frame, whatever is sun and shade.

Shade moves on with the wind, and changes little within seconds: once that motion is taken out, what
most cells' light still changes by is the camera's. Without it, a slow slope of shade that moves
over the view would be taken for a change of exposure. The motion is measured with it, by least
squares of the changes on the slopes of shade (B. Lucas and T. Kanade, IJCAI 1981, over the whole
view), from the frames of the last minute together. Errors add up.
"""

from dataclasses import dataclass, replace
from math import expm1

import cv2
import numpy as np

from recon.detection.sunlit.colour import CellColour
from recon.detection.sunlit.keyframes import SunlitLand
from recon.detection.sunlit.levels import LEAST_CELLS, UNCHANGED, Level
from recon.model.arrays import FloatArray
from recon.model.shade import FloatMap, MaskMap
from recon.model.units import NS_PER_S, seconds_to_ns

LONGEST_GAP_S = 20.0
"""Longest gap between frames: in a longer one most cells may have changed."""
LOCK_S = 60.0
"""A camera that sets its exposure automatically does so within a minute under moving clouds; the
errors of so many frames stay below the limits."""
LOCKED_LIGHT, LOCKED_COLOUR = 0.15, 0.10
"""Changes within that time of a camera that is not locked."""
CLOUD_COLOUR = 0.25
"""Thin cloud dims the whole view too, but makes it bluer by at least 0.4 of that."""
SMOOTHED_CELLS = 2.0
"""Smoothing of shade's slopes, in coarse cells: shade is smooth over 30 m, land errors are not."""
NOISE = 0.03, 0.02
"""Errors of a cell's change of light and of colour."""
FARTHEST = 3.0
"""Standard deviations at which a cell's change is cut off: vehicles, errors of place."""
FORGOTTEN_S = 60.0
"""Time in which the weight of what motion is read from halves."""
STILL = 200.0
"""Weight of no motion at all."""


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """Sums for the least squares of shade's velocity, in cells per second."""

    square: FloatArray
    product: FloatArray

    @property
    def velocity(self) -> FloatArray:
        """Return (2,): cells to the right and downward per second."""
        found = np.linalg.solve(self.square + STILL * np.eye(2), self.product)
        return np.asarray(found, np.float64)


NO_MOTION = Motion(np.zeros((2, 2)), np.zeros(2))


@dataclass(frozen=True, slots=True, eq=False)
class Drift:
    """The latest frame, and the sum of all changes of the camera up to it."""

    at_ns: int
    cells: CellColour
    total: Level
    recent: tuple[tuple[int, Level], ...] = ()
    """Capture times and totals of the last minute, without the latest."""
    motion: Motion = NO_MOTION

    def lock_problem(self) -> str:
        """Return what shows that exposure or white balance is not locked; empty if nothing does."""
        for at_ns, total in self.recent:
            change, after_s = self.total - total, (self.at_ns - at_ns) / NS_PER_S
            light, colour = abs(change.light), abs(change.colour)
            if light > LOCKED_LIGHT and colour < CLOUD_COLOUR * light:
                return f"exposure changed by {expm1(light):.0%} within {after_s:.0f} s"
            if colour > LOCKED_COLOUR and light < LOCKED_LIGHT / 2.0:
                return f"white balance changed by {expm1(colour):.0%} within {after_s:.0f} s"
        return ""


def followed(drift: Drift | None, cells: CellColour, land: SunlitLand | None, at_ns: int) -> Drift:
    """Return the drift with one more frame over land as far as known; across a long gap none."""
    if drift is None:
        return Drift(at_ns, cells, UNCHANGED)
    both = drift.cells.seen & cells.seen
    after_s = (at_ns - drift.at_ns) / NS_PER_S
    if after_s > LONGEST_GAP_S or np.count_nonzero(both) < LEAST_CELLS:
        # What the camera did meanwhile is unknown.
        return Drift(at_ns, cells, drift.total, motion=drift.motion)
    was, lands = drift.cells, (None, None) if land is None else (land.light, land.colour)
    parts = [
        _Change.between(was.light, cells.light, lands[0], after_s),
        _Change.between(was.colour, cells.colour, lands[1], after_s),
    ]
    motion = _pooled(drift.motion, parts, after_s)
    light, colour = (part.common(motion.velocity) for part in parts)
    total = drift.total + Level(light, colour)
    oldest_ns = at_ns - seconds_to_ns(LOCK_S)
    recent = tuple(each for each in drift.recent if each[0] >= oldest_ns)
    return Drift(at_ns, cells, total, (*recent, (drift.at_ns, drift.total)), motion)


@dataclass(frozen=True, slots=True, eq=False)
class _Change:
    """Cells' changes (N,), and by how much shade's slope moving at 1 cell/s changes them (2, N)."""

    changes: FloatArray
    by_motion: FloatArray

    @staticmethod
    def between(
        before: FloatMap, now: FloatMap, land: FloatMap | None, after_s: float
    ) -> "_Change":
        """Return it for one channel of two frames."""
        if land is None:
            changes = now - before
            cells = np.isfinite(changes)
            none = np.zeros((2, int(cells.sum())))
            return _Change(changes[cells].astype(np.float64), none)
        # Smoothed alike: or slopes are too small for the changes, and motion too fast.
        first, second = _smooth(before - land), _smooth(now - land)
        changes = second - first
        down, across = np.gradient(0.5 * (first + second))
        cells = np.isfinite(changes) & np.isfinite(down) & np.isfinite(across)
        slopes = np.stack([across[cells], down[cells]]).astype(np.float64)
        return _Change(changes[cells].astype(np.float64), -after_s * slopes)

    def squares(self, noise: float) -> tuple[FloatArray, FloatArray]:
        """Return the sums for shade's velocity, the common change taken out."""
        if not self.changes.size:
            return NO_MOTION.square, NO_MOTION.product
        slopes = self.by_motion - self.by_motion.mean(axis=1, keepdims=True)
        off = self.changes - np.median(self.changes)
        spread = FARTHEST * 1.48 * float(np.median(np.abs(off)))
        off = np.clip(off, -spread, spread)
        return slopes @ slopes.T / noise**2, slopes @ off / noise**2

    def common(self, velocity: FloatArray) -> float:
        """Return the change that is left in common when shade moves so."""
        left = self.changes - velocity @ self.by_motion
        return float(np.median(left)) if left.size else 0.0


def _pooled(motion: Motion, parts: list[_Change], after_s: float) -> Motion:
    kept = float(np.exp2(-after_s / FORGOTTEN_S))
    square, product = kept * motion.square, kept * motion.product
    for part, noise in zip(parts, NOISE, strict=True):
        more_square, more_product = part.squares(noise)
        square, product = square + more_square, product + more_product
    return replace(motion, square=square, product=product)


def _smooth(values: FloatMap) -> FloatMap:
    """Return values averaged with their neighbours; NaN where nothing is known."""
    known: MaskMap = np.isfinite(values)
    filled = np.where(known, values, np.float32(0.0))
    total = cv2.GaussianBlur(filled, (0, 0), SMOOTHED_CELLS)
    share = cv2.GaussianBlur(known.astype(np.float32), (0, 0), SMOOTHED_CELLS)
    smooth: FloatMap = np.where(known, total / np.maximum(share, 1e-3), np.nan).astype(np.float32)
    return smooth
