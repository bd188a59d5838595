"""No path is higher above ground than the site allows, the route home included."""

from math import inf

import numpy as np

from recon.model.arrays import IntArray
from recon.model.command import Command, Refusal, VirtualStick
from recon.safety.datum import is_ground_assumed_flat
from recon.safety.heights import stays_below
from recon.safety.path.order_path import as_sent, is_stop
from recon.safety.path.pieces import Kind, PathVolume, UnknownPath
from recon.safety.path.volumes import path_volume
from recon.safety.situation import Situation

RULE = "max_height"


def max_height(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a path that goes too high above ground.

    Every flight, corner and route home must be at most `max_height_above_ground_m` above the lowest
    ground under the whole piece; without an elevation model the ground is assumed flat. A path
    home is at the go-home height; while that is unknown, the path is refused. A piece that begins
    where the vehicle is may be as high above the lowest ground under it as the vehicle is above
    ground now. A stick without velocity may be `stop_slack_m` higher; while the vehicle's
    position is unknown, its height above takeoff counts.
    """
    path = path_volume(command, situation)
    if path is None:
        return None
    if isinstance(path, UnknownPath):
        return _blind(command, situation, path)
    stops = is_stop(command, situation)
    settings = situation.settings.fences
    limit_m = situation.airspace.airspace.limits.max_height_above_ground_m
    most_m = limit_m + (settings.stop_slack_m if stops else 0.0)
    highest_m = float(path.pieces.high_m.max())
    if situation.airspace.is_surely_below(path.footprints.box, highest_m, most_m):
        return None
    high = _higher(path, path.held_to_heights, situation, most_m)
    if len(high) == 0:
        return None
    high = _worse(path, high, situation, settings.not_worse_m)
    return None if len(high) == 0 else _refusal(path, int(high[0]), situation)


def _higher(path: PathVolume, indices: IntArray, situation: Situation, most_m: float) -> IntArray:
    """Which of these pieces are more than this above the lowest ground under them."""
    pieces = path.pieces
    is_low_enough = stays_below(
        situation.airspace, pieces.triangles_m[indices], pieces.high_m[indices], most_m
    )
    return indices[~is_low_enough]


def _worse(path: PathVolume, high: IntArray, situation: Situation, rounding_m: float) -> IntArray:
    """Return the pieces that break the rule, except those that the vehicle breaks as much now."""
    begins = high[path.pieces.is_entry[high]]
    if len(begins) == 0:
        return high
    ground_m = float(situation.airspace.ground_up_m(path.here_m[np.newaxis, :2])[0])
    if np.isnan(ground_m):
        return high
    here_m = float(path.here_m[2]) - ground_m
    worse = _higher(path, begins, situation, here_m + rounding_m)
    return np.setdiff1d(high, np.setdiff1d(begins, worse))


def _blind(command: Command, situation: Situation, unknown: UnknownPath) -> Refusal | None:
    """A stop of a vehicle without a position still requests a height."""
    body = command.body
    if not isinstance(body, VirtualStick) or not is_stop(command, situation):
        return Refusal(RULE, unknown.reason)
    vehicle, settings = situation.vehicle, situation.settings.fences
    limit_m = situation.airspace.airspace.limits.max_height_above_ground_m
    height_m = as_sent(body.height_above_takeoff_m)
    here_m = None if vehicle is None else vehicle.height_above_takeoff_m.value
    no_higher_m = -inf if here_m is None else here_m + settings.not_worse_m
    if height_m <= max(limit_m + settings.stop_slack_m, no_higher_m):
        return None
    return Refusal(
        RULE,
        f"Height must be at most {limit_m:g} m above takeoff; got {height_m:.1f} m",
        parameters={"height_above_takeoff_m": height_m, "max_m": limit_m},
    )


def _refusal(path: PathVolume, index: int, situation: Situation) -> Refusal:
    limit_m = situation.airspace.airspace.limits.max_height_above_ground_m
    pieces = path.pieces
    if pieces.high_m[index] == inf:
        vehicle = path.departure.vehicle
        return Refusal(
            RULE,
            f"{vehicle.display_name}: go-home height unknown; write go_home_height_m, as set in "
            f'the aircraft, into site.toml under [[vehicles]] serial = "{vehicle.serial}"',
        )
    what = path.subject(index)
    triangle_m = pieces.triangles_m[[index]]
    lowest_m = float(situation.airspace.ground_within_up_m(triangle_m)[0][0])
    if lowest_m == -inf:
        return Refusal(RULE, f"{what} goes over ground outside the site's elevation model")
    above_m = float(pieces.high_m[index]) - lowest_m
    flat = " (flat ground assumed)" if is_ground_assumed_flat(situation.airspace) else ""
    is_home = pieces.kinds[index] == Kind.ROUTE_HOME
    lower = "; set a lower go-home height in the aircraft and in site.toml" if is_home else ""
    return Refusal(
        RULE,
        f"{what} must be at most {limit_m:g} m above ground{flat}; got {above_m:.1f} m{lower}",
        parameters={"height_above_ground_m": above_m, "max_m": limit_m},
    )
