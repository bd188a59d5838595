"""Missions as drones fly them: what a survey gives, with the way there; and the way home."""

import numpy as np

from recon.geo import enu_from_geo, geo_from_enu
from recon.guidance.fleet_return import FleetReturnSettings
from recon.model.geo import LatLon, LocalFrame
from recon.model.mission import Mission
from recon.model.stamped import Stamped
from recon.model.vehicle import VehicleState
from recon.score.autopilot import Point
from recon.score.flight import Spot
from recon.score.scenario import Place, Scenario
from recon.station.operations.survey.approach import with_approach

RETURN = FleetReturnSettings()


def survey_points(
    mission: Mission, at_m: Spot, number: int, scenario: Scenario
) -> tuple[list[Point], int]:
    """Return a survey's mission with its ways as the station adds them, and where rows begin.

    `number` counts the survey's vehicles from 0.
    """
    vehicle, count = _vehicle(at_m, scenario.frame), len(scenario.fleet.serials)
    flown = with_approach(mission, vehicle, number, count, scenario.site.limits)
    return points_of(flown, scenario.frame), flown.waypoints.index(mission.waypoints[0])


def points_of(mission: Mission, frame: LocalFrame) -> list[Point]:
    """Return a mission's waypoints in metres of the site; the ground is level."""
    height_m = frame.origin.ellipsoid_height_m
    latitude = np.array([each.latitude_deg for each in mission.waypoints])
    longitude = np.array([each.longitude_deg for each in mission.waypoints])
    places = enu_from_geo(frame, latitude, longitude, np.full(len(latitude), height_m))
    return [
        Point(
            (east_m, north_m, each.height_above_takeoff_m),
            each.speed_mps,
            each.loiter_s or 0.0,
            each.corner_radius_m,
        )
        for each, (east_m, north_m, _up_m) in zip(mission.waypoints, places.tolist(), strict=True)
    ]


def way_home(at_m: Spot, pad_m: Place, layer: int) -> list[Point]:
    """Return the way of a fleet return, in the `layer`th height from the lowest."""
    height_m = RETURN.lowest_layer_m + layer * RETURN.layer_spacing_m
    return [
        Point((east_m, north_m, height_m), RETURN.speed_mps)
        for east_m, north_m in (at_m[:2], pad_m)
    ]


def _vehicle(at_m: Spot, frame: LocalFrame) -> VehicleState:
    """What the station must know of a vehicle to plan its way."""
    latitude, longitude, _height = geo_from_enu(frame, [(at_m[0], at_m[1], 0.0)])
    place = LatLon(float(latitude[0]), float(longitude[0]))
    return VehicleState(None, position=Stamped(place), height_above_takeoff_m=Stamped(at_m[2]))
