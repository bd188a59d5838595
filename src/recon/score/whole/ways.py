"""Where all vehicles truly were, and what came of it: photos, encounters, fences, batteries."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
import numpy.typing as npt

from recon.geo import Polygon, enu_from_point
from recon.guidance.survey import SurveyPlan
from recon.model.geo import LocalFrame
from recon.model.units import NS_PER_S
from recon.model.zone import ZoneKind
from recon.score.photos import STEEPEST_COURSE, Photos
from recon.score.settings import FLIGHT
from recon.sim.app.app import SimulatedApp
from recon.site import Site

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

AT_HEIGHT_WITHIN_M = 3.0
"""Of the survey's height: cruise heights to and from rows are 8 m apart from it."""
ON_ROW_FROM_MPS = 0.2
"""Slower, it has no course: it turns, or waits."""
LEVEL_WITH_M = 5.0
"""Two nearer than the separation are in danger when their heights are no farther apart."""
COURSE_OVER_S = 0.5


@dataclass(slots=True)
class TrueWay:
    """One vehicle's way, sampled: `places_m` east, north, up of the site's frame."""

    app: SimulatedApp
    home_m: tuple[float, float, float]
    at_s: list[float] = field(default_factory=list)
    places_m: list[tuple[float, float, float]] = field(default_factory=list)
    is_up: list[bool] = field(default_factory=list)
    landed_with: list[float] = field(default_factory=list)
    """Battery at each landing, 0 to 1."""

    def sample(self, now_ns: int) -> None:
        """Note where it is now."""
        aircraft = self.app.aircraft
        motion = aircraft.motion
        was_up = bool(self.is_up) and self.is_up[-1]
        self.at_s.append(now_ns / NS_PER_S)
        east_m, north_m, up_m = self.home_m
        place_m = (motion.east_m + east_m, motion.north_m + north_m, motion.height_m + up_m)
        self.places_m.append(place_m)
        self.is_up.append(aircraft.is_flying)
        if was_up and not aircraft.is_flying:
            self.landed_with.append(aircraft.battery.fraction)

    def at(self, moments_s: FloatArray) -> FloatArray:
        """Return places (N, 3) at some moments, between samples linear."""
        places = np.array(self.places_m)
        return np.stack([np.interp(moments_s, self.at_s, axis) for axis in places.T], axis=1)

    @property
    def flown_s(self) -> float:
        """Time in the air."""
        steps_s = np.diff(self.at_s, prepend=self.at_s[:1])
        return float(steps_s[np.array(self.is_up)].sum())


def true_way(app: SimulatedApp, frame: LocalFrame) -> TrueWay:
    """Return an app's way, with nothing on it yet."""
    east_m, north_m, up_m = enu_from_point(frame, app.settings.home).tolist()
    return TrueWay(app, (east_m, north_m, up_m))


def photos_on_rows(way: TrueWay, phase_s: float, plan: SurveyPlan) -> Photos:
    """Return the photos of a timer of that phase that were taken along rows at their height."""
    interval_s = plan.survey.camera.interval_s
    at_s = np.arange(phase_s, way.at_s[-1], interval_s)
    places = way.at(at_s)
    moved = way.at(at_s + COURSE_OVER_S)[:, :2] - way.at(at_s - COURSE_OVER_S)[:, :2]
    lying = plan.lattice.along_across_m(places[:, :2] + moved) - plan.lattice.along_across_m(
        places[:, :2]
    )
    along_m, across_m = np.abs(lying).T
    is_fast = np.hypot(*moved.T) >= 2.0 * COURSE_OVER_S * ON_ROW_FROM_MPS
    height_m = places[:, 2] - way.home_m[2]
    is_level = np.abs(height_m - plan.survey.height_above_takeoff_m) <= AT_HEIGHT_WITHIN_M
    chosen = is_fast & is_level & (across_m <= STEEPEST_COURSE * along_m)
    return Photos(at_s[chosen], places[chosen, :2])


def encounters(ways: Sequence[TrueWay]) -> int:
    """Return how often two in the air came nearer than the separation, and level."""
    count = 0
    for one, other in combinations(ways, 2):
        apart = np.array(one.places_m) - np.array(other.places_m)
        near = np.hypot(apart[:, 0], apart[:, 1]) < FLIGHT.separation_m
        near &= np.abs(apart[:, 2]) < LEVEL_WITH_M
        near &= np.array(one.is_up) & np.array(other.is_up)
        count += begins(near)
    return count


def breaches(ways: Sequence[TrueWay], site: Site) -> int:
    """Return how often one in the air left the boundary, or entered what is to be kept out of."""
    return sum(begins(_is_outside(way, site)) for way in ways)


def begins(mask: BoolArray) -> int:
    """Return how often a mask (N,) turns True."""
    return int((mask & ~np.concatenate(([False], mask[:-1]))).sum())


def _is_outside(way: TrueWay, site: Site) -> BoolArray:
    places = np.array(way.places_m)
    outside = np.zeros(len(places), dtype=np.bool_)
    if site.layers.boundary is not None:
        outside |= Polygon(site.layers.boundary).distance_to_edge_m(places[:, :2]) < 0.0
    for zone in site.layers.zones:
        if zone.kind is ZoneKind.KEEP_OUT:
            outside |= Polygon(zone.region).distance_to_edge_m(places[:, :2]) > 0.0
    is_up = np.array(way.is_up, dtype=np.bool_)
    return np.logical_and(outside, is_up, dtype=np.bool_)
