"""Each command an aircraft accepts."""

import pytest

from recon.model.vehicle import BatteryWarning, FlightMode
from recon.sim.flight.aircraft import Aircraft, AircraftSettings
from recon.sim.flight.battery import Battery
from recon.sim.flight.estimate import EstimateErrors
from recon.sim.flight.flight_modes import CONFIRM_HEIGHT_M, PositionHold, Stick
from recon.sim.flight.kinematics import AircraftMotion, Limits
from recon.sim.flight.mission import MissionPoint


def stick(**changes) -> Stick:
    values = {
        "is_body_frame": False,
        "yaw_deg": 0.0,
        "velocity_x_mps": 0.0,
        "velocity_y_mps": 0.0,
        "height_m": 30.0,
        "timeout_s": 2.0,
        "limits": Limits(),
    }
    return Stick(**(values | changes))


def test_takeoff_rises_to_takeoff_height_and_hovers(flights) -> None:
    aircraft = Aircraft(0)
    aircraft.take_off()
    assert aircraft.flight_mode is FlightMode.AUTO_TAKEOFF
    assert not aircraft.is_flying
    flights.fly_until(aircraft, lambda a: a.flight_mode is FlightMode.GPS_ATTI, within_s=8.0)
    assert aircraft.is_flying
    assert flights.fly_on(aircraft, 5.0).height_m == pytest.approx(1.2, abs=0.1)


def test_the_barometer_is_zeroed_at_takeoff_and_its_later_error_is_flown(flights) -> None:
    aircraft = Aircraft(0, errors=EstimateErrors((0.0, 0.0, -3.0)))
    assert aircraft.estimate.height_m == -3.0
    aircraft.take_off(PositionHold())
    flights.fly_on(aircraft, 20.0)
    assert aircraft.estimate.height_m == aircraft.motion.height_m == pytest.approx(1.2, abs=0.2)
    aircraft.errors.north_east_up_m = (0.0, 0.0, -5.0)
    flights.fly_on(aircraft, 20.0)
    assert aircraft.estimate.height_m == pytest.approx(1.2, abs=0.2)
    assert aircraft.motion.height_m == pytest.approx(3.2, abs=0.2)


def test_an_aircraft_lands_on_the_ground_whatever_its_barometer_says(flights) -> None:
    aircraft = flights.hovering(height_m=20.0)
    aircraft.errors.north_east_up_m = (0.0, 0.0, 4.0)
    aircraft.land()
    flights.fly_until(aircraft, lambda a: a.is_on_ground, 60.0)
    assert aircraft.motion.height_m == 0.0


def test_hover_stops_a_moving_aircraft(flights) -> None:
    aircraft = flights.hovering()
    aircraft.stick(stick(velocity_x_mps=12.0, timeout_s=60.0))
    assert flights.fly_on(aircraft, 10.0).ground_speed_mps == pytest.approx(12.0, abs=0.01)
    aircraft.hover()
    assert aircraft.flight_mode is FlightMode.GPS_ATTI
    assert flights.fly_on(aircraft, 10.0).ground_speed_mps == pytest.approx(0.0, abs=0.01)


def test_hover_and_return_leave_an_aircraft_on_the_ground_alone(flights) -> None:
    aircraft = Aircraft(0)
    aircraft.hover()
    aircraft.go_home()
    aircraft.land()
    aircraft.stick(stick())
    assert flights.fly_on(aircraft, 5.0) == AircraftMotion()
    assert not aircraft.is_flying


def test_landing_waits_at_a_third_of_a_metre_until_the_app_confirms(flights) -> None:
    aircraft = flights.hovering(height_m=20.0)
    aircraft.land()
    assert aircraft.flight_mode is FlightMode.AUTO_LANDING
    flights.fly_until(aircraft, lambda a: a.flight_mode is FlightMode.CONFIRM_LANDING, 60.0)
    waited_s = flights.fly_until(
        aircraft, lambda a: a.flight_mode is not FlightMode.CONFIRM_LANDING, 5.0
    )
    assert waited_s == pytest.approx(1.0, abs=0.1)
    assert aircraft.motion.height_m == pytest.approx(CONFIRM_HEIGHT_M, abs=0.1)
    flights.fly_until(aircraft, lambda a: not a.is_flying, 5.0)
    assert aircraft.motion.height_m == 0.0
    assert aircraft.flight_mode is FlightMode.GPS_ATTI


def test_landing_never_touches_the_ground_before_the_confirmation(flights) -> None:
    aircraft = flights.hovering(height_m=60.0)
    aircraft.land()
    lowest = []
    while aircraft.flight_mode is not FlightMode.CONFIRM_LANDING:
        lowest.append(flights.fly_on(aircraft, 0.05).height_m)
    assert min(lowest) > 0.15


def test_landing_comes_straight_down_from_flight(flights) -> None:
    aircraft = flights.hovering(height_m=10.0)
    aircraft.stick(stick(velocity_x_mps=10.0, timeout_s=60.0, height_m=10.0))
    flights.fly_on(aircraft, 6.0)
    aircraft.land()
    flights.fly_until(aircraft, lambda a: a.motion.height_m < 9.0, 20.0)
    start_m = aircraft.motion.north_m
    flights.fly_until(aircraft, lambda a: a.is_on_ground, 60.0)
    assert aircraft.motion.north_m == pytest.approx(start_m, abs=0.2)


def test_return_climbs_flies_home_and_lands(flights) -> None:
    aircraft = Aircraft(
        0,
        AircraftSettings(go_home_height_m=40.0),
        AircraftMotion(north_m=150.0, east_m=-80.0, height_m=15.0),
        PositionHold(),
    )
    aircraft.go_home()
    assert aircraft.flight_mode is FlightMode.GO_HOME
    below_go_home = [m for m in flights.fly(aircraft, 8.0) if m.height_m < 38.0]
    assert all(m.ground_speed_mps < 0.01 for m in below_go_home)
    flights.fly_until(aircraft, lambda a: a.is_on_ground, 120.0)
    assert (aircraft.motion.north_m, aircraft.motion.east_m) == pytest.approx((0.0, 0.0), abs=1.0)


def test_return_from_above_the_go_home_height_does_not_descend_first(flights) -> None:
    aircraft = Aircraft(
        0, motion=AircraftMotion(north_m=100.0, height_m=90.0), active_mode=PositionHold()
    )
    aircraft.go_home()
    flights.fly_until(aircraft, lambda a: a.motion.north_m < 5.0, 60.0)
    assert aircraft.motion.height_m == pytest.approx(90.0, abs=0.5)


def test_home_is_where_the_aircraft_took_off_last(flights) -> None:
    aircraft = flights.hovering(height_m=10.0)
    aircraft.stick(stick(velocity_x_mps=5.0, height_m=10.0, timeout_s=60.0))
    flights.fly_on(aircraft, 10.0)
    aircraft.land()
    flights.fly_until(aircraft, lambda a: a.is_on_ground, 60.0)
    landed_m = aircraft.motion.north_m
    assert landed_m > 20.0
    aircraft.take_off()
    flights.fly_on(aircraft, 10.0)
    aircraft.go_home()
    flights.fly_until(aircraft, lambda a: a.is_on_ground, 120.0)
    assert aircraft.motion.north_m == pytest.approx(landed_m, abs=1.0)


def test_stick_in_ground_mode_flies_north_and_east_whatever_the_heading(flights) -> None:
    aircraft = flights.hovering(yaw_deg=90.0)
    aircraft.stick(stick(velocity_x_mps=3.0, velocity_y_mps=-2.0, yaw_deg=90.0, timeout_s=60.0))
    assert aircraft.flight_mode is FlightMode.JOYSTICK
    motion = flights.fly_on(aircraft, 5.0)
    assert motion.velocity_north_mps == pytest.approx(3.0)
    assert motion.velocity_east_mps == pytest.approx(-2.0)


def test_stick_in_body_mode_turns_with_the_yaw(flights) -> None:
    aircraft = flights.hovering(yaw_deg=0.0)
    aircraft.stick(
        stick(
            is_body_frame=True, velocity_x_mps=4.0, velocity_y_mps=1.0, yaw_deg=90.0, timeout_s=60
        )
    )
    first = flights.fly_on(aircraft, 0.2)
    assert first.velocity_north_mps > abs(first.velocity_east_mps)
    turned = flights.fly_on(aircraft, 8.0)
    assert turned.yaw_deg == pytest.approx(90.0)
    assert turned.velocity_east_mps == pytest.approx(4.0, abs=0.01)
    assert turned.velocity_north_mps == pytest.approx(-1.0, abs=0.01)


def test_stick_timeout_stops_the_velocity_and_keeps_the_rest(flights) -> None:
    aircraft = flights.hovering(height_m=30.0)
    aircraft.stick(stick(velocity_x_mps=5.0, yaw_deg=120.0, height_m=45.0, timeout_s=1.5))
    assert flights.fly_on(aircraft, 1.5).velocity_north_mps > 3.0
    later = flights.fly_on(aircraft, 15.0)
    assert later.ground_speed_mps == pytest.approx(0.0, abs=1e-6)
    assert later.yaw_deg == pytest.approx(120.0)
    assert later.height_m == pytest.approx(45.0, abs=0.1)
    assert aircraft.flight_mode is FlightMode.JOYSTICK


def test_battery_drains_warns_and_lands_the_aircraft(flights) -> None:
    aircraft = flights.hovering(height_m=5.0)
    aircraft.battery = Battery(1.0, endurance_s=100.0)
    flights.fly_on(aircraft, 50.0)
    assert aircraft.battery.percent in (49, 50)
    assert aircraft.battery.warning is BatteryWarning.NONE
    flights.fly_on(aircraft, 24.0)
    assert aircraft.battery.warning is BatteryWarning.LOW
    flights.fly_on(aircraft, 14.0)
    assert aircraft.battery.warning is BatteryWarning.SERIOUS
    flights.fly_until(aircraft, lambda a: a.is_on_ground, 60.0)
    assert 0.0 <= aircraft.battery.fraction < 0.06


def test_the_battery_is_changed_some_time_after_landing(flights) -> None:
    aircraft = flights.hovering(height_m=5.0)
    aircraft.settings = AircraftSettings(battery_swap_s=30.0)
    aircraft.battery = Battery(0.4, endurance_s=1500.0)
    aircraft.land()
    flights.fly_until(aircraft, lambda a: a.is_on_ground, 60.0)
    flights.fly_on(aircraft, 29.0)
    assert aircraft.battery.fraction < 0.4
    flights.fly_on(aircraft, 2.0)
    assert aircraft.battery.fraction > 0.99


@pytest.mark.parametrize(("fraction", "is_kept"), [(0.55, True), (0.5, False)])
def test_a_battery_that_is_good_at_landing_stays_in(flights, fraction, is_kept) -> None:
    aircraft = flights.hovering(height_m=5.0)
    aircraft.settings = AircraftSettings(battery_swap_s=30.0, battery_kept_share=0.5)
    aircraft.battery = Battery(fraction, endurance_s=1500.0)
    aircraft.land()
    flights.fly_until(aircraft, lambda a: a.is_on_ground, 60.0)
    flights.fly_on(aircraft, 60.0)
    assert (aircraft.battery.fraction < fraction) == is_kept


@pytest.mark.parametrize("swap_s", [None, 30.0])
def test_the_battery_is_not_changed_after_a_crash_or_before_a_flight(flights, swap_s) -> None:
    for aircraft in (flights.hovering(), Aircraft(0)):
        aircraft.settings = AircraftSettings(battery_swap_s=swap_s)
        aircraft.battery = Battery(0.4, endurance_s=1500.0)
        aircraft.crash()
        flights.fly_on(aircraft, 60.0)
        assert aircraft.battery.fraction < 0.4


def test_a_crashed_aircraft_never_takes_off_again(flights) -> None:
    aircraft = flights.hovering()
    aircraft.crash()
    aircraft.take_off()
    aircraft.take_off_and_go_home()
    aircraft.fly_mission((MissionPoint(10.0, 0.0, 30.0, 5.0),), False, False)
    flights.fly_on(aircraft, 10.0)
    assert aircraft.is_on_ground
    assert aircraft.mission_id == 0


def test_motion_does_not_depend_on_how_often_it_is_advanced(flights) -> None:
    often, seldom = flights.hovering(), flights.hovering()
    for aircraft in (often, seldom):
        aircraft.stick(stick(velocity_x_mps=9.0, velocity_y_mps=4.0, yaw_deg=33.0))
    for now_ns in range(0, 10_000_000_001, 7_000_000):
        often.advance(now_ns)
    often.advance(10_000_000_000)
    seldom.advance(10_000_000_000)
    assert often.motion == seldom.motion


def test_wind_drifts_an_aircraft_under_sticks_and_not_in_position_mode(flights) -> None:
    aircraft = flights.hovering()
    aircraft.stick(
        stick(velocity_x_mps=2.0, drift_north_mps=0.5, drift_east_mps=-1.0, timeout_s=60)
    )
    drifting = flights.fly_on(aircraft, 5.0)
    assert drifting.velocity_north_mps == pytest.approx(2.5)
    assert drifting.velocity_east_mps == pytest.approx(-1.0)
    aircraft.hover()
    assert flights.fly_on(aircraft, 5.0).ground_speed_mps == pytest.approx(0.0, abs=0.01)


def test_the_apps_sticks_and_missions_are_ignored_under_pilot_control(flights) -> None:
    aircraft = flights.hovering()
    aircraft.stick(stick(velocity_x_mps=5.0, timeout_s=60.0))
    flights.fly_on(aircraft, 3.0)
    aircraft.pilot_takes()
    aircraft.stick(stick(velocity_x_mps=5.0, timeout_s=60.0))
    aircraft.fly_mission((), is_curved=False, lands_at_end=False)
    assert aircraft.flight_mode is FlightMode.GPS_SPORT
    assert flights.fly_on(aircraft, 5.0).ground_speed_mps == pytest.approx(0.0, abs=0.01)


def test_the_mode_switch_does_not_start_a_takeoff() -> None:
    aircraft = Aircraft(0)
    aircraft.pilot_takes()
    assert aircraft.is_on_ground
