"""The site's boundary is kept along the whole path, the route home included."""

import numpy as np
import numpy.typing as npt

from recon.geo import Polygon
from recon.model.command import Command, Refusal
from recon.safety.path.order_path import is_stop
from recon.safety.path.pieces import Kind, PathVolume, UnknownPath
from recon.safety.path.volumes import path_volume
from recon.safety.situation import Situation

RULE = "boundary"


def boundary(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a path that is not inside the site's boundary by its margin everywhere.

    Every flight, corner, route home and landing must be in the boundary, more than
    `boundary_margin_m` from its edge and its holes' edges, at every height. A vehicle that is
    already closer to the edge, or outside, may be moved if every piece that begins where it is (its
    route home from there too) goes no farther out than it is now; all else must keep the margin.
    A stick without velocity moves nowhere and is not judged. Without a boundary nothing is refused.
    """
    fence = situation.airspace.boundary
    if fence is None or is_stop(command, situation):
        return None
    path = path_volume(command, situation)
    if path is None:
        return None
    if isinstance(path, UnknownPath):
        return Refusal(RULE, path.reason)
    margin_m = situation.airspace.airspace.limits.boundary_margin_m
    if fence.has_box_in_the_middle(path.footprints.box, margin_m):
        return None
    # A climb covers what is below it.
    judged = np.flatnonzero(~path.of_kinds(Kind.CLIMB))
    outside = judged[~fence.holds(path.footprints.only(judged), margin_m)]
    outside = _worse(outside, path, fence, margin_m, situation.settings.fences.not_worse_m)
    if len(outside) == 0:
        return None
    return _refusal(path, int(outside[0]), fence, margin_m)


def _worse(
    outside: npt.NDArray[np.int64],
    path: PathVolume,
    fence: Polygon,
    margin_m: float,
    rounding_m: float,
) -> npt.NDArray[np.int64]:
    """Return the pieces that break the rule, except those that begin with it broken as much."""
    entries = path.pieces.is_entry[outside]
    if not entries.any():
        return outside
    room_m = float(fence.room_m(path.here)[0])
    if not room_m <= margin_m:
        return outside
    begins = outside[entries]
    is_worse = ~fence.holds(path.footprints.only(begins), room_m - rounding_m)
    return np.sort(np.concatenate([outside[~entries], begins[is_worse]]))


def _refusal(path: PathVolume, index: int, fence: Polygon, margin_m: float) -> Refusal:
    what = path.subject(index)
    room_m = float(fence.room_m(path.footprints.only(np.array([index])))[0])
    if room_m < 0.0:
        fault = f"{what} goes {-room_m:.1f} m beyond the site's boundary"
    else:
        fault = f"{what} comes within {room_m:.2f} m of the site's boundary"
    here_m = float(fence.room_m(path.here)[0])
    if here_m > margin_m or not path.pieces.is_entry[index]:
        reason = f"{fault}; it must stay inside, {margin_m:g} m from the edge"
    else:
        place = f"{here_m:.2f} m inside" if here_m >= 0.0 else f"{-here_m:.2f} m outside"
        reason = f"{fault}; the vehicle is {place} now and may only be moved back in"
    return Refusal(RULE, reason, parameters={"distance_inside_m": room_m, "min_m": margin_m})
