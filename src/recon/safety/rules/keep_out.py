"""Keep-out zones are kept out of along the whole path, the route home included."""

import numpy as np

from recon.model.airspace import Zone, ZoneKind
from recon.model.arrays import BoolArray, FloatArray, IntArray
from recon.model.command import Command, Refusal
from recon.safety.airspace import PreparedZone
from recon.safety.heights import (
    height_text,
    stays_above,
    stays_below,
    up_of,
    zone_datum,
)
from recon.safety.path.order_path import is_stop
from recon.safety.path.pieces import PathVolume, UnknownPath
from recon.safety.path.volumes import path_volume
from recon.safety.situation import Situation

RULE = "keep_out"


def keep_out(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a path that enters a keep-out zone or comes too close to one.

    A piece is clear of a zone when its footprint is more than `boundary_margin_m` from the zone's
    region, or all of it is above the ceiling, or below the floor, by `zone_vertical_margin_m`. A
    ceiling over the ground counts from the highest ground under the whole piece, a floor from the
    lowest. All pieces are judged, climbs and landings too.
    A vehicle that is itself too close to a zone may be moved if every piece that begins where it is
    goes no deeper: no farther in, from above the ceiling no lower, from below the floor no higher.
    A stick without velocity is held to the zones without the margins, and may be `stop_slack_m`
    beyond their floors and ceilings; where the vehicle's position is unknown, it is not judged.
    """
    airspace = situation.airspace
    path = path_volume(command, situation) if airspace.zones_of(ZoneKind.KEEP_OUT) else None
    if path is None:
        return None
    stops = is_stop(command, situation)
    if isinstance(path, UnknownPath):
        return None if stops else Refusal(RULE, path.reason)
    margin_m = airspace.airspace.limits.boundary_margin_m
    for zone in airspace.zones_near(ZoneKind.KEEP_OUT, path.footprints, margin_m):
        entered = _Judged(zone, path, situation, stops).worse()
        if entered is not None:
            return _refusal(zone, path, entered, situation)
    return None


class _Judged:
    """One zone and one path."""

    def __init__(
        self, zone: PreparedZone, path: PathVolume, situation: Situation, stops: bool
    ) -> None:
        settings = situation.settings.fences
        self.polygon, self.zone, self.path = zone.polygon, zone.zone, path
        self.airspace = situation.airspace
        margin_m = self.airspace.airspace.limits.boundary_margin_m
        self.gap_m = 0.0 if stops else margin_m
        self.vertical_m = -settings.stop_slack_m if stops else settings.zone_vertical_margin_m
        self.rounding_m = settings.not_worse_m

    def worse(self) -> int | None:
        """The first piece that enters the zone, and does so more than the vehicle's position."""
        pieces, footprints = self.path.pieces, self.path.footprints
        entered = np.flatnonzero(~self.polygon.is_clear_of(footprints, self.gap_m))
        is_met = self._meets(
            pieces.triangles_m[entered], pieces.low_m[entered], pieces.high_m[entered]
        )
        entered = entered[is_met]
        if len(entered) == 0:
            return None
        if self._is_in_it():
            entries = entered[pieces.is_entry[entered]]
            entered = np.setdiff1d(entered, entries[self._is_no_deeper(entries)])
        return int(entered[0]) if len(entered) > 0 else None

    def _meets(self, triangles_m: FloatArray, low_m: FloatArray, high_m: FloatArray) -> BoolArray:
        """Which pieces have a height of the zone, or come too close to one."""
        zone, datum = self.zone, zone_datum(self.zone)
        is_over = is_under = np.zeros(len(triangles_m), dtype=np.bool_)
        if zone.ceiling_m is not None:
            over_m = low_m - self.vertical_m
            is_over = stays_above(self.airspace, triangles_m, over_m, zone.ceiling_m, datum)
        if zone.floor_m is not None:
            under_m = high_m + self.vertical_m
            is_under = stays_below(self.airspace, triangles_m, under_m, zone.floor_m, datum)
        return ~(is_over | is_under)

    def _is_in_it(self) -> bool:
        """Whether the vehicle's height is one of the zone's: one beside it would go deeper."""
        up_m = self.path.here_m[2:]
        return bool(self._meets(self.path.here_triangle_m, up_m, up_m)[0])

    def _is_no_deeper(self, indices: IntArray) -> BoolArray:
        """Which pieces go no farther in, and no nearer to the zone's heights, than it is now."""
        zone, datum, here_m = self.zone, zone_datum(self.zone), self.path.here_m
        pieces, up_m = self.path.pieces, float(here_m[2])
        gap_m = -float(self.polygon.room_m(self.path.here)[0])
        no_deeper = self.polygon.is_clear_of(
            self.path.footprints.only(indices), gap_m - self.rounding_m
        )
        if zone.ceiling_m is not None and up_m >= up_of(
            self.airspace, here_m, zone.ceiling_m, datum
        ):
            no_deeper &= pieces.low_m[indices] >= up_m - self.rounding_m
        if zone.floor_m is not None and up_m <= up_of(self.airspace, here_m, zone.floor_m, datum):
            no_deeper &= pieces.high_m[indices] <= up_m + self.rounding_m
        return no_deeper


def _refusal(zone: PreparedZone, path: PathVolume, index: int, situation: Situation) -> Refusal:
    margin_m = situation.airspace.airspace.limits.boundary_margin_m
    vertical_m = situation.settings.fences.zone_vertical_margin_m
    gap_m = float(zone.polygon.gap_m(path.footprints.only(np.array([index])))[0])
    verb = "goes through" if gap_m == 0.0 else f"comes within {gap_m:.2f} m of"
    return Refusal(
        RULE,
        f"{path.subject(index)} {verb} the keep-out zone {zone.zone.name!r}{_extent(zone.zone)} at "
        f"{path.heights(index)}; the margin is {margin_m:g} m horizontally"
        f"{_vertically(zone.zone, vertical_m)}",
        parameters={
            "zone": zone.zone.name,
            "gap_m": gap_m,
            "min_m": margin_m,
            "min_vertical_m": vertical_m,
        },
    )


def _extent(zone: Zone) -> str:
    ends = []
    if zone.floor_m is not None:
        ends.append(f"from {height_text(zone.floor_m, zone_datum(zone))}")
    if zone.ceiling_m is not None:
        ends.append(f"up to {height_text(zone.ceiling_m, zone_datum(zone))}")
    return f" ({' '.join(ends)})" if ends else ""


def _vertically(zone: Zone, margin_m: float) -> str:
    has_end = zone.floor_m is not None or zone.ceiling_m is not None
    return f" or {margin_m:g} m vertically" if has_end else ""
