"""No path is lower above ground than the site allows, except for takeoff and landing."""

import numpy as np

from recon.model.command import Command, Refusal
from recon.safety.datum import is_ground_assumed_flat
from recon.safety.heights import columns, stays_above
from recon.safety.path.order_path import is_stop
from recon.safety.path.pieces import PathVolume, UnknownPath
from recon.safety.path.volumes import path_volume
from recon.safety.situation import Situation

RULE = "min_height"
_CLIMB_FIRST = "; climb straight up first (a mission's first waypoint may be above the vehicle)"


def min_height(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a path that comes too near to the ground.

    Every flight, corner and route home must be at least `min_height_above_ground_m` above the
    highest ground under the whole piece; without an elevation model the ground is assumed flat.
    Exempt are landings and what keeps to a column of takeoff or landing: see `columns`. Outside the
    elevation model the path is refused. A stick without velocity may be `stop_slack_m` lower; where
    the vehicle's position is unknown, it is not judged.
    """
    path = path_volume(command, situation)
    if path is None:
        return None
    stops = is_stop(command, situation)
    if isinstance(path, UnknownPath):
        return None if stops else Refusal(RULE, path.reason)
    slack_m = situation.settings.fences.stop_slack_m if stops else 0.0
    least_m = situation.airspace.airspace.limits.min_height_above_ground_m - slack_m
    pieces = path.pieces
    lowest_m = float(pieces.low_m.min())
    if situation.airspace.is_surely_above(path.footprints.box, lowest_m, least_m):
        return None
    judged = path.held_to_heights
    is_high_enough = stays_above(
        situation.airspace, pieces.triangles_m[judged], pieces.low_m[judged], least_m
    )
    low = judged[~is_high_enough]
    if len(low) == 0:
        return None
    low = low[~columns(path, situation, stops)[low]]
    return None if len(low) == 0 else _refusal(path, int(low[0]), situation)


def _refusal(path: PathVolume, index: int, situation: Situation) -> Refusal:
    least_m = situation.airspace.airspace.limits.min_height_above_ground_m
    pieces = path.pieces
    what = path.subject(index)
    triangle_m = pieces.triangles_m[[index]]
    highest_m = float(situation.airspace.ground_within_up_m(triangle_m)[1][0])
    if highest_m == np.inf:
        return Refusal(RULE, f"{what} goes over ground outside the site's elevation model")
    above_m = float(pieces.low_m[index]) - highest_m
    flat = " (flat ground assumed)" if is_ground_assumed_flat(situation.airspace) else ""
    low_now = path.here_m[2] <= pieces.low_m[index] and bool(pieces.is_entry[index])
    what_to_do = _CLIMB_FIRST if low_now else ""
    return Refusal(
        RULE,
        f"{what} must be at least {least_m:g} m above ground{flat} outside takeoff and landing; "
        f"got {above_m:.1f} m{what_to_do}",
        parameters={"height_above_ground_m": above_m, "min_m": least_m},
    )
