"""Which vehicles are in conflict, which are held, and which never are."""

from dataclasses import replace

import pytest
from tests.safety.traffic import at, flies, judged, route
from tests.safety.watchdogs.looks import (
    NOW,
    AuthorityHolder,
    Commanded,
    FlightMode,
    Intent,
    S,
    aircraft,
    held,
    in_context,
    looks,
)

from recon.model.severity import Severity
from recon.model.units import Stamped
from recon.model.vehicle import Failsafe, VehicleState
from recon.safety.watchdogs import Finding
from recon.safety.watchdogs.separation import separation

NORTH = (10.0, 0.0, 0.0)
SOUTH = (-10.0, 0.0, 0.0)


def head_on(gap_m: float = 100.0, **of_b: object) -> tuple[VehicleState, VehicleState]:
    """A flies north, B south, towards each other at 10 m/s each."""
    return (
        aircraft("A", (0.0, 0.0), velocity=NORTH),
        aircraft("B", (gap_m, 0.0), **{"velocity": SOUTH, **of_b}),  # type: ignore[arg-type]
    )


def only(findings: list[Finding]) -> Finding:
    (found,) = findings
    return found


class TestAlarms:
    def test_a_conflict_within_ten_seconds_names_both_and_tells_when(self) -> None:
        found = only(looks(separation, *head_on(150.0)))
        assert found.severity is Severity.ERROR
        apart = "0 m, and 0 m in height"
        assert found.text == f"B: comes too near in 7 s to A: {apart}"
        assert (found.serial, found.vehicle_name) == ("B", "B")

    def test_it_tells_of_a_hold_once_it_is_given_and_of_one_that_could_not_be(self) -> None:
        a, b = head_on(80.0)
        apart = "0 m, and 0 m in height"
        assert only(looks(separation, a, b)).holds == "B"
        given = only(looks(separation, a, in_context(b, held=held(0.5, 10.0))))
        assert given.text.endswith("; B was ordered to hold")
        other = only(looks(separation, a, in_context(b, hold_refused="no link")))
        assert (
            other.text == f"B: comes too near in 3 s to A: {apart}; B could not be held (no link)"
        )
        assert other.holds == "A"

    def test_beyond_ten_seconds_it_is_none(self) -> None:
        assert looks(separation, *head_on(230.0)) == []
        assert len(looks(separation, *head_on(210.0))) == 1

    def test_a_near_one_is_critical(self) -> None:
        assert only(looks(separation, *head_on(80.0))).severity is Severity.CRITICAL
        there = only(looks(separation, *head_on(10.0)))
        assert there.text.startswith("B: is too near to A: ")

    @pytest.mark.parametrize("place", [(150.0, 18.0), (0.0, -18.0)])
    def test_side_by_side_is_none(self, place: tuple[float, float]) -> None:
        a, _b = head_on()
        state = aircraft("B", place, velocity=SOUTH)
        assert looks(separation, a, state) == []

    @pytest.mark.parametrize(("height_m", "count"), [(46.0, 1), (47.5, 0), (34.0, 1), (32.5, 0)])
    def test_one_above_the_other_is_none(self, height_m: float, count: int) -> None:
        a, b = head_on(height_m=height_m)
        assert len(looks(separation, a, b)) == count

    def test_one_that_climbs_into_another_is_found(self) -> None:
        still = aircraft("A", (0.0, 0.0), 40.0)
        climbs = aircraft("B", (0.0, 5.0), 28.0, velocity=(0.0, 0.0, 2.0))
        assert only(looks(separation, still, climbs)).holds == "B"

    def test_a_mission_that_turns_before_is_followed_round_its_corner(self) -> None:
        turns = route((0.0, 0.0), (60.0, 0.0), (60.0, -200.0))
        flying = aircraft("A", (0.0, 0.0), velocity=(5.0, 0.0, 0.0), mode=FlightMode.GPS_WAYPOINT)
        standing = aircraft("B", (80.0, 0.0))
        assert looks(separation, in_context(flying, intent=flies(turns, 1)), standing) == []
        manual = replace(flying, flight_mode=Stamped(FlightMode.GPS_ATTI, NOW))
        by_hand = in_context(manual, intent=flies(turns, 1))
        assert len(looks(separation, by_hand, aircraft("B", (60.0, 0.0)))) == 1

    def test_a_mission_into_another_round_a_corner_is_found(self) -> None:
        turns = route((0.0, 0.0), (10.0, 0.0), (10.0, -200.0))
        flying = aircraft("A", (0.0, 0.0), velocity=(5.0, 0.0, 0.0), mode=FlightMode.GPS_WAYPOINT)
        standing = aircraft("B", (10.0, -30.0))
        assert len(looks(separation, in_context(flying, intent=flies(turns, 1)), standing)) == 1
        assert looks(separation, flying, standing) == []

    def test_one_that_flies_a_mission_backwards_is_not_followed(self) -> None:
        back = route((0.0, 0.0), (200.0, 0.0))
        flying = aircraft("A", (60.0, 0.0), velocity=SOUTH, mode=FlightMode.GPS_WAYPOINT)
        assert len(looks(separation, in_context(flying, intent=flies(back, 1)), aircraft("B"))) == 1

    def test_nothing_in_the_air_is_nothing(self) -> None:
        assert looks(separation) == []
        assert looks(separation, aircraft("A", None)) == []


class TestHolds:
    def test_the_alarm_is_first(self) -> None:
        assert only(looks(separation, *head_on(80.0), lasted_s=0.1)).holds is None
        assert only(looks(separation, *head_on(80.0), lasted_s=0.2)).holds == "B"

    def test_it_is_held_only_when_little_more_is_left_than_both_need_to_stop(self) -> None:
        slow = [(3.0, 0.0, 0.0), (-3.0, 0.0, 0.0)]
        for gap_m, holds in ((60.0, None), (45.0, "B")):
            a = aircraft("A", (0.0, 0.0), velocity=slow[0])
            b = aircraft("B", (gap_m, 0.0), velocity=slow[1])
            assert only(looks(separation, a, b)).holds == holds

    @pytest.mark.parametrize(
        ("of_a", "of_b", "holds"),
        [
            ({}, {}, "B"),
            ({"priority": 0}, {"priority": 1}, "A"),
            ({"priority": 2}, {"priority": 1}, "B"),
        ],
    )
    def test_lower_priority_yields_and_else_the_later_serial(
        self, of_a: dict[str, int], of_b: dict[str, int], holds: str
    ) -> None:
        a = aircraft("A", velocity=NORTH, **of_a)  # type: ignore[arg-type]
        b = aircraft("B", (100.0, 0.0), velocity=SOUTH, **of_b)  # type: ignore[arg-type]
        assert only(looks(separation, a, b)).holds == holds
        assert only(looks(separation, b, a)).holds == holds

    def test_the_imager_yields_after_others_and_an_operators_after_guidances(self) -> None:
        a, b = head_on()
        assert only(looks(separation, a, in_context(b, is_imager=True))).holds == "A"
        guided = in_context(a, holder=AuthorityHolder.GUIDANCE)
        assert only(looks(separation, guided, b)).holds == "A"
        low = in_context(aircraft("A", velocity=NORTH, priority=-1), is_imager=True)
        assert only(looks(separation, low, b)).holds == "A"

    def test_a_vehicle_without_a_profile_has_no_priority(self) -> None:
        a, b = head_on()
        assert only(looks(separation, replace(a, profile=None), b)).holds == "B"
        assert only(looks(separation, a, replace(b, profile=None))).holds == "B"

    def test_switched_off_it_only_reports(self) -> None:
        found = only(looks(separation, *head_on(), is_hold_on=False))
        assert found.holds is None
        assert "holding is switched off" in found.text

    def test_what_the_pilot_leads_is_never_held(self) -> None:
        a, b = head_on()
        assert only(looks(separation, a, in_context(b, holder=AuthorityHolder.PILOT))).holds == "A"
        both = [in_context(v, holder=AuthorityHolder.PILOT) for v in (a, b)]
        found = only(looks(separation, *both))
        assert found.holds is None
        assert "ordered to hold" not in found.text

    def test_what_is_on_the_ground_is_neither_held_nor_a_reason(self) -> None:
        a, b = head_on(flying=False)
        assert looks(separation, a, b) == []

    def test_an_unknown_in_air_flag_is_no_reason_until_telemetry_is_lost(self) -> None:
        a, b = head_on(flying=None)
        assert looks(separation, a, b) == []

    def test_one_without_a_serial_cannot_be_held(self) -> None:
        a, b = head_on()
        assert only(looks(separation, a, replace(b, serial=None, profile=None))).holds == "A"

    def test_the_one_in_front_is_not_held_for_the_one_behind(self) -> None:
        front = aircraft("B", (60.0, 0.0), velocity=(4.0, 0.0, 0.0))
        behind = aircraft("A", (0.0, 0.0), velocity=(12.0, 0.0, 0.0))
        assert only(looks(separation, front, behind)).holds == "A"

    def test_the_one_in_front_of_a_pilot_is_never_held(self) -> None:
        front = aircraft("B", (60.0, 0.0), velocity=(4.0, 0.0, 0.0))
        behind = in_context(aircraft("A", velocity=(12.0, 0.0, 0.0)), holder=AuthorityHolder.PILOT)
        assert only(looks(separation, front, behind)).holds is None


class TestTheOtherToo:
    """B is held; the conflict stays predicted."""

    def test_it_waits_for_the_hold_to_show(self) -> None:
        a, b = head_on(125.0)
        assert only(looks(separation, a, in_context(b, held=held(0.5, 10.0)))).holds is None

    def test_a_hold_that_shows_nothing_makes_it_hold_the_other(self) -> None:
        a, b = head_on(125.0)
        assert only(looks(separation, a, in_context(b, held=held(2.1, 10.0)))).holds == "A"

    def test_it_does_not_wait_when_the_other_needs_the_time(self) -> None:
        a, b = head_on(95.0)
        assert only(looks(separation, a, in_context(b, held=held(0.5, 10.0)))).holds == "A"

    def test_a_held_one_that_stands_in_the_way_makes_it_hold_the_other(self) -> None:
        a, b = head_on(80.0, velocity=(0.0, 0.0, 0.0))
        assert only(looks(separation, a, in_context(b, held=held(20.0, 10.0)))).holds == "A"

    def test_a_held_one_that_brakes_is_believed(self) -> None:
        a = aircraft("A", velocity=(0.0, 0.0, 0.0))
        b = in_context(aircraft("B", (60.0, 0.0), velocity=SOUTH), held=held(1.0, 10.0))
        assert looks(separation, a, b) == []

    def test_one_that_does_not_brake_is_predicted_to_go_on_and_held_again(self) -> None:
        a = aircraft("A", velocity=(0.0, 0.0, 0.0))
        b = aircraft("B", (60.0, 0.0), velocity=SOUTH)
        assert only(looks(separation, a, in_context(b, held=held(4.9, 10.0)))).holds is None
        assert only(looks(separation, a, in_context(b, held=held(5.1, 10.0)))).holds == "B"

    def test_a_newer_order_ends_the_belief_in_a_hold(self) -> None:
        a = aircraft("A", velocity=(0.0, 0.0, 0.0))
        b = aircraft("B", (60.0, 0.0), velocity=SOUTH, mode=FlightMode.GPS_WAYPOINT)
        on = replace(flies(route((60.0, 0.0), (-100.0, 0.0)), 1), since_ns=NOW - S // 2)
        assert len(looks(separation, a, in_context(b, held=held(1.0, 10.0), intent=on))) == 1
        holds = Intent(Commanded.HOLD, NOW - S // 2)
        assert looks(separation, a, in_context(b, held=held(1.0, 10.0), intent=holds)) == []


class TestComingDown:
    """A landing or returning vehicle is not held if that makes it worse."""

    @pytest.mark.parametrize(
        "mode", [FlightMode.AUTO_LANDING, FlightMode.CONFIRM_LANDING, FlightMode.GO_HOME]
    )
    def test_it_yields_last(self, mode: FlightMode) -> None:
        a, b = head_on(mode=mode)
        assert only(looks(separation, a, b)).holds == "A"

    def test_by_its_order_too(self) -> None:
        a, b = head_on()
        coming = in_context(b, intent=Intent(Commanded.LAND, NOW))
        assert only(looks(separation, a, coming)).holds == "A"

    def test_one_that_was_held_and_lands_now_is_predicted_to_land(self) -> None:
        a = aircraft("A", (60.0, 0.0), 20.0, velocity=(0.0, 0.0, 0.0))
        lands = aircraft("B", (60.0, 0.0), 45.0, (0.0, 0.0, -3.0), mode=FlightMode.AUTO_LANDING)
        landing = in_context(lands, held=held(1.0), intent=Intent(Commanded.LAND, NOW - 2 * S))
        assert len(looks(separation, a, landing)) == 1

    def test_it_is_held_when_that_helps_and_the_other_cannot_be(self) -> None:
        a, b = head_on(mode=FlightMode.GO_HOME)
        pilot = in_context(a, holder=AuthorityHolder.PILOT)
        coming = in_context(b, intent=Intent(Commanded.RETURN, NOW))
        assert only(looks(separation, pilot, coming)).holds == "B"

    def test_one_that_sinks_out_of_the_others_way_is_not_held(self) -> None:
        lands = aircraft("B", (60.0, 0.0), 38.0, (0.0, 0.0, -3.0), mode=FlightMode.AUTO_LANDING)
        pilot = in_context(aircraft("A", velocity=NORTH), holder=AuthorityHolder.PILOT)
        for finding in looks(separation, lands, pilot):
            assert finding.holds is None

    def test_a_return_flies_home_as_commanded(self) -> None:
        coming = in_context(
            aircraft("B", (0.0, 100.0), 60.0, (0.0, -8.0, 0.0), mode=FlightMode.GO_HOME),
            intent=Intent(Commanded.RETURN, NOW - S),
        )
        in_the_way = aircraft("A", (0.0, 40.0), 60.0)
        assert only(looks(separation, coming, in_the_way)).holds == "B"
        assert looks(separation, coming, aircraft("A", (0.0, 40.0), 40.0)) == []


class TestHazards:
    hazard = aircraft("G", (0.0, 0.0), velocity=NORTH, age_s=10.0, failsafe=Failsafe.HOVER)

    def test_a_vehicle_on_its_way_into_the_circle_is_alarmed_about_and_held(self) -> None:
        coming = aircraft("A", (0.0, 230.0), velocity=(0.0, -10.0, 0.0))
        found = only(looks(separation, self.hazard, coming))
        assert found.holds == "A"
        assert "the hazard area of G, telemetry lost for 10 s" in found.text
        assert looks(separation, self.hazard, aircraft("A", (0.0, 230.0))) == []

    def test_one_in_the_circle_is_alarmed_about_and_held_only_if_it_flies_in_deeper(self) -> None:
        for velocity, holds in (
            ((0.0, 0.0, 0.0), None),
            ((0.0, 10.0, 0.0), None),
            ((0.0, -10.0, 0.0), "A"),
        ):
            inside = aircraft("A", (0.0, 80.0), velocity=velocity)
            assert only(looks(separation, self.hazard, inside)).holds == holds

    @pytest.mark.parametrize("up_mps", [0.0, -3.0])
    def test_one_that_the_gate_lets_out_of_the_circle_is_not_held(self, up_mps: float) -> None:
        """Also one that sinks at first: the circle reaches down to the ground."""
        inside = aircraft("A", (0.0, 80.0), 40.0, velocity=(0.0, 0.0, up_mps))
        out = route((0.0, 80.0, 30.0), (0.0, 300.0, 30.0))
        assert judged(out, inside, self.hazard) is None
        leaving = in_context(inside, intent=flies(out))
        assert only(looks(separation, self.hazard, leaving)).holds is None
        deeper = aircraft("A", (0.0, 80.0), 40.0, velocity=(0.0, -8.0, up_mps))
        sinks_in = in_context(deeper, intent=flies(route((0.0, 80.0, 30.0), (0.0, 0.0, 30.0))))
        assert only(looks(separation, self.hazard, sinks_in)).holds == "A"

    def test_the_circle_grows(self) -> None:
        """At 10 m/s: 40 m after 4 s, 140 m ten seconds later."""
        hazard = aircraft("G", velocity=NORTH, age_s=4.0, failsafe=Failsafe.HOVER)
        for east_m, count in ((150.0, 1), (160.0, 0)):
            assert len(looks(separation, hazard, aircraft("A", (0.0, east_m)))) == count

    def test_it_grows_no_further_than_150_m(self) -> None:
        hazard = aircraft("G", velocity=NORTH, age_s=600.0, failsafe=Failsafe.HOVER)
        for east_m, count in ((165.0, 1), (170.0, 0)):
            assert len(looks(separation, hazard, aircraft("A", (0.0, east_m)))) == count

    def test_above_it_all_heights_pass_and_below_none(self) -> None:
        for height_m, count in ((50.0, 0), (46.0, 1), (10.0, 1)):
            assert len(looks(separation, self.hazard, aircraft("A", (0.0, 5.0), height_m))) == count

    def test_its_route_home_is_kept_clear_of(self) -> None:
        hazard = aircraft("G", (0.0, 800.0), age_s=60.0)
        for place, height_m, count in (
            ((20.0, 400.0), 50.0, 1),
            ((30.0, 400.0), 50.0, 0),
            ((20.0, 400.0), 30.0, 0),
            ((20.0, 400.0), 70.0, 0),
            ((20.0, 0.0), 5.0, 1),
            ((0.0, -30.0), 5.0, 0),
        ):
            assert len(looks(separation, hazard, aircraft("A", place, height_m))) == count, place

    def test_one_that_may_continue_its_mission_is_predicted_to(self) -> None:
        """Sent 900 m east at 5 m/s and lost for 100 s: half-path, give or take 50 m."""
        mission = route((0.0, 0.0), (0.0, 900.0))
        state = aircraft("G", velocity=(0.0, 5.0, 0.0), age_s=100.0, failsafe=Failsafe.HOVER)
        hazard = in_context(state, intent=flies(mission, 1))
        found = only(looks(separation, hazard, aircraft("A", (0.0, 540.0))))
        assert found.vehicle_name == "A"
        assert "to G (telemetry lost for 100 s, if it continues its mission)" in found.text
        assert looks(separation, in_context(state), aircraft("A", (0.0, 540.0))) == []
        assert looks(separation, hazard, aircraft("A", (0.0, 800.0))) == []
        coming = aircraft("A", (0.0, 660.0), velocity=(0.0, -10.0, 0.0))
        assert only(looks(separation, hazard, coming)).holds == "A"

    def test_two_that_may_fly_their_missions_on_are_no_conflict(self) -> None:
        mission = flies(route((0.0, 0.0), (0.0, 900.0)), 1)
        hazards = [
            in_context(aircraft(n, (0.0, e), age_s=20.0, failsafe=Failsafe.HOVER), intent=mission)
            for n, e in (("G", 0.0), ("H", 10.0))
        ]
        far = aircraft("A", (500.0, 0.0))
        assert looks(separation, far, *hazards) == []

    def test_two_hazard_areas_are_no_conflict(self) -> None:
        assert looks(separation, self.hazard, replace(self.hazard, serial="H")) == []

    def test_a_pilots_vehicle_is_not_held_for_one(self) -> None:
        inside = aircraft("A", (0.0, 80.0), velocity=(0.0, -10.0, 0.0))
        assert (
            only(
                looks(separation, self.hazard, in_context(inside, holder=AuthorityHolder.PILOT))
            ).holds
            is None
        )
        off = looks(separation, self.hazard, inside, is_hold_on=False)
        assert "holding is switched off" in only(off).text


class TestSticks:
    def test_one_steered_to_a_place_is_predicted_to_stop_there(self) -> None:
        steered = in_context(
            aircraft("A", velocity=NORTH, mode=FlightMode.JOYSTICK),
            intent=Intent(
                Commanded.STICK,
                NOW - S,
                target=at(50.0, 0.0),
                target_height_above_takeoff_m=40.0,
                speed_mps=10.0,
            ),
        )
        assert looks(separation, steered, aircraft("B", (70.0, 0.0))) == []
        assert len(looks(separation, steered, aircraft("B", (60.0, 0.0)))) == 1

    def test_one_under_free_sticks_flies_on_for_some_seconds(self) -> None:
        free = in_context(
            aircraft("A", velocity=NORTH, mode=FlightMode.JOYSTICK),
            intent=Intent(Commanded.STICK, NOW - S),
        )
        assert len(looks(separation, free, aircraft("B", (80.0, 0.0)))) == 1
        assert looks(separation, free, aircraft("B", (95.0, 0.0))) == []

    def test_at_its_target_it_may_move_as_it_likes(self) -> None:
        here = in_context(
            aircraft("A", velocity=(3.0, 0.0, 0.0), mode=FlightMode.JOYSTICK),
            intent=Intent(Commanded.STICK, NOW - S, target=at(0.0, 0.0), speed_mps=3.0),
        )
        assert len(looks(separation, here, aircraft("B", (10.0, 0.0)))) == 1
