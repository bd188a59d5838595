"""A survey's estimate as flights that other programs fly: each from its first row to its last."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import dist

import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.geo import geo_from_enu, point_from_enu
from recon.guidance.survey import Surveyor, SurveyPlan
from recon.guidance.survey.estimate import SurveyEstimate
from recon.guidance.survey.lattice import EastNorth
from recon.guidance.survey.missions import LEAST_LEG_M, Track, mission_of
from recon.guidance.survey.route import Route
from recon.model.geo import LatLon
from recon.model.survey import WhenDone
from recon.plans.flight_plan import AtEnd, ExportedPlan, PhotoTrigger, RowGround

TOUCHING_M = 0.05
"""Bands of rows are grown by this before they are joined: neighbours share an edge."""


def flight_plans(
    plan: SurveyPlan,
    needs: SurveyEstimate,
    fleet: Sequence[Surveyor],
    names: Mapping[str, str],
    *,
    by_distance: bool = False,
) -> list[ExportedPlan]:
    """Return every drone's flights; `names` are those of the drones by serial.

    Photos are by the survey's timer, or by distance at the same spacing. Where no path over free
    ground leads from a row to the next, the flight ends, and another begins.
    """
    surveyors = {each.serial: each for each in fleet}
    found: list[ExportedPlan] = []
    for drone in needs.drones:
        flights = [part for flight in drone.flights for part in _connected(plan, flight.route)]
        for number, (route, track) in enumerate(flights, start=1):
            name = f"{names.get(drone.serial, drone.serial)}, flight {number}"
            flown = _flown(plan, route, track, surveyors[drone.serial], name)
            found.append(replace(flown, photos=_photos(plan, by_distance=by_distance)))
    return found


def _connected(plan: SurveyPlan, route: Route) -> list[tuple[Route, Track]]:
    """Return a route's parts with a path through each, usually all of it."""
    parts: list[tuple[Route, Track]] = []
    whole = plan.track(route)
    if whole is not None:
        return [(route, whole)]
    for leg in route:
        longer = (*parts[-1][0], leg) if parts else (leg,)
        track = plan.track(longer)
        if parts and track is not None:
            parts[-1] = (longer, track)
            continue
        alone = plan.track((leg,))
        assert alone is not None  # one row has no path between rows
        parts.append(((leg,), alone))
    return parts


def _photos(plan: SurveyPlan, *, by_distance: bool) -> PhotoTrigger:
    camera = plan.survey.camera
    if by_distance:
        return PhotoTrigger(every_m=camera.interval_s * plan.survey.speed_mps)
    return PhotoTrigger(every_s=camera.interval_s)


def _flown(
    plan: SurveyPlan, route: Route, track: Track, surveyor: Surveyor, name: str
) -> ExportedPlan:
    survey, frame = plan.survey, plan.frame
    mission = mission_of(track, survey, frame, name, surveyor.takeoff_up_m)
    home_m, up_m = surveyor.home_m or surveyor.place_m, surveyor.takeoff_up_m
    home = point_from_enu(frame, (*home_m, up_m or 0.0))
    hovers = survey.when_done is WhenDone.HOVER
    return ExportedPlan(
        survey.name,
        name,
        mission.waypoints,
        at_end=AtEnd.HOVER if hovers else AtEnd.RETURN_HOME,
        curved=mission.curved,
        rows=_rows(plan, route, track),
        takeoff=LatLon(home.latitude_deg, home.longitude_deg),
        takeoff_ellipsoid_height_m=None if up_m is None else home.ellipsoid_height_m,
        ground=_ground(plan, route),
    )


def _rows(plan: SurveyPlan, route: Route, track: Track) -> tuple[tuple[int, int], ...]:
    """Return the first and the last waypoint of each row, in order."""
    found: list[tuple[int, int]] = []
    at = 0
    for leg in route:
        ends_m = plan.lattice.east_north_m(leg.ends_m(plan.lattice, plan.swath.lead_m)).tolist()
        first = _index_of(track, (ends_m[0][0], ends_m[0][1]), at)
        last = _index_of(track, (ends_m[1][0], ends_m[1][1]), first + 1)
        found.append((first, last))
        at = last
    return tuple(found)


def _index_of(track: Track, place_m: EastNorth, start: int) -> int:
    """Return the first corner from `start` on at a place; tracks leave out what is nearer."""
    corners = track.corners_m
    near = (i for i in range(start, len(corners)) if dist(corners[i], place_m) < LEAST_LEG_M)
    return next(near, len(corners) - 1)


def _ground(plan: SurveyPlan, route: Route) -> RowGround:
    """Return the bands of a flight's rows as areas; one with a hole is split no further."""
    lattice, half_m = plan.lattice, plan.lattice.spacing_m / 2.0
    bands = [
        shapely.box(
            leg.piece.start_m,
            lattice.row_across_m(leg.piece.row) - half_m - TOUCHING_M,
            leg.piece.end_m,
            lattice.row_across_m(leg.piece.row) + half_m + TOUCHING_M,
        )
        for leg in route
    ]
    areas = shapely.get_parts(shapely.union_all(bands))
    return RowGround(
        tuple(_ring(plan, area) for area in areas if not len(area.interiors)),
        lattice.bearing_deg,
        plan.swath.photo_m,
        lattice.spacing_m,
    )


def _ring(plan: SurveyPlan, area: shapely.Geometry) -> tuple[LatLon, ...]:
    corners_m = shapely.get_coordinates(area.exterior)[:-1]
    flat = shapely.get_coordinates(
        shapely.transform(shapely.LineString(corners_m), plan.lattice.east_north_m)
    )
    latitude_deg, longitude_deg, _ = geo_from_enu(
        plan.frame, [(east_m, north_m, 0.0) for east_m, north_m in flat.tolist()]
    )
    places = zip(latitude_deg.tolist(), longitude_deg.tolist(), strict=True)
    return tuple(LatLon(latitude, longitude) for latitude, longitude in places)
