"""Temporary zones act at once: on orders, on what is under way, and over a restart."""

from dataclasses import replace
from math import hypot

import pytest
from tests.fleet.reports import PLACE, S
from tests.safety.cases import STICK, mission
from tests.station.commanded import AIRSPACE, CommandedStation
from tests.station.failsafe.reacting import put_matrix, with_cell
from tests.station.flown import hovering
from tests.station.recovery.restarts import restart_world, restored_from, saved
from tests.station.station_world import HOME, World, world

from recon.geo.distance import moved_m, offset_north_east_m
from recon.model.airspace import ZoneKind
from recon.model.command import FlyMission, Phase, Refusal
from recon.model.event import AlarmAcknowledged, ZoneDrawn, ZoneEnded
from recon.model.failsafe_matrix import Activity, FailsafeCondition, Reaction
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint
from recon.model.severity import Severity
from recon.model.temporary_zone import Circle, DrawnZone, TemporaryZoneKind
from recon.safety.temporary_zones import MOST_ZONES
from recon.station.control import dispatch, temporary_zones
from recon.station.recovery.restart import restart_entries
from recon.station.recovery.snapshot import decode_snapshot, encode_snapshot, take_snapshot
from recon.station.state.station import Station

ANN = "Ann"
START = LatLon(HOME.latitude_deg, HOME.longitude_deg)


def person(
    north_m: float, radius_m: float = 10.0, *, lasts_s: float | None = None, start: LatLon = PLACE
) -> ZoneDrawn:
    circle = Circle(moved_m(start, north_m, 0.0), radius_m)
    drawn = DrawnZone(TemporaryZoneKind.PERSON, circle, "checks a sprinkler", lasts_s=lasts_s)
    return ZoneDrawn(drawn, ANN)


def ahead(at_north_m: float, radius_m: float = 10.0, lasts_s: float | None = None) -> ZoneDrawn:
    """A zone for a person on the simulated vehicle's way."""
    return person(at_north_m, radius_m, start=START, lasts_s=lasts_s)


def north_m(here: World) -> float:
    position = here.vehicle("SIM-1").position.value
    assert position is not None
    return offset_north_east_m(START, position)[0]


def speed_mps(here: World) -> float:
    velocity = here.vehicle("SIM-1").velocity_ned.value
    assert velocity is not None
    return hypot(velocity.north_mps, velocity.east_mps)


def northward(speed: float = 5.0, far_m: float = 300.0) -> FlyMission:
    """Over home, and then straight north."""
    places = (moved_m(START, at_m, 0.0) for at_m in (0.0, far_m))
    waypoints = (Waypoint(p.latitude_deg, p.longitude_deg, 45.0, speed) for p in places)
    return FlyMission(Mission(tuple(waypoints)))


def flown_to(far_m: float, speed: float = 5.0) -> tuple[World, int]:
    """A simulated vehicle that flies north, this far from home."""
    here = world()
    here.run_for(2.0)
    order = here.order("SIM-1", northward(speed))
    assert here.run_until(lambda: north_m(here) >= far_m and speed_mps(here) > speed - 0.5, 120.0)
    return here, order


def alarms(station: Station) -> dict[str, str]:
    """The text of each active alarm, by rule."""
    active = (alarm.condition for alarm in station.alarms.alarms.values() if alarm.is_active)
    return {condition.rule: condition.text for condition in active}


class TestUnderWay:
    @pytest.mark.parametrize("speed", [5.0, 8.0])
    def test_a_mission_is_held_before_a_zone_drawn_25_m_ahead(self, speed: float) -> None:
        here, order = flown_to(60.0, speed)
        edge_m = north_m(here) + 25.0
        here.driver.handle(ahead(edge_m + 10.0))
        here.run_for(10.0)
        assert speed_mps(here) < 0.3
        assert edge_m - 12.0 < north_m(here) < edge_m
        assert here.record(order).phase is Phase.SUPERSEDED
        hold = here.driver.station.orders.records[-1]
        assert hold.command.issued_by == "station: zone_ahead"
        texts = [a.condition.text for a in here.driver.station.alarms.alarms.values()]
        assert any(
            "is about to enter the keep-out zone 'person 1 (temporary)'" in text for text in texts
        )

    def test_a_site_that_leaves_its_geofence_to_alarms_does_not_leave_this_to_them(self) -> None:
        here, _ = flown_to(20.0)
        put_matrix(here, with_cell(FailsafeCondition.GEOFENCE, Activity.MISSION, Reaction.ALARM))
        here.driver.handle(ahead(north_m(here) + 25.0 + 10.0))
        here.run_for(20.0)
        assert speed_mps(here) < 0.5
        assert here.driver.station.orders.records[-1].command.issued_by == "station: zone_ahead"

    def test_one_far_ahead_lets_it_fly_up_to_it(self) -> None:
        here, _order = flown_to(60.0)
        here.driver.handle(ahead(200.0))
        here.run_for(5.0)
        assert speed_mps(here) > 4.0
        here.run_for(40.0)
        assert speed_mps(here) < 0.3
        assert 170.0 < north_m(here) < 190.0

    def test_one_that_ended_before_holds_nothing(self) -> None:
        here, _order = flown_to(60.0)
        here.driver.handle(ahead(200.0))
        here.driver.handle(ZoneEnded(1, ANN))
        here.run_for(40.0)
        assert north_m(here) > 220.0

    def test_what_is_beside_it_flies_on(self) -> None:
        here, _order = flown_to(60.0)
        beside = replace(ahead(0.0).drawn, shape=Circle(moved_m(START, 100.0, 40.0), 20.0))
        here.driver.handle(ZoneDrawn(beside, ANN))
        here.run_for(20.0)
        assert north_m(here) > 140.0

    def test_one_drawn_over_a_vehicle_alarms_at_once_and_lets_it_be_led_out(self) -> None:
        here, _order = flown_to(60.0)
        here.driver.handle(ahead(north_m(here) + 20.0, 30.0))
        here.run_for(0.5)
        text = alarms(here.driver.station)["zone_ahead"]
        assert "is in the keep-out zone 'person 1 (temporary)'" in text
        here.run_for(8.0)
        assert speed_mps(here) < 0.3
        through = here.order("SIM-1", northward(3.0))
        assert here.record(through).note.startswith("SIM-1: ")
        assert "goes through the keep-out zone 'person 1 (temporary)'" in here.record(through).note
        out = here.order("SIM-1", northward(3.0, -40.0))
        assert here.record(out).phase is not Phase.REFUSED_BY_STATION, here.record(out).note
        assert here.run_until(lambda: north_m(here) < 10.0, 60.0)
        here.run_for(4.0)
        assert "zone_ahead" not in alarms(here.driver.station)


class TestOrders:
    def test_the_next_order_into_it_is_refused(self) -> None:
        scene = hovering()
        scene.happens(person(30.0))
        assert scene.refusal_rule(scene.order(mission())) == "keep_out"
        assert scene.phase(scene.order(STICK)) is not Phase.REFUSED_BY_STATION

    def test_what_waits_to_be_sent_is_judged_by_it(self) -> None:
        scene = hovering()
        scene.is_stuck = True
        scene.order(mission())
        (approved,) = scene.handed
        assert dispatch.objection(scene.station, approved, scene.now_ns + S // 10) is None
        scene.happens(person(30.0))
        objection = dispatch.objection(scene.station, approved, scene.now_ns + S // 10)
        assert objection is not None
        assert "the situation has changed" in objection.reason
        assert "person 1 (temporary)" in objection.reason

    def test_the_next_part_of_a_mission_is_not_flown_into_it(self) -> None:
        here = world(max_waypoints=2)
        here.run_for(2.0)
        places = (moved_m(START, at_m, 0.0) for at_m in (0.0, 60.0, 120.0, 180.0))
        legs = tuple(Waypoint(p.latitude_deg, p.longitude_deg, 45.0, 8.0) for p in places)
        order = here.order("SIM-1", FlyMission(Mission(legs)))
        assert here.run_until(lambda: north_m(here) > 20.0 and speed_mps(here) > 5.0, 60.0)
        here.driver.handle(ahead(150.0))
        assert here.run_until(lambda: here.record(order).phase is Phase.FAILED, 60.0)
        assert "part 3 of 3 is not flown" in here.record(order).note
        assert "person 1 (temporary)" in here.record(order).note


class TestDrawing:
    def test_it_stands_in_the_airspace_with_its_name(self) -> None:
        scene = CommandedStation().happens(person(50.0))
        (zone,) = scene.station.temporary_zones.in_force.values()
        assert (zone.id, zone.by, zone.name) == (1, ANN, "person 1 (temporary)")
        names = [each.zone.name for each in scene.station.airspace.zones_of(ZoneKind.KEEP_OUT)]
        assert names == ["person 1 (temporary)"]
        assert not AIRSPACE.zones

    def test_numbers_are_not_used_twice(self) -> None:
        scene = CommandedStation().happens(person(50.0)).happens(ZoneEnded(1, ANN))
        scene.happens(person(60.0))
        assert list(scene.station.temporary_zones.in_force) == [2]
        assert scene.station.temporary_zones.changes == 3

    def test_what_cannot_be_drawn_changes_nothing(self) -> None:
        scene = CommandedStation()
        before = scene.station
        event = person(50.0, float("nan"))
        refusal = temporary_zones.draw_refusal(before, event)
        assert refusal == Refusal(
            "temporary_zone",
            "the zone was not drawn: its radius is nan m: 1 to 2000 m are possible; to clear more, "
            "use the all stop",
        )
        assert scene.happens(event).station is before

    def test_without_a_site_there_is_no_place_for_one(self) -> None:
        refusal = temporary_zones.draw_refusal(Station(), person(50.0))
        assert refusal is not None
        assert "needs a site with an origin" in refusal.reason

    def test_there_are_not_more_than_a_person_can_oversee(self) -> None:
        scene = CommandedStation()
        for number in range(MOST_ZONES):
            scene.happens(person(10.0 * number))
        refusal = temporary_zones.draw_refusal(scene.station, person(0.0))
        assert refusal is not None
        assert "32 temporary zones are in force" in refusal.reason
        assert len(scene.happens(person(0.0)).station.airspace.zones) == MOST_ZONES

    def test_one_that_is_unknown_cannot_be_ended(self) -> None:
        scene = CommandedStation().happens(person(50.0))
        refusal = temporary_zones.end_refusal(scene.station, ZoneEnded(7, ANN))
        assert refusal is not None
        assert refusal.reason == (
            "no temporary zone 7 is in force; those in force are: 1 (person 1 (temporary))"
        )
        before = scene.station
        assert scene.happens(ZoneEnded(7, ANN)).station is before


class TestItsTime:
    def test_it_is_shown_to_all_and_its_end_is_announced(self) -> None:
        scene = CommandedStation().happens(person(50.0, lasts_s=120.0)).passes(0.1)
        (alarm,) = scene.station.alarms.alarms.values()
        assert alarm.condition.severity is Severity.INFO
        assert alarm.condition.text == (
            "temporary zone person 1 (temporary) by Ann: checks a sprinkler; for the next 2 min"
        )
        scene.happens(AlarmAcknowledged(alarm.id, ANN)).passes(60.0)
        (alarm,) = scene.station.alarms.alarms.values()
        assert alarm.condition.severity is Severity.WARNING
        assert alarm.acknowledged_by is None
        assert "ends within a minute" in alarm.condition.text

    def test_at_its_end_it_is_gone_with_an_alarm(self) -> None:
        scene = CommandedStation().happens(person(50.0, lasts_s=10.0)).passes(9.9)
        assert scene.station.airspace.zones
        scene.passes(0.2)
        assert not scene.station.airspace.zones
        assert not scene.station.temporary_zones.in_force
        texts = [a.condition.text for a in scene.station.alarms.alarms.values()]
        assert any("has ended, its time is over" in text for text in texts)

    def test_without_an_end_it_lasts_until_a_person_ends_it(self) -> None:
        scene = CommandedStation().happens(person(50.0)).passes(60.0)
        assert alarms(scene.station)["temporary_zone"].endswith("until a person ends it")
        scene.happens(ZoneEnded(1, "Bob")).passes(0.1)
        assert "temporary_zone" not in alarms(scene.station)


class TestARestart:
    def test_zones_outlive_it_and_are_audited(self) -> None:
        here, _order = flown_to(60.0)
        here.driver.handle(ahead(200.0, lasts_s=3_600.0))
        before = here.driver.station.temporary_zones
        restart_world(here)
        here.run_for(10.0)
        after = here.driver.station.temporary_zones
        (old,), (zone,) = before.in_force.values(), after.in_force.values()
        assert zone == replace(old, drawn=replace(old.drawn, lasts_s=None))
        assert after.next_id == 2
        names = [each.zone.name for each in here.driver.station.airspace.zones]
        assert names == ["person 1 (temporary)"]
        entries = list(restart_entries(here.driver.station))
        assert [e.text for e in entries if e.kind == "temporary_zone.restored"] == [
            "temporary zone person 1 (temporary) restored: checks a sprinkler"
        ]

    def test_one_whose_time_is_over_ends_with_the_first_tick(self) -> None:
        scene = CommandedStation().happens(person(50.0, lasts_s=30.0))
        snapshot = saved(scene.station, scene.now_ns)
        later_ns = scene.now_ns + 3_600_000_000_000
        station = restored_from(snapshot, later_ns, Station(airspace=AIRSPACE))
        assert station.airspace.zones
        station, _ = temporary_zones.end_due(station, later_ns)
        assert not station.airspace.zones

    def test_ids_go_on_after_zones_that_have_ended(self) -> None:
        scene = CommandedStation().happens(person(50.0)).happens(ZoneEnded(1, ANN))
        snapshot = saved(scene.station, scene.now_ns)
        station = restored_from(snapshot, scene.now_ns, Station(airspace=AIRSPACE))
        assert station.temporary_zones.next_id == 2

    def test_one_that_cannot_be_used_is_an_alarm(self) -> None:
        scene = CommandedStation().happens(person(50.0))
        snapshot = saved(scene.station, scene.now_ns)
        station = restored_from(snapshot, scene.now_ns, Station())
        assert not station.temporary_zones.in_force
        (alarm,) = station.alarms.alarms.values()
        assert alarm.condition.text.startswith(
            "temporary zone person 1 (temporary) of the last run is not in force: "
        )

    def test_a_snapshot_with_a_value_out_of_range_is_rejected(self) -> None:
        scene = CommandedStation().happens(person(50.0))
        data = encode_snapshot(take_snapshot(scene.station, scene.now_ns))
        with pytest.raises(ValueError, match="temporary_zones"):
            decode_snapshot(data.replace(b'"kind":"person"', b'"kind":"bird"'))
