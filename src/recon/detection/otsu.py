"""Shade where a single frame is dark, by Otsu's threshold. A baseline for comparison.

N. Otsu, A threshold selection method from gray-level histograms, IEEE Trans. SMC 9 (1979). It
needs no history, takes dark soil for shade, and always finds two classes, even in clear sky.
"""

import cv2
import numpy as np
import numpy.typing as npt

from recon.detection.cells import cell_light
from recon.detection.frame_step import RejectedFrame, shade_map, take_frame
from recon.detection.settings import DetectionSettings
from recon.detection.state import DetectionState
from recon.model.imagery import GroundImage
from recon.model.shade import SUNLIT_TRANSMITTANCE, FloatMap, ShadeMap


def otsu(
    state: DetectionState, image: GroundImage, settings: DetectionSettings
) -> tuple[DetectionState, ShadeMap | RejectedFrame]:
    """Return the state after a frame, and its shade map; see `recon.detection.Detector`."""
    taken = take_frame(state, image, settings, cell_light)
    if isinstance(taken, RejectedFrame):
        return state, taken
    state, grid, cells = taken
    levels: FloatMap = 255.0 * cells.light ** np.float32(1.0 / settings.gamma)
    transmittance, separation = _two_classes(levels, levels[cells.seen])
    confidence = np.full(levels.shape, separation, dtype=np.float32)
    return state, shade_map(image, grid, (transmittance, cells.seen, confidence))


def _two_classes(levels: FloatMap, seen: npt.NDArray[np.float32]) -> tuple[FloatMap, float]:
    """Return the transmittance (R, C), and the share of variance between the classes, in [0, 1].

    The threshold is the edge of shade, the darker class's mean full shade, the brighter one's full
    sun; linear in between.
    """
    whole = np.rint(seen).astype(np.uint8)
    threshold, _ = cv2.threshold(whole, 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)
    is_bright = whole > threshold
    if is_bright.all() or not is_bright.any():
        return np.ones_like(levels), 0.0
    # Levels are whole numbers: the threshold lies between two of them.
    edge = threshold + 0.5
    dark, bright = float(seen[~is_bright].mean()), float(seen[is_bright].mean())
    # np.interp needs rising points even when a class is empty or at the threshold.
    places = (min(dark, edge - 0.1), edge, max(bright, edge + 0.1))
    transmittance: FloatMap = np.interp(levels, places, (0.0, SUNLIT_TRANSMITTANCE, 1.0)).astype(
        np.float32
    )
    share = float(is_bright.mean())
    between = share * (1.0 - share) * (bright - dark) ** 2
    return transmittance, min(1.0, between / max(float(seen.var()), 1e-9))
