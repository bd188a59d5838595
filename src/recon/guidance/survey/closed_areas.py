"""Ground where no row is flown for now, because a vehicle without telemetry may be there.

The gate refuses what leads through it. A planner that knows it flies the other rows meanwhile, and
these once the vehicle is in contact again or an operator has dismissed its hazard area.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.guidance.survey.lattice import EastNorth
from recon.guidance.survey.missions import Track
from recon.guidance.survey.plan import SurveyPlan
from recon.guidance.survey.segments import Segments
from recon.model.arrays import BoolArray


@dataclass(frozen=True, slots=True)
class ClosedArea:
    """A circle, and the route home of a vehicle that may return; the gate's margins are
    included."""

    name: str
    """The vehicle's name, for operators."""
    serial: str | None
    """None while it has not reported one."""
    place_m: EastNorth
    radius_m: float
    home_m: EastNorth | None
    """None where it is not expected to return, or its home is unknown."""
    corridor_half_m: float
    lost_s: float = 0.0
    """How long the vehicle has been without telemetry."""


def closed_ground(areas: Sequence[ClosedArea]) -> shapely.Geometry:
    """Return the ground of all areas together, in east-north metres; empty without any."""
    parts = []
    for each in areas:
        parts.append(shapely.buffer(shapely.Point(each.place_m), each.radius_m))
        if each.home_m is not None:
            path = shapely.linestrings([each.place_m, each.home_m])
            parts.append(shapely.buffer(path, each.corridor_half_m))
    return shapely.union_all(parts)


def closed_segments(ground: shapely.Geometry, segments: Segments, plan: SurveyPlan) -> BoolArray:
    """Return (S,): the segments of which a part, or the lead to it, lies on closed ground."""
    reach_m = plan.swath.lead_m + plan.swath.least_row_m
    ends = [
        (along_m, part.across_m)
        for part in segments.parts
        for along_m in (part.start_m - reach_m, part.end_m + reach_m)
    ]
    lines = shapely.linestrings(plan.lattice.east_north_m(np.array(ends)).reshape(-1, 2, 2))
    is_closed: BoolArray = np.asarray(shapely.intersects(ground, lines), dtype=np.bool_)
    return is_closed


def is_open(ground: shapely.Geometry, track: Track) -> bool:
    """Return whether no part of a track lies on closed ground."""
    path = shapely.linestrings(track.corners_m) if len(track.corners_m) > 1 else None
    place = shapely.Point(track.corners_m[0])
    return not shapely.intersects(ground, place if path is None else path)
