"""What orders make a vehicle fly: places and heights by construction."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.safety.cases import NOW, command, vehicle
from tests.safety.fenced import airspace, flier, goto, here, hills, mission, place, stick

from recon.model.command import (
    Body,
    HoldPosition,
    Hover,
    LandNow,
    Nudge,
    ReturnHome,
    StartCamera,
    StickFrame,
    StopCamera,
)
from recon.model.units import Stamped
from recon.model.vehicle import Attitude, Failsafe, VehicleState
from recon.safety import OPEN_AIRSPACE, PreparedAirspace
from recon.safety.path.pieces import Kind, PathVolume, UnknownPath
from recon.safety.path.volumes import path_volume
from recon.safety.settings import SafetySettings

FLAT = airspace()
INF = np.inf


def path(
    body: Body,
    state: VehicleState | None = None,
    air: PreparedAirspace = FLAT,
    *,
    takeoff: bool = False,
) -> PathVolume:
    found = path_volume(command(body, takeoff=takeoff), here(air, state))
    assert isinstance(found, PathVolume), found
    return found


def unknown(body: Body, state: VehicleState, air: PreparedAirspace = FLAT) -> str:
    found = path_volume(command(body), here(air, state))
    assert isinstance(found, UnknownPath), found
    return found.reason


def pieces(
    found: PathVolume, kind: Kind
) -> list[tuple[str, list[list[float]], float, float, bool]]:
    """Label, corners, low, high and whether it begins here, of each piece of a kind."""
    every = found.pieces
    return [
        (
            every.label(index),
            every.triangles_m[index].round(1).tolist(),
            round(float(every.low_m[index]), 3),
            round(float(every.high_m[index]), 3),
            bool(every.is_entry[index]),
        )
        for index in np.flatnonzero(found.of_kinds(kind))
    ]


@pytest.mark.parametrize("body", [Hover(), LandNow(), ReturnHome(), StartCamera(1.0), StopCamera()])
def test_what_sets_nothing_in_motion_flies_nowhere(body: Body) -> None:
    assert path_volume(command(body), here(FLAT)) is None


def test_no_vehicle_flies_nowhere() -> None:
    assert path_volume(command(goto(10.0, 0.0)), replace(here(FLAT), vehicle=None)) is None


@pytest.mark.parametrize("failsafe", Failsafe)
@pytest.mark.parametrize(
    "body",
    [
        mission((50.0, 0.0, 30.0), (50.0, 50.0, 30.0), (0.0, 50.0, 30.0), curved=True, land=True),
        goto(10.0, 0.0),
        HoldPosition(),
        stick(1.0, 2.0, 30.0),
        stick(1.0, 2.0, 30.0, frame=StickFrame.BODY, yaw_deg=80.0),
    ],
)
def test_every_piece_is_complete_and_entries_begin_at_the_vehicle(
    body: Body, failsafe: Failsafe
) -> None:
    found = path(body, flier(-20.0, 10.0, failsafe=failsafe))
    every = found.pieces
    columns = every.triangles_m, every.low_m, every.high_m, every.is_entry, every.names
    assert {len(column) for column in columns} == {len(every)}
    entries = every.only(every.is_entry)
    assert entries.label(0) == every.label(0)
    assert (entries.triangles_m[:, 0] == found.here_m[:2]).all()


class TestMission:
    square = mission((100.0, 0.0, 50.0), (100.0, 100.0, 30.0), (0.0, 100.0, 30.0))

    def test_the_way_there_and_the_legs(self) -> None:
        assert pieces(path(self.square, flier(20.0, -10.0, 40.0)), Kind.FLIGHT) == [
            ("the leg to waypoint 1", [[20, -10], [100, 0], [100, 0]], 41.0, 50.0, True),
            ("leg 1 to 2", [[100, 0], [100, 100], [100, 100]], 30.0, 50.0, False),
            ("leg 2 to 3", [[100, 100], [0, 100], [0, 100]], 30.0, 30.0, False),
        ]

    def test_without_curves_there_are_no_corners_and_no_end_but_hovering(self) -> None:
        found = path(self.square)
        assert pieces(found, Kind.CORNER) == []
        assert [piece[0] for piece in pieces(found, Kind.LANDING)] == ["the landing at home"]

    def test_a_corner_is_a_hull_on_both_legs(self) -> None:
        curved = replace(self.square.mission, curved=True)
        middle = replace(curved.waypoints[1], corner_radius_m=20.0)
        body = replace(
            self.square,
            mission=replace(curved, waypoints=(curved.waypoints[0], middle, curved.waypoints[2])),
        )
        found = pieces(path(body), Kind.CORNER)
        (name, corners, low_m, high_m, is_entry) = found[0]
        assert (name, low_m, is_entry) == ("the corner at waypoint 2", 30.0, False)
        # The leg before it sinks by 20 m over 100 m: 20 m along it is 3.9 m higher.
        assert high_m == pytest.approx(30.0 + 20.0 * 20.0 / np.hypot(100.0, 20.0), abs=0.01)
        assert corners == [[100.0, 80.4], [100.0, 100.0], [80.0, 100.0]]

    def test_the_ways_home(self) -> None:
        found = path(self.square, flier(20.0, -10.0, 40.0, go_home_m=35.0))
        assert pieces(found, Kind.CLIMB)[1:] == [
            (
                "the climb before the route home from leg 1 to 2",
                [[100, 0], [100, 100], [100, 100]],
                30.0,
                50.0,
                False,
            ),
            (
                "the climb before the route home from leg 2 to 3",
                [[100, 100], [0, 100], [0, 100]],
                30.0,
                35.0,
                False,
            ),
        ]
        assert pieces(found, Kind.ROUTE_HOME) == [
            (
                "the route home from the leg to waypoint 1",
                [[20, -10], [100, 0], [0, 0]],
                41.0,
                50.0,
                True,
            ),
            ("the route home from leg 1 to 2", [[100, 0], [100, 100], [0, 0]], 35.0, 50.0, False),
            ("the route home from leg 2 to 3", [[100, 100], [0, 100], [0, 0]], 35.0, 35.0, False),
        ]
        assert pieces(found, Kind.LANDING) == [
            ("the landing at home", [[0, 0], [0, 0], [0, 0]], -INF, 50.0, False)
        ]

    def test_an_unknown_go_home_height_may_be_any(self) -> None:
        found = path(self.square, flier(go_home_m=None))
        assert pieces(found, Kind.ROUTE_HOME)[2][2:4] == (30.0, INF)
        assert pieces(found, Kind.CLIMB)[2][2:4] == (30.0, INF)
        assert pieces(path(self.square, vehicle(None)), Kind.ROUTE_HOME)[2][2:4] == (30.0, INF)
        index = int(np.flatnonzero(found.of_kinds(Kind.ROUTE_HOME))[2])
        assert found.heights(index) == "30.0 m to an unknown go-home height above takeoff"
        assert found.height_parameters(index) == {"lowest_above_takeoff_m": 30.0}

    def test_an_aircraft_that_hovers_by_itself_has_no_route_home(self) -> None:
        found = path(self.square, flier(failsafe=Failsafe.HOVER))
        assert len(found.pieces) == 3

    def test_one_that_lands_by_itself_may_land_anywhere_on_the_way(self) -> None:
        found = path(self.square, flier(failsafe=Failsafe.LAND))
        assert pieces(found, Kind.ROUTE_HOME) == pieces(found, Kind.CLIMB) == []
        assert pieces(found, Kind.LANDING)[1] == (
            "the landing at leg 1 to 2",
            [[100, 0], [100, 100], [100, 100]],
            -INF,
            50.0,
            False,
        )

    def test_an_unset_failsafe_goes_home(self) -> None:
        assert pieces(path(self.square, flier(failsafe=None)), Kind.ROUTE_HOME)

    def test_it_lands_at_its_end(self) -> None:
        body = replace(self.square, mission=replace(self.square.mission, land_at_end=True))
        assert pieces(path(body), Kind.LANDING)[-1] == (
            "the landing at the end",
            [[0, 100], [0, 100], [0, 100]],
            -INF,
            30.0,
            False,
        )
        assert pieces(path(body), Kind.LANDING)[:-1] == pieces(path(self.square), Kind.LANDING)
        assert pieces(path(body), Kind.FLIGHT) == pieces(path(self.square), Kind.FLIGHT)
        last = len(path(body).pieces) - 1
        assert path(body).heights(last) == "the ground to 30.0 m above takeoff"
        assert path(body).height_parameters(last) == {"highest_above_takeoff_m": 30.0}

    def test_heights_count_from_the_takeoff_point(self) -> None:
        air = airspace(elevation=hills([[20.0] * 8] * 8))
        found = path(self.square, air=air)
        assert pieces(found, Kind.FLIGHT)[2][2:4] == (50.0, 50.0)
        assert found.heights(2) == "30.0 m above takeoff"
        assert found.height_parameters(1) == {
            "lowest_above_takeoff_m": 30.0,
            "highest_above_takeoff_m": 50.0,
        }
        assert found.subject(2) == "A: leg 2 to 3"

    def test_without_a_site_it_is_the_same_seen_from_the_vehicle(self) -> None:
        found = path(self.square, flier(20.0, 0.0), OPEN_AIRSPACE)
        assert pieces(found, Kind.FLIGHT)[0][1] == [[0, 0], [80, 0], [80, 0]]
        assert found.home_m == pytest.approx([-20.0, 0.0, 0.0], abs=0.01)

    def test_a_mission_without_waypoints_goes_nowhere(self) -> None:
        """Other rules refuse these; nothing falls over."""
        assert [piece[0] for piece in pieces(path(mission()), Kind.FLIGHT)] == ["the place to hold"]
        one = path(mission((9.0, 0.0, 40.0), curved=True))
        assert [piece[0] for piece in pieces(one, Kind.FLIGHT)] == ["the leg to waypoint 1"]

    @given(seed=st.integers(0, 10_000), radius_m=st.floats(0.2, 60.0), share=st.floats(0.0, 1.0))
    def test_the_route_home_from_a_corner_lies_in_its_legs_triangles_and_itself(
        self, seed: int, radius_m: float, share: float
    ) -> None:
        random = np.random.default_rng(seed)
        points = random.uniform(-200.0, 200.0, (3, 2))
        body = mission(*((*point, 40.0) for point in points), curved=True, radius_m=radius_m)
        found = path(body)
        corner = found.pieces.triangles_m[found.of_kinds(Kind.CORNER)][0]
        begin = random.dirichlet([1.0, 1.0, 1.0]) @ corner
        on_route_home = begin + share * (found.home_m[:2] - begin)
        covers = found.of_kinds(Kind.CORNER, Kind.ROUTE_HOME)
        assert any(
            is_within(triangle, on_route_home) for triangle in found.pieces.triangles_m[covers]
        )


def is_within(triangle: np.ndarray, point: np.ndarray) -> bool:
    sides = np.roll(triangle, -1, axis=0) - triangle
    to = point - triangle
    turns = sides[:, 0] * to[:, 1] - sides[:, 1] * to[:, 0]
    scale = 1e-6 * max(1.0, float(np.abs(triangle).max())) ** 2
    return bool((turns >= -scale).all() or (turns <= scale).all())


class TestSteered:
    def test_a_goto_flies_straight_and_may_pass_its_target(self) -> None:
        found = path(goto(100.0, 0.0, 60.0), flier(0.0, 0.0, 40.0))
        assert pieces(found, Kind.FLIGHT) == [
            ("the leg to the target", [[0, 0], [103, 0], [103, 0]], 41.0, 60.0, True)
        ]
        assert pieces(found, Kind.ROUTE_HOME)[0][4] is True

    def test_a_nudge_counts_from_the_vehicle(self) -> None:
        found = path(Nudge(north_m=4.0, east_m=-3.0, up_m=-0.5), flier(50.0, 50.0, 40.0))
        assert pieces(found, Kind.FLIGHT) == [
            ("the nudge", [[50, 50], [45.2, 56.4], [45.2, 56.4]], 39.5, 39.5, True)
        ]

    def test_however_short_the_way_it_may_pass_its_end(self) -> None:
        found = path(Nudge(north_m=0.5, east_m=0.0, up_m=0.0))
        assert pieces(found, Kind.FLIGHT)[0][1] == [[0, 0], [0, 3.5], [0, 3.5]]

    def test_straight_up_goes_nowhere_else(self) -> None:
        found = path(Nudge(0.0, 0.0, up_m=20.0), flier(50.0, 50.0, 10.0))
        assert pieces(found, Kind.FLIGHT) == [
            ("the nudge", [[50, 50], [50, 50], [50, 50]], 11.0, 30.0, True)
        ]

    def test_holding_the_place_is_a_place(self) -> None:
        found = path(HoldPosition(), flier(50.0, 50.0, 10.0))
        assert len(found.pieces) == 1
        assert pieces(found, Kind.FLIGHT) == [
            ("the place to hold", [[50, 50], [50, 50], [50, 50]], 10.0, 10.0, True)
        ]


def test_a_takeoff_climbs_on_the_spot_and_may_go_home_from_there() -> None:
    found = path(Hover(), flier(20.0, -10.0, 3.0), takeoff=True)
    column = [[20, -10], [20, -10], [20, -10]]
    top_m = 3.0 + SafetySettings().prediction.takeoff_height_m
    assert pieces(found, Kind.FLIGHT) == [("the takeoff", column, 4.0, top_m, True)]
    assert pieces(found, Kind.CLIMB) == [
        ("the climb before the route home from the takeoff", column, 4.0, 60.0, True)
    ]
    assert pieces(found, Kind.ROUTE_HOME) == [
        ("the route home from the takeoff", [[20, -10], [20, -10], [0, 0]], 60.0, 60.0, True)
    ]


class TestStick:
    def test_it_reaches_as_far_as_its_time_and_its_braking_carry(self) -> None:
        """5 m/s for 2 s are 10 m, and 5 m more to brake with 2.5 m/s2."""
        found = path(stick(3.0, 4.0, 45.0, 2.0), flier(10.0, 0.0, 40.0))
        assert pieces(found, Kind.FLIGHT) == [
            ("the stick's path", [[10, 0], [22, 9], [22, 9]], 41.0, 45.0, True)
        ]
        assert len(found.pieces) == 1

    @pytest.mark.parametrize("frame", StickFrame)
    def test_a_zero_stays(self, frame: StickFrame) -> None:
        found = path(stick(0.0, 0.0, 20.0, frame=frame), flier(10.0, 0.0, 40.0))
        assert pieces(found, Kind.FLIGHT) == [
            ("the stick's path", [[10, 0], [10, 0], [10, 0]], 20.0, 39.0, True)
        ]

    def test_the_wires_numbers_count(self) -> None:
        found = path(stick(1e-60, 0.0, 40.0), flier(10.0, 0.0, 40.0))
        assert pieces(found, Kind.FLIGHT)[0][1] == [[10, 0], [10, 0], [10, 0]]

    def heading(self, yaw_deg: float) -> VehicleState:
        return flier(attitude=Stamped(Attitude(yaw_deg, 0.0, 0.0), NOW))

    @pytest.mark.parametrize(
        ("yaw_deg", "end"),
        [(0.0, [1.4, 0.0]), (90.0, [0.0, -1.4]), (180.0, [-1.4, 0.0]), (-90.0, [0.0, 1.4])],
    )
    def test_in_the_bodys_frame_it_goes_where_the_vehicle_points(
        self, yaw_deg: float, end: list[float]
    ) -> None:
        """1 m/s to the right, for 1.2 s and 0.2 m of braking."""
        body = stick(0.0, 1.0, 40.0, 1.2, frame=StickFrame.BODY, yaw_deg=yaw_deg)
        found = path(body, self.heading(yaw_deg))
        (piece,) = pieces(found, Kind.FLIGHT)
        assert piece[1][0] == [0, 0]
        assert piece[1][1] == pytest.approx(end, abs=0.01)
        assert piece[1][2] == pytest.approx(end, abs=0.01)
        assert piece[2:] == (40.0, 40.0, True)

    @given(
        yaw_deg=st.floats(-180.0, 180.0),
        turn_deg=st.floats(-180.0, 180.0),
        share=st.floats(0.0, 1.0),
        north_mps=st.floats(-8.0, 8.0),
        east_mps=st.floats(0.1, 8.0),
    )
    def test_it_may_go_where_the_vehicle_points_while_it_turns(
        self, yaw_deg: float, turn_deg: float, share: float, north_mps: float, east_mps: float
    ) -> None:
        wanted_deg = yaw_deg + turn_deg
        body = stick(north_mps, east_mps, frame=StickFrame.BODY, yaw_deg=wanted_deg)
        found = path(body, self.heading(yaw_deg))
        yaw = np.radians(yaw_deg + share * turn_deg)
        speed_mps = float(np.hypot(north_mps, east_mps))
        reach_m = speed_mps + speed_mps**2 / 5.0
        bearing = yaw + np.arctan2(east_mps, north_mps)
        end = 0.9999 * reach_m * np.array([np.sin(bearing), np.cos(bearing)])
        assert any(is_within(triangle, end) for triangle in found.pieces.triangles_m)
        farthest_m = np.linalg.norm(found.pieces.triangles_m, axis=-1).max()
        assert farthest_m < 1.04 * reach_m + 0.01

    @pytest.mark.parametrize("attitude", [Stamped(), Stamped(Attitude(0.0, 0.0, 0.0), NOW)])
    def test_it_may_go_anywhere_when_it_turns_round_or_its_yaw_is_unknown(
        self, attitude: Stamped[Attitude]
    ) -> None:
        body = stick(5.0, 0.0, frame=StickFrame.BODY, yaw_deg=175.0)
        found = path(body, flier(attitude=attitude))
        for bearing in np.radians(np.arange(0.0, 360.0, 7.0)):
            end = 9.99 * np.array([np.sin(bearing), np.cos(bearing)])
            assert any(is_within(triangle, end) for triangle in found.pieces.triangles_m)

    @pytest.mark.parametrize(
        ("turn_deg", "count"),
        [(0.0, 1), (-30.0, 1), (31.0, 2), (90.0, 3), (-170.0, 6), (171.0, 12)],
    )
    def test_a_fan_has_a_piece_for_each_30_deg_and_a_circle_beyond_170_deg(
        self, turn_deg: float, count: int
    ) -> None:
        body = stick(1.0, 0.0, frame=StickFrame.BODY, yaw_deg=turn_deg)
        found = path(body, self.heading(0.0))
        assert len(found.pieces) == count


class TestUnknown:
    def test_without_a_position(self) -> None:
        refusal_text = unknown(goto(9.0, 9.0), flier(position=Stamped()))
        assert refusal_text == "A: position unknown; wait for a GNSS fix"

    def test_without_a_height(self) -> None:
        refusal_text = unknown(stick(1.0, 0.0), flier(height_above_takeoff_m=Stamped()))
        assert refusal_text == "A: no height telemetry; check its companion app"

    def test_without_a_home(self) -> None:
        refusal_text = unknown(TestMission.square, flier(takeoff_point=None))
        assert refusal_text == (
            "A: home unknown: it took off before telemetry was received; write its pad into "
            "site.toml, or let its pilot land it and take off again"
        )

    def test_without_ground_at_home(self) -> None:
        air = airspace(elevation=hills([[0.0, 0.0], [0.0, 0.0]]))
        refusal_text = unknown(HoldPosition(), flier(takeoff_point=place(500.0, 0.0)), air)
        assert refusal_text == (
            "A: the elevation model has no ground at its takeoff point, so its heights cannot be "
            "related to the site; write its pad's altitude into site.toml"
        )


def test_several_rules_share_one_path() -> None:
    order, now = command(TestMission.square), here(FLAT)
    assert path_volume(order, now) is path_volume(order, now)
    assert path_volume(replace(order), now) is not path_volume(order, now)
    assert replace(now) == now
    assert path_volume(order, replace(now)) is not path_volume(order, now)
