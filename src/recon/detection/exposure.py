"""Estimates how the camera's exposure changed from what all cells have in common.

Clouds change the light of some cells, the camera that of all cells by one factor. Between two
frames a few seconds apart the factor is the mode of the cells' changes, estimated as the mean of
the shortest interval that holds a third of them. When even that interval is wide, the light itself
is changing over the whole view and cannot be separated from the camera's part: the exposure then
counts as unchanged.
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
"""Width of the smoothing box: removes four fifths of the noise, no wider than shadow edges."""

MODE_SHARE = 1.0 / 3.0
"""Share of the cells: under small clouds hardly more keep their light for some seconds."""

LEAST_CELLS = 50
"""Cells that both frames must show; fewer may all lie under the edge of one shadow."""


@dataclass(frozen=True, slots=True, eq=False)
class Exposure:
    """A reference frame, and the camera's gain in it relative to the first frame."""

    at_ns: int
    cells: CellLight
    gain: float = 1.0


def gain_now(
    exposure: Exposure | None, cells: CellLight, at_ns: int, settings: DetectionSettings
) -> tuple[Exposure, float]:
    """Return the reference for later frames, and this frame's gain relative to the first frame.

    The reference is replaced every `exposure_step_s`, not at every frame: errors add up per step.
    """
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
    """Return the natural log of the factor common to the cells, or 0 without one."""
    both = before.seen & now.seen
    if np.count_nonzero(both) < LEAST_CELLS:
        return 0.0
    changes = np.zeros(both.shape, dtype=np.float32)
    # In logarithms the exposure is a common offset, whatever the brightness of a cell.
    changes[both] = np.log(now.light[both] / before.light[both])
    middle, width = _mode(_smoothed(changes, both)[both])
    return middle if width <= spread else 0.0


def _smoothed(changes: FloatMap, known: MaskMap) -> FloatMap:
    """Return (R, C): means over the known cells around each, so that noise is no spread."""
    around = (SMOOTHED_CELLS, SMOOTHED_CELLS)
    shares = cv2.blur(known.astype(np.float32), around)
    means = cv2.blur(changes, around) / np.maximum(shares, 1e-6)
    return means.astype(np.float32, copy=False)


def _mode(values: npt.NDArray[np.float32]) -> tuple[float, float]:
    """Return the mean and the width of the shortest interval that holds a third of the values."""
    ordered = np.sort(values)
    # Shortest interval in sorted values: a sliding window of fixed count.
    held = int(len(ordered) * MODE_SHARE)
    widths = ordered[held:] - ordered[: len(ordered) - held]
    first = int(np.argmin(widths))
    return float(ordered[first : first + held + 1].mean(dtype=np.float64)), float(widths[first])
