"""Missions along rows, and the shortest paths between rows inside the region.

The paths are found by Dijkstra's search on a visibility graph of the region's corners.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from heapq import heappop, heappush
from itertools import pairwise
from math import dist

import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.geo import geo_from_enu
from recon.guidance.survey.lattice import AlongAcross, EastNorth, RowLattice
from recon.guidance.survey.route import Route
from recon.guidance.survey.settings import SurveySettings
from recon.guidance.survey.terrain import Terrain, vertices_of
from recon.model.arrays import FloatArray
from recon.model.geo import LatLon, LocalFrame
from recon.model.mission import Mission, Waypoint
from recon.model.survey import Survey

CLEARANCE_M = 0.25
"""Corners of a way stand this far off the edge, so that rounding never crosses it."""

OFF_PLACE_M = 3.0
"""A vehicle at the end of a row is no farther off it: GNSS and braking."""

MOST_CORNERS = 400
"""Of the area; from there on it is taken a little smaller, with fewer corners."""

COARSEST_M = 50.0
"""A region that has more corners even so has no room to spare."""


class RegionPaths:
    """Shortest ways in one area; what it has worked out it keeps."""

    def __init__(self, area: shapely.Geometry) -> None:
        self.area = area
        self._corners = _corners(area)
        self._seen: dict[int, list[tuple[int, float]]] = {}
        shapely.prepare(area)

    def between(self, start_m: EastNorth, end_m: EastNorth) -> tuple[EastNorth, ...] | None:
        """Return the corners on the way, none where it is straight; None where there is no way."""
        if self._is_open(np.array([start_m]), end_m)[0]:
            return ()
        return self._around(start_m, end_m)

    def inside(self, place_m: EastNorth) -> EastNorth:
        """Return the place, or the nearest one `CLEARANCE_M` inside the area if it is not far off.

        Rows end on the edge, and a vehicle stops some way beyond it.
        """
        inner = shapely.buffer(self.area, -CLEARANCE_M)
        place = shapely.Point(place_m)
        if inner.is_empty or shapely.covers(inner, place):
            return place_m
        nearest = shapely.get_point(shapely.shortest_line(inner, place), 0)
        is_far = shapely.distance(nearest, place) > OFF_PLACE_M
        return place_m if is_far else (float(nearest.x), float(nearest.y))

    def _around(self, start_m: EastNorth, end_m: EastNorth) -> tuple[EastNorth, ...] | None:
        """Dijkstra's search over the corners, from the start to the first that sees the end."""
        sees_end = self._is_open(self._corners, end_m)
        waiting = [(far_m, corner, -1) for corner, far_m in self._visible_from(start_m)]
        waiting.sort()
        before: dict[int, int] = {}
        best: tuple[float, int] | None = None
        while waiting:
            far_m, corner, previous = heappop(waiting)
            if best is not None and far_m >= best[0]:
                break
            if corner in before:
                continue
            before[corner] = previous
            if sees_end[corner]:
                total_m = far_m + dist(self._corners[corner], end_m)
                best = min(best or (total_m, corner), (total_m, corner))
            for neighbour, leg_m in self._neighbours(corner):
                if neighbour not in before:
                    heappush(waiting, (far_m + leg_m, neighbour, corner))
        return None if best is None else self._back(best[1], before)

    def _back(self, corner: int, before: dict[int, int]) -> tuple[EastNorth, ...]:
        way: list[EastNorth] = []
        while corner >= 0:
            way.append((float(self._corners[corner][0]), float(self._corners[corner][1])))
            corner = before[corner]
        return tuple(reversed(way))

    def _neighbours(self, corner: int) -> list[tuple[int, float]]:
        if corner not in self._seen:
            place = self._corners[corner]
            self._seen[corner] = self._visible_from((float(place[0]), float(place[1])))
        return self._seen[corner]

    def _visible_from(self, place_m: EastNorth) -> list[tuple[int, float]]:
        open_to = np.flatnonzero(self._is_open(self._corners, place_m))
        return [(int(each), dist(self._corners[each], place_m)) for each in open_to]

    def _is_open(self, places_m: FloatArray, end_m: EastNorth) -> npt.NDArray[np.bool_]:
        """Which of N places see one straight, (N,)."""
        ends = np.broadcast_to(np.array(end_m), places_m.shape)
        legs = shapely.linestrings(np.stack([places_m, ends], axis=1))
        is_inside: npt.NDArray[np.bool_] = shapely.covers(self.area, legs)
        is_there: npt.NDArray[np.bool_] = (places_m == ends).all(axis=1)
        return is_inside | is_there


def _corners(area: shapely.Geometry) -> FloatArray:
    """Corners to turn at, a little inside the area; of a round edge only some."""
    inner = shapely.buffer(area, -CLEARANCE_M, join_style="mitre")
    tolerance_m = CLEARANCE_M
    while shapely.get_num_coordinates(inner) > MOST_CORNERS and tolerance_m < COARSEST_M:
        # What is left out lies farther in than the clearance by as much as it may be off.
        farther_in = shapely.buffer(area, -CLEARANCE_M - tolerance_m, join_style="mitre")
        inner = shapely.simplify(farther_in, tolerance_m)
        tolerance_m *= 2.0
    corners: FloatArray = np.unique(shapely.get_coordinates(inner), axis=0)
    return corners


NADIR_DEG = -90.0
LEAST_LEG_M = 1.0
"""DJI refuses waypoints nearer than 0.5 m."""


@dataclass(frozen=True, slots=True)
class Track:
    """A route with its ways between rows: the corners in east-north metres of the site.

    Of a survey above ground, waypoints that follow the ground are among them, and `up_m` is the
    height at each, up of the frame; empty: all are at the survey's height above takeoff.
    """

    corners_m: tuple[EastNorth, ...]
    up_m: tuple[float, ...] = ()

    @property
    def length_m(self) -> float:
        """From the first corner to the last."""
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
    ways: RegionPaths,
    terrain: Terrain | None = None,
) -> Track | None:
    """Return where a route leads; between rows inside the ways' area, None where it has no way.

    With a terrain it follows that.
    """
    corners: list[EastNorth] = []
    for leg in route:
        start_m, end_m = _east_north(leg.ends_m(lattice, lead_m), lattice)
        if corners:
            between = ways.between(corners[-1], start_m)
            if between is None:
                return None
            corners += between
        corners += [start_m, end_m]
    thinned = _thinned(corners)
    return Track(thinned) if terrain is None else Track(*vertices_of(thinned, terrain))


def flight_time_s(
    track: Track, speed_mps: float, start_m: EastNorth, home_m: EastNorth, settings: SurveySettings
) -> float:
    """Return how long a track takes with the way to it and the way home, stops included."""
    stops = len(track.corners_m) + 1
    way_m = dist(start_m, track.corners_m[0]) + dist(track.corners_m[-1], home_m)
    climbing_s = track.climbing_s(speed_mps, settings.climb_mps)
    moving_s = (track.length_m + way_m) / speed_mps + climbing_s
    return moving_s + stops * speed_mps / settings.turning_mps2


def approach_of(
    track: Track, start_m: EastNorth, ways: RegionPaths, frame: LocalFrame
) -> tuple[LatLon, ...]:
    """Return the corners on the way from a place to a track, as far as the ways' area has one."""
    corners_m = ways.between(ways.inside(start_m), ways.inside(track.corners_m[0]))
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
    """Without the corners that are too near to the one before."""
    kept: list[EastNorth] = []
    for corner in corners:
        if not kept or dist(kept[-1], corner) >= LEAST_LEG_M:
            kept.append(corner)
    return tuple(kept)
