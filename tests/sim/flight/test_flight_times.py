"""Times and distances of plain flights, worked out by hand from the airframe's limits."""

import pytest

from recon.model.vehicle import FlightMode
from recon.sim.flight.aircraft import Aircraft, AircraftSettings
from recon.sim.flight.flight_modes import PositionHold, Stick
from recon.sim.flight.kinematics import AircraftMotion, Limits
from recon.sim.flight.mission import MissionPoint

TICK_S = 0.05


def stick(speed_mps: float, height_m: float, yaw_deg: float = 0.0) -> Stick:
    return Stick(False, yaw_deg, speed_mps, 0.0, height_m, 600.0, Limits())


def test_ten_metres_a_second_take_four_seconds_and_twenty_metres(flights) -> None:
    aircraft = flights.hovering()
    aircraft.stick(stick(10.0, 30.0))
    taken_s = flights.fly_until(aircraft, lambda a: a.motion.velocity_north_mps >= 10.0 - 1e-9)
    assert taken_s == pytest.approx(4.0, abs=TICK_S)
    assert aircraft.motion.north_m == pytest.approx(20.0, abs=0.5)
    start_m = aircraft.motion.north_m
    aircraft.hover()
    stopped_s = flights.fly_until(aircraft, lambda a: a.motion.ground_speed_mps < 1e-9)
    assert stopped_s == pytest.approx(4.0, abs=TICK_S)
    assert aircraft.motion.north_m - start_m == pytest.approx(20.0, abs=0.5)


@pytest.mark.parametrize(("target_m", "rate_mps"), [(230.0, 2.6), (30.0, 3.2)])
def test_a_hundred_metres_up_or_down_take_as_long_as_the_rate_implies(
    flights, target_m: float, rate_mps: float
) -> None:
    aircraft = flights.hovering(height_m=130.0)
    aircraft.stick(stick(0.0, target_m))
    flights.fly_until(aircraft, lambda a: abs(a.motion.velocity_up_mps) >= rate_mps - 1e-9)
    start_m = aircraft.motion.height_m
    taken_s = flights.fly_until(aircraft, lambda a: abs(a.motion.height_m - start_m) >= 80.0)
    assert taken_s == pytest.approx(80.0 / rate_mps, abs=2.0 * TICK_S)


def test_half_a_turn_takes_three_seconds(flights) -> None:
    aircraft = flights.hovering()
    aircraft.stick(stick(0.0, 30.0, yaw_deg=180.0))
    taken_s = flights.fly_until(aircraft, lambda a: abs(a.motion.yaw_deg) > 180.0 - 1e-6)
    assert taken_s == pytest.approx(3.0, abs=TICK_S)


@pytest.mark.parametrize("speed_mps", [3.0, 8.0, 12.0])
@pytest.mark.parametrize("leg_m", [100.0, 300.0])
def test_a_leg_with_stops_takes_its_length_over_speed_and_its_start_and_stop(
    flights, speed_mps: float, leg_m: float
) -> None:
    aircraft = flights.hovering()
    points = (
        MissionPoint(0.0, 0.0, 30.0, speed_mps),
        MissionPoint(leg_m, 0.0, 30.0, speed_mps),
    )
    aircraft.fly_mission(points, is_curved=False, lands_at_end=False)
    taken_s = flights.fly_until(aircraft, lambda a: a.flight_mode is FlightMode.GPS_ATTI)
    # Gaining speed at 2.5 m/s2 and braking at 2 m/s2 lose half of their time against full speed;
    # the last metres are settled in a second or two.
    ideal_s = leg_m / speed_mps + speed_mps / 5.0 + speed_mps / 4.0
    assert ideal_s - 0.2 <= taken_s <= ideal_s + 2.5


def test_a_return_takes_its_climb_leg_and_landing(flights) -> None:
    aircraft = Aircraft(
        0,
        AircraftSettings(go_home_height_m=62.0),
        AircraftMotion(north_m=-300.0, height_m=30.0),
        PositionHold(),
    )
    aircraft.go_home()
    climb_s = flights.fly_until(aircraft, lambda a: a.motion.height_m >= 61.0)
    assert climb_s == pytest.approx(31.0 / 2.6, abs=2.0)
    assert aircraft.motion.north_m == -300.0
    transit_s = flights.fly_until(aircraft, lambda a: a.flight_mode is FlightMode.AUTO_LANDING)
    assert transit_s == pytest.approx(300.0 / 10.0 + 10.0 / 5.0 + 10.0 / 4.0, abs=2.5)
    down_s = flights.fly_until(aircraft, lambda a: a.is_on_ground)
    # 3 m/s to 6 m, 0.8 m/s to the stop at 0.3 m, a second for the confirmation, the rest.
    assert down_s == pytest.approx(56.0 / 3.0 + 5.7 / 0.8 + 1.0 + 0.3 / 0.8, abs=3.0)
