"""Shade against a reference of the land in full sun, learned over the whole flight.

Theory of operation, per frame:

1. `cell_colour` averages light and colour (blue over red) over each cell of the field grid.
2. Every ten seconds or more a keyframe is kept. From all keyframes, `solution.solved` finds the
   land: edges that stand still are land, edges that move are shade.
3. With the land taken out, `course` finds the level of sun of all keyframes together, and `belief`
   follows it from frame to frame; a flat frame that both explain is left open.
4. `contrast.explained` finds each cell's transmittance from its light and colour against full sun.

While nothing shows which is sun and which shade, no cell is valid. What the flight has learned is
kept as a reference (`sunlit_reference_of`), which the next one adopts: `sunlit.earlier`.
"""

from dataclasses import replace

import cv2
import numpy as np

from recon.detection.frame_step import RejectedFrame, shade_map, take_frame
from recon.detection.settings import DetectionSettings
from recon.detection.state import DetectionState
from recon.detection.sunlit.colour import CellColour, cell_colour, upsampled
from recon.detection.sunlit.contrast import explained
from recon.detection.sunlit.course import change_between, spread_after
from recon.detection.sunlit.drift import followed
from recon.detection.sunlit.earlier import adopted_reference, reference_of
from recon.detection.sunlit.hot_spot import shape_of
from recon.detection.sunlit.keyframes import Keyframe, is_due, with_keyframe
from recon.detection.sunlit.levels import LEAST_CELLS
from recon.detection.sunlit.memory import SunlitMemory
from recon.detection.sunlit.solution import DOUBT, LEAST, solved
from recon.model.geo import GroundGrid
from recon.model.imagery import GroundImage
from recon.model.shade import FloatMap, MaskMap, ShadeMap, SunlitReference
from recon.model.units import NS_PER_S

SMOOTHED_CELLS = 5
"""Size of the median filter over the map: edges of shade are wider than 20 m."""


def sunlit_reference(
    state: DetectionState, image: GroundImage, settings: DetectionSettings
) -> tuple[DetectionState, ShadeMap | RejectedFrame]:
    """Return the state after a frame, and its shade map; see `recon.detection.Detector`."""
    taken = take_frame(state, image, settings, cell_colour)
    if isinstance(taken, RejectedFrame):
        return state, taken
    state, grid, fine = taken
    coarse = fine.coarse()
    memory = state.sunlit or SunlitMemory(adopted_reference(state.references, image, grid, coarse))
    memory = memory.with_detail(fine, coarse)
    drift = followed(memory.drift, coarse, memory.land, image.captured_at_ns)
    is_locked = image.exposure_locked or not settings.follows_exposure
    problem = memory.lock_problem or (drift.lock_problem() if is_locked else "")
    memory = replace(memory, drift=drift, lock_problem=problem)
    is_locked = is_locked and not problem
    memory = _with_keyframe(memory, coarse, image, grid, is_locked)
    memory = _believed(memory, coarse, image.captured_at_ns, is_locked)
    found = _unknown(fine) if memory.level is None else _transmittance(memory, fine)
    return replace(state, sunlit=memory), shade_map(image, grid, found)


def sunlit_reference_of(state: DetectionState, image: GroundImage) -> SunlitReference | None:
    """Return what a flight has learned of the land, for later ones; None while that is too little.

    `image` is its newest ground image.
    """
    if state.sunlit is None or state.grid is None:
        return None
    return reference_of(state.sunlit.keyframes, state.sunlit.land, image, state.grid)


def _with_keyframe(
    memory: SunlitMemory, coarse: CellColour, image: GroundImage, grid: GroundGrid, is_locked: bool
) -> SunlitMemory:
    at_ns, drift, shape = image.captured_at_ns, memory.drift, shape_of(image, grid)
    assert drift is not None
    if not is_due(memory.keyframes, at_ns, shape):
        return memory
    kept = with_keyframe(memory.keyframes, Keyframe(at_ns, coarse, drift.total, shape))
    found = solved(kept, memory.land, memory.adopted.earlier, is_locked)
    return replace(
        memory,
        keyframes=found.keyframes,
        land=found.land,
        belief=found.belief,
        correction=found.correction,
        believed_at_ns=at_ns,
        belief_drift=drift.total,
    )


def _believed(
    memory: SunlitMemory, coarse: CellColour, at_ns: int, is_locked: bool
) -> SunlitMemory:
    """Return the memory with the level of sun in a frame; without one where that is open."""
    land, drift = memory.land, memory.drift
    if land is None or memory.belief is None:
        return replace(memory, level=None)
    assert drift is not None
    after_s = (at_ns - memory.believed_at_ns) / NS_PER_S
    cells = coarse.seen & land.known
    belief = memory.belief
    if after_s > 0.0:
        changed = change_between(memory.belief_drift, drift.total, is_locked)
        belief = belief.later(changed, spread_after(after_s, is_locked))
        if np.count_nonzero(cells) >= LEAST_CELLS:
            light, colour = (coarse.light - land.light)[cells], (coarse.colour - land.colour)[cells]
            belief = belief.seen(light, colour, land.contrast, after_s)
    found = belief.estimate(land.contrast)
    level = found.level + memory.correction if found.doubt < DOUBT else None
    return replace(
        memory, belief=belief, level=level, believed_at_ns=at_ns, belief_drift=drift.total
    )


def _unknown(fine: CellColour) -> tuple[FloatMap, MaskMap, FloatMap]:
    nothing = np.zeros(fine.light.shape, dtype=np.float32)
    return nothing, np.zeros(fine.light.shape, dtype=np.bool_), nothing


def _transmittance(memory: SunlitMemory, fine: CellColour) -> tuple[FloatMap, MaskMap, FloatMap]:
    """Return transmittance, validity and confidence, (R, C) each."""
    land, detail = memory.land, memory.detail
    assert land is not None
    assert detail is not None
    level = memory.level
    assert level is not None
    shape = fine.light.shape
    light = fine.light - upsampled(land.light, shape) - detail.light - np.float32(level.light)
    colour = fine.colour - upsampled(land.colour, shape) - detail.colour - np.float32(level.colour)
    valid: MaskMap = np.isfinite(light) & np.isfinite(colour)
    found, _, _ = explained(light, colour, land.contrast)
    # Outside the frame as in sun: the median there must not see cells of any other value.
    smooth = cv2.medianBlur(np.where(valid, found, np.float32(1.0)), SMOOTHED_CELLS)
    transmittance = np.asarray(smooth, dtype=np.float32)
    return transmittance, valid, _confidence(memory, transmittance)


def _confidence(memory: SunlitMemory, transmittance: FloatMap) -> FloatMap:
    """Return (R, C): the share of the keyframes gathered, times the distance from the edge."""
    gathered = min(1.0, len(memory.keyframes) / (3.0 * LEAST))
    clear = np.abs(transmittance - 0.5) * 2.0
    confidence: FloatMap = (gathered * (0.3 + 0.7 * clear)).astype(np.float32)
    return confidence
