"""Whole station and simulated apps: what is false in telemetry gates nothing and is an alarm."""

from dataclasses import replace

import pytest
from tests.station.audited import Audited
from tests.station.station_world import World, square_mission, world
from tests.station.steered_world import steered

from recon.fleet.state import staleness
from recon.geo.distance import horizontal_distance_m
from recon.model.command import FlyMission, Hover, Phase
from recon.model.event import ClockGap
from recon.model.units import seconds_to_ns
from recon.model.vehicle import Staleness
from recon.sim.flight.flight_modes import GoHome
from recon.station.traffic.known_traffic import in_the_air


def alarms(w: World) -> dict[str, str]:
    """The active alarms: their sentences by rule."""
    book = w.driver.station.alarms.alarms.values()
    return {a.condition.rule: a.condition.text for a in book if a.is_active}


class TestFalseReportsOfTheGround:
    def test_one_in_flight_leaves_home_and_datum_as_they_were(self) -> None:
        w = world(faults=("false-ground:1:20:0.25",))
        audited = Audited(w)
        w.run_for(1.0)
        order = w.order("SIM-1", FlyMission(square_mission()))
        w.run_for(18.0)
        before = w.vehicle("SIM-1")
        assert before.reported_is_flying.value is True
        w.run_for(1.3)
        assert w.vehicle("SIM-1").reported_is_flying.value is False
        assert w.vehicle("SIM-1").is_flying.value is True
        w.run_for(1.0)
        after = w.vehicle("SIM-1")
        assert after.takeoff_point == before.takeoff_point
        assert after.altitude_offset_at_takeoff_m == before.altitude_offset_at_takeoff_m
        assert "treated as flying" in alarms(w)["ground_report"]
        assert w.record(order).phase is Phase.STARTED
        assert audited.of("vehicle.doubted")[0].text.startswith("SIM-1: reports on")
        assert audited.of("vehicle.landed") == []

    def test_a_steady_one_hides_nothing_from_the_others(self) -> None:
        """A hovers at 40 m, and B is sent through its place."""
        w = world(2, faults=("false-ground:1:5",))
        w.run_for(8.0)
        assert w.vehicle("SIM-1").reported_is_flying.value is False
        assert "SIM-1" in [vehicle.serial for vehicle, _ in in_the_air(w.driver.station)]
        here = w.vehicle("SIM-1").position.value
        height_m = w.vehicle("SIM-1").height_above_takeoff_m.value
        assert here is not None
        assert height_m is not None
        mission = square_mission(height_m=height_m)
        places = tuple(
            replace(
                waypoint,
                latitude_deg=here.latitude_deg + n * 1e-4,
                longitude_deg=here.longitude_deg,
            )
            for n, waypoint in enumerate(mission.waypoints)
        )
        order = w.order("SIM-2", FlyMission(replace(mission, waypoints=places)))
        assert w.record(order).phase is Phase.REFUSED_BY_STATION
        refusal = w.record(order).refusal
        assert refusal is not None
        assert refusal.rule == "separation"

    def test_a_hold_still_stops_it(self) -> None:
        w = world(faults=("false-ground:1:10",))
        w.run_for(1.0)
        w.order("SIM-1", FlyMission(square_mission(side_m=60.0)))
        w.run_for(14.0)
        order = w.order("SIM-1", Hover())
        w.run_for(8.0)
        assert w.record(order).phase is Phase.DONE
        assert w.app("SIM-1").aircraft.motion.ground_speed_mps < 0.2


class TestFrozenTelemetry:
    def test_a_mission_is_not_seen_flown_and_none_is_accepted(self) -> None:
        """Its values stand still under fresh packets, while it goes home and lands."""
        w = world(faults=("frozen-telemetry:1:15:60",))
        w.run_for(1.0)
        w.order("SIM-1", FlyMission(square_mission()))
        w.run_for(14.5)
        aircraft = w.app("SIM-1").aircraft
        aircraft.active_mode = GoHome(0.0, 0.0, 50.0, aircraft.settings.limits)
        w.run_for(6.0)
        vehicle = w.vehicle("SIM-1")
        assert staleness(vehicle, w.driver.now_ns) is Staleness.LOST
        assert {"frozen_telemetry", "link_lost"} <= set(alarms(w))
        refused = w.order("SIM-1", FlyMission(square_mission()))
        refusal = w.record(refused).refusal
        assert refusal is not None
        assert refusal.rule in ("flying", "link_age")


class TestJumps:
    def test_steering_stops_and_does_not_follow_a_jump(self) -> None:
        s = steered(faults=("position-jump:1:8:30",))
        order = s.goto(80.0, speed_mps=8.0)
        s.run_until(lambda: s.distance_m(0.0) > 30.0)
        s.w.run_for(12.0)
        assert s.phase(order) is Phase.FAILED
        assert "its position jumped" in s.note(order)
        assert s.distance_m(80.0) > 5.0
        furthest_m = s.aircraft.motion.north_m
        assert furthest_m < 80.0
        assert s.aircraft.motion.ground_speed_mps < 0.2
        assert "position_jump" in alarms(s.w)

    def test_a_short_one_is_never_believed(self) -> None:
        w = world(faults=("position-jump:1:6:1.5",))
        w.run_for(5.9)
        before = w.vehicle("SIM-1").position.value
        assert before is not None
        for _ in range(30):
            w.run_for(0.1)
            now = w.vehicle("SIM-1").position.value
            assert now is not None
            assert horizontal_distance_m(before, now) < 5.0
        assert "position_jump" in alarms(w)


class TestAlarmsInFlight:
    def test_gnss_lost(self) -> None:
        w = world(faults=("gnss-loss:1:5",))
        w.run_for(4.0)
        assert "gnss" not in alarms(w)
        w.run_for(5.0)
        assert "GNSS lost (3 satellites, signal level 0 of 5)" in alarms(w)["gnss"]


class TestSuspension:
    @pytest.mark.parametrize("seconds", [2.0, 60.0])
    def test_nothing_from_before_gates_motion_after_it(self, seconds: float) -> None:
        """The packets that waited arrive first, as fresh ones would."""
        w = world()
        w.run_for(5.0)
        w.driver.now_ns += seconds_to_ns(seconds)
        w.driver.handle(ClockGap(seconds))
        assert f"suspended for {seconds:.0f} s" in str(w.driver.station.alarms.alarms.values())
        w.run_for(0.5)
        refused = w.order("SIM-1", FlyMission(square_mission()))
        refusal = w.record(refused).refusal
        assert refusal is not None
        assert refusal.rule in ("flying", "link_age")
        w.run_for(1.0)
        accepted = w.order("SIM-1", FlyMission(square_mission()))
        assert w.record(accepted).phase is not Phase.REFUSED_BY_STATION
