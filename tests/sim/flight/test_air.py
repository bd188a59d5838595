"""Wind: it is leaned against, it costs time and battery, gusts push, sticks drift."""

from dataclasses import replace
from itertools import pairwise
from math import hypot

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.model.units import NS_PER_S
from recon.model.vehicle import FlightMode
from recon.safety.energy import Consumption
from recon.safety.settings import EnergySettings
from recon.sim.flight.air import Air, Squall
from recon.sim.flight.aircraft import Aircraft, AircraftSettings
from recon.sim.flight.battery import Battery, flying_load
from recon.sim.flight.flight_modes import PositionHold, Stick
from recon.sim.flight.kinematics import AircraftMotion, Limits, VelocityDemand, step
from recon.sim.flight.mission import MissionPoint
from recon.sim.world import Wind, WindSettings

STEADY = WindSettings(
    speed_10m_mps=6.0,
    heading_deg=180.0,
    shear_exponent=0.0,
    veer_deg_per_100m=0.0,
    gust_intensity=0.0,
)
"""To the south, 6 m/s at every height, without a gust."""
GUSTY = replace(STEADY, gust_intensity=0.25, seed=3)
ENDURANCE_S = 1_000.0


def in_wind(settings: WindSettings, north_m: float = 0.0, height_m: float = 40.0) -> Aircraft:
    return Aircraft(
        0,
        motion=AircraftMotion(north_m=north_m, height_m=height_m),
        active_mode=PositionHold(),
        battery=Battery(1.0, ENDURANCE_S),
        air=Air(Wind(settings)),
    )


def out_to(north_m: float, speed_mps: float) -> tuple[MissionPoint, ...]:
    return (MissionPoint(0.0, 0.0, 40.0, speed_mps), MissionPoint(north_m, 0.0, 40.0, speed_mps))


def flown_s(flights, aircraft: Aircraft, north_m: float, speed_mps: float) -> float:
    """Return how long a flight to a place straight north takes from where the aircraft is."""
    start = MissionPoint(aircraft.motion.north_m, 0.0, 40.0, speed_mps)
    aircraft.fly_mission((start, MissionPoint(north_m, 0.0, 40.0, speed_mps)), False, False)
    return flights.fly_until(aircraft, lambda a: a.flight_mode is FlightMode.GPS_ATTI)


def test_a_steady_wind_is_compensated_by_tilt(flights) -> None:
    aircraft = in_wind(STEADY)
    motion = flights.fly_on(aircraft, 60.0)
    assert hypot(motion.north_m, motion.east_m) < 1e-6
    # The air goes south past a nose to the north: it leans forward.
    assert motion.pitch_deg == pytest.approx(-7.7, abs=0.5)
    assert aircraft.air.warning_level == 1


def test_it_is_slower_against_the_wind_and_not_faster_with_it(flights) -> None:
    aircraft = in_wind(STEADY)
    against_s = flown_s(flights, aircraft, 500.0, 15.0)
    with_s = flown_s(flights, aircraft, 0.0, 15.0)
    # 17 m/s through the air are 11 over the ground; each start and stop costs some seconds.
    assert against_s == pytest.approx(500.0 / 11.0, abs=6.0)
    assert with_s == pytest.approx(500.0 / 15.0, abs=7.5)
    assert against_s > 500.0 / 11.0
    assert with_s > 500.0 / 15.0


def test_a_wind_faster_than_the_aircraft_carries_it_along() -> None:
    motion, demand = AircraftMotion(), VelocityDemand(velocity_north_mps=10.0)
    for _ in range(400):
        motion = step(motion, demand, 0.05, Limits(), (-20.0, 0.0))
    assert motion.velocity_north_mps == pytest.approx(-3.0)


velocities = st.tuples(st.floats(-14.0, 14.0), st.floats(-14.0, 14.0))


@given(velocities, velocities)
def test_a_course_is_kept_within_the_airspeed(asked, wind) -> None:
    limits = Limits()
    motion = AircraftMotion()
    for _ in range(400):
        motion = step(motion, VelocityDemand(*asked), 0.05, limits, wind)
    north, east = motion.velocity_north_mps, motion.velocity_east_mps
    assert hypot(north - wind[0], east - wind[1]) <= limits.airspeed_mps + 1e-6
    if hypot(*wind) < limits.airspeed_mps:
        assert north * asked[1] - east * asked[0] == pytest.approx(0.0, abs=1e-6)
        assert north * asked[0] + east * asked[1] >= -1e-6


def test_gusts_displace_by_metres_and_the_aircraft_returns(flights) -> None:
    aircraft = in_wind(replace(GUSTY, speed_10m_mps=8.0))
    away = [hypot(m.north_m, m.east_m) for m in flights.fly(aircraft, 600.0)]
    assert 0.2 < max(away) < 4.0
    assert away[-1] < 3.0


def test_gusts_are_the_same_for_the_same_seed(flights) -> None:
    def track(seed: int) -> list[AircraftMotion]:
        return list(flights.fly(in_wind(replace(GUSTY, seed=seed)), 60.0))

    assert track(3) == track(3)
    assert track(3) != track(4)


def test_gusts_do_not_depend_on_how_often_it_is_advanced(flights) -> None:
    often, seldom = in_wind(GUSTY), in_wind(GUSTY)
    for now_ns in range(0, 20 * NS_PER_S, 7_000_000):
        often.advance(now_ns)
    often.advance(20 * NS_PER_S)
    seldom.advance(20 * NS_PER_S)
    assert often.motion == seldom.motion


def test_sticks_drift_with_the_wind(flights) -> None:
    aircraft = in_wind(STEADY)
    aircraft.stick(Stick(False, 0.0, 0.0, 0.0, 40.0, 60.0, Limits()))
    assert flights.fly_on(aircraft, 10.0).velocity_north_mps == pytest.approx(-0.48)


def test_a_landing_in_gusts_stops_for_its_confirmation(flights) -> None:
    for seed in range(4):
        aircraft = in_wind(replace(GUSTY, speed_10m_mps=9.0, seed=seed), height_m=15.0)
        aircraft.land()
        flights.fly_until(aircraft, lambda a: a.flight_mode is FlightMode.CONFIRM_LANDING, 120.0)
        assert aircraft.motion.height_m > 0.15
        flights.fly_until(aircraft, lambda a: a.is_on_ground, 60.0)


def test_an_aircraft_on_the_ground_stays_where_it_stands(flights) -> None:
    aircraft = Aircraft(0, air=Air(Wind(GUSTY)))
    assert flights.fly_on(aircraft, 60.0) == AircraftMotion()
    aircraft.take_off()
    flights.fly_on(aircraft, 1.4)
    assert aircraft.motion.north_m == 0.0


def test_without_gnss_it_drifts_with_the_wind(flights) -> None:
    aircraft = in_wind(STEADY)
    aircraft.fly_mission(out_to(300.0, 8.0), False, False)
    flights.fly_on(aircraft, 10.0)
    aircraft.lose_gnss()
    assert aircraft.flight_mode is FlightMode.ATTI
    aircraft.fly_mission(out_to(300.0, 8.0), False, False)
    aircraft.go_home()
    assert aircraft.flight_mode is FlightMode.ATTI
    assert flights.fly_on(aircraft, 15.0).velocity_north_mps == pytest.approx(-6.0)
    aircraft.find_gnss()
    assert aircraft.flight_mode is FlightMode.GPS_ATTI
    assert flights.fly_on(aircraft, 15.0).ground_speed_mps == pytest.approx(0.0, abs=0.01)


def test_a_squall_comes_in_gusts_and_ends(flights) -> None:
    aircraft = flights.hovering()
    aircraft.air.begin_squall(Squall(heading_deg=90.0), aircraft.now_ns)
    felt = []
    for _ in flights.fly(aircraft, 16.0):
        felt.append(aircraft.air.felt[1])
    assert max(felt) == pytest.approx(9.0, abs=0.1)
    assert sum(a < 4.5 <= b for a, b in pairwise(felt)) == 2
    assert 0.2 < aircraft.motion.east_m < 4.0 or max(abs(v) for v in aircraft.air.push) > 0.0
    aircraft.air.end_squall()
    assert flights.fly_on(aircraft, 30.0).ground_speed_mps < 0.01


def test_climbing_costs_most_and_loads_are_those_of_the_curve() -> None:
    still = (0.0, 0.0)
    assert flying_load(AircraftMotion(), still) == 1.0
    assert flying_load(AircraftMotion(velocity_north_mps=9.0), still) == pytest.approx(1.0)
    assert flying_load(AircraftMotion(velocity_east_mps=15.0), still) == pytest.approx(1.25)
    assert flying_load(AircraftMotion(), (0.0, -15.0)) == pytest.approx(1.25)
    assert flying_load(AircraftMotion(velocity_up_mps=2.6), still) == pytest.approx(1.416)
    assert flying_load(AircraftMotion(velocity_up_mps=-3.2), still) == pytest.approx(0.872)


def gates_view(aircraft: Aircraft) -> Consumption:
    """Return the station's energy model of this aircraft, in the wind that it warns of."""
    energy = EnergySettings()
    wind_load = energy.wind_loads[aircraft.air.warning_level]
    return Consumption(ENDURANCE_S, wind_load, aircraft.settings.go_home_height_m, energy)


@pytest.mark.parametrize(
    ("wind_mps", "speed_mps"),
    [(w, s) for w in (0.0, 4.9, 6.9, 9.9) for s in (2.0, 5.0, 8.0, 10.0) if s <= 8.0 or w < 7.0],
)
@pytest.mark.parametrize("leg_m", [15.0, 60.0, 400.0])
def test_the_gates_energy_model_is_more_pessimistic_than_a_flight(
    flights, wind_mps: float, speed_mps: float, leg_m: float
) -> None:
    for north_m in (leg_m, -leg_m):
        aircraft = in_wind(replace(STEADY, speed_10m_mps=wind_mps))
        flights.fly_on(aircraft, 0.1)
        uses, start, end = gates_view(aircraft), (0.0, 0.0, 40.0), (north_m, 0.0, 40.0)
        before = aircraft.battery.fraction
        flown_s(flights, aircraft, north_m, speed_mps)
        # The mission starts where it is: that waypoint costs the leg's start and stop once more.
        predicted = uses.leg(start, start, speed_mps) + uses.leg(start, end, speed_mps)
        assert before - aircraft.battery.fraction <= predicted


@pytest.mark.parametrize("wind_mps", [0.0, 4.9, 7.9, 9.9])
@pytest.mark.parametrize("height_m", [10.0, 90.0])
def test_the_gates_route_home_is_more_pessimistic_than_the_flown_one(
    flights, wind_mps: float, height_m: float
) -> None:
    aircraft = in_wind(replace(STEADY, speed_10m_mps=wind_mps), -400.0, height_m)
    aircraft.settings = AircraftSettings(go_home_height_m=50.0)
    flights.fly_on(aircraft, 0.1)
    before, predicted = (
        aircraft.battery.fraction,
        gates_view(aircraft).home((-400.0, 0.0, height_m)),
    )
    aircraft.go_home()
    flights.fly_until(aircraft, lambda a: a.is_on_ground)
    assert before - aircraft.battery.fraction <= predicted
