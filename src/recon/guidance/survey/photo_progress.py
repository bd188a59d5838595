"""What has been imaged, and in which light, by photos that an app has reported one by one.

Nothing is assumed of a timer: a photo shows what lies below it, less the slack of its place, and a
photo that was not taken shows nothing. It counts when it was taken at the survey's height, straight
down, and with its longer side across the rows; the light is that of the shade map nearest in time.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import cos, radians, sin

import numpy as np

from recon.guidance.survey.plan import SurveyPlan
from recon.guidance.survey.progress import (
    CoverageProgress,
    PhotoSample,
    off_height_m,
    with_95_times,
)
from recon.guidance.survey.view import crossing, nearest_map, sunlit_cells
from recon.model.arrays import BoolArray
from recon.model.flown_before import StateArray
from recon.model.survey import CellState
from recon.model.units import seconds_to_ns

LEAST_DOWN_DEG = -80.0
"""Highest gimbal pitch that counts as straight down: at -80 degrees from 60 m a photo lies 11 m
ahead of the aircraft."""
KEPT = 10_000
"""Most photos that wait to count: a vehicle takes a few while they settle."""


def with_photos(progress: CoverageProgress, seen: Sequence[PhotoSample]) -> CoverageProgress:
    """Return the progress with more photos, which count when settled."""
    if not seen:
        return progress
    return replace(progress, photos=(*progress.photos, *seen)[-KEPT:])


def count_settled_photos(
    progress: CoverageProgress, plan: SurveyPlan, now_ns: int
) -> CoverageProgress:
    """Return the progress with the photos counted that have waited long enough."""
    until_ns = now_ns - seconds_to_ns(plan.settings.settle_s)
    due = [photo for photo in progress.photos if photo.at_ns <= until_ns]
    if not due:
        return progress
    waiting = tuple(photo for photo in progress.photos if photo.at_ns > until_ns)
    state, is_sun_known = progress.state.copy(), progress.is_sun_known.copy()
    for photo in due:
        if is_taken_as_planned(photo, plan):
            _count(photo, plan, progress, state, is_sun_known)
    counted = replace(progress, photos=waiting, state=state, is_sun_known=is_sun_known)
    return with_95_times(counted, plan, until_ns)


def is_taken_as_planned(photo: PhotoSample, plan: SurveyPlan) -> bool:
    """Return whether a photo shows what one of the survey's rows would show from there."""
    off_m = off_height_m(plan, (photo,))
    if off_m is None or off_m > plan.settings.height_slack_m:
        return False
    if photo.gimbal_pitch_deg is not None and photo.gimbal_pitch_deg > LEAST_DOWN_DEG:
        return False
    turned = radians(photo.yaw_deg - plan.lattice.bearing_deg)
    return abs(sin(turned)) <= plan.settings.steepest_course * abs(cos(turned))


def _count(
    photo: PhotoSample,
    plan: SurveyPlan,
    progress: CoverageProgress,
    state: StateArray,
    is_sun_known: BoolArray,
) -> None:
    """Mark a photo's cells in the two arrays."""
    ((along_m, across_m),) = plan.lattice.along_across_m([(photo.east_m, photo.north_m)]).tolist()
    place = (along_m, across_m)
    times_ns = (photo.at_ns, photo.at_ns)
    shown = crossing(plan.cells, plan.lattice, plan.counted_swath, (place, place), times_ns)
    window = shown.window
    shade = nearest_map(progress.shade, photo.at_ns, plan.settings.shade_age_s)
    sunlit, known = sunlit_cells(shade, plan.cells.grid, window, plan.settings.least_transmittance)
    imaged = plan.cells.is_inside[window.index] & shown.is_in_view
    part = state[window.index]
    np.maximum(part, np.where(imaged, CellState.IN_SHADE, 0), out=part, casting="unsafe")
    np.maximum(part, np.where(imaged & sunlit, CellState.IN_SUN, 0), out=part, casting="unsafe")
    is_sun_known[window.index] |= imaged & known
