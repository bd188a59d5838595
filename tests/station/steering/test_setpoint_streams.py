"""Steered orders over the whole way: streams, sticks, bytes, a simulated app and its aircraft."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import Phase as Phases
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.station.steered_world import HEIGHT_M, OWNER, SERIAL, Steered, steered

from recon import wire
from recon.geo import enu_from_point
from recon.model.airspace import Region
from recon.model.command import (
    FlyMission,
    GoTo,
    HoldPosition,
    Hover,
    LandNow,
    Nudge,
    Phase,
    Refusal,
    ReturnHome,
    StartCamera,
)
from recon.model.control import AuthorityHolder
from recon.model.event import AuthorityTaken, OwnerConnected
from recon.model.mission import Mission, Waypoint
from recon.model.vehicle import FlightMode
from recon.safety import PreparedAirspace
from recon.sim.fake_link import FakeLink
from recon.station.steering.setpoint_streams import advance, start_stream
from recon.station.steering.stream_ends import StreamUpdate

JITTERY = FakeLink(delay_s=0.05, jitter_s=0.25, seed=4)


class TestArrival:
    def test_a_goto_of_200_m_in_wind_arrives_and_is_held_there(self) -> None:
        s = steered(wind=(0.6, -0.6), make_link=lambda: replace(JITTERY))
        order = s.goto(200.0, 0.0, height_m=55.0)
        farthest_m = 0.0
        for _ in range(60):
            s.run_for(1.0)
            farthest_m = max(farthest_m, s.aircraft.motion.north_m)
        assert s.distance_m(200.0) < 1.0
        assert farthest_m < 201.5
        assert abs(s.aircraft.motion.height_m - 55.0) < 1.0
        assert s.w.phases(order) == [Phase.QUEUED, Phase.SENT, Phase.STARTED, Phase.DONE]
        s.run_for(30.0)
        assert s.distance_m(200.0) < 1.0
        assert s.aircraft.flight_mode is FlightMode.JOYSTICK
        assert s.alarm_texts() == []

    def test_sticks_come_at_10_hz_each_with_a_timeout_of_a_second(self) -> None:
        s = steered()
        s.goto(100.0)
        s.run_for(10.0)
        sticks = s.sticks()
        gaps_s = [b - a for (a, _), (b, _) in pairwise(sticks)]
        assert 98 <= len(sticks) <= 101
        assert max(gaps_s[1:]) == pytest.approx(0.1, abs=1e-6)
        assert min(gaps_s[1:]) == pytest.approx(0.1, abs=1e-6)
        assert {packet.timeout_s for _, packet in sticks} == {1.0}

    def test_the_order_list_has_one_line_for_all_of_them(self) -> None:
        s = steered()
        order = s.goto(60.0)
        s.run_for(30.0)
        assert list(s.w.driver.station.orders.records) == [order]
        assert s.stream is not None
        assert s.stream.packets_sent > 280
        s.order(Hover())
        assert s.w.record(order).times_sent > 280

    def test_a_nudge_moves_by_so_much_from_where_it_is(self) -> None:
        s = steered()
        s.w.driver.handle(OwnerConnected(OWNER))
        s.order(Nudge(3.0, -2.0, 4.0, turn_deg=90.0), OWNER)
        s.run_for(20.0)
        assert s.distance_m(3.0, -2.0) < 0.8
        assert abs(s.aircraft.motion.height_m - HEIGHT_M - 4.0) < 0.8
        assert abs(s.aircraft.motion.yaw_deg - 90.0) < 1.0

    def test_a_position_is_held_against_wind_out_of_full_flight(self) -> None:
        s = steered(wind=(0.0, 1.0))
        s.goto(300.0)
        s.run_for(12.0)
        order = s.order(HoldPosition(), OWNER)
        s.run_for(15.0)
        north_m, east_m = s.aircraft.motion.north_m, s.aircraft.motion.east_m
        s.run_for(20.0)
        assert s.distance_m(north_m, east_m) < 0.7
        assert s.phase(order) is Phase.DONE

    def test_a_camera_order_gets_through_a_stream(self) -> None:
        s = steered()
        s.goto(200.0)
        s.run_for(2.0)
        s.order(StartCamera(1.0))
        s.run_for(0.5)
        (asked,) = [p for _, p in s.tap.received if isinstance(p, wire.CameraControl)]
        assert asked.action == 1
        gaps_s = [b - a for (a, _), (b, _) in pairwise(s.sticks(1.0))]
        assert max(gaps_s) <= 0.31

    def test_after_long_at_its_goal_it_is_left_to_hold_itself(self) -> None:
        s = steered()
        station = s.w.driver.station
        short = replace(station.settings.streams, hold_at_most_s=5.0)
        s.w.driver.station = replace(station, settings=replace(station.settings, streams=short))
        order = s.goto(5.0)
        s.run_for(25.0)
        assert s.stream is None
        assert "the aircraft now holds it itself" in s.note(order)
        assert s.aircraft.flight_mode is FlightMode.GPS_ATTI
        assert s.alarm_texts() == []


class TestTelemetryLost:
    def test_two_seconds_are_zeros_and_then_the_same_stream_goes_on(self) -> None:
        s = steered(faults=(f"telemetry-dropout:{SERIAL}:8:2.5",))
        order = s.goto(80.0)
        s.run_for(6.5)
        assert len(s.zeros(9.1)) >= 3
        assert s.moving_sticks(9.3) == []
        s.run_for(20.0)
        assert s.distance_m(80.0) < 1.0
        assert Phase.FAILED not in s.w.phases(order)
        assert s.hovers() == []

    def test_five_seconds_fail_with_an_alarm_and_nothing_resumes(self) -> None:
        s = steered(faults=(f"telemetry-dropout:{SERIAL}:8:5",))
        order = s.goto(200.0)
        s.run_for(8.6)
        assert s.phase(order) is Phase.FAILED
        assert len(s.zeros(9.1)) >= 15
        assert s.note(order) == "telemetry incomplete or missing for 3 s"
        assert any("telemetry incomplete or missing for 3 s" in text for text in s.alarm_texts())
        ended_s = s.now_s
        s.run_for(20.0)
        assert s.moving_sticks(9.3) == []
        assert s.hovers(ended_s) != []
        assert s.aircraft.flight_mode is FlightMode.GPS_ATTI
        assert s.aircraft.motion.ground_speed_mps < 0.1
        assert s.distance_m(200.0) > 100.0

    def test_what_is_not_seen_now_is_not_steered(self) -> None:
        s = steered(faults=(f"telemetry-dropout:{SERIAL}:1:60",))
        order = s.goto(50.0)
        assert s.phase(order) is Phase.REFUSED_BY_STATION
        s.run_for(2.0)
        assert s.sticks() == []

    def test_a_reconnect_in_mid_goto_never_resumes_it(self) -> None:
        s = steered()
        order = s.goto(200.0)
        s.run_for(6.0)
        s.reconnects(1.0)
        assert s.phase(order) is Phase.FAILED
        cut_s = s.now_s
        s.run_for(20.0)
        assert s.moving_sticks(cut_s) == []
        assert s.hovers(cut_s) != []
        assert s.aircraft.motion.ground_speed_mps < 0.1
        assert s.distance_m(200.0) > 100.0
        assert any("connection lost" in text for text in s.alarm_texts())


class TestBlownAway:
    def test_a_gust_towards_the_fence_ends_a_goto_in_time(self) -> None:
        """Flown 45 m from the boundary, it is carried off sideways faster than sticks correct."""
        s = steered()
        station = s.w.driver.station
        fence = station.airspace.airspace
        assert fence.frame is not None
        here = enu_from_point(fence.frame, s.tap.app.settings.home)
        east_m, north_m = float(here[0]) + 45.0, float(here[1])
        corners = [(-500.0, -500.0), (0.0, -500.0), (0.0, 500.0), (-500.0, 500.0)]
        ring = np.array([(east_m + east, north_m + north) for east, north in corners])
        air = PreparedAirspace(replace(fence, boundary=Region(ring)))
        s.w.driver.station = replace(station, airspace=air)
        order = s.goto(200.0)
        s.run_for(5.0)
        assert s.phase(order) is Phase.STARTED
        s.gust(east_mps=14.0)
        s.run_until(lambda: fence_alarms(s) != [], 20.0)
        assert s.aircraft.motion.east_m < 45.0 - s.aircraft.motion.ground_speed_mps
        assert "SIM-1" in fence_alarms(s)[0]
        seen_s = s.now_s
        s.run_for(8.0)
        assert s.phase(order) in (Phase.FAILED, Phase.SUPERSEDED)
        assert s.hovers(seen_s) != []
        assert s.moving_sticks(seen_s + 1.0) == []
        assert s.aircraft.motion.east_m < 45.0
        assert s.aircraft.motion.ground_speed_mps < 0.1


def test_a_first_setpoint_that_is_refused_leaves_a_return_as_it_is() -> None:
    """The goto leads inwards, and the first stick cannot turn so soon: a hold would end a return,
    and leave the vehicle standing where it must not be."""
    s = steered()
    s.goto(0.0, 250.0)
    s.run_for(45.0)
    returning = s.order(ReturnHome())
    s.run_until(lambda: s.aircraft.motion.velocity_east_mps < -7.0)
    station, now_ns = s.w.driver.station, s.w.driver.now_ns
    goto = replace(s.w.record(returning).command, body=GoTo(s.there(0.0, 200.0), HEIGHT_M, 8.0))
    station, _ = start_stream(station, goto, OWNER, now_ns)
    refused = Refusal("boundary", "it goes out")
    ended = advance(StreamUpdate(station), SERIAL, now_ns, lambda _station, _command: refused)
    assert (ended.outputs, ended.holds) == ((), ())
    assert ended.station.control(SERIAL).stream is None
    (alarm,) = ended.station.alarms.alarms.values()
    assert alarm.condition.text.endswith("it goes out; nothing was sent, it continues as before")


def fence_alarms(s: Steered) -> list[str]:
    """Active alarms of the watch on fences."""
    alarms = s.w.driver.station.alarms.alarms.values()
    return [a.condition.text for a in alarms if a.is_active and "boundary" in a.condition.text]


class TestEnds:
    def test_the_holder_goes_zero_is_sent_and_then_hold(self) -> None:
        s = steered()
        order = s.goto(200.0)
        s.run_for(6.0)
        gone_s = s.now_s
        s.holder_goes()
        s.run_for(1.0)
        ((zero_s),) = s.zeros(gone_s)
        assert zero_s - gone_s <= 0.15
        assert s.moving_sticks(gone_s + 0.03) == []
        assert zero_s < s.hovers(gone_s)[0] <= gone_s + 0.2
        assert s.phase(order) is Phase.FAILED
        assert any("connection that owns the order closed" in text for text in s.alarm_texts())
        s.run_for(5.0)
        assert s.aircraft.flight_mode is FlightMode.GPS_ATTI

    def test_another_streams_end_changes_nothing(self) -> None:
        s = steered()
        s.goto(200.0)
        s.run_for(3.0)
        s.w.driver.handle(OwnerConnected("another-stream-here"))
        stream = s.stream
        s.run_for(1.0)
        assert stream is not None
        assert s.stream is not None
        assert s.stream.command == stream.command

    def test_an_order_without_an_open_owner_is_refused(self) -> None:
        s = steered()
        order = s.order(GoTo(s.there(50.0), HEIGHT_M, 5.0), OWNER)
        assert s.phase(order) is Phase.REFUSED_BY_STATION
        assert s.refusal_rule(order) == "owner"
        s.goto(50.0)
        s.holder_goes()
        again = s.order(GoTo(s.there(50.0), HEIGHT_M, 5.0), OWNER)
        assert s.refusal_rule(again) == "owner"

    @pytest.mark.parametrize("body", [Hover(), LandNow(), ReturnHome()])
    def test_a_stop_in_mid_goto_ends_it_at_once(self, body: Hover | LandNow | ReturnHome) -> None:
        s = steered()
        order = s.goto(200.0)
        s.run_for(6.0)
        stopped_s = s.now_s
        s.order(body)
        assert s.stream is None
        assert s.phase(order) is Phase.SUPERSEDED
        s.run_for(10.0)
        assert s.sticks(stopped_s + 0.03) == []
        assert s.aircraft.flight_mode is not FlightMode.JOYSTICK

    def test_a_mission_in_mid_goto_takes_over(self) -> None:
        s = steered()
        s.goto(200.0)
        s.run_for(6.0)
        there = [s.there(north_m, 60.0) for north_m in (60.0, 90.0)]
        mission = Mission(
            tuple(Waypoint(p.latitude_deg, p.longitude_deg, 40.0, 5.0) for p in there)
        )
        s.order(FlyMission(mission))
        ordered_s = s.now_s
        s.run_for(10.0)
        assert s.sticks(ordered_s + 0.03) == []
        assert s.aircraft.flight_mode is FlightMode.GPS_WAYPOINT

    def test_a_newer_goto_takes_over_without_a_stop(self) -> None:
        s = steered()
        first = s.goto(200.0)
        s.run_for(8.0)
        second = s.goto(120.0, 40.0)
        slowest_mps = 99.0
        for _ in range(10):
            s.run_for(0.2)
            slowest_mps = min(slowest_mps, s.aircraft.motion.ground_speed_mps)
        assert slowest_mps > 5.0
        s.run_for(30.0)
        assert s.phase(first) is Phase.SUPERSEDED
        assert s.distance_m(120.0, 40.0) < 1.0
        assert s.phase(second) is Phase.DONE

    def test_a_refused_goto_leaves_the_one_that_is_flown(self) -> None:
        s = steered()
        order = s.goto(100.0)
        s.run_for(3.0)
        refused = s.order(GoTo(s.there(100.0), float("nan"), 5.0), OWNER)
        assert s.phase(refused) is Phase.REFUSED_BY_STATION
        assert s.stream is not None
        assert s.stream.command.id == order

    def test_the_pilot_takes_over_and_is_not_fought(self) -> None:
        s = steered()
        order = s.goto(200.0)
        s.run_for(6.0)
        s.aircraft.pilot_takes()
        s.run_until(lambda: s.stream is None, 2.0)
        seen_s = s.now_s
        assert s.phase(order) is Phase.SUPERSEDED
        assert s.note(order) == "pilot-only flight mode selected"
        assert s.w.driver.station.control(SERIAL).authority.holder is AuthorityHolder.PILOT
        assert s.refusal_rule(s.goto(50.0)) == "authority"
        s.run_for(10.0)
        assert s.sticks(seen_s + 0.05) == []
        assert s.hovers() == []
        assert s.aircraft.flight_mode is FlightMode.GPS_SPORT

    def test_an_aircraft_that_goes_home_by_itself_is_let_go(self) -> None:
        s = steered()
        order = s.goto(200.0)
        s.run_for(6.0)
        s.aircraft.has_pilot_control = True  # in failsafe sticks are ignored too
        s.aircraft.go_home()
        s.run_for(2.0)
        seen_s = s.now_s
        assert s.phase(order) is Phase.FAILED
        assert any("returning home" in text for text in s.alarm_texts())
        s.run_for(5.0)
        assert s.sticks(seen_s) == []
        assert s.hovers() == []
        assert s.aircraft.flight_mode is FlightMode.GO_HOME

    @pytest.mark.parametrize("holder", [AuthorityHolder.GUIDANCE, AuthorityHolder.PILOT])
    def test_another_holder_of_authority_ends_it_with_a_stop(self, holder: AuthorityHolder) -> None:
        s = steered()
        order = s.goto(200.0)
        s.run_for(6.0)
        s.w.driver.handle(AuthorityTaken(SERIAL, holder, "another"))
        taken_s = s.now_s
        s.run_for(8.0)
        assert s.phase(order) in (Phase.FAILED, Phase.SUPERSEDED)
        assert s.moving_sticks(taken_s + 0.15) == []
        assert s.aircraft.flight_mode is FlightMode.GPS_ATTI
        assert s.aircraft.motion.ground_speed_mps < 0.1

    def test_a_refusal_by_the_gate_stops_it_with_the_reason(self) -> None:
        """The satellites are lost: sticks are refused, a zero is not."""
        s = steered()
        order = s.goto(200.0)
        s.run_for(6.0)
        s.tap.app._sensors._satellites = 3
        s.run_until(lambda: s.phase(order) is Phase.FAILED, 2.0)
        refused_s = s.now_s
        assert "the gate refused its setpoint: " in s.note(order)
        assert s.refusal_rule(order) == "gnss"
        assert any("the gate refused its setpoint: " in text for text in s.alarm_texts())
        s.run_for(8.0)
        assert s.moving_sticks(refused_s + 0.05) == []
        assert len(s.zeros(refused_s - 0.01)) == 1
        assert len(s.hovers(refused_s)) >= 1
        assert s.aircraft.motion.ground_speed_mps < 0.1

    def test_a_battery_that_drops_stops_it_with_the_reason(self) -> None:
        s = steered()
        order = s.goto(200.0)
        s.run_for(6.0)
        s.aircraft.battery.fraction = 0.2
        s.run_until(lambda: s.phase(order) is Phase.FAILED, 2.0)
        refused_s = s.now_s
        assert "the gate refused its setpoint: " in s.note(order)
        assert s.refusal_rule(order) == "battery"
        s.run_for(8.0)
        assert s.moving_sticks(refused_s + 0.05) == []
        assert s.hovers(refused_s) != []
        assert s.aircraft.motion.ground_speed_mps < 0.1

    def test_an_app_that_carries_no_stick_out_is_given_up(self) -> None:
        s = steered(faults=(f"ack-then-nothing:{SERIAL}",))
        order = s.goto(200.0)
        s.run_for(4.0)
        assert s.phase(order) is Phase.FAILED
        assert "did not enter stick mode" in s.note(order)
        ended_s = s.now_s
        s.run_for(5.0)
        assert s.sticks(ended_s) == []

    def test_no_more_than_so_many_are_steered_at_once(self) -> None:
        s = steered()
        station = s.w.driver.station
        none = replace(station.settings.streams, most_at_once=0)
        s.w.driver.station = replace(station, settings=replace(station.settings, streams=none))
        order = s.goto(50.0)
        assert s.refusal_rule(order) == "steered_at_once"
        one = replace(none, most_at_once=1)
        s.w.driver.station = replace(station, settings=replace(station.settings, streams=one))
        first, second = s.goto(50.0), s.goto(60.0)
        assert s.phase(first) is Phase.SUPERSEDED
        assert s.stream is not None
        assert s.stream.command.id == second

    def test_a_hold_between_the_zero_and_the_stations_own_takes_its_place(self) -> None:
        s = steered()
        s.goto(200.0)
        s.run_for(5.0)
        s.holder_goes()
        s.run_for(0.05)
        assert s.stream is not None
        order = s.order(Hover())
        assert s.stream is None
        s.run_for(5.0)
        issuers = {r.command.issued_by for r in s.w.driver.station.orders.records.values()}
        assert issuers == {"test"}
        assert s.phase(order) is Phase.DONE

    def test_the_pilot_who_comes_between_the_zero_and_the_hold_is_left_alone(self) -> None:
        s = steered()
        s.goto(200.0)
        s.run_for(5.0)
        s.aircraft.pilot_takes()
        s.holder_goes()
        s.run_until(lambda: s.w.vehicle(SERIAL).flight_mode.value is FlightMode.GPS_SPORT, 1.0)
        replaced_s = s.now_s
        s.run_for(5.0)
        assert s.sticks(replaced_s + 0.05) == []
        assert s.aircraft.flight_mode is not FlightMode.JOYSTICK

    def test_a_landing_refused_for_want_of_a_link_ends_it_as_well(self) -> None:
        s = steered()
        order = s.goto(200.0)
        s.run_for(5.0)
        s.w.driver.disconnect(s.w.connected[SERIAL].link_id)
        stop = s.order(LandNow())
        assert s.phase(stop) is Phase.REFUSED_BY_STATION
        assert s.phase(order) is Phase.FAILED
        assert "land was ordered, and refused" in s.note(order)
        assert s.stream is None

    def test_a_vehicle_that_is_forgotten_is_steered_no_more(self) -> None:
        s = steered()
        s.goto(200.0)
        s.run_for(5.0)
        station = s.w.driver.station
        s.w.driver.station = replace(station, fleet=replace(station.fleet, vehicles={}))
        s.w.driver.disconnect(s.w.connected[SERIAL].link_id)
        s.run_for(0.2)
        assert s.stream is None

    def test_a_vehicle_on_the_ground_is_not_steered(self) -> None:
        s = steered()
        s.order(LandNow())
        s.run_for(60.0)
        assert s.aircraft.is_on_ground
        order = s.goto(20.0)
        assert s.phase(order) is Phase.REFUSED_BY_STATION
        assert s.sticks() == []

    def test_a_stop_that_waits_for_telemetry_ends_it_too(self) -> None:
        s = steered(faults=(f"telemetry-dropout:{SERIAL}:8:30",))
        s.goto(200.0)
        s.run_for(7.95)
        s.order(Hover())
        assert s.stream is None


def lived(s: Steered, order: int) -> None:
    """What holds of every flight, whatever happened on it."""
    record = s.w.record(order)
    ended_s = record.history[-1].at_ns / 1e9 if record.phase is Phase.FAILED else s.now_s
    assert all(at_s <= ended_s + 0.35 for at_s in s.moving_sticks(0.0))
    assert all(packet.timeout_s == 1.0 for _, packet in s.sticks())
    assert all(packet.mode == 0 for _, packet in s.sticks())
    if record.phase is Phase.FAILED:
        assert s.alarm_texts()
        assert s.stream is None


@settings(max_examples=examples(10), deadline=None, phases=(Phases.explicit, Phases.generate))
@given(
    st.floats(5.0, 12.0),
    st.floats(0.2, 6.0),
    st.floats(0.0, 0.2),
    st.integers(0, 1_000),
    st.sampled_from(["telemetry-dropout", "restart", "half-open", "second-link"]),
)
@pytest.mark.flight
def test_whatever_happens_to_the_link_no_stick_outlives_its_stream(
    at_s: float, lasts_s: float, jitter_s: float, seed: int, fault: str
) -> None:
    s = steered(
        faults=(f"{fault}:{SERIAL}:{at_s:.2f}:{lasts_s:.2f}",),
        make_link=lambda: FakeLink(delay_s=0.03, jitter_s=jitter_s, seed=seed),
        seed=seed,
    )
    order = s.goto(150.0, 20.0)
    s.run_for(45.0)
    lived(s, order)
    assert s.aircraft.motion.ground_speed_mps < 0.3
    if s.phase(order) is not Phase.FAILED:
        assert s.distance_m(150.0, 20.0) < 1.0
