"""A side-step: the imaging drone moves a little aside and back, so that a flat scene is decided.

Under a uniform sky no cell differs from the others, and all sun looks like all shade. In sun the
ground is brightest opposite the sun (the hot spot), and that place moves with the camera: what is
brighter there in one frame is darker in the next. Under cloud nothing moves. Pure.
"""

from dataclasses import dataclass
from math import cos, radians, sin

from recon.geo.distance import moved_m
from recon.model.geo import LatLon
from recon.model.shade import MaskMap

ACROSS_FIRST_DEG = (90.0, -90.0, 45.0, -45.0, 135.0, -135.0, 0.0, 180.0)
"""Directions from the sun's azimuth. Across it the view of the ground keeps its angle to the sun's
plane, in which ground also brightens and darkens without a hot spot."""


@dataclass(frozen=True, slots=True)
class SideStepSettings:
    """How far and how fast the imaging drone moves, and how long it may take."""

    distance_m: float = 25.0
    """Distance that at 120 m moves the hot spot by more than its own width, 4 to 8 degrees."""

    speed_mps: float = 4.0
    """25 m in about 10 s: at one frame in 2 s enough of them on the way, without motion blur."""

    leg_within_s: float = 60.0
    """A path takes 10 s; one that takes longer than this is not flown as it was ordered."""

    gate_waits_s: float = 30.0
    """Time for which a refused path back is tried again; then the vehicle holds."""

    judged_again_s: float = 1.0

    unknown_share: float = 0.5
    """Share of the ground in view from which on light counts as mostly unknown."""

    unknown_for_s: float = 20.0
    """Time that light must be unknown before the imaging drone moves. Edges of shade pass six
    times an hour: most flat views stay flat for minutes, and surveys are flown in them."""

    map_within_s: float = 10.0
    """An older shade map does not show the present light."""

    automatic_every_s: float = 300.0
    """Shortest time between two automatic ones: the sky changes in minutes; each costs view."""

    refused_again_s: float = 60.0
    """Time after a refusal before the next attempt."""


SIDE_STEP_SETTINGS = SideStepSettings()


def bearings_deg(sun_azimuth_deg: float | None) -> tuple[float, ...]:
    """Return the directions to try, clockwise from north, the best first.

    With the sun unknown, east is the first.
    """
    azimuth_deg = 0.0 if sun_azimuth_deg is None else sun_azimuth_deg
    return tuple((azimuth_deg + off_deg) % 360.0 for off_deg in ACROSS_FIRST_DEG)


def place_aside(place: LatLon, bearing_deg: float, distance_m: float) -> LatLon:
    """Return the place at a distance from another in a direction."""
    bearing = radians(bearing_deg)
    return moved_m(place, distance_m * cos(bearing), distance_m * sin(bearing))


def is_mostly_unknown(known: MaskMap, seen: MaskMap, settings: SideStepSettings) -> bool:
    """Return whether light is unknown on most of the ground in view; of no ground: False.

    Both are (R, C): the cells with a known light, and those that the frame shows.
    """
    in_view = int(seen.sum())
    unknown = int((seen & ~known).sum())
    return in_view > 0 and unknown >= settings.unknown_share * in_view
