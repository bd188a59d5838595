"""Where two trajectories come too near to each other in space and time."""

from dataclasses import replace
from itertools import product
from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.safety.traffic import SETTINGS
from tests.safety.trajectories import NEED, standing, trajectories, writer_at

from recon.model.arrays import FloatArray
from recon.safety.prediction import Conflict, FlightPart, Trajectory, first_conflict
from recon.safety.prediction.conflicts import segments_apart_m
from recon.safety.prediction.trajectory import TrajectoryWriter
from recon.safety.prediction_settings import PredictionSettings

OTHER = standing(0.0)


def conflict(
    own: Trajectory, *others: Trajectory, prediction: PredictionSettings = SETTINGS
) -> Conflict | None:
    """The first conflict of one that may not be led apart from those too near already."""
    return first_conflict(own, others, NEED, prediction, may_lead_apart=False)


def led_apart(own: TrajectoryWriter, other: Trajectory = OTHER) -> bool:
    """Whether an order may lead `own` along this way, though another is too near already."""
    return first_conflict(own.trajectory("A"), [other], NEED, SETTINGS) is None


def present(from_s: float, seconds: float) -> Trajectory:
    """One that stands at one place for a while; before and after it is nowhere."""
    writer = writer_at(0.0)
    writer.time_s = from_s
    writer.waits(seconds, 0)
    return writer.trajectory("SIM-1")


@pytest.mark.parametrize(
    ("east_m", "north_m", "up_m", "is_too_near"),
    [
        (14.99, 0.0, 40.0, True),
        (15.0, 0.0, 40.0, False),
        (8.99, 12.0, 40.0, True),
        (9.0, 12.0, 40.0, False),
        (0.0, 0.0, 47.99, True),
        (0.0, 0.0, 48.0, False),
        (0.0, 0.0, 32.01, True),
        (0.0, 0.0, 32.0, False),
    ],
)
def test_15_m_or_8_m_in_height_are_enough(
    east_m: float, north_m: float, up_m: float, is_too_near: bool
) -> None:
    assert (conflict(standing(east_m, up_m, north_m), OTHER) is not None) is is_too_near


class TestTime:
    @pytest.mark.parametrize(("later_s", "meets"), [(15.9, True), (16.0, True), (16.1, False)])
    def test_at_the_last_moment_of_one_the_other_may_have_come(
        self, later_s: float, meets: bool
    ) -> None:
        """One leaves at 10 s or 3 s later, the other comes at 16 s or 3 s earlier."""
        sure = replace(SETTINGS, time_uncertainty=0.0)
        early, late = present(0.0, 10.0), present(later_s, 10.0)
        assert (conflict(early, late, prediction=sure) is not None) is meets
        assert (conflict(late, early, prediction=sure) is not None) is meets

    @pytest.mark.parametrize(("from_s", "meets"), [(0.0, False), (35.0, True), (80.0, False)])
    @pytest.mark.parametrize("index", [0, 1, 2])
    def test_each_of_many_others_is_met_in_its_own_time(
        self, index: int, from_s: float, meets: bool
    ) -> None:
        others = [standing(500.0), standing(600.0)]
        others.insert(index, present(from_s, 10.0))
        found = conflict(present(30.0, 10.0), *others)
        assert (found is not None) is meets
        assert found is None or found.other == index

    @settings(max_examples=examples(100))
    @given(trajectories(), st.lists(trajectories(), min_size=2, max_size=4))
    def test_others_do_not_hide_each_other(self, own: Trajectory, others: list[Trajectory]) -> None:
        found = [conflict(own, other) for other in others]
        together = conflict(own, *others)
        assert (together is None) is all(one is None for one in found)
        if together is not None:
            assert together.at_s == min(one.at_s for one in found if one is not None)


class TestReport:
    def test_it_names_the_first_vehicle_met_not_the_nearest(self) -> None:
        own = writer_at(0.0)
        own.moves(0.0, 400.0, 80.0, 1)
        found = conflict(own.trajectory("A"), standing(2.0, north_m=300.0), standing(10.0))
        assert found is not None
        assert (found.other, found.own_part, found.at_s) == (1, 1, 0.0)
        assert found.horizontal_m == pytest.approx(10.0)

    @pytest.mark.parametrize("swapped", [False, True])
    def test_it_names_the_first_part_of_the_way_of_either(self, swapped: bool) -> None:
        """First 10 m apart and at one height, then 2 m and 6 m, of another part of its path."""
        comes = writer_at(10.0)
        comes.waits(5.0, 3)
        comes.moves(10.0, 0.0, 1.0, 4, band_m=(46.0, 46.0))
        comes.moves(2.0, 0.0, 20.0, 4)
        path = comes.trajectory("A")
        found = conflict(OTHER, path) if swapped else conflict(path, OTHER)
        assert found is not None
        assert (found.other_part if swapped else found.own_part) == 3
        assert (found.horizontal_m, found.vertical_m) == (10.0, 0.0)

    def test_what_is_within_a_disc_is_0_m_away_and_what_is_over_is_now(self) -> None:
        own = writer_at(1.0)
        own.time_s, own.radius_m = -2.0, 5.0
        own.waits(10.0, 0)
        found = conflict(own.trajectory("A"), OTHER)
        assert found is not None
        assert (found.at_s, found.horizontal_m, found.vertical_m) == (0.0, 0.0, 0.0)


class TestLeadingApart:
    @pytest.mark.parametrize(("to_m", "passes"), [(9.5, True), (9.4, False)])
    def test_half_a_metre_nearer_may_be_noise(self, to_m: float, passes: bool) -> None:
        beside, below = writer_at(10.0), writer_at(2.0)
        beside.moves(to_m, 0.0, 10.0, 0)
        below.moves(2.0, 0.0, 10.0, 0, band_m=(50.0 - to_m, 50.0 - to_m))
        assert led_apart(beside) is passes
        assert led_apart(below, standing(0.0, 45.0)) is passes

    def test_one_at_the_minima_is_not_too_near_and_may_not_come_nearer(self) -> None:
        own = writer_at(15.0)
        own.moves(14.9, 0.0, 10.0, 0)
        assert not led_apart(own)
        over = writer_at(0.0, up_m=48.0)
        over.moves(0.0, 0.0, 10.0, 0, band_m=(47.9, 47.9))
        assert not led_apart(over)

    @pytest.mark.parametrize(
        ("waits_s", "passes"),
        [
            ((39.9,), True),
            ((40.0,), False),
            ((50.0,), False),
            ((19.9, 5.0), True),
            ((20.0, 5.0), False),
        ],
    )
    def test_it_has_20_s_and_does_not_stay_for_twice_as_long(
        self, waits_s: tuple[float, ...], passes: bool
    ) -> None:
        own = writer_at(5.0)
        for seconds in waits_s:
            own.waits(seconds, 0)
        assert led_apart(own) is passes

    def test_how_near_another_is_counts_now_not_in_a_second(self) -> None:
        coming, own = writer_at(10.0), writer_at(0.0)
        coming.moves(5.0, 0.0, 1.0, 0)
        coming.waits(10.0, 0)
        own.waits(11.0, 0)
        assert not led_apart(own, coming.trajectory("SIM-1"))

    def test_one_of_uncertain_height_is_too_near_with_any_of_it(self) -> None:
        own = writer_at(5.0)
        own.moves(25.0, 0.0, 5.0, 0)
        below = standing(0.0, 32.0)
        assert first_conflict(own.trajectory("A", 2.0), [below], NEED, SETTINGS) is None

    def test_one_may_sink_on_its_way_out_of_a_hazard_area(self) -> None:
        """It may be at any height: none is nearer to it than another."""
        hazard, own = TrajectoryWriter(0.0, 0.0, -1e5, 40.0), writer_at(10.0, up_m=45.0)
        hazard.radius_m = 50.0
        hazard.stays(FlightPart.HAZARD)
        own.moves(90.0, 0.0, 10.0, 0, band_m=(41.0, 41.0))
        assert led_apart(own, hazard.trajectory("SIM-1"))
        assert not led_apart(own, standing(0.0))


class TestSegments:
    """Known distances, anywhere in the plane and turned by any angle."""

    PLACES = tuple(product((0.0, 0.7, 2.0, 4.0), ((0.0, 0.0), (30.0, -70.0), (-200.0, 5.0))))

    def apart_m(self, *points: tuple[float, float]) -> FloatArray:
        """How far apart two segments are by their four ends, at all places, in either order."""
        found = []
        for angle, offset in self.PLACES:
            turn = np.array([[cos(angle), -sin(angle)], [sin(angle), cos(angle)]])
            p0, p1, q0, q1 = ((turn @ np.array(p) + np.array(offset))[np.newaxis] for p in points)
            found += [segments_apart_m(p0, p1, q0, q1), segments_apart_m(q0, q1, p0, p1)]
        return np.concatenate(found)

    @pytest.mark.parametrize("between", [0.1, pi / 2.0, 3.0])
    @pytest.mark.parametrize("long_m", [0.1, 40.0])
    def test_those_that_cross_are_0_m_apart(self, between: float, long_m: float) -> None:
        ahead = cos(between) * long_m, sin(between) * long_m
        back = -0.3 * ahead[0], -0.3 * ahead[1]
        assert self.apart_m((-7.0, 0.0), (20.0, 0.0), back, ahead).max() == 0.0

    @pytest.mark.parametrize("long_m", [0.1, 1.0, 40.0])
    @pytest.mark.parametrize("beside_m", [0.05, 6.0])
    @pytest.mark.parametrize("on_m", [-50.0, 0.0, 0.03, 50.0])
    def test_beside_each_other_the_nearest_end_counts(
        self, long_m: float, beside_m: float, on_m: float
    ) -> None:
        """One end is above the middle of the other segment, the other end farther off."""
        middle_m = 0.5 * long_m
        away = middle_m + on_m, beside_m + 3.0
        found = self.apart_m((0.0, 0.0), (long_m, 0.0), (middle_m, beside_m), away)
        assert found == pytest.approx(beside_m, abs=1e-9)
