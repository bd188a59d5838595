"""Shade where a cell is darker than it was itself in the last two minutes.

Each cell's light is compared with the 90th percentile of its own samples, taken for its light in
full sun. So the ground's own pattern cancels out: dark soil is not shade. It tells nothing of a
cell that lay in shade for the whole window; such a cell looks like one in sun, and its confidence
is that of a cell that did not change.
"""

from dataclasses import replace

import numpy as np

from recon.detection.exposure import gain_now
from recon.detection.frame_step import RejectedFrame, shade_map, take_frame
from recon.detection.settings import DetectionSettings
from recon.detection.state import DetectionState, LightHistory
from recon.model.imagery import GroundImage
from recon.model.shade import SUNLIT_TRANSMITTANCE, FloatMap, ShadeMap


def brightness_ratio(
    state: DetectionState, image: GroundImage, settings: DetectionSettings
) -> tuple[DetectionState, ShadeMap | RejectedFrame]:
    """Return the state after a frame, and the shade it shows; see `recon.detection.Detector`."""
    taken = take_frame(state, image, settings)
    if isinstance(taken, RejectedFrame):
        return state, taken
    state, grid, cells = taken
    at_ns = image.captured_at_ns
    exposure, gain = gain_now(state.exposure, cells, at_ns, settings)
    light: FloatMap = cells.light / np.float32(gain)
    history = LightHistory.with_sample(state.history, at_ns, light, settings)
    state = replace(state, exposure=exposure, history=history)
    valid = cells.seen & (history.count >= settings.least_samples)
    ratio = light / history.sunlit
    transmittance = (ratio - settings.diffuse_share) / (1.0 - settings.diffuse_share)
    found = (transmittance, valid, _confidence(light, history, settings))
    return state, shade_map(image, grid, found, settings)


def _confidence(light: FloatMap, history: LightHistory, settings: DetectionSettings) -> FloatMap:
    """Return (R, C): how full the window is, times how much of sun and shade the cell has shown.

    Having been as much darker as the edge of shade is, or being it now, counts in full.
    """
    filled = np.minimum(history.count / settings.samples, 1.0)
    darkest = np.fmin(history.dark, light) / history.sunlit
    edge = (1.0 - settings.diffuse_share) * (1.0 - SUNLIT_TRANSMITTANCE)
    noise = settings.unshaded_contrast
    contrast = np.clip((1.0 - darkest - noise) / (edge - noise), 0.0, 1.0)
    flat = settings.flat_confidence
    confidence: FloatMap = (filled * (flat + (1.0 - flat) * contrast)).astype(np.float32)
    return confidence
