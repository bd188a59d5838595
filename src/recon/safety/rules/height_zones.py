"""No path in a height zone is lower than its floor or higher than its ceiling."""

import numpy as np

from recon.model.airspace import ZoneKind
from recon.model.command import Command, Refusal
from recon.safety.airspace import PreparedZone
from recon.safety.heights import columns, height_text, stays_above, stays_below, up_of, zone_datum
from recon.safety.path.order_path import is_stop
from recon.safety.path.pieces import PathVolume, UnknownPath
from recon.safety.path.volumes import path_volume
from recon.safety.situation import Situation

RULE = "height_zones"


def height_zones(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a path that is too low or too high in a height zone.

    It holds for every piece whose footprint is not more than `boundary_margin_m` from the zone's
    region, and for all of that piece: no lower than the floor (over the ground: above the highest
    ground under the piece), no higher than the ceiling (above the lowest). A landing is as low as
    the ground. Not held to the floor is what keeps to a column of takeoff or landing: `columns`
    states which; a mission's landing place in a zone is not such a column. When the vehicle is in
    the zone now, a piece that begins where it is may be as high above the ceiling's datum as it is.
    A stick without velocity is held to zones that the vehicle is in, with `stop_slack_m`; where the
    vehicle is not known to be, it is not judged.
    """
    airspace = situation.airspace
    path = path_volume(command, situation) if airspace.zones_of(ZoneKind.HEIGHT) else None
    if path is None:
        return None
    stops = is_stop(command, situation)
    if isinstance(path, UnknownPath):
        return None if stops else Refusal(RULE, path.reason)
    margin_m = airspace.airspace.limits.boundary_margin_m
    for zone in airspace.zones_near(ZoneKind.HEIGHT, path.footprints, margin_m):
        refusal = _fault(zone, path, situation, stops)
        if refusal is not None:
            return refusal
    return None


def _fault(
    zone: PreparedZone, path: PathVolume, situation: Situation, stops: bool
) -> Refusal | None:
    airspace, settings, pieces = situation.airspace, situation.settings.fences, path.pieces
    margin_m = 0.0 if stops else airspace.airspace.limits.boundary_margin_m
    slack_m = settings.stop_slack_m if stops else 0.0
    near = np.flatnonzero(~zone.polygon.is_clear_of(path.footprints, margin_m))
    triangles_m, datum = pieces.triangles_m[near], zone_datum(zone.zone)
    floor_m, ceiling_m = zone.zone.floor_m, zone.zone.ceiling_m
    if floor_m is not None:
        low_m = pieces.low_m[near] + slack_m
        is_low = ~stays_above(airspace, triangles_m, low_m, floor_m, datum)
        if is_low.any():
            is_low &= ~columns(path, situation, stops)[near]
        if is_low.any():
            limit = f"fly no lower than {height_text(floor_m, datum)} there"
            return _refusal(zone, path, int(near[is_low][0]), limit)
    if ceiling_m is not None:
        high_m = pieces.high_m[near] - slack_m
        is_high = ~stays_below(airspace, triangles_m, high_m, ceiling_m, datum)
        if is_high.any() and not zone.polygon.is_clear_of(path.here, margin_m)[0]:
            most_m = float(path.here_m[2]) - up_of(airspace, path.here_m, 0.0, datum)
            most_m += settings.not_worse_m
            is_no_higher = stays_below(airspace, triangles_m, pieces.high_m[near], most_m, datum)
            is_high &= ~(pieces.is_entry[near] & is_no_higher)
        if is_high.any():
            limit = f"fly no higher than {height_text(ceiling_m, datum)} there"
            return _refusal(zone, path, int(near[is_high][0]), limit)
    return None


def _refusal(zone: PreparedZone, path: PathVolume, index: int, limit: str) -> Refusal:
    limits = {"min_m": zone.zone.floor_m, "max_m": zone.zone.ceiling_m}
    return Refusal(
        RULE,
        f"{path.subject(index)} is at {path.heights(index)} in the height zone "
        f"{zone.zone.name!r}; {limit}",
        parameters={
            "zone": zone.zone.name,
            **path.height_parameters(index),
            **{name: limit_m for name, limit_m in limits.items() if limit_m is not None},
        },
    )
