"""How far bounds reach, in numbers worked out by hand, and who is near by them."""

from dataclasses import replace

import numpy as np
import pytest
from tests.safety.traffic import FRAME, ORIGIN, aircraft, at, flies, seen, waypoint
from tests.safety.watchdogs.looks import SETTINGS, Commanded, Intent
from tests.safety.watchdogs.test_fences import WALL, site, square

from recon.model.airspace import Airspace, ElevationModel
from recon.model.geo import GroundGrid
from recon.model.mission import Mission
from recon.model.vehicle import VehicleState
from recon.safety import PreparedAirspace
from recon.safety.prediction import PredictionSettings
from recon.safety.separation_minima import SeparationMinima
from recon.safety.watchdogs.reach import (
    Reach,
    near_each_other,
    near_limits,
    path_ahead_s,
    reach_of,
)

PREDICTION = SETTINGS.prediction
ROUNDING_M = 0.01
MINIMA = SeparationMinima(17.0, 7.0)
HORIZON_S = 10.0
HOVERING = Intent(Commanded.HOLD)
CLIMBING = aircraft("A", (0.0, 0.0), 40.0, (0.0, 0.0, 2.0))
LEVEL = aircraft("A", (30.0, 40.0), 40.0, (3.0, 4.0, 0.0))


def bound(
    state: VehicleState,
    intent: Intent = HOVERING,
    horizon_s: float = HORIZON_S,
    prediction: PredictionSettings = PREDICTION,
) -> Reach:
    reach = reach_of(seen(state), intent, horizon_s, prediction)
    assert reach is not None
    return reach


def band_m(reach: Reach) -> tuple[float, float]:
    return reach.low_m, reach.high_m


class TestReachOf:
    def test_it_is_at_the_vehicles_place(self) -> None:
        reach = bound(LEVEL)
        assert (reach.north_m, reach.east_m) == pytest.approx((30.0, 40.0), abs=0.01)
        assert reach.place == at(30.0, 40.0)
        assert reach.age_s == 0.0
        assert bound(replace(LEVEL, airborne_since_ns=None)).drift_m == 0.0

    def test_it_has_the_age_and_the_drift_of_what_is_known(self) -> None:
        old = aircraft("A", age_s=2.0)
        assert bound(old).age_s == 2.0
        aloft = seen(old)._replace(drift_m=0.25)
        reach = reach_of(aloft, HOVERING, HORIZON_S, PREDICTION)
        assert reach is not None
        assert reach.drift_m == 0.25

    def test_its_radius_grows_from_the_time_of_its_place(self) -> None:
        reach = Reach(ORIGIN, 0.0, 0.0, 40.0, 40.0, 8.0, 0.5, 0.25)
        assert reach.radius_m(2.0) == 8.0 * 2.5 + 0.25

    @pytest.mark.parametrize(
        ("state", "intent", "fastest_mps"),
        [
            (CLIMBING, HOVERING, 1.0),
            (LEVEL, HOVERING, 5.0),
            (LEVEL, Intent(Commanded.STICK, speed_mps=7.0), 7.0),
            (LEVEL, Intent(Commanded.STICK, speed_mps=2.0), 5.0),
            (LEVEL, Intent(Commanded.STICK), 10.0),
            (LEVEL, flies(Mission((waypoint(0.0, 0.0, speed_mps=9.0),))), 9.0),
            (LEVEL, flies(Mission((waypoint(0.0, 0.0, speed_mps=2.0),))), 5.0),
        ],
    )
    def test_it_is_as_fast_as_what_it_does_and_what_it_is_sent(
        self, state: VehicleState, intent: Intent, fastest_mps: float
    ) -> None:
        assert bound(state, intent).fastest_mps == pytest.approx(fastest_mps)

    @pytest.mark.parametrize("count", [1, 4])
    def test_each_waypoint_adds_what_too_short_legs_are_off(self, count: int) -> None:
        """Three phases of a millimetre each may not be predicted."""
        mission = Mission((waypoint(0.0, 0.0),) * count)
        assert bound(LEVEL, flies(mission)).slack_m == pytest.approx(ROUNDING_M + count * 0.003)
        assert bound(LEVEL).slack_m == pytest.approx(ROUNDING_M)

    @pytest.mark.parametrize(
        ("horizon_s", "age_s", "prediction", "lasts_s"),
        [
            (10.0, 0.0, PREDICTION, 10.0),
            (10.0, 0.5, PREDICTION, 10.5),
            (2.0, 0.0, PREDICTION, 5.0),
            (2.0, 0.0, replace(PREDICTION, stick_horizon_s=3.0), 3.0),
            (2.0, 0.5, replace(PREDICTION, reaction_s=7.0), 7.5),
        ],
    )
    def test_it_climbs_or_sinks_for_as_long_as_anything_lasts_and_then_brakes(
        self, horizon_s: float, age_s: float, prediction: PredictionSettings, lasts_s: float
    ) -> None:
        """From 3 m/s up or down with 2 m/s2: another 2.25 m."""
        change_m = 3.0 * lasts_s + 2.25 + ROUNDING_M
        for up_mps in (3.0, -3.0):
            state = aircraft("A", (0.0, 0.0), 40.0, (0.0, 0.0, up_mps), age_s=age_s)
            reach = bound(state, HOVERING, horizon_s, prediction)
            assert band_m(reach) == pytest.approx((40.0 - change_m, 40.0 + change_m))

    @pytest.mark.parametrize(
        ("intent", "low_m", "high_m"),
        [
            (HOVERING, 40.0, 40.0),
            (Intent(Commanded.STICK, target_height_above_takeoff_m=25.0), 25.0, 40.0),
            (Intent(Commanded.STICK, target_height_above_takeoff_m=55.0), 40.0, 55.0),
            (flies(Mission((waypoint(0.0, 0.0, 30.0), waypoint(9.0, 0.0, 70.0)))), 30.0, 70.0),
            (flies(Mission((waypoint(0.0, 0.0, 50.0), waypoint(9.0, 0.0, 70.0)))), 40.0, 70.0),
        ],
    )
    def test_it_spans_present_and_commanded_heights(
        self, intent: Intent, low_m: float, high_m: float
    ) -> None:
        expected = low_m - ROUNDING_M, high_m + ROUNDING_M
        assert band_m(bound(LEVEL, intent)) == pytest.approx(expected)

    @pytest.mark.parametrize(
        "intent",
        [
            Intent(Commanded.LAND),
            Intent(Commanded.RETURN),
            Intent(Commanded.MISSION),
            flies(Mission((waypoint(0.0, 0.0),), curved=True)),
            flies(Mission((waypoint(0.0, 0.0),), land_at_end=True)),
            Intent(Commanded.HOLD, mission=Mission((waypoint(0.0, 0.0),))),
        ],
    )
    def test_what_is_not_known_to_stay_in_one_has_none(self, intent: Intent) -> None:
        assert reach_of(seen(LEVEL), intent, HORIZON_S, PREDICTION) is None


def standing(
    north_m: float = 0.0, up_m: float = 40.0, *, east_m: float = 0.0, drift_m: float = 0.0
) -> Reach:
    """A bound of a radius of one metre at the horizon."""
    return Reach(ORIGIN, east_m, north_m, up_m - 1.0, up_m + 1.0, 0.1, 0.0, 0.0, drift_m)


class TestNearEachOther:
    @pytest.mark.parametrize(
        ("other", "is_near"),
        [
            (standing(18.9), True),
            (standing(19.0), False),
            (standing(-18.9), True),
            (standing(-19.0), False),
            (standing(east_m=-18.9), True),
            (standing(east_m=19.0), False),
            (standing(0.0, 48.9), True),
            (standing(0.0, 49.0), False),
            (standing(0.0, 31.1), True),
            (standing(0.0, 31.0), False),
            (standing(0.0, 49.0, drift_m=0.5), True),
            (standing(0.0, 49.5, drift_m=0.5), False),
            (standing(0.0, 31.0, drift_m=0.5), True),
            (standing(0.0, 30.5, drift_m=0.5), False),
        ],
    )
    def test_the_minima_are_kept_between_the_bounds(self, other: Reach, is_near: bool) -> None:
        """17 m between two circles of a metre; 7 m between bands of a metre up and down."""
        expected = {0, 1} if is_near else set()
        for pair in ([standing(), other], [other, standing()]):
            assert near_each_other(pair, MINIMA, HORIZON_S) == expected

    def test_each_is_compared_with_each_other(self) -> None:
        reaches = [standing(0.0), standing(100.0), standing(118.0), standing(50.0), standing(16.0)]
        assert near_each_other(reaches, MINIMA, HORIZON_S) == {0, 1, 2, 4}

    def test_a_longer_horizon_widens_them(self) -> None:
        pair = [standing(), standing(20.0)]
        assert near_each_other(pair, MINIMA, 10.0) == set()
        assert near_each_other(pair, MINIMA, 20.0) == {0, 1}

    def test_heights_that_cannot_be_compared_keep_none_apart(self) -> None:
        pair = [standing(), standing(0.0, 90.0)]
        unknown = np.array([[False, True], [True, False]])
        assert near_each_other(pair, MINIMA, HORIZON_S, unknown) == {0, 1}
        assert near_each_other(pair, MINIMA, HORIZON_S, ~unknown) == set()
        apart = [standing(), standing(30.0, 90.0)]
        assert near_each_other(apart, MINIMA, HORIZON_S, unknown) == set()

    def test_what_is_not_finite_is_near_to_all(self) -> None:
        odd = standing()._replace(east_m=float("nan"), low_m=float("nan"), high_m=float("nan"))
        assert near_each_other([odd, standing(500.0)], MINIMA, HORIZON_S) == {0, 1}

    def test_one_alone_is_near_to_nothing(self) -> None:
        assert near_each_other([standing()], MINIMA, HORIZON_S) == set()
        assert near_each_other([], MINIMA, HORIZON_S) == set()


class TestWayAhead:
    @pytest.mark.parametrize(
        ("speed_mps", "seconds"), [(0.0, 1.25), (5.0, 2.5), (10.0, 3.75), (15.0, 4.0)]
    )
    def test_it_is_a_quarter_more_than_stopping_takes_until_the_horizon(
        self, speed_mps: float, seconds: float
    ) -> None:
        settings = replace(SETTINGS.watchdogs, horizon_s=4.0)
        assert path_ahead_s(speed_mps, settings, PREDICTION) == pytest.approx(seconds)


def circle(north_m: float, east_m: float, up_m: float = 40.0, *, radius_m: float = 40.0) -> Reach:
    """A bound of this radius, at any time."""
    return Reach(at(north_m, east_m), 0.0, 0.0, up_m, up_m, 0.0, 0.0, radius_m)


def near(airspace: PreparedAirspace, *reaches: Reach) -> set[int]:
    return near_limits(reaches, airspace, FRAME, SETTINGS.watchdogs, PREDICTION)


def hill_at(north_m: float, east_m: float) -> PreparedAirspace:
    """Flat ground with a hill of 100 m, its top there and 10 m to all sides of it."""
    grid = GroundGrid(FRAME, -600.0, 600.0, 10.0, 120, 120)
    ground = np.full((120, 120), FRAME.origin.ellipsoid_height_m)
    row, col = round((600.0 - north_m) / 10.0), round((east_m + 600.0) / 10.0)
    ground[row - 1 : row + 1, col - 1 : col + 1] += 100.0
    return PreparedAirspace(Airspace(frame=FRAME, elevation=ElevationModel(grid, ground)))


class TestNearLimits:
    def test_those_whose_circle_reaches_the_boundary(self) -> None:
        inside, in_a_corner, at_the_edge = circle(0.0, 0.0), circle(430, 430), circle(0.0, 470.0)
        assert near(site(), inside, in_a_corner, at_the_edge) == {2}
        assert near(site(), at_the_edge, inside, in_a_corner) == {0}
        assert near(site(), inside, in_a_corner) == set()

    def test_one_on_the_edge_reaches_it_however_small_its_circle(self) -> None:
        airspace = PreparedAirspace(Airspace(frame=FRAME, boundary=square(0.0, 500.0, 500.0)))
        assert near(airspace, circle(0.0, 0.0, radius_m=0.0)) == {0}

    def test_those_whose_circle_reaches_a_zone(self) -> None:
        assert near(site(WALL), circle(0.0, 0.0), circle(250.0, 0.0), circle(230.0, 0.0)) == {1}

    @pytest.mark.parametrize("north_m", [-1, 0, 1])
    @pytest.mark.parametrize("east_m", [-1, 0, 1])
    def test_those_whose_circle_has_high_ground_below_it(self, north_m: int, east_m: int) -> None:
        """The hill is 30 m from one of them, in each direction; one is above all ground."""
        away_m = 20.0 if north_m and east_m else 30.0
        airspace = hill_at(200.0 + away_m * north_m, 300.0 + away_m * east_m)
        reaches = circle(200.0, 300.0, 110.0), circle(-200.0, -300.0), circle(200.0, 300.0)
        assert near(airspace, *reaches) == {2}
        assert near(airspace, *reversed(reaches)) == {0}

    @pytest.mark.parametrize(
        ("up_m", "is_near"), [(4.9, True), (5.1, False), (119.9, False), (120.1, True)]
    )
    def test_those_beyond_the_height_limits(self, up_m: float, is_near: bool) -> None:
        assert near(site(), circle(0.0, 0.0, up_m)) == ({0} if is_near else set())

    def test_what_is_within_their_way_ahead_and_one_sample_more(self) -> None:
        """At 10 m/s 3.75 s and 0.25 s: 40 m."""
        for north_m, expected in ((459.9, set()), (460.1, {0})):
            flying = circle(north_m, 0.0, radius_m=0.0)._replace(fastest_mps=10.0)
            assert near(site(), flying) == expected
