"""No path leads farther from home than the site allows."""

import numpy as np

from recon.model.command import Command, Refusal
from recon.safety.path.order_path import is_stop
from recon.safety.path.pieces import Kind, UnknownPath
from recon.safety.path.volumes import path_volume
from recon.safety.situation import Situation

RULE = "home_distance"
ROUNDING_M = 1e-6


def home_distance(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a path of which any point is farther than `max_distance_from_home_m` from home.

    The distance is horizontal. Flights count: a corner and the route home are nowhere farther than
    the legs they begin on. A piece that begins where the vehicle is may go as far as the vehicle is
    now. A stick without velocity moves nowhere and is not judged.
    """
    if is_stop(command, situation):
        return None
    path = path_volume(command, situation)
    if path is None:
        return None
    if isinstance(path, UnknownPath):
        return Refusal(RULE, path.reason)
    limit_m = situation.airspace.airspace.limits.max_distance_from_home_m
    pieces, home_m = path.pieces, path.home_m[:2]
    if path.footprints.box.farthest_m(*home_m.tolist()) <= limit_m - ROUNDING_M:
        return None
    # The farthest point of a hull is one of its corners.
    far_m = np.linalg.norm(pieces.triangles_m - home_m, axis=-1).max(axis=1)
    here_m = float(np.linalg.norm(path.here_m[:2] - home_m))
    no_farther_m = here_m + situation.settings.fences.not_worse_m
    allowed_m = np.where(pieces.is_entry, max(limit_m, no_farther_m), limit_m)
    judged = path.of_kinds(Kind.FLIGHT)
    far = np.flatnonzero(judged & ~(far_m <= allowed_m))
    if len(far) == 0:
        return None
    index = int(far[0])
    return Refusal(
        RULE,
        f"{path.subject(index)} must stay within {limit_m:g} m of home; got {far_m[index]:.1f} m",
        parameters={"distance_from_home_m": float(far_m[index]), "max_m": limit_m},
    )
