"""A shade map as the shadows' motion alone changes it, for maps of one moment."""

from dataclasses import replace

import cv2
import numpy as np

from recon.model.shade import FloatMap, ShadeMap
from recon.model.units import seconds_to_ns

CONFIDENCE_HALVES_S = 3.0
"""Time that halves a moved map's confidence: shadows change shape; the velocity is inexact."""


def moved_on(shade: ShadeMap, velocity_mps: tuple[float, float] | None, seconds: float) -> ShadeMap:
    """Return a map as the motion (east, north) alone changes it in a time, in whole cells.

    What was not seen then is not valid. The confidence halves in `CONFIDENCE_HALVES_S`.
    """
    grid, (east_mps, north_mps) = shade.grid, velocity_mps or (0.0, 0.0)
    right, down = (round(mps * seconds / grid.cell_m) for mps in (east_mps, -north_mps))
    move = np.array([[1.0, 0.0, right], [0.0, 1.0, down]])

    def moved(values: FloatMap, nowhere: float) -> FloatMap:
        size = (grid.cols, grid.rows)
        found = cv2.warpAffine(values, move, size, flags=cv2.INTER_NEAREST, borderValue=nowhere)
        return found.astype(np.float32, copy=False)

    fading = np.float32(np.exp2(-seconds / CONFIDENCE_HALVES_S))
    return replace(
        shade,
        captured_at_ns=shade.captured_at_ns + seconds_to_ns(seconds),
        transmittance=moved(shade.transmittance, float("nan")),
        valid=moved(shade.valid.astype(np.float32), 0.0) > 0.5,
        confidence=moved(shade.confidence, 0.0) * fading,
        metres_per_pixel=moved(shade.metres_per_pixel, float("nan")),
    )
