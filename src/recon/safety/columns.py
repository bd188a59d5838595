"""Where a vehicle may be near the ground: the columns of takeoff and landing."""

import numpy as np
import numpy.typing as npt

from recon.safety.airspace import PreparedAirspace
from recon.safety.datum import places_m
from recon.safety.path.pieces import PathVolume
from recon.safety.situation import Situation

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]


def columns(path: PathVolume, situation: Situation, is_stop: bool) -> BoolArray:
    """Return which of the path's N pieces keep to a column of takeoff or landing, (N,).

    So does a piece of which nothing is farther than `column_radius_m` from the home, or from one of
    the site's or the vehicle's pads. And so does one that begins where the vehicle is, goes no
    farther than that from there, and no lower than the vehicle is now: who is too low already may
    climb. (A stick without velocity: no more than `stop_slack_m` lower.)
    """
    settings, pieces = situation.settings.fences, path.pieces
    radius_m = settings.column_radius_m
    slack_m = settings.stop_slack_m if is_stop else settings.not_worse_m
    within = np.zeros(len(pieces), dtype=np.bool_)
    for centre_m in _centres_m(path, situation.airspace):
        within |= _reach_m(pieces.triangles_m, centre_m) <= radius_m
    is_here = _reach_m(pieces.triangles_m, path.here_m[:2]) <= radius_m
    is_no_lower = pieces.low_m >= path.here_m[2] - slack_m
    return np.asarray(within | (pieces.is_entry & is_here & is_no_lower))


def _centres_m(path: PathVolume, airspace: PreparedAirspace) -> FloatArray:
    """Home and the pads, (N, 2)."""
    profile = path.departure.vehicle.profile
    places = [pad.place for pad in airspace.airspace.landing_pads]
    if profile is not None and profile.pad is not None:
        places.append(profile.pad)
    pads_m = places_m(path.departure.frame, places)
    return np.concatenate([path.home_m[np.newaxis, :2], pads_m])


def _reach_m(triangles_m: FloatArray, centre_m: FloatArray) -> FloatArray:
    """How far the farthest corner of each (N, 3, 2) triangle is from a place, (N,)."""
    offsets_m = triangles_m - centre_m
    return np.asarray(np.hypot(offsets_m[..., 0], offsets_m[..., 1]).max(axis=1))
