"""Whose turn it is: what a flight still has before it, and how far apart its pieces are."""

from math import hypot

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.guidance.returning_scenes import KEPT, SETTINGS

from recon.guidance.fleet_return import (
    Hovering,
    Pad,
    Place,
    ReturnFlight,
    Separation,
    claim_left,
    hindrance,
    layer_is_taken_by,
    least_time_s,
    whole_claim,
)
from recon.guidance.fleet_return.flight import are_apart, column, distance_m, level_legs, point
from recon.guidance.fleet_return.turn import places_left

COORDINATES = st.integers(-50, 50).map(float)
PLACES = st.tuples(COORDINATES, COORDINATES)
SAMPLES = np.linspace(0.0, 1.0, 101)[:, np.newaxis]


def flight(
    name: str = "A",
    start: Place = (0.0, 200.0, 60.0),
    pad: tuple[float, float] = (0.0, 0.0),
    layer_m: float = 20.0,
) -> ReturnFlight:
    path = (start[:2], pad)
    return ReturnFlight(name, name, start, 0.0, Pad(f"pad {name}", *pad, 0.0), layer_m, path, 1)


class TestDistance:
    @given(PLACES, PLACES, PLACES, PLACES)
    def test_agrees_with_dense_sampling(
        self,
        a: tuple[float, float],
        b: tuple[float, float],
        c: tuple[float, float],
        d: tuple[float, float],
    ) -> None:
        ones = np.array(a) + SAMPLES * np.subtract(b, a)
        others = np.array(c) + SAMPLES * np.subtract(d, c)
        sampled_m = np.hypot(*(ones[:, np.newaxis] - others[np.newaxis]).T).min()
        step_m = 0.01 * (hypot(*np.subtract(b, a)) + hypot(*np.subtract(d, c)))
        assert distance_m(a, b, c, d) <= sampled_m + 1e-9
        assert sampled_m <= distance_m(a, b, c, d) + step_m

    def test_apart_means_beside_or_above(self) -> None:
        need = Separation(15.0, 6.0)
        leg = level_legs([(0.0, 0.0), (100.0, 0.0)], 20.0)
        assert are_apart(leg, [point((50.0, 15.0, 20.0))], need)
        assert are_apart(leg, [point((50.0, 0.0, 26.0))], need)
        assert not are_apart(leg, [point((50.0, 14.9, 25.9))], need)
        assert are_apart(leg, [column((50.0, 0.0), 26.0, 90.0)], need)
        assert not are_apart(leg, [column((50.0, 0.0), 0.0, 90.0)], need)


class TestPlacesLeft:
    def reaches(self, place_m: Place, probe_m: Place) -> bool:
        """Whether a flight at a place may still come to another one."""
        left = places_left(flight(), place_m, SETTINGS)
        return not are_apart(left, [point(probe_m)], Separation(1.0, 1.0))

    def test_before_it_has_sunk_all_of_it(self) -> None:
        assert self.reaches((0.0, 200.0, 60.0), (0.0, 200.0, 60.0))
        assert self.reaches((0.0, 200.0, 40.0), (0.0, 200.0, 55.0))
        assert self.reaches((0.0, 200.0, 40.0), (0.0, 100.0, 20.0))

    def test_on_its_way_only_what_is_ahead(self) -> None:
        assert not self.reaches((0.0, 120.0, 20.5), (0.0, 130.0, 20.0))
        assert not self.reaches((0.0, 120.0, 20.5), (0.0, 200.0, 60.0))
        assert self.reaches((0.0, 120.0, 20.5), (0.0, 60.0, 20.0))
        assert self.reaches((0.0, 120.0, 20.5), (0.0, 0.0, 5.0))

    def test_while_it_lands_only_what_is_below(self) -> None:
        assert not self.reaches((0.0, 0.5, 12.0), (0.0, 0.0, 20.0))
        assert self.reaches((0.0, 0.5, 12.0), (0.0, 0.0, 6.0))

    def test_where_it_should_not_be_everything(self) -> None:
        assert self.reaches((30.0, 120.0, 20.0), (0.0, 190.0, 20.0))
        assert self.reaches((30.0, 120.0, 20.0), (30.0, 120.0, 20.0))
        assert self.reaches((0.0, 120.0, 33.0), (0.0, 200.0, 50.0))

    def test_of_one_that_began_over_its_pad_everything_until_it_is_down(self) -> None:
        """It may be climbing or landing: both look alike."""
        over = flight(start=(0.0, 1.0, 5.0))
        left = places_left(over, (0.0, 0.5, 12.0), SETTINGS)
        assert not are_apart(left, [point((0.0, 0.0, 20.0))], Separation(1.0, 1.0))


class TestLayer:
    def test_it_is_taken_until_its_vehicle_has_landed(self) -> None:
        far = flight("B", (500.0, 200.0, 60.0), (500.0, 0.0))
        assert layer_is_taken_by(far, [], [flight()]) == "A is still in its layer"
        assert layer_is_taken_by(far, [], [flight(layer_m=28.0)]) is None

    def test_an_earlier_turn_has_it_first(self) -> None:
        far = flight("B", (500.0, 200.0, 60.0), (500.0, 0.0))
        assert layer_is_taken_by(far, [flight()], []) == "A has its layer first"


def test_the_least_time_is_that_of_the_way_and_both_columns() -> None:
    """40 m down, 200 m level, 20 m down: at 8 m/s level and 5 m/s upright."""
    assert least_time_s(flight(), SETTINGS) == pytest.approx(40.0 / 5.0 + 200.0 / 8.0 + 20.0 / 5.0)


class TestHindrance:
    def test_a_crossing_below_waits_until_the_other_has_passed(self) -> None:
        """B would sink through the path of A, which is below and not yet past."""
        under = flight("A", (-100.0, 100.0, 20.0), (100.0, 100.0), 20.0)
        upper = flight("B", (0.0, 200.0, 60.0), (0.0, 100.0), 28.0)
        before = claim_left(under, (-50.0, 100.0, 20.0), SETTINGS)
        past = claim_left(under, (60.0, 100.0, 20.0), SETTINGS)
        assert hindrance(upper, [], [before], [], KEPT) == "A has not yet passed"
        assert hindrance(upper, [], [past], [], KEPT) is None

    def test_who_hovers_in_the_way_is_named(self) -> None:
        hovering = [Hovering("c", "C", (10.0, 100.0, 22.0))]
        assert hindrance(flight(), [], [], hovering, KEPT) == "C hovers too near to its path"

    def test_an_earlier_turn_that_would_be_hindered_goes_first(self) -> None:
        crossing = whole_claim(flight("B", (-100.0, 100.0, 20.0), (100.0, 100.0), 20.0))
        beside = whole_claim(flight("C", (400.0, 200.0, 60.0), (400.0, 0.0), 28.0))
        assert hindrance(flight(), [crossing], [], [], KEPT) == "B goes first"
        assert hindrance(flight(), [beside], [], [], KEPT) is None
