"""What is planned passes the gate: every flight of drawn fleets, rule by rule.

A plan that the gate refuses would leave vehicles in the air that could come home.
"""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.guidance.returning_scenes import (
    FRAME,
    SETTINGS,
    Scene,
    box,
    drawn_scene,
    keep_out,
    scene_of,
)
from tests.safety.cases import TAKEOFF, command, situation, vehicle

from recon.geo import point_from_enu
from recon.guidance.fleet_return import CalledVehicle, Pad, ReturnFlight, mission_of
from recon.model.command import FlyMission
from recon.model.geo import GeoPoint, LatLon
from recon.model.vehicle import Failsafe, VehicleState
from recon.safety import PreparedAirspace, Situation
from recon.safety.rules import Rule
from recon.safety.rules.boundary import boundary
from recon.safety.rules.dji_limits import dji_limits
from recon.safety.rules.height_zones import height_zones
from recon.safety.rules.home_distance import home_distance
from recon.safety.rules.keep_out import keep_out as keep_out_rule
from recon.safety.rules.max_height import max_height
from recon.safety.rules.min_height import min_height
from recon.safety.rules.speed import speed

RULES = (
    boundary,
    dji_limits,
    height_zones,
    home_distance,
    keep_out_rule,
    max_height,
    min_height,
    speed,
)


def on_flat_ground(scene: Scene) -> Scene:
    """The same fleet, every takeoff at the height of its pad, as the gate works it out."""
    vehicles = [replace(v, takeoff_up_m=v.pad.up_m) for v in scene.vehicles]
    airspace = scene.airspace
    ceiling_m = airspace.limits.max_height_above_ground_m
    return scene_of(vehicles, ceiling_m, airspace.zones, airspace.boundary)


def hovering(flight: ReturnFlight) -> VehicleState:
    """The state of a vehicle that hovers where its flight begins; it would hover on its own too."""
    here = point_from_enu(FRAME, (*flight.start_m[:2], 0.0))
    pad = point_from_enu(FRAME, (*flight.pad.east_north_m, 0.0))
    home = GeoPoint(pad.latitude_deg, pad.longitude_deg, FRAME.origin.ellipsoid_height_m)
    return vehicle(
        replace(TAKEOFF, pad=home, failsafe=Failsafe.HOVER),
        position=LatLon(here.latitude_deg, here.longitude_deg),
        height_above_takeoff_m=flight.start_m[2],
        takeoff_point=LatLon(pad.latitude_deg, pad.longitude_deg),
    )


def judged(scene: Scene, flight: ReturnFlight) -> Situation:
    return replace(situation(hovering(flight)), airspace=PreparedAirspace(scene.airspace))


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
@settings(max_examples=examples(25), deadline=None)
@given(
    seed=st.integers(0, 10**9),
    count=st.integers(2, 20),
    ceiling_m=st.sampled_from([30.0, 60.0, 120.0]),
    zone_count=st.integers(0, 4),
    is_fenced=st.booleans(),
)
def test_every_planned_flight_passes(
    rule: Rule, seed: int, count: int, ceiling_m: float, zone_count: int, is_fenced: bool
) -> None:
    drawn = drawn_scene(seed, count, 6, ceiling_m, zone_count, is_fenced=is_fenced)
    scene = on_flat_ground(drawn)
    for flight in scene.plan().flights:
        mission = mission_of(flight, FRAME, flight.start_m, SETTINGS, 15.0)
        refusal = rule(command(FlyMission(mission)), judged(scene, flight))
        assert refusal is None, (flight, refusal)


def test_the_rules_are_asked_for_real() -> None:
    """The control: the same flight straight through a zone, and out of the site, is refused."""
    zone = keep_out("road", box(0.0, 100.0, 20.0))
    vehicle_there = CalledVehicle("A", "A", (0.0, 200.0, 30.0), 0.0, Pad("p", 0.0, -40.0, 0.0), 0.5)
    scene = scene_of([vehicle_there], zones=(zone,), boundary=box(0.0, 100.0, 420.0))
    (flight,) = scene.plan().flights
    straight = replace(flight, path_m=(flight.path_m[0], flight.path_m[-1]))
    outside = replace(flight, path_m=(flight.path_m[0], (0.0, 900.0), flight.path_m[-1]))
    for flown, rule in ((straight, keep_out_rule), (outside, boundary)):
        mission = mission_of(flown, FRAME, flown.start_m, SETTINGS, 15.0)
        refusal = rule(command(FlyMission(mission)), judged(scene, flown))
        assert refusal is not None
        assert refusal.rule == rule.__name__
