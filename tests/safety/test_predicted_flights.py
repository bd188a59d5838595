"""Where vehicles come on their missions, under sticks, home and down, by construction."""

from dataclasses import replace

import pytest
from tests.safety.traffic import SETTINGS, aircraft, at, flies, judged, route, seen, waypoint

from recon.model.command import Body, FlyMission, FollowPath, GoTo
from recon.model.control import Commanded, Intent
from recon.model.mission import Mission
from recon.model.vehicle import FlightMode, VehicleState
from recon.safety import Traffic
from recon.safety.prediction import (
    FlightPart,
    Predictor,
    VehicleMotion,
    predict_order,
    predict_traffic,
)
from recon.safety.prediction.trajectory import (
    ALL_HEIGHTS_M,
    END_S,
    FOREVER_S,
    PART,
    START_S,
    Row,
    Samples,
    sample,
)

HOME, LAND, STICK = Intent(Commanded.RETURN), Intent(Commanded.LAND), Intent(Commanded.STICK)
ALONG = route((0.0, 0.0), (100.0, 0.0))
Velocity = tuple[float, float, float]


def written(
    vehicle: VehicleState | VehicleMotion,
    intent: Intent,
    *,
    until_s: float = FOREVER_S,
    exactly: bool = True,
) -> list[Row]:
    motion = seen(vehicle) if isinstance(vehicle, VehicleState) else vehicle
    predictor = Predictor(motion, SETTINGS, until_s=until_s, exactly=exactly)
    predictor.follow(intent)
    return predictor.writer.rows


def where(vehicle: VehicleState | VehicleMotion, intent: Intent, *times_s: float) -> Samples:
    return sample([written(vehicle, intent)], times_s)


def parts(rows: list[Row]) -> list[int]:
    return [int(row[PART]) for row in rows]


class TestLegs:
    def test_each_is_flown_at_the_speed_of_the_waypoint_before_it(self) -> None:
        """To the first at its own: 12 s, 22 s and 8.5 s."""
        legs = Mission(
            (
                waypoint(50.0, 0.0, speed_mps=5.0),
                waypoint(150.0, 0.0, speed_mps=10.0),
                waypoint(195.0, 0.0, speed_mps=2.0),
            )
        )
        flown = where(aircraft(), flies(legs), 6.0, 12.0, 23.0, 34.0, 38.25, 42.5)
        expected = [25.0, 50.0, 100.0, 150.0, 172.5, 195.0]
        assert flown.north_m[0] == pytest.approx(expected, abs=0.05)

    def test_speed_is_gained_on_the_way_to_the_first_waypoint_too(self) -> None:
        there = route((100.0, 0.0), (200.0, 0.0))
        flown = where(aircraft(), flies(there), 1.0, 21.0)
        assert flown.north_m[0] == pytest.approx([1.25, 98.75], abs=0.01)

    def test_only_speed_towards_a_place_counts(self) -> None:
        """As far north as it is east; B flies north or away, and gains its speed anew."""
        there = flies(route((70.0, 50.0), (70.0, 150.0)), 1)
        for velocity, east_m in (
            ((0.0, 0.0, 0.0), 51.25),
            ((0.0, -5.0, 0.0), 51.25),
            ((5.0, 0.0, 0.0), 51.25),
            ((0.0, 5.0, 0.0), 55.0),
        ):
            state = aircraft("B", (70.0, 50.0), velocity=velocity)
            assert where(state, there, 1.0).east_m[0, 0] == pytest.approx(east_m, abs=0.01)

    @pytest.mark.parametrize(
        ("loiter_s", "count", "north_m"), [(None, 5, 60.0), (0.0, 5, 60.0), (0.5, 6, 57.5)]
    )
    def test_a_loiter_lasts_its_time(
        self, loiter_s: float | None, count: int, north_m: float
    ) -> None:
        """50 m to the waypoint in 12 s, and 10 m from it on in 3 s."""
        legs = Mission(
            (waypoint(0.0, 0.0), waypoint(50.0, 0.0, loiter_s=loiter_s), waypoint(100.0, 0.0))
        )
        rows = written(aircraft(), flies(legs, 1))
        kept = [row for row in rows if row[PART] == 1]
        assert len(kept) == count - 2
        assert sample([rows], [15.0]).north_m[0, 0] == pytest.approx(north_m, abs=0.01)

    def test_each_row_has_the_number_of_its_waypoint_and_takes_time(self) -> None:
        climbs = aircraft(velocity=(0.0, 0.0, 2.0))
        legs = Mission(
            (
                waypoint(0.0, 0.0, 70.0, loiter_s=4.0),
                waypoint(50.0, 0.0, 70.0),
                waypoint(50.0, 0.0, 70.0),
            )
        )
        rows = written(climbs, flies(legs))
        assert parts(rows) == [0, 0, 0, 1, 1, 1, 2, FlightPart.HOVERING]
        assert all(row[END_S] > row[START_S] for row in rows)

    @pytest.mark.parametrize("exactly", [False, True])
    @pytest.mark.parametrize("passed", [0, 1])
    def test_what_begins_by_the_end_asked_for_is_written_and_no_later_way(
        self, passed: int, exactly: bool
    ) -> None:
        intent = flies(route((30.0, 0.0), (60.0, 0.0), (60.0, 40.0), (0.0, 0.0)), passed)
        whole = written(aircraft(), intent, exactly=exactly)
        paths = [row for row in whole if row[PART] >= 0]
        assert len(paths) == (4 - passed) * (3 if exactly else 1)
        for until_s in (row[START_S] for row in paths):
            short = written(aircraft(), intent, until_s=until_s, exactly=exactly)
            asked = [row for row in paths if row[START_S] <= until_s]
            assert [row for row in short if row[PART] >= 0] == asked


class TestCurved:
    def test_it_stops_at_its_last_waypoint_only(self) -> None:
        """40 m in 9 s, 55 m in 11 s, and 5 m in 2 s of braking."""
        legs = route((0.0, 0.0), (40.0, 0.0), (100.0, 0.0), curved=True)
        flown = where(aircraft(), flies(legs, 1), 9.0, 20.0, 21.0, 22.0)
        assert flown.north_m[0] == pytest.approx([40.0, 95.0, 98.75, 100.0], abs=0.01)

    def test_a_leg_has_the_bulge_of_the_corners_at_its_ends_and_no_other(self) -> None:
        """A corner of 20 m at a right angle bulges by 10 m, one of 10 m by 5 m."""
        paths = (
            waypoint(0.0, 0.0, corner_radius_m=90.0),
            waypoint(100.0, 0.0, corner_radius_m=10.0),
            waypoint(100.0, 100.0, corner_radius_m=20.0),
            waypoint(200.0, 100.0),
            waypoint(300.0, 100.0, corner_radius_m=90.0),
            waypoint(400.0, 100.0, corner_radius_m=90.0),
        )
        rows = written(aircraft(), flies(Mission(paths, curved=True)), exactly=False)
        assert parts(rows) == [0, 1, 2, 3, 4, 5, FlightPart.HOVERING]
        found = [float(sample([[row]], [row[END_S]]).radius_m[0, 0]) for row in rows]
        assert found == pytest.approx([0.0, 5.0, 10.0, 10.0, 0.0, 0.0, 0.0], abs=0.01)
        straight = written(aircraft(), flies(replace(Mission(paths), curved=False)), exactly=False)
        assert sample([straight], [row[START_S] for row in straight]).radius_m.max() == 0.0


class TestFirstWaypoint:
    @pytest.mark.parametrize(
        ("velocity", "waits"),
        [
            ((0.0, 0.0, 0.5), True),
            ((0.0, 0.0, 0.49), False),
            ((1.99, 0.0, 2.0), True),
            ((2.0, 0.0, 2.0), False),
        ],
    )
    def test_one_is_seen_to_climb_first_if_it_climbs_and_goes_nowhere(
        self, velocity: Velocity, waits: bool
    ) -> None:
        up = flies(route((50.0, 0.0, 70.0), (100.0, 0.0, 70.0)))
        flown = where(aircraft(velocity=velocity), up, 5.0)
        assert (flown.north_m[0, 0] < 1e-6) == waits

    def test_one_that_climbs_at_its_height_leaves_at_once(self) -> None:
        level = flies(route((50.0, 0.0, 40.0), (100.0, 0.0, 40.0)))
        rows = written(aircraft(velocity=(0.0, 0.0, 1.0)), level)
        assert all(row[END_S] > row[START_S] for row in rows)
        assert sample([rows], [1.0]).north_m[0, 0] == pytest.approx(1.25, abs=0.01)

    @pytest.mark.parametrize("age_s", [0.0, 2.0])
    @pytest.mark.parametrize(
        ("body", "height_m", "delay_s"),
        [
            (FlyMission(ALONG), 40.0, 8.2),
            (FlyMission(ALONG), 20.0, 8.2 + 10.0),
            (FlyMission(ALONG), 60.0, 8.2 + 10.0),
            (FlyMission(ALONG), None, 8.2),
            (FlyMission(route(*((float(n), 0.0) for n in range(60)))), 40.0, 14.0),
            (FlyMission(route(*((float(n), 0.0) for n in range(300)))), 40.0, 17.9),
            (GoTo(at(100.0, 0.0), 40.0, 5.0), 40.0, 0.0),
            (GoTo(at(100.0, 0.0), 40.0, 5.0), 10.0, 15.0 - 10.0),
            (GoTo(at(100.0, 0.0), 40.0, 5.0), 60.0, 10.0 - 5.0),
            (GoTo(at(100.0, 0.0), 40.0, 5.0), None, 0.0),
        ],
    )
    def test_a_slow_change_of_height_may_delay_it(
        self, body: Body, height_m: float | None, delay_s: float, age_s: float
    ) -> None:
        """As slow as 2 m/s; the flight itself counts 3 m/s up and 4 m/s down. A mission's change
        of height may come first, and its start 8 s late, and 0.1 s for each waypoint that is
        uploaded at once."""
        state = aircraft(height_m=height_m, age_s=age_s)
        assert predict_order(seen(state), body, SETTINGS).delay_s == pytest.approx(delay_s)

    @pytest.mark.parametrize("intent", [HOME, LAND, STICK, Intent(), flies(ALONG, 1)])
    def test_nothing_else_is_delayed(self, intent: Intent) -> None:
        (found,) = predict_traffic(seen(aircraft()), intent, SETTINGS, FOREVER_S)
        assert found.delay_s == 0.0


class TestTooFastForItsLeg:
    """Speed that is too high for a leg is lost within seconds: the vehicle arrives sooner."""

    slow = Mission(
        (
            waypoint(-50.0, 0.0, speed_mps=2.0),
            waypoint(60.0, 0.0, speed_mps=2.0),
            waypoint(0.0, 0.0),
        )
    )
    """From the origin at 15 m/s: at 2 m/s after 5.2 s and 44 m, at 60 m after 13.5 s."""

    @pytest.mark.parametrize(("south_m", "passes"), [(-260.0, True), (-40.0, False)])
    def test_the_gate_counts_it_where_it_is_by_then(self, south_m: float, passes: bool) -> None:
        """A passes 16 m beyond that place: some 8 s or 52 s from now, or 8 s later."""
        other = aircraft("B", velocity=(15.0, 0.0, 0.0))
        across = route((76.0, south_m), (76.0, 400.0))
        found = judged(across, aircraft("A", (76.0, south_m)), Traffic(other, flies(self.slow, 1)))
        assert (found is None) is passes

    def test_a_mission_begins_at_rest_after_its_stop(self) -> None:
        """7 s and 60 m to stop from 15 m/s; then 40 m at 1 m/s, and 0.4 s for gaining and losing
        speed."""
        fast = aircraft("A", velocity=(15.0, 0.0, 0.0))
        mission = Mission((waypoint(100.0, 0.0, speed_mps=1.0), waypoint(0.0, 0.0)))
        rows = predict_order(seen(fast), FlyMission(mission), SETTINGS).rows
        assert rows[2, END_S] == pytest.approx(7.0 + 40.4, abs=0.01)
        meets = aircraft("B", (116.0, -225.0), velocity=(0.0, 5.0, 0.0))
        crosses = flies(route((116.0, -235.0), (116.0, 600.0)), 1)
        assert judged(mission, fast, Traffic(meets, crosses)) is not None


class TestSticks:
    def test_one_without_a_place_goes_straight_on_in_all_directions(self) -> None:
        """5 s at 3 m/s north, 4 m/s west and 1 m/s down, from 70 m north and 10 m east."""
        state = aircraft("B", (70.0, 10.0), velocity=(3.0, -4.0, -1.0))
        flown = where(state, STICK, 5.0)
        found = flown.north_m, flown.east_m, flown.low_m, flown.high_m
        assert [one[0, 0] for one in found] == pytest.approx([85.0, -10.0, 35.0, 35.0], abs=0.01)

    def test_one_to_a_place_brakes_for_it(self) -> None:
        """50 m at 10 m/s: 4 s, 1 s and 4 s."""
        goes = replace(STICK, target=at(50.0, 0.0))
        flown = where(aircraft(), goes, 4.0, 8.0, 9.0)
        assert flown.north_m[0] == pytest.approx([20.0, 48.75, 50.0], abs=0.01)


class TestLanding:
    def test_it_brakes_at_once_and_sinks_where_it_has_stopped(self) -> None:
        """5 m in 2 s, and 4 m/s down for the 60 s looked ahead."""
        state = aircraft("B", (70.0, 10.0), velocity=(5.0, 0.0, 0.0))
        rows = written(state, LAND, until_s=60.0)
        assert parts(rows) == [FlightPart.STOPPING, FlightPart.LANDING]
        flown = sample([rows], [1.0, 2.0, 62.0])
        assert flown.north_m[0] == pytest.approx([73.75, 75.0, 75.0], abs=0.01)
        assert flown.east_m[0] == pytest.approx([10.0] * 3, abs=0.01)
        assert flown.low_m[0] == pytest.approx([40.0, 40.0, -200.0])

    @pytest.mark.parametrize(
        ("takeoff_up_m", "up_m", "lasts_s"),
        [(0.0, 40.0, 50.0), (15.0, 40.0, 42.5), (0.0, -20.0, 30.0), (None, 40.0, 280.0)],
    )
    def test_it_sinks_to_its_takeoff_point_and_waits_half_a_minute(
        self, takeoff_up_m: float | None, up_m: float, lasts_s: float
    ) -> None:
        """At 2 m/s; over unknown ground from as high as any flies home."""
        above = seen(aircraft(height_m=up_m))._replace(takeoff_up_m=takeoff_up_m)
        predictor = Predictor(above, replace(SETTINGS, landing_mps=2.0))
        predictor.follow(LAND)
        down = predictor.writer.rows[-1]
        assert down[END_S] - down[START_S] == pytest.approx(lasts_s)
        assert down[PART] == FlightPart.LANDING


class TestReturn:
    @pytest.mark.parametrize(("speed_mps", "low_m"), [(1.99, 60.0), (2.0, 40.0)])
    def test_from_2_mps_towards_home_it_is_under_way_at_whatever_height(
        self, speed_mps: float, low_m: float
    ) -> None:
        state = aircraft("B", (200.0, 0.0), velocity=(-speed_mps, 0.0, 0.0))
        assert where(state, HOME, 20.0).low_m[0, 0] == low_m

    def test_one_that_stops_first_begins_its_way_at_rest_and_ends_it_at_rest(self) -> None:
        """It stops within 1.44 s, climbs 20 m in 6.67 s, and flies 200 m at 10 m/s in 24 s."""
        state = aircraft("B", (200.0, 0.0), velocity=(0.0, 3.6, 0.0))
        flown = where(state, HOME, 0.72, 1.44, 8.11, 9.11, 31.11, 32.11)
        assert flown.north_m[0] == pytest.approx([200.0, 200.0, 200.0, 198.75, 1.25, 0.0], abs=0.05)
        assert flown.east_m[0, :3] == pytest.approx([1.944, 2.592, 2.592], abs=0.01)
        slow = aircraft("B", (200.0, 0.0), velocity=(-1.8, 0.0, 0.0))
        stands_m = 200.0 - 0.648
        flown = where(slow, HOME, 0.72 + 20.0 / 3.0, 0.72 + 20.0 / 3.0 + 1.0)
        assert flown.north_m[0] == pytest.approx([stands_m, stands_m - 1.25], abs=0.02)

    def test_one_without_a_home_may_be_at_every_height(self) -> None:
        flown = where(aircraft(home=None, height_m=40.0), HOME, 1.0)
        assert (flown.low_m[0, 0], flown.high_m[0, 0]) == (-ALL_HEIGHTS_M, ALL_HEIGHTS_M)
        homeless = seen(aircraft())._replace(home_m=None)
        flown = where(homeless, HOME, 1.0)
        assert (flown.low_m[0, 0], flown.high_m[0, 0]) == (-ALL_HEIGHTS_M, ALL_HEIGHTS_M)

    def test_one_at_home_is_there_at_once(self) -> None:
        rows = written(aircraft(mode=FlightMode.GO_HOME, height_m=60.0), HOME)
        assert rows[-1][PART] == FlightPart.LANDING
        assert rows[-1][START_S] < 0.1


class TestWithoutAnOrder:
    @pytest.mark.parametrize(
        ("velocity", "low_m", "high_m"),
        [
            ((0.0, 0.0, 2.0), 40.0, 50.0),
            ((0.0, 0.0, -2.0), 30.0, 40.0),
            ((0.0, 0.0, 0.5), 40.0, 42.5),
            ((0.0, 0.0, 0.49), 40.0, 40.0),
        ],
    )
    def test_one_that_climbs_or_sinks_may_do_so_for_5_s(
        self, velocity: Velocity, low_m: float, high_m: float
    ) -> None:
        flown = where(aircraft(velocity=velocity), Intent(), 6.0)
        assert (flown.low_m[0, 0], flown.high_m[0, 0]) == pytest.approx((low_m, high_m))

    @pytest.mark.parametrize(("speed_mps", "radius_m"), [(0.49, 0.0), (0.5, 3.05), (10.0, 80.0)])
    def test_one_that_moves_may_turn_anywhere_and_needs_its_way_to_stop(
        self, speed_mps: float, radius_m: float
    ) -> None:
        """5 s, a second of reaction, and the braking."""
        flown = where(aircraft(velocity=(speed_mps, 0.0, 0.0)), Intent(), 6.0)
        assert flown.radius_m[0, 0] == pytest.approx(radius_m)


class TestSteeredPaths:
    def test_one_is_flown_where_a_mission_would_be(self) -> None:
        steered = Intent(Commanded.STICK, mission=ALONG, passed=1, target=at(100.0, 0.0))
        flown = Intent(Commanded.MISSION, mission=ALONG, passed=1)
        assert written(aircraft(), steered) == written(aircraft(), flown)

    def test_it_may_be_late_by_its_corners(self) -> None:
        corner_s = SETTINGS.steered_corner_s
        ordered = predict_order(seen(aircraft()), FollowPath(ALONG), SETTINGS)
        whole = predict_order(seen(aircraft()), FlyMission(ALONG), SETTINGS)
        start_s = SETTINGS.starts_within_s(ALONG)
        assert ordered.delay_s == pytest.approx(whole.delay_s - start_s + 2.0 * corner_s)
        under_way = Intent(Commanded.STICK, mission=ALONG, passed=1)
        (seen_by_others,) = predict_traffic(seen(aircraft()), under_way, SETTINGS, 60.0)
        assert seen_by_others.delay_s == pytest.approx(corner_s)
