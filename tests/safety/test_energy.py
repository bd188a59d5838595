"""The energy model against flights whose cost is counted by hand."""

from dataclasses import replace
from math import hypot

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.safety.cases import PLACE, TAKEOFF, mission, vehicle, waypoint

from recon.model.airspace import Airspace, FlightLimits
from recon.model.units import Stamped
from recon.safety import OPEN_AIRSPACE, PreparedAirspace
from recon.safety.energy import (
    Consumption,
    Need,
    Point,
    consumption,
    fraction_to_get_home,
    mission_need,
    mission_points,
    path_need,
    place_of,
)
from recon.safety.settings import EnergySettings

SETTINGS = EnergySettings(
    level_load=1.25,
    climb_load=1.6,
    sink_load=1.0,
    climb_mps=2.0,
    sink_mps=2.0,
    landing_mps=1.5,
    touchdown_s=15.0,
    home_mps=8.0,
    brake_mps2=2.5,
    gimbal_s=3.0,
    wind_loads=(1.0, 1.2, 1.5),
    unknown_wind_load=1.2,
)
CALM = Consumption(1_000.0, 1.0, 60.0, SETTINGS)
"""A battery of 1000 s: each loaded second is a thousandth."""

points = st.tuples(
    st.floats(-2_000.0, 2_000.0), st.floats(-2_000.0, 2_000.0), st.floats(0.0, 120.0)
)


def per_mille(loaded_s: float) -> object:
    return pytest.approx(loaded_s / 1_000.0, rel=1e-12)


class TestLeg:
    def test_level_flight_counts_its_time_and_its_stops(self) -> None:
        start, end = (10.0, 20.0, 50.0), (40.0, 60.0, 50.0)
        assert CALM.leg(start, end, 5.0) == per_mille((10.0 + 2.0) * 1.25)
        assert CALM.leg(start, end, 5.0, stops=False) == per_mille(10.0 * 1.25)

    def test_a_climb_is_dearer_than_a_descent(self) -> None:
        low, high = (0.0, 0.0, 20.0), (0.0, 0.0, 50.0)
        assert CALM.leg(low, high, 5.0) == per_mille(15.0 * 1.6)
        assert CALM.leg(high, low, 5.0) == per_mille(15.0)

    def test_the_shortest_legs_cost_their_time_and_stops_too(self) -> None:
        here = (0.0, 0.0, 50.0)
        assert CALM.leg(here, (0.5, 0.0, 50.0), 5.0) == per_mille((0.1 + 2.0) * 1.25)
        assert CALM.leg(here, (0.0, 0.0, 50.5), 5.0) == per_mille(0.25 * 1.6)

    def test_sinking_is_cheaper_where_its_load_is_less(self) -> None:
        light = replace(CALM, settings=replace(SETTINGS, sink_load=0.5))
        assert light.leg((0.0, 0.0, 50.0), (0.0, 0.0, 20.0), 5.0) == per_mille(15.0 * 0.5)
        assert light.landing(60.0) == per_mille((40.0 + 15.0) * 0.5)

    def test_climbing_on_the_way_is_no_cheaper_than_one_after_the_other(self) -> None:
        climb = CALM.leg((0.0, 0.0, 20.0), (0.0, 0.0, 50.0), 5.0)
        level = CALM.leg((0.0, 0.0, 20.0), (50.0, 0.0, 20.0), 5.0)
        assert CALM.leg((0.0, 0.0, 20.0), (50.0, 0.0, 50.0), 5.0) == pytest.approx(climb + level)

    def test_no_speed_at_all_is_dear_and_no_error(self) -> None:
        assert CALM.leg((0.0, 0.0, 0.0), (10.0, 0.0, 0.0), 0.0) == per_mille(100.0 * 1.25)

    def test_wind_and_endurance_scale_everything(self) -> None:
        windy = replace(CALM, wind_load=1.5, endurance_s=500.0)
        start, end = (0.0, 0.0, 50.0), (30.0, 40.0, 70.0)
        assert windy.leg(start, end, 5.0) == pytest.approx(3.0 * CALM.leg(start, end, 5.0))
        assert windy.home(end) == pytest.approx(3.0 * CALM.home(end))


class TestHome:
    def test_it_climbs_first_flies_straight_and_lands_from_there(self) -> None:
        climb, path, landing = 10.0 * 1.6, (10.0 + 3.2) * 1.25, 40.0 + 15.0
        assert CALM.home((80.0, 0.0, 40.0)) == per_mille(climb + path + landing)

    def test_higher_than_the_go_home_height_it_stays_there(self) -> None:
        assert CALM.home((0.0, 80.0, 90.0)) == per_mille((10.0 + 3.2) * 1.25 + 60.0 + 15.0)

    def test_above_home_only_the_landing_is_left(self) -> None:
        assert CALM.home((0.0, 0.0, 60.0)) == CALM.landing(60.0) == per_mille(40.0 + 15.0)

    def test_lower_than_home_the_landing_is_the_touchdown(self) -> None:
        assert CALM.landing(-20.0) == per_mille(15.0)

    @given(points, points)
    def test_between_two_points_home_is_never_dearer_than_from_the_dearer_end(
        self, a: Point, b: Point
    ) -> None:
        """Why asking at the ends of legs is enough: the path flown and the route home are
        convex."""
        flown = CALM.leg(a, b, 8.0, stops=False)
        dearest = max(CALM.home(a), flown + CALM.home(b))
        for share in (0.1, 0.5, 0.9):
            between = tuple(x + share * (y - x) for x, y in zip(a, b, strict=True))
            here: Point = (between[0], between[1], between[2])
            stop = CALM.fraction(8.0 / 2.5 * 1.25)  # a route home of no length does not brake
            assert share * flown + CALM.home(here) <= dearest + stop + 1e-9


class TestPath:
    def test_the_dearest_point_of_all_counts(self) -> None:
        """Out and back: at the far end home is farthest, and the path back is no saving."""
        out, far = (0.0, 0.0, 60.0), (400.0, 0.0, 60.0)
        need = path_need(CALM, [out, far, out], 10.0)
        leg, back = CALM.leg(out, far, 10.0), CALM.home(far)
        assert need == Need(leg, back, 1)
        assert need.whole == leg + back

    def test_a_longer_way_on_near_home_is_dearer_in_the_end(self) -> None:
        path = [(0.0, 0.0, 60.0), (50.0, 0.0, 60.0)] * 10
        assert path_need(CALM, path, 10.0).at == 19

    def test_staying_is_dearest_where_it_is(self) -> None:
        here = (300.0, 0.0, 60.0)
        assert path_need(CALM, [here], 5.0) == Need(0.0, CALM.home(here), 0)
        assert path_need(CALM, [here, (0.0, 0.0, 60.0)], 15.0).at == 0

    def test_of_equals_the_first_counts(self) -> None:
        here = (300.0, 0.0, 60.0)
        assert path_need(CALM, [here, here], 5.0).at == 0

    @given(st.lists(points, min_size=2, max_size=8), st.floats(1.0, 15.0))
    def test_nothing_flown_on_top_makes_it_cheaper(self, path: list[Point], speed: float) -> None:
        wholes = [path_need(CALM, path[:count], speed).whole for count in range(1, len(path) + 1)]
        assert wholes == sorted(wholes)


class TestMission:
    def need(self, *, curved: bool = False, **changes: object) -> Need:
        body = mission(waypoint(100.0, speed_mps=10.0), waypoint(200.0, **changes), curved=curved)
        at = mission_points(vehicle(), body.mission)
        assert at is not None
        return mission_need(CALM, at, body.mission)

    def test_the_way_to_the_first_waypoint_and_each_leg_at_its_own_speed(self) -> None:
        need = self.need()
        legs = (10.0 + 4.0) * 1.25 + (10.0 + 4.0) * 1.25
        assert need.at == 2
        assert need.flown == pytest.approx(legs / 1_000.0, rel=1e-4)
        assert need.back == pytest.approx(CALM.home((200.0, 0.0, 40.0)), rel=1e-4)

    def test_the_last_waypoints_speed_is_of_no_leg(self) -> None:
        speeds_mps = (10.0, 5.0, 2.0)
        waypoints = (waypoint(100.0 * n, speed_mps=v) for n, v in enumerate(speeds_mps, start=1))
        body = mission(*waypoints, curved=True)
        at: list[Point] = [(100.0 * number, 0.0, 40.0) for number in range(4)]
        need = mission_need(CALM, at, body.mission)
        assert need.flown == per_mille((10.0 + 10.0 + 20.0) * 1.25)

    @pytest.mark.parametrize("count", [2, 4])
    def test_points_of_another_mission_are_an_error(self, count: int) -> None:
        body = mission(waypoint(100.0), waypoint(200.0))
        at: list[Point] = [(100.0 * number, 0.0, 40.0) for number in range(count)]
        with pytest.raises(ValueError, match="zip"):
            mission_need(CALM, at, body.mission)

    def test_a_curved_one_does_not_stop(self) -> None:
        saved = self.need().flown - self.need(curved=True).flown
        assert saved == pytest.approx(2 * 4.0 * 1.25 / 1_000.0, rel=1e-4)

    def test_actions_take_time_at_their_waypoint(self) -> None:
        extra = self.need(loiter_s=20.0).flown - self.need().flown
        assert extra == pytest.approx(20.0 / 1_000.0)
        extra = self.need(gimbal_pitch_deg=-90.0).flown - self.need().flown
        assert extra == pytest.approx(3.0 / 1_000.0)

    def test_waypoints_lie_around_home(self) -> None:
        at = mission_points(vehicle(), mission(waypoint(0.0), waypoint(70.0)).mission)
        assert at is not None
        assert at[0] == (0.0, 0.0, 40.0)
        assert at[1] == (0.0, 0.0, 40.0)
        assert at[2] == pytest.approx((70.0, 0.0, 40.0), abs=0.05)

    @pytest.mark.parametrize(
        "changes",
        [
            {"position": Stamped()},
            {"height_above_takeoff_m": Stamped()},
            {"takeoff_point": None},
        ],
    )
    def test_an_unknown_place_or_home_leaves_it_unknown(self, changes: dict[str, object]) -> None:
        state = vehicle(**changes)  # type: ignore[arg-type]
        assert place_of(state) is None
        assert mission_points(state, mission().mission) is None
        assert fraction_to_get_home(state, OPEN_AIRSPACE, SETTINGS) is None


class TestVehicle:
    def test_endurance_and_go_home_height_come_from_the_profile(self) -> None:
        profile = replace(TAKEOFF, endurance_s=900.0, go_home_height_m=45.0)
        uses = consumption(vehicle(profile), OPEN_AIRSPACE, SETTINGS)
        assert uses == Consumption(900.0, 1.0, 45.0, SETTINGS)

    @pytest.mark.parametrize("profile", [None, replace(TAKEOFF, endurance_s=None)])
    def test_without_endurance_it_is_unknown(self, profile: object) -> None:
        state = replace(vehicle(), profile=profile)  # type: ignore[arg-type]
        assert consumption(state, OPEN_AIRSPACE, SETTINGS) is None
        assert fraction_to_get_home(state, OPEN_AIRSPACE, SETTINGS) is None

    def test_an_unknown_go_home_height_is_the_highest_allowed(self) -> None:
        airspace = PreparedAirspace(Airspace(FlightLimits(max_height_above_ground_m=99.0)))
        state = vehicle(replace(TAKEOFF, go_home_height_m=None))
        uses = consumption(state, airspace, SETTINGS)
        assert uses is not None
        assert uses.go_home_height_m == 99.0
        here = place_of(state)
        assert here is not None
        assert fraction_to_get_home(state, airspace, SETTINGS) == uses.home(here)

    @pytest.mark.parametrize(
        ("level", "load"), [(0, 1.0), (1, 1.2), (2, 1.5), (3, 1.5), (127, 1.5), (None, 1.2)]
    )
    def test_the_aircrafts_wind_warning_is_its_load(self, level: int | None, load: float) -> None:
        uses = consumption(vehicle(wind_level=level), OPEN_AIRSPACE, SETTINGS)
        assert uses is not None
        assert uses.wind_load == load

    def test_the_route_home_from_where_it_is(self) -> None:
        away = replace(PLACE, latitude_deg=PLACE.latitude_deg + 0.001, longitude_deg=-93.601)
        state = vehicle(position=away)
        here = place_of(state)
        assert here is not None
        assert hypot(*here[:2]) == pytest.approx(138.5, abs=0.5)
        uses = consumption(state, OPEN_AIRSPACE, SETTINGS)
        assert uses is not None
        assert fraction_to_get_home(state, OPEN_AIRSPACE, SETTINGS) == uses.home(here)
        assert 0.05 < uses.home(here) < 0.15


def test_the_pages_example_is_what_the_model_computes() -> None:
    """docs/energy-model.md counts a goto of 300 m by hand."""
    uses = Consumption(1_500.0, 1.0, 60.0, EnergySettings())
    need = path_need(uses, [(0.0, 0.0, 40.0), (300.0, 0.0, 40.0)], 5.0)
    assert 1_500.0 * need.flown == pytest.approx(77.5)
    assert 1_500.0 * need.back == pytest.approx(16.0 + 50.9 + 55.0, abs=0.05)
    assert need.whole == pytest.approx(0.133, abs=0.0005)


def test_level_flight_leaves_climb_landing_and_reserve() -> None:
    uses = Consumption(1500.0, 1.0, 60.0, SETTINGS)
    # 20 m up to the go-home height: 16 loaded seconds; the landing from there: 55.
    left_s = (1.0 - 0.25) * 1500.0 - 16.0 - 55.0
    assert uses.level_flight_s(1.0, 40.0, 0.25) == pytest.approx(left_s / 1.25)
    # Above the go-home height the landing begins where the vehicle is.
    left_s = (1.0 - 0.25) * 1500.0 - 90.0 / 1.5 - 15.0
    assert uses.level_flight_s(1.0, 90.0, 0.25) == pytest.approx(left_s / 1.25)
    assert uses.level_flight_s(0.2, 40.0, 0.25) == 0.0
