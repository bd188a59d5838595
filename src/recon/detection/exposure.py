"""How the camera's exposure changed, told from what the cells have in common.

Clouds change some cells' light, the camera all cells' by one factor. Between two frames a few
seconds apart the factor is where the cells' changes crowd most: the mean of the shortest interval
that holds a third of them. Where even that interval is wide, light itself is changing over the
whole view, and the camera's part is not told from it: the exposure then counts as unchanged.
"""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from recon.detection.cells import CellLight
from recon.detection.settings import DetectionSettings
from recon.model.shade import FloatMap, MaskMap
from recon.model.units import seconds_to_ns

SMOOTHED_CELLS = 5
"""Across: takes four fifths of the noise away, and is no wider than shadows' edges."""

CROWD_SHARE = 1.0 / 3.0
"""Of the cells: under a sky of small clouds hardly more keep their light for some seconds."""

LEAST_CELLS = 50
"""Cells that two frames must both show; fewer may all lie under one edge."""


@dataclass(frozen=True, slots=True, eq=False)
class Exposure:
    """A frame to compare with, and by what factor the camera showed it brighter than the first."""

    at_ns: int
    cells: CellLight
    gain: float = 1.0


def gain_now(
    exposure: Exposure | None, cells: CellLight, at_ns: int, settings: DetectionSettings
) -> tuple[Exposure, float]:
    """Return what to compare with from now on, and this frame's factor against the first frame."""
    if exposure is None:
        return Exposure(at_ns, cells), 1.0
    age_ns = at_ns - exposure.at_ns
    gain = exposure.gain
    if settings.follows_exposure and age_ns <= seconds_to_ns(settings.exposure_gap_s):
        gain *= float(np.exp(common_change(exposure.cells, cells, settings.exposure_spread)))
    if age_ns >= seconds_to_ns(settings.exposure_step_s):
        exposure = Exposure(at_ns, cells, gain)
    return exposure, gain


def common_change(before: CellLight, now: CellLight, spread: float) -> float:
    """Return the natural log of the factor that the crowd of cells has changed by, or 0."""
    both = before.seen & now.seen
    if np.count_nonzero(both) < LEAST_CELLS:
        return 0.0
    changes = np.zeros(both.shape, dtype=np.float32)
    changes[both] = np.log(now.light[both] / before.light[both])
    middle, width = _crowd(_smoothed(changes, both)[both])
    return middle if width <= spread else 0.0


def _smoothed(changes: FloatMap, known: MaskMap) -> FloatMap:
    """Return (R, C): means over the known cells around each; noise must not look like spread."""
    around = (SMOOTHED_CELLS, SMOOTHED_CELLS)
    shares = cv2.blur(known.astype(np.float32), around)
    means = cv2.blur(changes, around) / np.maximum(shares, 1e-6)
    return means.astype(np.float32, copy=False)


def _crowd(values: npt.NDArray[np.float32]) -> tuple[float, float]:
    """Return the mean and the width of the shortest interval that holds a third of the values."""
    ordered = np.sort(values)
    held = int(len(ordered) * CROWD_SHARE)
    widths = ordered[held:] - ordered[: len(ordered) - held]
    first = int(np.argmin(widths))
    return float(ordered[first : first + held + 1].mean(dtype=np.float64)), float(widths[first])
