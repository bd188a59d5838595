"""What DJI's SDK takes, on both sides of every limit."""

from dataclasses import replace

import pytest
from tests.safety.cases import (
    STICK,
    TAKEOFF,
    command,
    mission,
    situation,
    vehicle,
    waypoint,
)

from recon.model.command import Body, FollowPath, GoTo, HoldPosition, Nudge, StartCamera
from recon.model.geo import LatLon
from recon.model.mission import Waypoint
from recon.safety.rules.dji_limits import dji_limits
from recon.safety.settings import SafetySettings


def is_taken(body: Body, max_waypoints: int = 99) -> bool:
    state = vehicle(replace(TAKEOFF, max_waypoints=max_waypoints))
    answer = dji_limits(command(body), situation(state))
    assert answer is None or (answer.rule == "dji_limits" and answer.reason)
    return answer is None


def line(count: int, step_m: float = 10.0) -> tuple[Waypoint, ...]:
    return tuple(waypoint(number * step_m) for number in range(count))


class TestWaypoints:
    @pytest.mark.parametrize(
        ("name", "taken", "refused"),
        [
            ("height_above_takeoff_m", (-200.0, 500.0), (-200.01, 500.01)),
            ("speed_mps", (0.01, 15.0), (0.0, -1.0, 15.01, 1e-60, 1e300)),
            ("loiter_s", (0.0, 32.767, None), (-0.01, 32.768)),
            ("gimbal_pitch_deg", (-90.0, 0.0, None), (-90.1, 0.1)),
            ("latitude_deg", (42.001,), (90.1, -91.0)),
            ("longitude_deg", (-93.601,), (180.1, -181.0)),
        ],
    )
    def test_each_field(
        self, name: str, taken: tuple[float | None, ...], refused: tuple[float, ...]
    ) -> None:
        for value in taken:
            changed = waypoint(600.0, **{name: value})
            assert is_taken(mission(waypoint(0.0), changed)), value
        for value in refused:
            changed = waypoint(600.0, **{name: value})
            assert not is_taken(mission(waypoint(0.0), changed)), value

    @pytest.mark.parametrize(("count", "taken"), [(0, 0), (1, 0), (2, 1), (99, 1), (100, 0)])
    def test_how_many(self, count: int, taken: int) -> None:
        body = replace(mission(), mission=replace(mission().mission, waypoints=line(count)))
        assert is_taken(body) == bool(taken)

    @pytest.mark.parametrize(("count", "taken"), [(25, True), (26, False)])
    def test_a_legacy_app_takes_25(self, count: int, taken: bool) -> None:
        assert is_taken(mission(*line(count)), max_waypoints=25) is taken

    @pytest.mark.parametrize(
        ("leg_m", "taken"), [(0.49, False), (0.51, True), (1999.0, True), (2001.0, False)]
    )
    def test_neighbours(self, leg_m: float, taken: bool) -> None:
        assert is_taken(mission(waypoint(0.0), waypoint(leg_m))) is taken

    def test_neighbours_are_apart_in_three_dimensions(self) -> None:
        assert is_taken(mission(waypoint(0.0), waypoint(0.0, height_above_takeoff_m=41.0)))
        assert not is_taken(mission(waypoint(0.0), waypoint(0.0, height_above_takeoff_m=40.4)))

    @pytest.mark.parametrize(("back_m", "taken"), [(0.3, False), (0.7, True)])
    def test_the_first_and_the_last(self, back_m: float, taken: bool) -> None:
        assert is_taken(mission(waypoint(0.0), waypoint(50.0), waypoint(back_m))) is taken

    @pytest.mark.parametrize(("step_m", "taken"), [(999.0, True), (1001.0, False)])
    def test_the_last_is_at_most_2_km_from_the_first(self, step_m: float, taken: bool) -> None:
        assert is_taken(mission(*line(3, step_m))) is taken

    @pytest.mark.parametrize(("legs", "taken"), [(15, True), (17, False)])
    def test_the_whole_path_is_at_most_30_km(self, legs: int, taken: bool) -> None:
        there_and_back = (waypoint(1900.0 * (n % 2) + n) for n in range(legs + 1))
        assert is_taken(mission(*there_and_back)) is taken


class TestCurved:
    def corners(self, *radii_m: float) -> Body:
        points = (waypoint(20.0 * n, corner_radius_m=r) for n, r in enumerate(radii_m))
        return mission(*points, curved=True)

    @pytest.mark.parametrize(
        ("radii_m", "taken"),
        [
            ((0.2, 5.0, 0.2), True),
            ((0.2, 0.2, 0.2), True),
            ((0.2, 0.19, 0.2), False),
            ((0.3, 5.0, 0.2), False),
            ((0.2, 5.0, 0.3), False),
            ((0.2, 19.7, 0.2), True),
            ((0.2, 19.9, 0.2), False),
            ((0.2, 10.1, 10.1, 0.2), False),
            ((0.2, 1000.1, 0.2), False),
        ],
    )
    def test_corner_radii(self, radii_m: tuple[float, ...], taken: bool) -> None:
        assert is_taken(self.corners(*radii_m)) is taken

    def test_radii_do_not_matter_when_the_path_is_not_curved(self) -> None:
        assert is_taken(mission(waypoint(0.0, corner_radius_m=500.0), waypoint(50.0)))

    @pytest.mark.parametrize("action", ["loiter_s", "gimbal_pitch_deg"])
    def test_a_curved_mission_with_an_action_is_refused_not_silently_changed(
        self, action: str
    ) -> None:
        points = (waypoint(0.0), waypoint(50.0, **{action: 0.0}))
        assert not is_taken(mission(*points, curved=True))
        assert is_taken(mission(*points))


class TestStick:
    @pytest.mark.parametrize(
        ("name", "taken", "refused"),
        [
            ("velocity_x_mps", (-15.0, 0.0, 15.0), (-15.01, 15.01)),
            ("velocity_y_mps", (-15.0, 0.0, 15.0), (-15.01, 15.01)),
            ("height_above_takeoff_m", (0.0, 500.0), (-0.01, 500.01)),
            ("timeout_s", (0.1, 5.0), (0.0, -1.0, 5.01, 1e-60)),
            ("yaw_deg", (-720.0, 359.0), ()),
        ],
    )
    def test_each_field(
        self, name: str, taken: tuple[float, ...], refused: tuple[float, ...]
    ) -> None:
        assert all(is_taken(replace(STICK, **{name: value})) for value in taken)
        assert not any(is_taken(replace(STICK, **{name: value})) for value in refused)


@pytest.mark.parametrize(
    ("fps_hz", "taken"), [(0.1, True), (30.0, True), (0.0, False), (30.1, False), (1e-60, False)]
)
def test_frame_rates(fps_hz: float, taken: bool) -> None:
    assert is_taken(StartCamera(fps_hz)) is taken


class TestSteered:
    @pytest.mark.parametrize(
        ("name", "taken", "refused"),
        [
            ("target", (LatLon(90.0, -180.0),), (LatLon(90.1, 0.0), LatLon(0.0, 180.1))),
            ("height_above_takeoff_m", (0.0, 500.0), (-0.01, 500.01)),
            ("speed_mps", (0.1, 15.0), (0.09, 0.0, -5.0, 15.01)),
        ],
    )
    def test_a_goto_asks_for_nothing_that_sticks_cannot_say(
        self, name: str, taken: tuple[object, ...], refused: tuple[object, ...]
    ) -> None:
        body = GoTo(LatLon(42.0, -93.6), 40.0, 5.0)
        for value in taken:
            assert is_taken(replace(body, **{name: value})), value  # type: ignore[arg-type]
        for value in refused:
            assert not is_taken(replace(body, **{name: value})), value  # type: ignore[arg-type]

    @pytest.mark.parametrize("name", ["north_m", "east_m", "up_m"])
    def test_a_nudge_is_a_short_way(self, name: str) -> None:
        body = Nudge(0.0, 0.0, 0.0)
        for value in (-100.0, 100.0):
            assert is_taken(replace(body, **{name: value}))
            assert not is_taken(replace(body, **{name: 1.001 * value}))

    @pytest.mark.parametrize(("speed_mps", "taken"), [(0.1, 1), (15.0, 1), (0.0, 0), (15.1, 0)])
    def test_a_nudge_has_a_speed(self, speed_mps: float, taken: int) -> None:
        assert is_taken(Nudge(1.0, 0.0, 0.0, speed_mps)) == bool(taken)

    def test_holding_asks_for_nothing(self) -> None:
        assert is_taken(HoldPosition())


def upright(*heights_m: float) -> tuple[Waypoint, ...]:
    """Waypoints one above the other: their distances are exact."""
    return tuple(waypoint(0.0, height_above_takeoff_m=height_m) for height_m in heights_m)


class TestAtTheLimitItself:
    """The last accepted value and the first refused one, with round limits in place of DJI's."""

    def is_taken(self, body: Body, **limits: float) -> bool:
        settings = SafetySettings(**limits)  # type: ignore[arg-type]
        return dji_limits(command(body), replace(situation(), settings=settings)) is None

    @pytest.mark.parametrize(("top_m", "taken"), [(0.5, True), (0.4999, False)])
    def test_the_shortest_leg(self, top_m: float, taken: bool) -> None:
        assert self.is_taken(mission(*upright(0.0, top_m))) is taken

    @pytest.mark.parametrize(("top_m", "taken"), [(100.0, True), (100.01, False)])
    def test_the_longest_leg(self, top_m: float, taken: bool) -> None:
        assert self.is_taken(mission(*upright(0.0, top_m)), max_leg_m=100.0) is taken

    @pytest.mark.parametrize(("back_m", "taken"), [(0.5, True), (0.4999, False)])
    def test_the_nearest_end(self, back_m: float, taken: bool) -> None:
        assert self.is_taken(mission(*upright(0.0, 50.0, back_m))) is taken

    @pytest.mark.parametrize(("end_m", "taken"), [(100.0, True), (100.01, False)])
    def test_the_farthest_end(self, end_m: float, taken: bool) -> None:
        assert self.is_taken(mission(*upright(0.0, 50.0, end_m)), max_leg_m=100.0) is taken

    @pytest.mark.parametrize(("end_m", "taken"), [(20.0, True), (19.99, False)])
    def test_the_longest_path(self, end_m: float, taken: bool) -> None:
        assert self.is_taken(mission(*upright(0.0, 50.0, end_m)), max_path_m=80.0) is taken

    @pytest.mark.parametrize(
        ("radius_m", "taken"), [(1e-6, True), (-1e-6, True), (1.1e-6, False), (-1.1e-6, False)]
    )
    def test_the_tolerance_of_an_end_radius(self, radius_m: float, taken: bool) -> None:
        ends = (waypoint(0.0, corner_radius_m=0.0), waypoint(50.0, corner_radius_m=radius_m))
        body = mission(*ends, curved=True)
        assert self.is_taken(body, min_corner_radius_m=0.0) is taken

    def test_the_largest_radius(self) -> None:
        between = waypoint(1500.0, corner_radius_m=1000.0)
        assert self.is_taken(mission(waypoint(0.0), between, waypoint(100.0), curved=True))

    @pytest.mark.parametrize(("top_m", "taken"), [(10.0, False), (10.01, True)])
    def test_corners_that_fill_their_leg(self, top_m: float, taken: bool) -> None:
        low, high, end = upright(0.0, top_m, 100.0)
        body = mission(low, replace(high, corner_radius_m=9.8), end, curved=True)
        assert self.is_taken(body) is taken


def test_an_unknown_vehicle_has_the_protocols_waypoint_limit() -> None:
    for known in (replace(situation(), vehicle=None), situation(vehicle(None))):
        assert dji_limits(command(mission(*line(99))), known) is None
        answer = dji_limits(command(mission(*line(100))), known)
        assert answer is not None
        assert answer.parameters["max_count"] == 99


class TestFollowedPaths:
    @pytest.mark.parametrize("count", [1, 2, 300])
    def test_a_path_that_is_steered_needs_no_upload(self, count: int) -> None:
        path = FollowPath(replace(mission().mission, waypoints=line(count, 0.1)))
        assert is_taken(path, max_waypoints=0)
        assert not is_taken(FollowPath(replace(path.mission, curved=True)))

    def test_what_sticks_cannot_carry_is_refused(self) -> None:
        for changed in (
            {"height_above_takeoff_m": -1.0},
            {"speed_mps": 0.0},
            {"speed_mps": 15.1},
            {"latitude_deg": 91.0},
            {"loiter_s": 1.0},
        ):
            assert not is_taken(FollowPath(mission(waypoint(0.0, **changed)).mission)), changed
        assert not is_taken(FollowPath(replace(mission().mission, waypoints=())))
        assert not is_taken(FollowPath(replace(mission().mission, waypoints=line(1_001))))

    def test_a_mission_is_refused_where_the_aircraft_takes_none(self) -> None:
        state = vehicle(replace(TAKEOFF, max_waypoints=0))
        answer = dji_limits(command(mission()), situation(state))
        assert answer is not None
        assert "flies no missions" in answer.reason
