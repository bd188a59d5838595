"""Paths are kept apart in space and time; a lost vehicle is a hazard."""

from dataclasses import replace

import pytest
from tests.safety.traffic import AIR, NOW, aircraft, at, flies, judged, route

from recon.model.airspace import Airspace
from recon.model.command import (
    Command,
    FlyMission,
    GoTo,
    HoldPosition,
    Hover,
    LandNow,
    Nudge,
    Refusal,
    ReturnHome,
    StickFrame,
    VirtualStick,
)
from recon.model.control import Commanded, Intent
from recon.model.mission import Mission
from recon.model.units import Stamped
from recon.model.vehicle import Failsafe, TrackPoint, VehicleState
from recon.safety import PreparedAirspace, Situation, Traffic
from recon.safety.rules.separation import in_way_of_climb_home, separation

NORTH = route((0.0, 0.0), (200.0, 0.0))


def refused(found: Refusal | None, *words: str) -> None:
    assert found is not None
    assert found.rule == "separation"
    for word in words:
        assert word in found.reason


class TestStanding:
    def test_a_path_past_a_standing_vehicle_is_refused_with_leg_time_and_distance(self) -> None:
        own, other = aircraft("A"), aircraft("B", (100.0, 10.0))
        found = judged(NORTH, own, other)
        assert found is not None
        assert found.reason == (
            "A: between waypoints 1 and 2, about 17 s from now, it must keep 18 m, or 7.5 m in "
            "height, from B (while it hovers); got 10 m and 0 m in height: fly at another height, "
            "elsewhere, or later"
        )

    @pytest.mark.parametrize(("east_m", "height_m"), [(18.5, 40.0), (0.0, 48.0), (10.0, 32.0)])
    def test_it_passes_beside_above_and_below(self, east_m: float, height_m: float) -> None:
        assert judged(NORTH, aircraft("A"), aircraft("B", (100.0, east_m), height_m)) is None

    @pytest.mark.parametrize(("east_m", "height_m"), [(17.5, 40.0), (0.0, 47.0), (10.0, 33.0)])
    def test_nearer_than_both_is_refused(self, east_m: float, height_m: float) -> None:
        refused(judged(NORTH, aircraft("A"), aircraft("B", (100.0, east_m), height_m)))

    def test_the_sites_own_limits_hold(self) -> None:
        limits = replace(
            AIR.airspace.limits, min_separation_horizontal_m=30.0, min_separation_vertical_m=9.0
        )
        wide = PreparedAirspace(replace(AIR.airspace, limits=limits))
        for place, height_m, passes in (
            ((100.0, 32.5), 40.0, False),
            ((100.0, 33.5), 40.0, True),
            ((100.0, 0.0), 50.0, False),
            ((100.0, 0.0), 51.0, True),
        ):
            found = judged(NORTH, aircraft("A"), aircraft("B", place, height_m), airspace=wide)
            assert (found is None) is passes

    def test_the_mission_ends_hovering_in_others_way(self) -> None:
        crossing = route((200.0, -900.0), (200.0, 900.0))
        late = Traffic(aircraft("B", (200.0, -900.0)), flies(crossing, passed=1))
        refused(judged(NORTH, aircraft("A"), late), "while it hovers")

    def test_a_mission_that_lands_is_out_of_the_way_some_time_later(self) -> None:
        landing = route((0.0, 0.0), (100.0, 0.0), land=True)
        crossing = route((100.0, -1900.0), (100.0, 900.0))
        late = Traffic(aircraft("B", (100.0, -1900.0)), flies(crossing, passed=1))
        assert judged(landing, aircraft("A"), late) is None
        refused(judged(route((0.0, 0.0), (100.0, 0.0)), aircraft("A"), late))


class TestTime:
    def test_the_same_place_at_different_times_passes(self) -> None:
        crossing = route((100.0, -20.0), (100.0, 600.0))
        soon = Traffic(aircraft("B", (100.0, -20.0)), flies(crossing, passed=1))
        start = aircraft("A", (-900.0, 0.0))
        assert judged(route((-900.0, 0.0), (200.0, 0.0)), start, soon) is None

    def test_the_same_place_at_the_same_time_is_refused(self) -> None:
        crossing = route((100.0, -100.0), (100.0, 600.0))
        same = Traffic(aircraft("B", (100.0, -100.0)), flies(crossing, passed=1))
        refused(judged(NORTH, aircraft("A"), same), "between waypoints 1 and 2")

    def test_uncertainty_grows_with_time(self) -> None:
        """60 s between two crossings pass when they are near, and not after ten minutes."""
        for far_m, passes in ((300.0, True), (3000.0, False)):
            own = aircraft("A", (-far_m, 0.0))
            crossing = route((0.0, -far_m - 300.0), (0.0, 600.0))
            other = Traffic(aircraft("B", (0.0, -far_m - 300.0)), flies(crossing, passed=1))
            found = judged(route((-far_m, 0.0), (600.0, 0.0)), own, other)
            assert (found is None) is passes

    @pytest.mark.parametrize(
        ("east_m", "missions", "orders"), [(166, 0, 0), (178, 0, 1), (230, 1, 1)]
    )
    def test_a_mission_may_start_seconds_late(
        self, east_m: float, missions: int, orders: int
    ) -> None:
        """What B crosses when A is past passes for an order that starts now, not for a mission."""
        crossing = route((20.0, -east_m), (20.0, 600.0))
        other = Traffic(aircraft("B", (20.0, -east_m)), flies(crossing, passed=1))
        own = aircraft("A", (-55.0, 0.0))
        there = route((-55.0, 0.0), (100.0, 0.0))
        assert (judged(there, own, other) is None) is bool(missions)
        assert (judged(GoTo(at(100.0, 0.0), 40.0, 5.0), own, other) is None) is bool(orders)

    @pytest.mark.parametrize(
        ("velocity", "passed", "passes"),
        [
            ((0.0, 0.0, 0.0), 0, False),
            (None, 0, False),
            ((0.0, 5.0, 0.0), 0, True),
            ((0.0, 0.0, 2.0), 0, True),
            ((0.0, 0.0, 0.0), 1, True),
        ],
    )
    def test_so_may_anothers_that_has_not_begun(
        self, velocity: tuple[float, float, float] | None, passed: int, passes: bool
    ) -> None:
        """What A crosses when B is past passes, unless B may still set out 8 s from now."""
        refusal_text = flies(route((20.0, -60.0), (20.0, 600.0)), passed)
        other = Traffic(aircraft("B", (20.0, -60.0), velocity=velocity), refusal_text)
        there = GoTo(at(200.0, 0.0), 40.0, 5.0)
        assert (judged(there, aircraft("A", (-165.0, 0.0)), other) is None) is passes
        assert judged(there, aircraft("A", (-250.0, 0.0)), other) is None

    def test_layers_and_areas_pass_however_long(self) -> None:
        def survey(north_m: float, height_m: float) -> Mission:
            lines = [
                (north_m + 20.0 * row, 300.0 * ((row + end) % 2), height_m)
                for row in range(40)
                for end in range(2)
            ]
            return route(*lines)

        own = aircraft("A", (0.0, 0.0))
        above = Traffic(aircraft("B", (0.0, 0.0), 48.0), flies(survey(0.0, 48.0)))
        beside = Traffic(aircraft("C", (-820.0, 0.0)), flies(survey(-820.0, 40.0)))
        assert judged(survey(0.0, 40.0), own, above, beside) is None
        refused(judged(survey(0.0, 44.0), aircraft("A", (0.0, 0.0), 44.0), above))


class TestOrders:
    own = aircraft("A")
    wall = aircraft("B", (40.0, 0.0))

    @pytest.mark.parametrize(
        "body",
        [
            GoTo(at(100.0, 0.0), 40.0, 5.0),
            Nudge(30.0, 0.0, 0.0),
            VirtualStick(StickFrame.GROUND, 0.0, 15.0, 0.0, 40.0, 1.0),
            FlyMission(NORTH),
        ],
    )
    def test_each_way_to_move_is_judged(self, body: object) -> None:
        refused(judged(body, self.own, self.wall))  # type: ignore[arg-type]

    @pytest.mark.parametrize(
        "body",
        [
            GoTo(at(-100.0, 0.0), 40.0, 5.0),
            GoTo(at(20.0, 0.0), 40.0, 5.0),
            Nudge(-10.0, 0.0, 3.0),
            HoldPosition(),
            VirtualStick(StickFrame.GROUND, 0.0, 3.0, 0.0, 40.0, 1.0),
            VirtualStick(StickFrame.GROUND, 0.0, 0.0, 15.0, 40.0, 1.0),
            VirtualStick(StickFrame.BODY, 0.0, 0.0, 15.0, 40.0, 1.0),
        ],
    )
    def test_each_way_elsewhere_passes(self, body: object) -> None:
        assert judged(body, self.own, self.wall) is None  # type: ignore[arg-type]

    @pytest.mark.parametrize("body", [Hover(), LandNow(), ReturnHome()])
    def test_stops_are_never_refused(self, body: object) -> None:
        assert judged(body, self.own, aircraft("B", (5.0, 0.0))) is None  # type: ignore[arg-type]

    def test_a_zero_stick_is_never_refused(self) -> None:
        zero = VirtualStick(StickFrame.GROUND, 0.0, 0.0, 0.0, 40.0, 1.0)
        rushing = aircraft("A", velocity=(10.0, 0.0, 0.0))
        assert judged(zero, rushing, aircraft("B", (30.0, 0.0))) is None

    def test_a_stick_looks_at_its_own_few_seconds_only(self) -> None:
        stick = VirtualStick(StickFrame.GROUND, 0.0, 2.0, 0.0, 40.0, 1.0)
        coming = Traffic(aircraft("B", (300.0, 0.0)), flies(route((300.0, 0.0), (0.0, 0.0)), 1))
        assert judged(stick, self.own, coming) is None
        refused(judged(FlyMission(NORTH), self.own, coming))

    def test_without_traffic_nothing_is_asked(self) -> None:
        assert judged(NORTH, aircraft("A", None)) is None

    def test_without_a_site_the_frame_is_the_vehicle(self) -> None:
        nowhere = PreparedAirspace(Airspace())
        refused(judged(NORTH, self.own, self.wall, airspace=nowhere))
        assert judged(NORTH, self.own, aircraft("B", (40.0, 30.0)), airspace=nowhere) is None


class TestLeadingApart:
    """Two that are too near already may be led apart, and not nearer."""

    own = aircraft("A")
    near = aircraft("B", (8.0, 0.0), 42.0)

    @pytest.mark.parametrize(
        ("body", "passes"),
        [
            (GoTo(at(-50.0, 0.0), 40.0, 5.0), True),
            (GoTo(at(50.0, 0.0), 40.0, 5.0), False),
            (Nudge(0.0, 0.0, -10.0), True),
            (route((-20.0, 0.0), (-100.0, 0.0)), True),
            (route((-20.0, 0.0), (-100.0, 0.0), (0.0, 0.0)), False),
            (Nudge(0.0, 0.0, 10.0), False),  # up, past it
            (route((0.0, 0.0, 60.0), (-100.0, 0.0, 60.0)), False),
            (route((0.0, 0.0, 30.0), (-100.0, 0.0, 30.0)), True),
            (route((0.0, 0.0, 40.0), (0.0, 0.0, 40.0)), False),  # it stays where it is
            (HoldPosition(), True),  # no stop is refused
        ],
    )
    def test_nearer_is_refused_and_away_passes(self, body: object, passes: bool) -> None:
        assert (judged(body, self.own, self.near) is None) is passes  # type: ignore[arg-type]

    @pytest.mark.parametrize("stays", [(0.0, 0.0, 36.0), (20.0, 0.0, 36.0)])
    def test_one_that_has_yet_to_come_down_is_not_too_near_already(
        self, stays: tuple[float, float, float]
    ) -> None:
        """It is 8 m higher, and was sent down to here."""
        above = Traffic(aircraft("B", height_m=44.0), flies(route((0.0, 0.0, 36.0), stays)))
        own = aircraft("A", height_m=36.0)
        refused(judged(route((0.0, 0.0, 36.0), (0.0, 0.0, 36.0)), own, above), "from B")

    @pytest.mark.parametrize("age_s", [0.0, 0.2, 1.0])
    def test_one_that_is_leaving_already_may_go_on(self, age_s: float) -> None:
        """Its last reported position is nearer than where it is now; that is over."""
        leaving = aircraft("A", velocity=(-5.0, 0.0, 0.0), age_s=age_s)
        away = VirtualStick(StickFrame.GROUND, 0.0, -5.0, 0.0, 40.0, 1.0)
        assert judged(away, leaving, self.near) is None
        assert judged(GoTo(at(-50.0, 0.0), 40.0, 5.0), leaving, self.near) is None
        refused(judged(GoTo(at(50.0, 0.0), 40.0, 5.0), leaving, self.near))

    def test_how_far_a_turn_may_lead_counts_not_as_too_near_already(self) -> None:
        """At 10 m/s towards B it comes 20 m nearer before it flies back, be the stick ever so."""
        back = VirtualStick(StickFrame.GROUND, 0.0, -12.0, 0.0, 40.0, 1.0)
        rushing = aircraft("A", velocity=(10.0, 0.0, 0.0))
        refused(judged(back, rushing, aircraft("B", (32.0, 0.0))), "from B")
        assert judged(back, rushing, aircraft("B", (65.0, 0.0))) is None

    @pytest.mark.parametrize("other_m", [0.1, 3.0, 7.0])
    def test_one_on_the_ground_does_not_take_off_beside_another(self, other_m: float) -> None:
        up_and_away = route((0.0, 0.0, 40.0), (0.0, -60.0, 40.0))
        beside = aircraft("B", (10.0, 0.0), other_m)
        standing = aircraft("A", height_m=0.0, flying=False)
        refused(judged(up_and_away, standing, beside), "from B")
        assert judged(up_and_away, standing, aircraft("B", (10.0, 0.0), 60.0)) is None
        assert judged(up_and_away, standing, aircraft("B", (60.0, 0.0), other_m)) is None


class TestUnseen:
    def test_a_hazard_area_is_kept_clear_of_as_wide_as_it_may_grow(self) -> None:
        own = aircraft("A", (0.0, -400.0))
        hazard = aircraft("B", (0.0, 0.0), age_s=3.1, failsafe=Failsafe.HOVER)
        for east_m, passes in ((-170.0, True), (-160.0, False)):
            found = judged(route((0.0, -400.0), (0.0, east_m)), own, hazard)
            assert (found is None) is passes
        refused(
            judged(route((0.0, -400.0), (0.0, -100.0)), own, hazard),
            "of where B may be, telemetry lost",
            "dismiss its hazard area",
        )

    def test_at_3_s_it_is_still_a_vehicle(self) -> None:
        late = aircraft("B", (0.0, 0.0), age_s=3.0)
        own = aircraft("A", (0.0, -400.0))
        assert judged(route((0.0, -400.0), (0.0, -100.0)), own, late) is None

    @pytest.mark.parametrize(
        ("failsafe", "passes"),
        [(Failsafe.GO_HOME, False), (None, False), (Failsafe.HOVER, True), (Failsafe.LAND, True)],
    )
    def test_its_route_home_is_kept_clear_of(self, failsafe: Failsafe | None, passes: bool) -> None:
        hazard = aircraft("B", (0.0, 800.0), failsafe=failsafe, age_s=60.0)
        crossing = route((-100.0, 400.0, 50.0), (100.0, 400.0, 50.0))
        found = judged(crossing, aircraft("A", (-100.0, 400.0), 50.0), hazard)
        assert (found is None) is passes

    @pytest.mark.parametrize(("height_m", "passes"), [(30.0, True), (50.0, False), (70.0, True)])
    def test_the_route_home_has_all_heights_between(self, height_m: float, passes: bool) -> None:
        hazard = aircraft("B", (0.0, 800.0), age_s=60.0)
        crossing = route((-100.0, 400.0, height_m), (100.0, 400.0, height_m))
        found = judged(crossing, aircraft("A", (-100.0, 400.0), height_m), hazard)
        assert (found is None) is passes

    def test_a_lost_vehicle_may_continue_its_mission(self) -> None:
        far = route((0.0, 800.0), (0.0, 1800.0))
        hazard = aircraft("B", (0.0, 800.0), age_s=10.0, failsafe=Failsafe.HOVER)
        own = aircraft("A", (-100.0, 1200.0))
        crossing = route((-100.0, 1200.0), (5.0, 1200.0))
        assert judged(crossing, own, Traffic(hazard)) is None
        refused(judged(crossing, own, Traffic(hazard, flies(far, passed=1))))

    def test_one_may_be_led_out_of_a_hazard_area(self) -> None:
        hazard = aircraft("B", (0.0, 0.0), age_s=60.0, failsafe=Failsafe.HOVER)
        own = aircraft("A", (0.0, 80.0))
        assert judged(GoTo(at(0.0, 200.0), 40.0, 10.0), own, hazard) is None
        refused(judged(GoTo(at(0.0, -200.0), 40.0, 10.0), own, hazard))

    def test_one_may_be_led_away_from_where_a_hazard_area_will_have_grown_to(self) -> None:
        """Lost for 4 s it is within 8 m; 80 m away it may still come."""
        hazard = aircraft("B", (0.0, 0.0), age_s=4.0, failsafe=Failsafe.HOVER)
        own = aircraft("A", (0.0, 80.0))
        assert judged(GoTo(at(0.0, 200.0), 40.0, 10.0), own, hazard) is None
        refused(judged(GoTo(at(0.0, 60.0), 40.0, 10.0), own, hazard), "of where B may be")

    def test_a_vehicle_without_a_position_is_where_it_was_last_seen(self) -> None:
        last = at(100.0, 0.0)
        blind = replace(
            aircraft("B", None),
            track=(TrackPoint(NOW - 10**9, last.latitude_deg, last.longitude_deg, 40.0),),
        )
        refused(judged(NORTH, aircraft("A"), blind), "B")

    def test_one_that_has_never_reported_a_position_refuses_motion(self) -> None:
        refused(judged(NORTH, aircraft("A"), aircraft("B", None)), "A: B may be in the air")

    def test_an_app_without_an_aircraft_is_no_traffic_and_hides_none(self) -> None:
        app = VehicleState("B", link_id=2)
        assert judged(NORTH, aircraft("A"), app) is None
        refused(judged(NORTH, aircraft("A"), app, aircraft("C", (100.0, 0.0))), "from C")

    @pytest.mark.parametrize("east_m", [60.0, 9_000.0])
    def test_the_order_of_traffic_does_not_matter(self, east_m: float) -> None:
        wall, far = aircraft("B", (100.0, 0.0)), aircraft("C", (0.0, east_m))
        refused(judged(NORTH, aircraft("A"), wall, far), "from B")
        refused(judged(NORTH, aircraft("A"), far, wall), "from B")

    def test_a_vehicle_that_does_not_know_where_it_is_does_not_move_among_others(self) -> None:
        words = "A: no position telemetry, and other vehicles are in the air"
        for airspace in (AIR, PreparedAirspace(Airspace())):
            found = judged(NORTH, aircraft("A", None), aircraft("B"), airspace=airspace)
            assert found is not None
            assert found.reason == words

    def test_an_unknown_vehicle_is_another_rules_matter(self) -> None:
        situation = Situation(NOW, None, (), airspace=AIR, traffic=(Traffic(aircraft("B")),))
        command = Command(1, FlyMission(NORTH), "test", NOW, NOW, serial="A")
        assert separation(command, situation) is None


class TestUnknownHeights:
    def test_an_unknown_height_is_every_height(self) -> None:
        for state in (
            aircraft("B", (100.0, 0.0), None),
            aircraft("B", (100.0, 0.0), 90.0, home=None),
        ):
            refused(judged(NORTH, aircraft("A"), state))
            elsewhere = replace(state, position=Stamped(at(100.0, 30.0), NOW))
            assert judged(NORTH, aircraft("A"), elsewhere) is None


class TestOtherIntents:
    """The intents of others decide where they will be."""

    def test_one_that_returns_climbs_flies_home_and_lands(self) -> None:
        returning = Traffic(aircraft("B", (0.0, 300.0)), Intent(Commanded.RETURN))
        for place, height_m, passes in (
            ((-30.0, 150.0), 60.0, False),
            ((-30.0, 150.0), 40.0, True),
            ((-30.0, 300.0), 50.0, False),
            ((-30.0, 0.0), 10.0, False),
            ((-60.0, 350.0), 60.0, True),
        ):
            north_m, east_m = place
            through = route((north_m, east_m, height_m), (0.0, east_m, height_m))
            found = judged(through, aircraft("A", place, height_m), returning)
            assert (found is None) is passes, place

    def test_one_that_lands_is_everywhere_below(self) -> None:
        landing = Traffic(aircraft("B", (100.0, 0.0), 80.0), Intent(Commanded.LAND))
        refused(judged(NORTH, aircraft("A"), landing), "while it lands")
        assert judged(NORTH, aircraft("A"), aircraft("B", (100.0, 0.0), 80.0)) is None

    def test_one_that_goes_to_a_place_stands_there(self) -> None:
        goes = Intent(
            Commanded.STICK,
            target=at(100.0, 0.0),
            target_height_above_takeoff_m=40.0,
            speed_mps=5.0,
        )
        refused(judged(NORTH, aircraft("A"), Traffic(aircraft("B", (100.0, 60.0)), goes)))
        assert judged(NORTH, aircraft("A"), aircraft("B", (100.0, 60.0))) is None

    def test_one_that_stops_needs_its_way_to_stop(self) -> None:
        braking = aircraft("B", (20.0, 40.0), velocity=(0.0, -12.0, 0.0))
        holds = Traffic(braking, Intent(Commanded.HOLD))
        away = route((0.0, 0.0), (60.0, 0.0))
        refused(judged(away, aircraft("A"), holds))
        far = aircraft("B", (20.0, 60.0), velocity=(0.0, -12.0, 0.0))
        assert judged(away, aircraft("A"), Traffic(far, Intent(Commanded.HOLD))) is None

    def test_one_flown_by_hand_may_go_anywhere_near(self) -> None:
        past = route((0.0, 0.0), (300.0, 0.0))
        fast = aircraft("B", (150.0, 60.0), velocity=(0.0, 10.0, 0.0))
        refused(judged(past, aircraft("A"), fast), "under manual control")
        assert judged(past, aircraft("A"), aircraft("B", (150.0, 60.0))) is None


class TestClimbHome:
    """Who is in the way of the climb to go home: from 40 m to 60 m, 300 m north of home."""

    def name_above(self, own: VehicleState, *traffic: VehicleState) -> str | None:
        others = tuple(Traffic(state) for state in traffic)
        return in_way_of_climb_home(own, Situation(NOW, own, (), airspace=AIR, traffic=others))

    @pytest.mark.parametrize(
        ("place", "height_m", "name"),
        [
            ((300.0, 0.0), 52.0, "B"),
            ((305.0, 5.0), 64.0, "B"),
            ((300.0, 0.0), 72.0, None),
            ((300.0, 0.0), 30.0, None),
            ((340.0, 0.0), 52.0, None),
        ],
    )
    def test_one_that_hovers_above_within_the_minima(
        self, place: tuple[float, float], height_m: float, name: str | None
    ) -> None:
        own = aircraft("A", (300.0, 0.0))
        assert self.name_above(own, aircraft("B", place, height_m)) == name

    def test_who_is_high_enough_does_not_climb(self) -> None:
        own = aircraft("A", (300.0, 0.0), 62.0)
        assert self.name_above(own, aircraft("B", (300.0, 0.0), 71.0)) is None

    def test_one_on_the_way_further_on_is_left_to_the_watchdog(self) -> None:
        own = aircraft("A", (300.0, 0.0))
        assert self.name_above(own, aircraft("B", (150.0, 0.0), 60.0)) is None

    def test_a_lost_vehicle_may_be_anywhere(self) -> None:
        own = aircraft("A", (300.0, 0.0))
        assert self.name_above(own, aircraft("B", (300.0, 0.0), 52.0, age_s=20.0)) is None

    def test_nothing_is_in_the_way_where_that_is_unknown(self) -> None:
        other = aircraft("B", (300.0, 0.0), 52.0)
        assert self.name_above(aircraft("A", None), other) is None
        nowhere = replace(aircraft("B", None), core_received_at_ns=NOW)
        assert self.name_above(aircraft("A", (300.0, 0.0)), nowhere) is None
        over_other_ground = aircraft("B", (300.0, 0.0), 52.0, home=(300.0, 0.0))
        assert self.name_above(aircraft("A", (300.0, 0.0)), over_other_ground) is None
        own = aircraft("A", None)
        assert in_way_of_climb_home(own, Situation(NOW, own, ())) is None
