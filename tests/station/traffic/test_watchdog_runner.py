"""The watchdogs' findings become alarms and holds, ten times a second."""

import pytest
from tests.fleet.reports import PLACE, S, core, extended
from tests.station.commanded import CommandedStation
from tests.station.operations.test_fleet_return import SIX, six_in_the_air
from tests.station.returning_world import LEAST_LEVEL_M

from recon.geo.distance import moved_m
from recon.model.command import GoTo, Hover, Phase, ReturnHome
from recon.model.control import AuthorityHolder, Commanded, ControlAuthority, Intent
from recon.model.event import AuthorityTaken, SeparationHoldSwitched, Tick
from recon.model.geo import LatLon
from recon.model.severity import Severity
from recon.model.vehicle import FlightMode
from recon.safety.watchdogs import CommandedHold, hold_outcome
from recon.station.state.alarm_book import Alarm


def place(north_m: float) -> LatLon:
    return moved_m(PLACE, north_m, 0.0)


HELD = hold_outcome(CommandedHold(0, 0.0), "")
"""What a finding states of a vehicle whose hold was sent."""


class Two:
    """A (link 1) and B (link 2) on one line, north of each other, moving as reported."""

    def __init__(self, gap_m: float, a_mps: float = 5.0, b_mps: float = -5.0) -> None:
        self.scene = CommandedStation()
        taken = ControlAuthority(AuthorityHolder.OPERATOR, "Ann", 0, "taken over by Ann")
        for serial in "AB":
            self.scene.station = self.scene.station.with_control(serial, authority=taken)
        self.north_m = {1: 0.0, 2: gap_m}
        self.mps = {1: a_mps, 2: b_mps}
        self.flying = {1: True, 2: True}
        self.receives()

    def receives(self) -> None:
        for link_id, serial in ((1, "A"), (2, "B")):
            if link_id not in self.north_m:
                continue
            reports = (
                core(
                    flying=self.flying[link_id],
                    position=place(self.north_m[link_id]),
                    velocity=(self.mps[link_id], 0.0, 0.0),
                ),
                extended(serial, mode=FlightMode.GPS_ATTI),
            )
            known = link_id in self.scene.station.fleet.links
            (self.scene.receives if known else self.scene.opens)(link_id, *reports)

    def passes(self, seconds: float) -> "Two":
        for _ in range(round(seconds * 10)):
            for link_id in self.north_m:
                self.north_m[link_id] += 0.1 * self.mps[link_id]
            self.scene.now_ns += S // 10
            self.receives()
            self.scene.happens(Tick())
        return self

    def closes(self, link_id: int) -> "Two":
        self.scene.closes(link_id)
        del self.north_m[link_id]
        return self

    def holds(self) -> list[tuple[str | None, str]]:
        """The vehicles that the station has held automatically, and the reason."""
        return [
            (approved.command.serial, approved.command.issued_by)
            for approved in self.scene.handed
            if isinstance(approved.command.body, Hover)
        ]

    def alarm(self, rule: str) -> Alarm:
        (found,) = (
            a for a in self.scene.station.alarms.alarms.values() if a.condition.rule == rule
        )
        return found


class TestSeparation:
    def test_first_an_alarm_then_a_hold_then_the_other_too(self) -> None:
        two = Two(140.0).passes(2.0)
        assert two.scene.alarms() == set()
        two.passes(1.0)
        assert two.scene.alarms() == {"separation"}
        assert two.holds() == []
        two.passes(3.5)
        assert two.holds()[0] == ("B", "station: separation")
        two.passes(3.0)
        assert ("A", "station: separation") in two.holds()

    def test_a_hold_is_an_order_on_record_with_a_number_of_the_stations_own(self) -> None:
        two = Two(70.0).passes(0.5)
        (record,) = two.scene.station.orders.records.values()
        assert record.command.id < 0
        assert record.command.issued_by == "station: separation"
        assert record.phase is Phase.SENT
        assert two.alarm("separation").condition.text.endswith(f"; B {HELD}")
        two.passes(6.0)
        assert two.alarm("separation").condition.text.count(f"B {HELD}") == 1

    def test_a_hold_ends_the_conflict_and_the_other_flies_on(self) -> None:
        two = Two(120.0, a_mps=2.0, b_mps=-8.0)
        two.passes(3.6)
        two.mps[2] = 0.0
        two.passes(6.0)
        assert {serial for serial, _ in two.holds()} == {"B"}
        assert two.scene.alarms() == {"separation"} or two.scene.alarms() == set()

    def test_switched_off_it_raises_alarms_and_holds_no_vehicle(self) -> None:
        two = Two(100.0)
        two.scene.happens(SeparationHoldSwitched(is_on=False, by="Ann"))
        two.passes(5.0)
        assert two.holds() == []
        assert two.scene.alarms() == {"separation", "separation_hold_off"}
        assert "switched off" in two.alarm("separation").condition.text
        assert "switched off by Ann" in two.alarm("separation_hold_off").condition.text
        two.scene.happens(SeparationHoldSwitched(is_on=True, by="Ann"))
        two.passes(0.3)
        assert "separation_hold_off" not in two.scene.alarms()
        assert two.holds() != []

    def test_a_vehicle_under_pilot_control_is_not_held(self) -> None:
        two = Two(100.0)
        for serial in ("A", "B"):
            two.scene.happens(AuthorityTaken(serial, AuthorityHolder.PILOT, "test"))
        two.passes(5.0)
        assert two.holds() == []
        assert "separation" in two.scene.alarms()

    def test_no_vehicle_is_held_on_the_ground_or_because_of_one_there(self) -> None:
        two = Two(60.0, b_mps=0.0)
        two.flying[2] = False
        two.passes(8.0)
        assert two.holds() == []
        assert two.scene.alarms() == set()

    def test_the_alarm_stays_for_some_seconds_after_its_cause_has_ended(self) -> None:
        two = Two(60.0).passes(0.3)
        assert two.alarm("separation").is_active
        two.mps = {1: -5.0, 2: 5.0}
        two.passes(2.9)
        assert two.alarm("separation").is_active
        two.passes(0.5)
        assert not two.alarm("separation").is_active

    def test_a_vehicle_in_conflict_again_is_held_again_after_five_seconds(self) -> None:
        two = Two(60.0, a_mps=0.0).passes(10.0)
        assert [serial for serial, _ in two.holds()].count("B") >= 2

    def test_a_hold_ends_with_the_flight_or_a_newer_order(self) -> None:
        two = Two(70.0).passes(0.5)
        held = two.scene.station.watchdog_state.held
        assert set(held) == {"B"}
        newer = Intent(Commanded.MISSION, two.scene.now_ns + 1)
        station = two.scene.station.with_control("B", intent=newer)
        two.scene.station = station
        two.passes(0.2)
        assert two.scene.station.watchdog_state.held.get("B") is not held["B"]
        two.scene.lands(2, core(flying=False, position=place(70.0)), extended("B"))
        assert "B" not in two.scene.station.watchdog_state.held

    def test_a_vehicle_whose_hold_was_not_sent_does_not_count_as_held(self) -> None:
        two = Two(110.0).passes(1.5)
        assert two.holds() == []
        two.closes(2).passes(1.5)
        assert set(two.scene.station.watchdog_state.held) == {"A"}
        assert two.holds() == [("A", "station: separation")]
        text = two.alarm("separation").condition.text
        (waits, *_) = (
            r.note for r in two.scene.station.orders.records.values() if r.command.serial == "B"
        )
        assert f"B {hold_outcome(None, waits)}" in text
        assert text.endswith(f"; A {HELD}")
        asked = [r for r in two.scene.station.orders.records.values() if r.command.serial == "B"]
        assert 1 <= len(asked) <= 2

    def test_it_runs_ten_times_a_second_at_any_tick_rate(self) -> None:
        two = Two(300.0).passes(1.0)
        run_ns = two.scene.station.watchdog_state.run_at_ns
        two.scene.now_ns += S // 20
        two.scene.happens(Tick())
        assert two.scene.station.watchdog_state.run_at_ns == run_ns
        two.scene.now_ns += S // 20
        two.scene.happens(Tick())
        assert two.scene.station.watchdog_state.run_at_ns == two.scene.now_ns

    def test_two_links_of_one_serial_are_one_vehicle(self) -> None:
        scene = CommandedStation()
        for link_id in (1, 2):
            scene.opens(link_id, core(), extended("A"))
            scene.keeps_receiving(link_id, core(), extended("A"))
        scene.passes(3.0)
        assert "separation" not in scene.alarms()


class TestOthers:
    def test_a_link_that_is_late_is_a_warning_before_it_is_lost(self) -> None:
        scene = CommandedStation().opens(1, core(), extended()).passes(1.1)
        assert scene.alarms() == {"link_late"}
        scene.passes(2.0)
        assert "link_lost" in scene.alarms()

    def test_a_position_jump_is_not_believed_and_an_alarm(self) -> None:
        scene = CommandedStation().opens(1, core(), extended())
        scene.keeps_receiving(1, core()).passes(1.0)
        assert scene.alarms() == set()
        scene.keeps_receiving(1, core(position=place(60.0))).passes(0.2)
        assert scene.alarms() == {"position_jump"}
        assert scene.station.fleet.vehicles["A"].position.value == PLACE
        scene.keeps_receiving(1, core()).passes(5.0)
        assert scene.alarms() == set()
        assert scene.alarms(active=False) == {"position_jump"}

    def test_a_position_unknown_for_a_moment_is_compared_with_the_last_known(self) -> None:
        scene = CommandedStation().opens(1, core(), extended())
        scene.keeps_receiving(1, core()).passes(0.5)
        scene.keeps_receiving(1, core(position=None)).passes(0.5)
        scene.keeps_receiving(1, core(position=place(400.0))).passes(0.2)
        assert "position_jump" in scene.alarms()

    def test_a_starved_setpoint_stream_is_an_alarm(self) -> None:
        for is_stuck, alarms in ((False, set()), (True, {"stick_starved"})):
            scene = (
                CommandedStation()
                .opens(1, core(flying=False, height_m=0.0), extended())
                .receives(1, core())
            )
            scene.keeps_receiving(1, core(), extended()).passes(1.0)
            scene.is_stuck = is_stuck
            scene.order(GoTo(place(50.0), 40.0, 5.0))
            scene.keeps_receiving(1, core(), extended(mode=FlightMode.JOYSTICK)).passes(0.9)
            assert scene.alarms() == alarms
            scene.order(Hover())
            scene.passes(4.0)
            assert "stick_starved" not in scene.alarms()
            assert scene.station.watchdog_state.sticks == {}

    def test_altitudes_that_drift_apart_are_an_alarm(self) -> None:
        scene = CommandedStation().opens(1, core(flying=False), extended()).receives(1, core())
        scene.keeps_receiving(1, core(altitude_m=300.0)).passes(0.5)
        scene.keeps_receiving(1, core(altitude_m=330.0)).passes(2.0)
        alarms = scene.station.alarms.alarms.values()
        assert [a.condition.severity for a in alarms] == [Severity.WARNING]
        assert scene.alarms() == {"altitude_mismatch"}


@pytest.mark.parametrize("is_on", [True, False])
def test_six_on_crossing_ways_home_at_one_height(is_on: bool) -> None:
    """With real apps, delays and dynamics: the watchdog keeps them apart, and without it nothing
    does."""
    world = six_in_the_air(go_home_height_m=35.0)
    world.world.driver.handle(SeparationHoldSwitched(is_on=is_on, by="test"))
    for serial in SIX:
        world.world.order(serial, ReturnHome())
    world.runs(60.0)
    assert (world.nearest.level_m >= LEAST_LEVEL_M) is is_on
