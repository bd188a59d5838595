"""Whether pieces of a path stay above or below a height, and heights in words."""

import numpy as np

from recon.model.airspace import HeightDatum, Zone
from recon.model.arrays import BoolArray, FloatArray
from recon.safety.airspace import PreparedAirspace
from recon.safety.datum import places_m
from recon.safety.path.pieces import PathVolume
from recon.safety.situation import Situation


def stays_above(
    airspace: PreparedAirspace,
    triangles_m: FloatArray,
    low_m: FloatArray,
    height_m: float,
    datum: HeightDatum = HeightDatum.GROUND,
) -> BoolArray:
    """Return which of N pieces, (N, 3, 2) down to (N,) up_m, are nowhere below a height.

    Over the ground: the highest ground under the whole piece counts.
    """
    if datum is HeightDatum.WGS84:
        return np.asarray(low_m >= height_m - airspace.origin_height_m)
    return airspace.is_ground_below(triangles_m, low_m - height_m)


def stays_below(
    airspace: PreparedAirspace,
    triangles_m: FloatArray,
    high_m: FloatArray,
    height_m: float,
    datum: HeightDatum = HeightDatum.GROUND,
) -> BoolArray:
    """Return which of N pieces, (N, 3, 2) up to (N,) up_m, are nowhere above a height.

    Over the ground: the lowest ground under the whole piece counts.
    """
    if datum is HeightDatum.WGS84:
        return np.asarray(high_m <= height_m - airspace.origin_height_m)
    return airspace.is_ground_above(triangles_m, high_m - height_m)


def up_of(
    airspace: PreparedAirspace, here_m: FloatArray, height_m: float, datum: HeightDatum
) -> float:
    """Return the up_m of a height over a (3,) place; NaN over ground that is not known."""
    if datum is HeightDatum.WGS84:
        return height_m - airspace.origin_height_m
    return float(airspace.ground_up_m(here_m[np.newaxis, :2])[0]) + height_m


def zone_datum(zone: Zone) -> HeightDatum:
    """Return what a zone's heights count from; a zone without any needs none."""
    return zone.datum or HeightDatum.GROUND


def height_text(height_m: float, datum: HeightDatum) -> str:
    """Return a height with what it counts from."""
    return f"{height_m:g} m above {'ground' if datum is HeightDatum.GROUND else 'the ellipsoid'}"


def columns(path: PathVolume, situation: Situation, is_stop: bool) -> BoolArray:
    """Return which of the path's N pieces keep to a column of takeoff or landing, (N,).

    So does a piece of which nothing is farther than `column_radius_m` from the home, or from one of
    the site's or the vehicle's pads. And so does one that begins where the vehicle is, goes no
    farther than that from there, and no lower than the vehicle is now: a vehicle that is too low
    already may climb. (A stick without velocity: no more than `stop_slack_m` lower.)
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
