"""The app on its link: telemetry, acknowledgments, and the actions that follow."""

import random
from dataclasses import replace
from math import isfinite

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon import wire
from recon.geo import enu_from_geo
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.units import seconds_to_ns
from recon.model.vehicle import AltitudeReference, FlightMode
from recon.sim.app.commands import AppBehaviour, HoverOnGround
from recon.sim.fleet import Airborne, SimulationConfig, build_fleet
from recon.sim.flight.aircraft import AircraftSettings
from recon.sim.flight.estimate import FIELD_DRIFT, DriftSettings, EstimateErrors

HOME = GeoPoint(41.9, -93.6, 275.0)
HOVER, LAND, RETURN = (wire.EmergencyCommand(action=action) for action in (0, 1, 2))
STARTS_S = 3.0
"""A mission of a few waypoints is uploaded and flown by then."""

SQUARE = [(0.0, 10.0, 40.0), (60.0, 10.0, 40.0), (60.0, 70.0, 40.0)]


def of(kind: type, packets: list) -> list:
    return [p for p in packets if isinstance(p, kind)]


def stick(**changes) -> wire.VirtualStickCommand:
    values = {
        "mode": 0,
        "yaw_deg": 0.0,
        "velocity_x_mps": 5.0,
        "velocity_y_mps": 0.0,
        "height_above_takeoff_m": 30.0,
        "timeout_s": 60.0,
    }
    return wire.VirtualStickCommand(**(values | changes))


def test_it_announces_at_once_that_it_is_simulated(app_bench) -> None:
    bench = app_bench()
    first = bench.run(0.01)[0]
    assert isinstance(first, wire.MessageString)
    assert (first.type, first.text) == (1, b"recon-sim simulated vehicle")


def test_telemetry_comes_at_10_and_2_hz_with_the_serial(app_bench) -> None:
    packets = app_bench().run(10.0)
    assert len(of(wire.CoreTelemetry, packets)) == 100
    extended = of(wire.ExtendedTelemetry, packets)
    assert len(extended) == 20
    assert {p.serial for p in extended} == {b"SIM-7"}
    assert {p.camera_state for p in extended} == {0}


def test_telemetry_is_true_within_sensor_errors(app_bench) -> None:
    bench = app_bench(height_m=50.0, bias_m=-23.0)
    bench.send(stick(velocity_x_mps=8.0, height_above_takeoff_m=50.0))
    bench.run(12.0)
    core, truth = bench.last(wire.CoreTelemetry), bench.app.aircraft.motion
    home = bench.app.settings.home
    east, north, _ = enu_from_geo(LocalFrame(home), core.latitude_deg, core.longitude_deg, 275.0)[0]
    assert (north, east) == pytest.approx((truth.north_m, truth.east_m), abs=1.5)
    assert core.height_above_takeoff_m == pytest.approx(50.0, abs=0.6)
    assert core.altitude_m - core.height_above_takeoff_m == pytest.approx(275.0 - 23.0)
    assert core.velocity_north_mps == pytest.approx(8.0)
    assert core.is_flying == 1


@pytest.mark.parametrize("command", [HOVER, LAND, RETURN, stick()])
def test_the_acknowledgment_comes_before_the_action(app_bench, command) -> None:
    bench = app_bench()
    before = bench.app.aircraft.active_mode
    (answer,) = of(wire.Acknowledgment, bench.send(command))
    assert (answer.positive, answer.source_pid) == (1, command.PID)
    assert bench.app.aircraft.active_mode is before
    bench.run(0.3)
    assert bench.app.aircraft.active_mode is not before


@pytest.mark.parametrize(
    ("command", "mode"),
    [
        (LAND, FlightMode.AUTO_LANDING),
        (RETURN, FlightMode.GO_HOME),
        (stick(), FlightMode.JOYSTICK),
    ],
)
def test_the_action_shows_in_telemetry_and_hover_ends_it(app_bench, command, mode) -> None:
    bench = app_bench()
    bench.send(command)
    bench.run(1.0)
    assert bench.mode == mode
    bench.send(HOVER)
    bench.run(1.0)
    assert bench.mode == FlightMode.GPS_ATTI


def test_landing_ends_on_the_ground(app_bench) -> None:
    bench = app_bench(height_m=8.0)
    bench.send(LAND)
    modes = [p.flight_mode for p in of(wire.ExtendedTelemetry, bench.run(30.0))]
    assert FlightMode.CONFIRM_LANDING in modes
    assert bench.last(wire.CoreTelemetry).is_flying == 0


@pytest.mark.parametrize("reference", [AltitudeReference.TAKEOFF, AltitudeReference.WGS84])
@pytest.mark.parametrize("bias_m", [-35.0, 0.0, 28.5])
def test_both_altitude_references_reach_the_same_true_height(
    app_bench, mission_packet, reference, bias_m
) -> None:
    bench = app_bench(reference=reference, bias_m=bias_m)
    bench.run(1.0)
    core = bench.last(wire.CoreTelemetry)
    offset_m = 0.0
    if reference is AltitudeReference.WGS84:
        offset_m = core.altitude_m - core.height_above_takeoff_m
    bench.send(mission_packet([(n, e, 62.0 + offset_m) for n, e, _ in SQUARE]))
    bench.run(60.0)
    assert bench.mode == FlightMode.GPS_ATTI
    assert bench.app.aircraft.motion.height_m == pytest.approx(62.0, abs=0.6)


def test_a_mission_shows_its_mode_and_number(app_bench, mission_packet) -> None:
    bench = app_bench()
    bench.send(mission_packet(SQUARE))
    bench.run(STARTS_S)
    assert bench.mode == FlightMode.GPS_WAYPOINT
    assert bench.last(wire.ExtendedTelemetry).mission_id == 1
    bench.run(60.0)
    assert bench.last(wire.ExtendedTelemetry).mission_id == 0


class TestUpload:
    """0.1 s for each waypoint, and 2 s until it is flown."""

    def test_the_aircraft_holds_until_its_mission_is_there(self, app_bench, mission_packet) -> None:
        bench = app_bench()
        bench.send(mission_packet(SQUARE))
        bench.run(2.0 + 0.1 * len(SQUARE))
        assert bench.mode == FlightMode.GPS_ATTI
        bench.run(0.8)
        assert bench.mode == FlightMode.GPS_WAYPOINT

    def test_a_mission_under_way_is_stopped_before(self, app_bench, mission_packet) -> None:
        bench = app_bench()
        bench.send(mission_packet(SQUARE))
        bench.run(5.0)
        bench.send(mission_packet(SQUARE[::-1]))
        bench.run(1.0)
        assert bench.mode == FlightMode.GPS_ATTI
        bench.run(3.0)
        assert bench.mode == FlightMode.GPS_WAYPOINT
        assert bench.last(wire.ExtendedTelemetry).mission_id == 2

    def test_whatever_is_ordered_meanwhile_replaces_it(self, app_bench, mission_packet) -> None:
        bench = app_bench()
        bench.send(mission_packet(SQUARE))
        bench.run(1.0)
        bench.send(HOVER)
        bench.run(10.0)
        assert bench.mode == FlightMode.GPS_ATTI
        assert bench.last(wire.ExtendedTelemetry).mission_id == 0

    def test_it_is_not_started_for_a_pilot_who_has_taken_over(
        self, app_bench, mission_packet
    ) -> None:
        bench = app_bench()
        bench.send(mission_packet(SQUARE))
        bench.run(1.0)
        bench.app.aircraft.has_pilot_control = True
        bench.run(10.0)
        assert bench.last(wire.ExtendedTelemetry).mission_id == 0
        assert any("mission not started: the pilot" in line for line in bench.app.take_log())


def test_a_mission_that_the_sdk_rejects_is_acknowledged_and_nothing_happens(
    app_bench, mission_packet
) -> None:
    bench = app_bench()
    (answer,) = of(wire.Acknowledgment, bench.send(mission_packet(SQUARE[:1])))
    assert answer.positive == 1
    bench.run(2.0)
    assert bench.mode == FlightMode.GPS_ATTI
    assert any("rejected silently" in line for line in bench.app.take_log())


def test_a_stick_out_of_range_is_acknowledged_and_nothing_happens(app_bench) -> None:
    bench = app_bench()
    (answer,) = of(wire.Acknowledgment, bench.send(stick(velocity_x_mps=16.0)))
    assert answer.positive == 1
    bench.run(2.0)
    assert bench.mode == FlightMode.GPS_ATTI


def test_unknown_actions_and_commands_to_a_missing_camera_are_refused(app_bench) -> None:
    bench = app_bench()
    for command in (
        wire.EmergencyCommand(action=7),
        wire.CameraControl(action=1, target_fps_hz=1.0),
    ):
        (answer,) = of(wire.Acknowledgment, bench.send(command))
        assert (answer.positive, answer.source_pid) == (0, command.PID)


def test_packets_in_the_wrong_direction_are_ignored(app_bench) -> None:
    bench = app_bench()
    packets = bench.send(wire.Acknowledgment(positive=1, source_pid=253))
    assert of(wire.Acknowledgment, packets) == []


@pytest.mark.parametrize("command", [HOVER, RETURN])
@pytest.mark.parametrize("habit", list(HoverOnGround))
def test_hover_and_return_on_the_ground(app_bench, command, habit) -> None:
    bench = app_bench(height_m=0.0, hover_on_ground=habit)
    bench.send(command)
    flew = {p.is_flying for p in of(wire.CoreTelemetry, bench.run(10.0))}
    assert (1 in flew) == (habit is HoverOnGround.TAKEOFF)


def test_return_on_the_ground_comes_back_to_the_ground(app_bench) -> None:
    bench = app_bench(height_m=0.0, hover_on_ground=HoverOnGround.TAKEOFF)
    bench.send(RETURN)
    bench.run(10.0)
    assert bench.last(wire.CoreTelemetry).is_flying == 1
    bench.run(80.0)
    assert bench.last(wire.CoreTelemetry).is_flying == 0


def test_commands_split_over_reads_are_understood(app_bench) -> None:
    bench = app_bench()
    for byte in wire.encode(LAND):
        bench.app.receive(bytes([byte]), bench.now_ns)
    assert of(wire.Acknowledgment, bench.run(0.05))


def test_a_new_link_starts_with_empty_buffers(app_bench) -> None:
    bench = app_bench()
    bench.run(1.0)
    bench.app.disconnected()
    assert bench.run(1.0) == []
    bench.app.connected(bench.now_ns)
    assert isinstance(bench.run(0.01)[0], wire.MessageString)


@given(st.lists(st.floats(0.001, 0.7), min_size=1, max_size=30))
def test_the_same_seed_gives_the_same_bytes_however_time_advances(app_bench, steps) -> None:
    whole, cut = app_bench(), app_bench()
    end_ns, now_ns, pieces = seconds_to_ns(sum(steps)), 0, []
    expected = b"".join(whole.app.advance(end_ns))
    for step_s in steps:
        now_ns = min(end_ns, now_ns + seconds_to_ns(step_s))
        pieces += cut.app.advance(now_ns)
    pieces += cut.app.advance(end_ns)
    assert b"".join(pieces) == expected


def test_what_is_due_next_is_never_late(app_bench) -> None:
    bench = app_bench()
    bench.app.advance(0)
    for _ in range(50):
        due_ns = bench.app.next_due_ns
        assert bench.app.advance(due_ns - 1) == []
        assert bench.app.advance(due_ns) != []


def test_a_link_that_is_not_read_holds_a_bounded_number_of_packets(app_bench) -> None:
    bench = app_bench()
    packets = bench.run(120.0, step_s=120.0)
    assert len(packets) == 256


any_float = st.floats(width=32) | st.sampled_from([0.0, 90.0, 180.0, 1e30])
any_waypoints = st.lists(
    st.builds(
        wire.Waypoint,
        latitude_deg=any_float,
        longitude_deg=any_float,
        altitude_m=any_float,
        corner_radius_m=any_float,
        speed_mps=any_float,
        loiter_time_s=any_float,
        gimbal_pitch_deg=any_float,
    ),
    min_size=1,
    max_size=4,
)
any_command = (
    st.builds(
        wire.ExecuteWaypointMission,
        land_at_end=st.integers(0, 255),
        curved_flight=st.integers(0, 255),
        waypoints=any_waypoints,
    )
    | st.builds(
        wire.VirtualStickCommand,
        mode=st.integers(0, 255),
        yaw_deg=any_float,
        velocity_x_mps=any_float,
        velocity_y_mps=any_float,
        height_above_takeoff_m=any_float,
        timeout_s=any_float,
    )
    | st.builds(wire.EmergencyCommand, action=st.integers(0, 255))
    | st.builds(wire.CameraControl, action=st.integers(0, 255), target_fps_hz=any_float)
)


@given(st.lists(any_command, max_size=6))
def test_any_command_is_acknowledged_and_telemetry_stays_finite(app_bench, orders) -> None:
    bench = app_bench()
    for order in orders:
        answers = of(wire.Acknowledgment, bench.send(order))
        assert [a.source_pid for a in answers] == [order.PID]
        bench.run(0.3)
    core = bench.last(wire.CoreTelemetry) if orders else bench.run(1.0)[1]
    assert isfinite(core.latitude_deg + core.longitude_deg + core.altitude_m + core.yaw_deg)


def test_garbage_does_no_harm(app_bench) -> None:
    bench = app_bench()
    noise = random.Random(3)
    for _ in range(50):
        bench.app.receive(noise.randbytes(400), bench.now_ns)
    bench.run(11.0)
    assert of(wire.Acknowledgment, bench.send(HOVER))


@pytest.mark.parametrize("reports", [True, False])
def test_mission_numbers_are_reported_or_always_0(app_bench, mission_packet, reports) -> None:
    bench = app_bench()
    bench.app.settings = replace(
        bench.app.settings, behaviour=AppBehaviour(reports_mission_id=reports)
    )
    bench.send(mission_packet(SQUARE))
    bench.run(STARTS_S)
    assert bench.mode == FlightMode.GPS_WAYPOINT
    assert bench.last(wire.ExtendedTelemetry).mission_id == int(reports)


def test_limits_set_in_the_aircraft_are_kept_and_reported(app_bench, mission_packet) -> None:
    bench = app_bench()
    bench.app.aircraft.settings = AircraftSettings(max_height_m=50.0, max_distance_m=120.0)
    bench.send(mission_packet([(0.0, 10.0, 50.1), (60.0, 10.0, 40.0)]))
    bench.send(mission_packet([(0.0, 10.0, 40.0), (121.0, 10.0, 40.0)]))
    bench.run(1.0)
    assert bench.mode == FlightMode.GPS_ATTI
    bench.send(stick(velocity_x_mps=0.0, height_above_takeoff_m=80.0))
    bench.run(40.0)
    assert bench.app.aircraft.motion.height_m == pytest.approx(50.0, abs=0.1)
    extended = bench.last(wire.ExtendedTelemetry)
    assert (extended.max_height_reached, extended.max_distance_reached) == (1, 0)


def test_pads_at_different_altitudes_differ_in_altitude_and_not_in_height() -> None:
    low, high = GeoPoint(41.9, -93.6, 260.0), GeoPoint(41.901, -93.6, 291.0)
    config = SimulationConfig(
        home=low,
        vehicle_count=2,
        airborne=Airborne.ALL,
        altitude_bias_m=0.0,
        pads={"SIM-1": low, "SIM-2": high},
    )
    altitudes = []
    for app in build_fleet(config, 0):
        app.connected(0)
        packets = wire.Deframer().feed(b"".join(app.advance(200_000_000)))
        core = of(wire.CoreTelemetry, packets)[-1]
        altitudes.append(
            (core.altitude_m - core.height_above_takeoff_m, core.height_above_takeoff_m)
        )
    assert [base for base, _ in altitudes] == pytest.approx([260.0, 291.0])
    assert [height for _, height in altitudes] == pytest.approx([40.0, 50.0], abs=0.5)


def drifted_m(seed: int, seconds: float) -> float:
    """The height's slow error outdoors, after a time."""
    errors = EstimateErrors(random=random.Random(seed), settings=FIELD_DRIFT)
    errors.step(seconds)
    return errors.north_east_up_m[2]


def test_outdoors_estimates_are_good_to_metres_and_drift_slowly() -> None:
    ends_m = [drifted_m(seed, 900.0) for seed in range(200)]
    assert 0.5 < (sum(end * end for end in ends_m) / len(ends_m)) ** 0.5 < 1.1
    assert max(abs(drifted_m(seed, 0.1)) for seed in range(200)) < 0.1


def test_an_aircraft_holds_the_height_it_reports_and_not_the_true_one(
    app_bench, mission_packet
) -> None:
    bench = app_bench(drift=DriftSettings(height_m=3.0, height_time_s=300.0))
    bench.send(mission_packet([(0.0, 10.0, 40.0), (400.0, 10.0, 40.0)], speed_mps=4.0))
    bench.run(20.0)
    reported_m, off_m = [], []
    for _ in range(200):
        bench.run(1.0)
        reported_m.append(bench.last(wire.CoreTelemetry).height_above_takeoff_m)
        off_m.append(abs(bench.app.aircraft.motion.height_m - 40.0))
    # A hundred seconds of mission and as many of hovering where it ended.
    assert bench.mode == FlightMode.GPS_ATTI
    assert reported_m == pytest.approx([40.0] * 200, abs=1.2)
    assert max(off_m) > 1.5
