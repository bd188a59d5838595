"""Shade where a cell is darker than its own recent maximum.

Theory of operation, per frame:

1. `take_frame` checks the frame and averages its light over each cell of the field grid.
2. `gain_now` estimates how the camera's exposure changed since the first frame; light is divided by
   that gain, so that samples of different frames are comparable.
3. The sample joins the cell's history: at most 24 samples over two minutes.
4. The 90th percentile of a cell's samples is taken as its light in full sun. Light over that, less
   the diffuse share which shade keeps, is the transmittance of the direct beam.
5. A cell with fewer than four samples is invalid. Confidence grows with the number of samples and
   with the contrast that the cell has shown.

The ground's own pattern cancels out: dark soil is not shade. A cell in shade for the whole window
looks like one in sun; its confidence stays at that of a cell that did not change.
"""

from dataclasses import replace

import numpy as np

from recon.detection.cells import cell_light
from recon.detection.exposure import gain_now
from recon.detection.frame_step import RejectedFrame, shade_map, take_frame
from recon.detection.settings import DetectionSettings
from recon.detection.state import DetectionState, LightHistory
from recon.model.imagery import GroundImage
from recon.model.shade import SUNLIT_TRANSMITTANCE, FloatMap, ShadeMap


def brightness_ratio(
    state: DetectionState, image: GroundImage, settings: DetectionSettings
) -> tuple[DetectionState, ShadeMap | RejectedFrame]:
    """Return the state after a frame, and its shade map; see `recon.detection.Detector`."""
    taken = take_frame(state, image, settings, cell_light)
    if isinstance(taken, RejectedFrame):
        return state, taken
    state, grid, cells = taken
    at_ns = image.captured_at_ns
    exposure, gain = gain_now(state.exposure, cells, at_ns, settings)
    # Light at the exposure of the first frame, so that samples of all frames are comparable.
    light: FloatMap = cells.light / np.float32(gain)
    history = LightHistory.with_sample(state.history, at_ns, light, settings)
    state = replace(state, exposure=exposure, history=history)
    valid = cells.seen & (history.count >= settings.least_samples)
    ratio = light / history.sunlit
    # In full shade only the diffuse share is left: ratio = diffuse + (1 - diffuse) x transmittance.
    transmittance = (ratio - settings.diffuse_share) / (1.0 - settings.diffuse_share)
    found = (transmittance, valid, _confidence(light, history, settings))
    return state, shade_map(image, grid, found)


def _confidence(light: FloatMap, history: LightHistory, settings: DetectionSettings) -> FloatMap:
    """Return (R, C): how full the window is, times how much contrast the cell has shown.

    Contrast counts in full once the cell was (or is) as dark as the edge of shade.
    """
    filled = np.minimum(history.count / settings.samples, 1.0)
    # fmin ignores NaN of cells without history.
    darkest = np.fmin(history.dark, light) / history.sunlit
    edge = (1.0 - settings.diffuse_share) * (1.0 - SUNLIT_TRANSMITTANCE)
    noise = settings.unshaded_contrast
    contrast = np.clip((1.0 - darkest - noise) / (edge - noise), 0.0, 1.0)
    flat = settings.flat_confidence
    confidence: FloatMap = (filled * (flat + (1.0 - flat) * contrast)).astype(np.float32)
    return confidence
