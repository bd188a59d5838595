"""Missions in parts: repaired, judged as a whole, and each part flown only over a whole chain."""

from dataclasses import replace

import pytest
from tests.safety.cases import mission, waypoint
from tests.station.audited import Audited
from tests.station.commanded import PROFILES, CommandedStation
from tests.station.flown import GPS, NORTHWARD, WAYPOINT, at, flies, hovering, row
from tests.station.recovery.restarts import restart_world
from tests.station.station_world import HOME, World, world

from recon.geo.distance import horizontal_distance_m
from recon.model.command import FlyMission, Hover, LandNow, Phase, StopCamera
from recon.model.control import AuthorityHolder
from recon.model.event import AuthorityTaken, CommandSent
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint
from recon.model.vehicle import FlightMode
from recon.station.state.orders import OrderRecord

BROKEN_OFF = "mission_broken_off"


def in_parts(count: int = 7, most: int = 3) -> tuple[CommandedStation, int]:
    """A vehicle whose app takes three waypoints, ordered seven in a row 10 m apart."""
    scene = hovering()
    profile = replace(PROFILES["A"], max_waypoints=most)
    vehicle = replace(scene.station.fleet.vehicles["A"], profile=profile)
    fleet = replace(
        scene.station.fleet,
        profiles={**scene.station.fleet.profiles, "A": profile},
        vehicles={**scene.station.fleet.vehicles, "A": vehicle},
    )
    scene.station = replace(scene.station, fleet=fleet)
    order = scene.order(row(count))
    scene.answered(order, True)
    return scene, order


def flown_to(scene: CommandedStation, *norths_m: float) -> CommandedStation:
    """It flies past these places and hovers at the last: a part's end."""
    flies(scene, *norths_m)
    return scene.keeps_receiving(1, *at(norths_m[-1], GPS)).passes(0.3)


def missions_sent(scene: CommandedStation) -> list[Mission]:
    return [body.mission for body in scene.bodies() if isinstance(body, FlyMission)]


class TestParts:
    def test_each_is_sent_when_the_one_before_was_flown_to_its_end(self) -> None:
        scene, order = in_parts()
        assert [len(part.waypoints) for part in missions_sent(scene)] == [3]
        flies(scene, 0.0, 10.0, 20.0)
        assert len(missions_sent(scene)) == 1
        scene.keeps_receiving(1, *at(20.0, GPS)).passes(0.1)
        assert len(missions_sent(scene)) == 2
        flown_to(scene, 20.0, 30.0, 40.0)
        flown_to(scene, 40.0, 50.0, 60.0)
        assert len(missions_sent(scene)) == 3
        scene.passes(30.0)
        assert len(missions_sent(scene)) == 3
        assert scene.phase(order) is Phase.DONE
        assert scene.alarms() == set()

    def test_phases_name_the_part_and_the_order_ends_once(self) -> None:
        scene, order = in_parts(5)
        flown_to(scene, 0.0, 10.0, 20.0)
        scene.answered(order, True)
        flown_to(scene, 20.0, 30.0, 40.0)
        part = [Phase.QUEUED, Phase.SENT, Phase.ACKNOWLEDGED, Phase.STARTED]
        assert scene.phases(order) == [*part, *part, Phase.DONE]
        notes = [change.note for change in scene.record(order).history]
        assert notes[3] == "part 1 of 2: telemetry shows the mission flying"
        assert notes[4] == "part 2 of 2"

    def test_the_second_begins_where_the_first_ended_and_the_last_alone_lands(self) -> None:
        scene = in_parts()[0]
        plan = next(iter(scene.station.orders.records.values())).plan
        assert plan is not None
        assert [part.land_at_end for part in plan.parts] == [False] * 3
        assert [part.waypoints[0] for part in plan.parts[1:]] == [
            part.waypoints[-1] for part in plan.parts[:-1]
        ]

    def test_repairs_are_on_the_record(self) -> None:
        scene = hovering()
        order = scene.order(mission(waypoint(0.0, speed_mps=0.0), waypoint(50.0), waypoint(50.4)))
        plan = scene.record(order).plan
        assert plan is not None
        assert len(plan.repairs) == 2
        assert len(missions_sent(scene)[0].waypoints) == 2

    def test_the_whole_is_judged_when_it_is_ordered(self) -> None:
        """Its last waypoint lies outside of the fence: not even the first part is flown."""
        scene = hovering()
        points = [*row(120).mission.waypoints, waypoint(3_100.0)]
        order = scene.order(mission(*points))
        assert scene.phase(order) is Phase.REFUSED_BY_STATION
        assert missions_sent(scene) == []

    def test_a_mission_ignored_is_an_alarm_for_a_later_part_too(self) -> None:
        scene, order = in_parts()
        flown_to(scene, 0.0, 10.0, 20.0).passes(8.5)
        assert scene.phase(order) is Phase.TIMED_OUT
        assert scene.record(order).note.startswith("part 2 of 3: ")
        assert scene.alarms() == {"mission_ignored"}
        flies(scene, 25.0)
        assert scene.alarms() == set()
        scene.keeps_receiving(1, *at(40.0, GPS)).passes(10.0)
        assert len(missions_sent(scene)) == 2

    def test_a_later_part_that_the_app_refuses_is_an_alarm(self) -> None:
        scene, order = in_parts()
        flown_to(scene, 0.0, 10.0, 20.0)
        scene.answered(order, False).passes(0.1)
        assert scene.phase(order) is Phase.REFUSED_BY_APP
        assert scene.alarms() == {BROKEN_OFF}

    def test_a_later_part_that_never_left_is_an_alarm(self) -> None:
        scene, order = in_parts()
        flies(scene, 0.0, 10.0, 20.0)
        scene.is_stuck = True
        scene.keeps_receiving(1, *at(20.0, GPS)).passes(6.0)
        assert scene.phase(order) is Phase.EXPIRED
        assert scene.alarms() == {BROKEN_OFF}


class TestBrokenOff:
    def ended(self, scene: CommandedStation, order: int, why: str) -> None:
        assert scene.phase(order) is Phase.FAILED
        assert why in scene.record(order).note
        assert "it holds at the end of part 1" in scene.record(order).note
        assert len(missions_sent(scene)) == 1
        assert BROKEN_OFF in scene.alarms()

    def test_a_link_renewed_in_between_ends_it_at_the_end_of_the_part(self) -> None:
        scene, order = in_parts()
        flies(scene, 0.0, 10.0)
        scene.closes(1).passes(0.5)
        reports = at(15.0, WAYPOINT, velocity=NORTHWARD)
        scene.opens(2, *reports).keeps_receiving(2, *reports).passes(1.0)
        assert scene.phase(order) is Phase.STARTED
        assert "no part will follow" in scene.record(order).note
        scene.keeps_receiving(2, *at(20.0, GPS)).passes(0.3)
        self.ended(scene, order, "its connection ended or was renewed")

    @pytest.mark.parametrize(("silent_s", "is_broken"), [(2.8, False), (3.3, True)])
    def test_a_gap_of_telemetry_of_more_than_3_s_ends_it(
        self, silent_s: float, is_broken: bool
    ) -> None:
        scene, order = in_parts()
        flies(scene, 0.0, 10.0).talk.clear()
        scene.passes(silent_s)
        flown_to(scene, 18.0, 20.0)
        if is_broken:
            self.ended(scene, order, "no telemetry for more than 3 s")
        else:
            assert len(missions_sent(scene)) == 2

    def test_a_change_of_authority_ends_it(self) -> None:
        scene, order = in_parts()
        flies(scene, 0.0, 10.0).happens(AuthorityTaken("A", AuthorityHolder.OPERATOR, "another"))
        flown_to(scene, 15.0, 20.0)
        self.ended(scene, order, "authority changed since the order")

    def test_what_the_gate_refuses_then_is_not_flown(self) -> None:
        scene, order = in_parts()
        flies(scene, 0.0, 10.0, 20.0)
        reports = (at(20.0, GPS)[0], replace(at(20.0, GPS)[1], gnss_signal_level=0))
        scene.keeps_receiving(1, *reports).passes(0.5)
        self.ended(scene, order, "GNSS signal level")
        assert scene.refusal_rule(order) == "gnss"

    def test_the_pilot_ends_it_at_once(self) -> None:
        scene, order = in_parts()
        flies(scene, 0.0, 10.0).keeps_receiving(1, *at(12.0, GPS)).passes(1.5)
        assert scene.phase(order) is Phase.SUPERSEDED
        scene.keeps_receiving(1, *at(20.0, GPS)).passes(30.0)
        assert len(missions_sent(scene)) == 1

    def test_a_newer_order_ends_it_and_a_camera_order_does_not(self) -> None:
        scene, order = in_parts()
        flies(scene, 0.0, 10.0).order(StopCamera())
        assert scene.phase(order) is Phase.STARTED
        scene.order(Hover())
        flown_to(scene, 15.0, 20.0).passes(10.0)
        assert scene.phase(order) is Phase.SUPERSEDED
        assert len(missions_sent(scene)) == 1

    def test_the_alarm_ends_with_a_newer_order_or_on_the_ground(self) -> None:
        for ends in ("order", "ground"):
            scene, _ = in_parts()
            flies(scene, 0.0, 10.0).happens(
                AuthorityTaken("A", AuthorityHolder.OPERATOR, "another")
            )
            flown_to(scene, 15.0, 20.0)
            assert BROKEN_OFF in scene.passes(60.0).alarms()
            if ends == "order":
                scene.order(LandNow())
            else:
                scene.lands(1, *at(20.0, GPS, flying=False))
            assert BROKEN_OFF not in scene.passes(0.2).alarms()


# --- the whole way, with a simulated app ---------------------------------------------------------


def lawn(count: int, per_row: int = 23) -> FlyMission:
    """Rows of waypoints 4 m apart, flown round their corners."""
    points = []
    for number in range(count):
        line, column = divmod(number, per_row)
        east_m = 4.0 * (column if line % 2 == 0 else per_row - 1 - column)
        points.append(
            Waypoint(
                HOME.latitude_deg + 6.0 * line / 111_000.0,
                HOME.longitude_deg + east_m / 82_600.0,
                45.0,
                8.0,
                corner_radius_m=1.0,
            )
        )
    return FlyMission(Mission(tuple(points), curved=True))


def flying(count: int, most: int) -> tuple[World, int]:
    w = world(keeps_log=False, max_waypoints=most)
    w.run_for(2.0)
    return w, w.order("SIM-1", lawn(count))


def parts_flown(record: OrderRecord) -> int:
    return sum("the mission flying" in change.note for change in record.history)


@pytest.mark.flight
def test_230_waypoints_are_flown_in_three_parts() -> None:
    w, order = flying(230, 99)
    assert w.run_until(lambda: w.record(order).phase.is_final, 400.0)
    record = w.record(order)
    assert record.phase is Phase.DONE
    assert parts_flown(record) == 3
    assert record.plan is not None
    assert [len(part.waypoints) for part in record.plan.parts] == [99, 99, 34]
    assert w.driver.station.alarms.alarms == {}
    place, end = w.vehicle("SIM-1").position.value, record.plan.part.waypoints[-1]
    assert place is not None
    assert horizontal_distance_m(place, LatLon(end.latitude_deg, end.longitude_deg)) < 3.0


def test_a_link_that_breaks_in_the_second_part_ends_it_there_and_nothing_is_sent_again() -> None:
    w, order = flying(40, 15)
    assert w.run_until(lambda: parts_flown(w.record(order)) == 2, 200.0)
    w.run_for(3.0)
    w.driver.disconnect(w.connected["SIM-1"].link_id)
    w.connect(w.app("SIM-1"))
    assert w.run_until(lambda: w.record(order).phase.is_final, 200.0)
    record = w.record(order)
    assert record.phase is Phase.FAILED
    assert parts_flown(record) == 2
    assert "part 3 of 3 is not flown: its connection ended or was renewed" in record.note
    w.run_for(30.0)
    assert w.record(order).times_sent == 2
    aircraft = w.app("SIM-1").aircraft
    assert aircraft.flight_mode is FlightMode.GPS_ATTI
    assert aircraft.motion.ground_speed_mps < 0.5
    rules = {alarm.condition.rule for alarm in w.driver.station.alarms.alarms.values()}
    assert BROKEN_OFF in rules


def test_a_restart_in_flight_sends_no_next_part() -> None:
    w = world(max_waypoints=15)
    audited = Audited(w)
    w.run_for(2.0)
    order = w.order("SIM-1", lawn(40))
    (queued, *_) = audited.of("order.queued")
    assert queued.details["parts"] == 3
    assert "flown in 3 parts" in queued.details["repairs"][0]
    assert w.run_until(lambda: parts_flown(w.record(order)) == 1, 30.0)
    w.run_for(5.0)
    restart_world(w)
    w.run_for(60.0)
    assert w.record(order).phase is Phase.FAILED
    assert not any(isinstance(event, CommandSent) for event in w.driver.log)
    assert w.app("SIM-1").aircraft.flight_mode is FlightMode.GPS_ATTI
