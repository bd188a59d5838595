"""Shade that has left the view is followed: a map of where it has moved since.

An imaging drone that hovers upwind of the field sees clouds before they are over it, and not the
field itself. What shades a cell that is not in view was in view earlier, upwind of it. So each such
cell has the value of the newest kept map that saw its shade, moved on by the common velocity; the
longer ago that was, the less confidence. What is in view and unknown stays unknown, and motion is
never measured in followed shade.
"""

from dataclasses import replace

import cv2
import numpy as np

from recon.forecast.motion import ShadowMotion
from recon.forecast.settings import ForecastSettings
from recon.forecast.state import ForecastState
from recon.forecast.upwind import upwind
from recon.model.shade import FloatMap, ShadeMap
from recon.model.units import ns_to_seconds, seconds_to_ns


def with_recent(state: ForecastState, shade: ShadeMap, settings: ForecastSettings) -> ForecastState:
    """Return the state with a whole map kept, once per `keep_every_s`, as long as it is used."""
    at_ns, every_ns = shade.captured_at_ns, seconds_to_ns(settings.keep_every_s)
    recent = tuple(one for one in state.recent if one.grid == shade.grid)
    if recent and at_ns // every_ns == recent[-1].captured_at_ns // every_ns:
        return state
    oldest_ns = at_ns - seconds_to_ns(settings.followed_for_s)
    recent = tuple(one for one in recent if one.captured_at_ns >= oldest_ns)
    return replace(state, recent=(*recent, shade))


def with_followed(
    state: ForecastState, motion: ShadowMotion | None, settings: ForecastSettings
) -> ForecastState:
    """Return the state with its newest map and the shade followed from the kept ones.

    Without a motion, or without knowing what is in view, nothing is followed.
    """
    newest = state.newest
    if motion is None or state.in_view is None:
        return replace(state, followed=newest)
    parts = (newest.transmittance, newest.confidence, newest.metres_per_pixel)
    values, known = [part.copy() for part in parts], newest.valid.copy()
    left = ~(newest.valid | state.in_view)
    for before in reversed(state.recent):
        age_s = ns_to_seconds(newest.captured_at_ns - before.captured_at_ns)
        if not 0.0 < age_s <= settings.followed_for_s or before.grid != newest.grid:
            continue
        if not left.any():
            break
        to_then = upwind(newest.grid, motion, age_s)
        added = (_moved(before.valid.astype(np.float32), to_then) > 0.5) & left
        older = (before.transmittance, before.confidence, before.metres_per_pixel)
        for value, part in zip(values, older, strict=True):
            value[added] = _moved(part, to_then)[added]
        values[1][added] *= np.float32(np.exp(-age_s / settings.followed_memory_s))
        known |= added
        left &= ~added
    transmittance, confidence, metres_per_pixel = values
    return replace(
        state,
        followed=replace(
            newest,
            transmittance=transmittance,
            valid=known,
            confidence=confidence,
            metres_per_pixel=metres_per_pixel,
        ),
    )


def _moved(values: FloatMap, to_then: np.ndarray) -> FloatMap:
    """Return (R, C): each cell's value at the place and time it came from; 0 beyond the grid."""
    size = (values.shape[1], values.shape[0])
    how = cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP
    moved = cv2.warpAffine(values, to_then, size, flags=how, borderMode=cv2.BORDER_CONSTANT)
    found: FloatMap = moved.astype(np.float32, copy=False)
    return found
