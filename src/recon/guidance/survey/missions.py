"""Missions along rows."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import dist

import numpy as np

from recon.geo import geo_from_enu
from recon.guidance.survey.lattice import AlongAcross, EastNorth, RowLattice
from recon.guidance.survey.region_paths import RegionPaths
from recon.guidance.survey.route import Route
from recon.guidance.survey.settings import SurveySettings
from recon.guidance.survey.terrain import Terrain, vertices_of
from recon.model.geo import LatLon, LocalFrame
from recon.model.mission import Mission, Waypoint
from recon.model.survey import Survey

NADIR_DEG = -90.0
LEAST_LEG_M = 1.0
"""DJI refuses waypoints nearer than 0.5 m."""


@dataclass(frozen=True, slots=True)
class Track:
    """A route with its paths between rows: the corners in east-north metres of the site.

    Of a survey above ground, waypoints that follow the ground are among them, and `up_m` is the
    height at each, up of the frame; empty: all are at the survey's height above takeoff.
    """

    corners_m: tuple[EastNorth, ...]
    up_m: tuple[float, ...] = ()

    @property
    def length_m(self) -> float:
        """Return the length from the first corner to the last."""
        return sum(dist(a, b) for a, b in pairwise(self.corners_m))

    def climbing_s(self, speed_mps: float, climb_mps: float) -> float:
        """Return how much longer its legs take than on the level: steep ones are flown slower."""
        legs = zip(pairwise(self.corners_m), pairwise(self.up_m), strict=False)
        return sum(
            max(0.0, abs(up_b - up_a) / climb_mps - dist(a, b) / speed_mps)
            for (a, b), (up_a, up_b) in legs
        )


def track_of(
    route: Route,
    lattice: RowLattice,
    lead_m: float,
    paths: RegionPaths,
    terrain: Terrain | None = None,
) -> Track | None:
    """Return where a route leads; between rows inside the paths' area, None where it has no path.

    With a terrain it follows that.
    """
    corners: list[EastNorth] = []
    for leg in route:
        start_m, end_m = _east_north(leg.ends_m(lattice, lead_m), lattice)
        if corners:
            between = paths.between(corners[-1], start_m)
            if between is None:
                return None
            corners += between
        corners += [start_m, end_m]
    thinned = _thinned(corners)
    return Track(thinned) if terrain is None else Track(*vertices_of(thinned, terrain))


def flight_time_s(
    track: Track, speed_mps: float, start_m: EastNorth, home_m: EastNorth, settings: SurveySettings
) -> float:
    """Return how long a track takes with the leg to it and the route home, stops included."""
    stops = len(track.corners_m) + 1
    path_m = dist(start_m, track.corners_m[0]) + dist(track.corners_m[-1], home_m)
    climbing_s = track.climbing_s(speed_mps, settings.climb_mps)
    moving_s = (track.length_m + path_m) / speed_mps + climbing_s
    return moving_s + stops * speed_mps / settings.turning_mps2


def approach_of(
    track: Track, start_m: EastNorth, paths: RegionPaths, frame: LocalFrame
) -> tuple[LatLon, ...]:
    """Return the corners on the way from a place to a track, as far as the paths' area has one."""
    corners_m = paths.between(paths.inside(start_m), paths.inside(track.corners_m[0]))
    if not corners_m:
        return ()
    flat_m = np.column_stack([np.array(corners_m), np.zeros(len(corners_m))])
    latitude_deg, longitude_deg, _ = geo_from_enu(frame, flat_m)
    places = zip(latitude_deg, longitude_deg, strict=True)
    return tuple(LatLon(float(latitude), float(longitude)) for latitude, longitude in places)


def mission_of(
    track: Track,
    survey: Survey,
    frame: LocalFrame,
    purpose: str,
    takeoff_up_m: float | None = None,
) -> Mission:
    """Return the mission that flies a track. It hovers at its end.

    `takeoff_up_m` is the height of the vehicle's takeoff point, known for a survey above ground.
    """
    heights_m = _heights_above_takeoff_m(track, survey, takeoff_up_m)
    flat_m = np.column_stack([np.array(track.corners_m), np.zeros(len(track.corners_m))])
    latitude_deg, longitude_deg, _ = geo_from_enu(frame, flat_m)
    return Mission(
        tuple(
            Waypoint(
                float(latitude),
                float(longitude),
                height_m,
                survey.speed_mps,
                gimbal_pitch_deg=NADIR_DEG if index == 0 else None,
            )
            for index, (latitude, longitude, height_m) in enumerate(
                zip(latitude_deg, longitude_deg, heights_m, strict=True)
            )
        ),
        purpose=purpose,
    )


def _heights_above_takeoff_m(
    track: Track, survey: Survey, takeoff_up_m: float | None
) -> Sequence[float]:
    if not track.up_m:
        return [survey.height_m] * len(track.corners_m)
    assert takeoff_up_m is not None, "a vehicle without a takeoff height is not able"
    return [round(up_m - takeoff_up_m, 2) for up_m in track.up_m]


def _east_north(ends: Sequence[AlongAcross], lattice: RowLattice) -> tuple[EastNorth, EastNorth]:
    start, end = lattice.east_north_m(np.array(ends)).tolist()
    return (start[0], start[1]), (end[0], end[1])


def _thinned(corners: Sequence[EastNorth]) -> tuple[EastNorth, ...]:
    """Return the corners without those that are too near to the one before."""
    kept: list[EastNorth] = []
    for corner in corners:
        if not kept or dist(kept[-1], corner) >= LEAST_LEG_M:
            kept.append(corner)
    return tuple(kept)
