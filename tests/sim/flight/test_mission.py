"""Missions: every waypoint is reached, no limit is exceeded, corners are rounded."""

from itertools import pairwise
from math import hypot, sqrt

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from tests.examples import examples

from recon.geo.path import rounded_path as geo_rounded_path
from recon.model.vehicle import FlightMode
from recon.sim.flight.kinematics import AircraftMotion, Limits
from recon.sim.flight.mission import MissionPoint
from recon.sim.flight.path import Corner, rounded_path

LIMITS = Limits()
SECONDS = 0.05

# A flight takes long: a failing example is shown as it was found, not shrunk for minutes.
QUICK = (Phase.explicit, Phase.reuse, Phase.generate)

points = st.builds(
    MissionPoint,
    north_m=st.floats(-150.0, 150.0),
    east_m=st.floats(-150.0, 150.0),
    height_m=st.floats(15.0, 60.0),
    speed_mps=st.floats(2.0, 15.0),
    corner_radius_m=st.floats(0.2, 40.0),
)


def assert_limits_kept(track: list[AircraftMotion]) -> None:
    for before, after in pairwise(track):
        assert after.ground_speed_mps <= LIMITS.speed_mps + 1e-6
        assert -LIMITS.descent_mps - 1e-6 <= after.velocity_up_mps <= LIMITS.climb_mps + 1e-6
        change = hypot(
            after.velocity_north_mps - before.velocity_north_mps,
            after.velocity_east_mps - before.velocity_east_mps,
        )
        assert change <= LIMITS.acceleration_mps2 * SECONDS + 1e-6


def closest_m(track: list[AircraftMotion], point: MissionPoint) -> float:
    return min(
        hypot(m.north_m - point.north_m, m.east_m - point.east_m, m.height_m - point.height_m)
        for m in track
    )


def segment_distance_m(point: np.ndarray, start: np.ndarray, end: np.ndarray) -> float:
    along = float(np.clip((point - start) @ (end - start) / ((end - start) @ (end - start)), 0, 1))
    return float(np.linalg.norm(point - start - along * (end - start)))


def flown(flights, mission: tuple[MissionPoint, ...], curved: bool) -> list[AircraftMotion]:
    aircraft = flights.hovering(height_m=20.0)
    aircraft.fly_mission(mission, curved, lands_at_end=False)
    assert aircraft.flight_mode is FlightMode.GPS_WAYPOINT
    track = []
    while aircraft.flight_mode is FlightMode.GPS_WAYPOINT:
        track.append(flights.fly_on(aircraft, SECONDS))
        assert len(track) < 40_000, "the mission does not end"
    return track


@settings(max_examples=examples(25), deadline=None, phases=QUICK)
@given(st.lists(points, min_size=2, max_size=6))
def test_stopping_missions_reach_every_waypoint_within_the_limits(flights, mission) -> None:
    track = flown(flights, tuple(mission), curved=False)
    assert_limits_kept(track)
    for point in mission:
        assert closest_m(track, point) < 0.6
    assert track[-1].ground_speed_mps < 0.5


@settings(max_examples=examples(25), deadline=None, phases=QUICK)
@given(st.lists(points, min_size=2, max_size=6))
def test_curved_missions_stay_near_their_path_and_end_at_the_last_waypoint(
    flights, mission
) -> None:
    track = flown(flights, tuple(mission), curved=True)
    assert_limits_kept(track)
    assert closest_m(track, mission[0]) < 0.6
    assert closest_m(track[-1:], mission[-1]) < 1.5


@pytest.mark.parametrize("turn_back_m", [(0.0, 0.0), (0.5, 10.0), (20.0, 1.0)])
def test_reversals_are_flown_to_their_end(flights, turn_back_m) -> None:
    mission = tuple(
        MissionPoint(n, e, h, 15.0, r)
        for n, e, h, r in (
            (150.0, 20.0, 15.0, 0.2),
            (-150.0, 0.5, 15.0, 40.0),
            (150.0, 0.0, 20.0, 1.0),
            (*turn_back_m, 60.0, 0.2),
        )
    )
    track = flown(flights, mission, curved=True)
    assert_limits_kept(track)
    assert closest_m(track[-1:], mission[-1]) < 1.5


def test_a_curved_flight_does_not_stop_at_its_corners_and_follows_the_curve(flights) -> None:
    mission = tuple(
        MissionPoint(n, e, 20.0, 6.0, r)
        for n, e, r in ((0.0, 20.0, 0.2), (120.0, 20.0, 20.0), (120.0, 140.0, 0.2))
    )
    track = flown(flights, mission, curved=True)
    corner = [m for m in track if hypot(m.north_m - 120.0, m.east_m - 20.0) < 25.0]
    assert min(m.ground_speed_mps for m in corner) > 3.0
    # The quadratic curve's middle is a quarter of |start - 2 corner + end| from the corner.
    assert closest_m(corner, mission[1]) == pytest.approx(20.0 * 2.0**0.5 / 4.0, abs=0.5)
    on_curve = [m for m in corner if m.north_m > 101.0 and m.east_m < 39.0]
    assert on_curve
    for m in on_curve:
        # From the corner back x and ahead y: sqrt x + sqrt y = sqrt r.
        shares = sqrt(max(0.0, 120.0 - m.north_m) / 20.0), sqrt(max(0.0, m.east_m - 20.0) / 20.0)
        assert sum(shares) == pytest.approx(1.0, abs=0.08)


def test_a_corner_is_cut_as_the_shared_geometry_cuts_it() -> None:
    """The station's fences and the simulator's aircraft read a radius the same way."""
    waypoints = [(0.0, 0.0, 20.0), (120.0, 20.0, 30.0), (40.0, 90.0, 25.0), (60.0, 200.0, 25.0)]
    radii = [0.2, 30.0, 25.0, 0.2]
    path = rounded_path(
        [Corner(*place, radius, 6.0) for place, radius in zip(waypoints, radii, strict=True)],
        LIMITS,
    )
    shared = geo_rounded_path(waypoints, radii, chord_error_m=0.001).points_m
    for point in path.points_m:
        distances = [segment_distance_m(point, a, b) for a, b in pairwise(shared)]
        assert min(distances) < 0.005


def test_loiter_and_gimbal_are_done_at_the_waypoint(flights) -> None:
    aircraft = flights.hovering(height_m=20.0)
    aircraft.gimbal.pitch_deg = aircraft.gimbal.wanted_deg = 0.0
    mission = (
        MissionPoint(0.0, 0.0, 20.0, 5.0, loiter_s=4.0, gimbal_pitch_deg=-60.0),
        MissionPoint(40.0, 0.0, 20.0, 5.0),
    )
    aircraft.fly_mission(mission, is_curved=False, lands_at_end=False)
    waited_s = flights.fly_until(aircraft, lambda a: a.motion.north_m > 0.1, 20.0)
    assert 4.0 <= waited_s < 5.5
    assert aircraft.gimbal.pitch_deg == pytest.approx(-60.0)


def test_the_gimbal_is_waited_for(flights) -> None:
    aircraft = flights.hovering(height_m=20.0)
    aircraft.gimbal.pitch_deg = aircraft.gimbal.wanted_deg = 0.0
    mission = (
        MissionPoint(0.0, 0.0, 20.0, 5.0, gimbal_pitch_deg=-90.0),
        MissionPoint(40.0, 0.0, 20.0, 5.0),
    )
    aircraft.fly_mission(mission, is_curved=False, lands_at_end=False)
    assert flights.fly_until(aircraft, lambda a: a.motion.north_m > 0.1, 20.0) >= 3.0


def test_a_mission_lands_at_its_end_when_requested(flights) -> None:
    aircraft = flights.hovering(height_m=20.0)
    mission = (MissionPoint(10.0, 0.0, 15.0, 5.0), MissionPoint(30.0, 10.0, 15.0, 5.0))
    aircraft.fly_mission(mission, is_curved=False, lands_at_end=True)
    flights.fly_until(aircraft, lambda a: a.is_on_ground, 120.0)
    assert (aircraft.motion.north_m, aircraft.motion.east_m) == pytest.approx((30.0, 10.0), abs=0.7)


def test_a_mission_from_the_ground_takes_off_first(flights) -> None:
    aircraft = flights.hovering(height_m=20.0)
    aircraft.land()
    flights.fly_until(aircraft, lambda a: a.is_on_ground, 60.0)
    mission = (MissionPoint(10.0, 0.0, 15.0, 5.0), MissionPoint(30.0, 10.0, 15.0, 5.0))
    aircraft.fly_mission(mission, is_curved=False, lands_at_end=False)
    assert aircraft.flight_mode is FlightMode.AUTO_TAKEOFF
    flights.fly_until(aircraft, lambda a: a.flight_mode is FlightMode.GPS_WAYPOINT, 10.0)
    # Straight up to the first waypoint's height before going there.
    flights.fly_until(aircraft, lambda a: a.motion.ground_speed_mps > 0.2, 30.0)
    assert aircraft.motion.height_m > 13.5


def test_a_mission_replaces_a_mission_and_counts(flights) -> None:
    aircraft = flights.hovering(height_m=20.0)
    first = (MissionPoint(200.0, 0.0, 20.0, 10.0), MissionPoint(300.0, 0.0, 20.0, 10.0))
    second = (MissionPoint(0.0, -50.0, 20.0, 10.0), MissionPoint(0.0, -90.0, 20.0, 10.0))
    aircraft.fly_mission(first, is_curved=False, lands_at_end=False)
    flights.fly_on(aircraft, 5.0)
    assert aircraft.mission_id == 1
    aircraft.fly_mission(second, is_curved=False, lands_at_end=False)
    assert aircraft.mission_id == 2
    flights.fly_until(aircraft, lambda a: a.mission_id == 0, 60.0)
    assert aircraft.motion.east_m == pytest.approx(-90.0, abs=0.7)


def test_the_legs_before_a_tight_corner_are_flown_at_full_speed(flights) -> None:
    mission = tuple(
        MissionPoint(n, e, 20.0, 12.0) for n, e in ((0.0, 0.0), (150.0, 0.0), (150.0, 150.0))
    )
    track = flown(flights, mission, curved=True)
    on_first_leg = [m.ground_speed_mps for m in track if 60.0 < m.north_m < 90.0]
    assert min(on_first_leg) == pytest.approx(12.0, abs=0.5)
    assert len(track) * SECONDS < 60.0


corners = st.builds(
    Corner,
    north_m=st.floats(-300.0, 300.0),
    east_m=st.floats(-300.0, 300.0),
    height_m=st.floats(10.0, 100.0),
    radius_m=st.floats(0.2, 100.0),
    speed_mps=st.floats(1.0, 15.0),
)


@given(st.lists(corners, min_size=2, max_size=8))
def test_paths_are_finite_connected_and_end_at_rest(path_corners: list[Corner]) -> None:
    path = rounded_path(path_corners, LIMITS)
    gaps = ((path.points_m[1:] - path.points_m[:-1]) ** 2).sum(axis=1) ** 0.5
    assert gaps.max(initial=0.0) < 1.0
    assert path.speeds_mps[-1] == 0.0
    assert (path.speeds_mps[:-1] >= 0.0).all()
    last = path_corners[-1]
    assert tuple(path.points_m[-1]) == pytest.approx((last.north_m, last.east_m, last.height_m))
