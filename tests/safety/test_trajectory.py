"""Rows of a trajectory: where its vehicle is at a moment, and the pieces it is compared in."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.safety.traffic import SETTINGS
from tests.safety.trajectories import NEED, trajectories, writer_at

from recon.safety.prediction import FOREVER_S, FlightPart, Trajectory, part_text
from recon.safety.prediction.predicted_trajectories import trajectory_bounds
from recon.safety.prediction.protected_volumes import MOST_PIECES, cut
from recon.safety.prediction.trajectory import Samples, TrajectoryWriter, sample


@pytest.mark.parametrize(
    ("part", "words"),
    [
        (0, "on its way to the first waypoint"),
        (1, "between waypoints 1 and 2"),
        (FlightPart.HOVERING, "while it hovers"),
    ],
)
def test_legs_are_named_by_their_waypoints(part: int, words: str) -> None:
    assert part_text(part) == words


def test_a_trajectory_begins_now_and_is_as_uncertain_in_height_as_its_drift() -> None:
    writer = TrajectoryWriter(0.0, 0.0, 36.0, 44.0)
    writer.moves(10.0, 0.0, 5.0, 0, band_m=(50.0, 60.0))
    assert writer.trajectory("A").rows[0, 0] == 0.0
    drifted = writer.trajectory("A", 2.0)
    assert drifted.here_m == (34.0, 46.0)
    assert drifted.rows[0, 6:10].tolist() == [34.0, 46.0, 48.0, 62.0]


class TestSample:
    def test_before_and_after_it_a_vehicle_is_at_its_ends(self) -> None:
        writer = writer_at(1.0, 2.0)
        writer.moves(11.0, 22.0, 10.0, 0)
        found = sample([writer.rows], [-5.0, 0.0, 5.0, 10.0, 99.0])
        assert found.east_m[0].tolist() == [1.0, 1.0, 6.0, 11.0, 11.0]
        assert found.north_m[0].tolist() == [2.0, 2.0, 12.0, 22.0, 22.0]

    def test_where_two_rows_meet_the_later_one_holds(self) -> None:
        writer = writer_at(0.0)
        writer.waits(10.0, 0)
        writer.widens(30.0, 60.0)
        writer.waits(10.0, 0)
        found = sample([writer.rows], [9.9, 10.0])
        assert found.low_m[0].tolist() == [40.0, 30.0]
        assert found.high_m[0].tolist() == [40.0, 60.0]

    @settings(max_examples=examples(100))
    @given(
        st.lists(trajectories(), min_size=2, max_size=4),
        st.lists(st.floats(-5.0, 100.0), min_size=1, max_size=5),
    )
    def test_among_others_each_is_where_it_is_alone(
        self, flown: list[Trajectory], times_s: list[float]
    ) -> None:
        together = sample([trajectory.rows for trajectory in flown], times_s)
        for index, trajectory in enumerate(flown):
            alone = sample([trajectory.rows], times_s)
            for name in Samples.__slots__:
                assert getattr(together, name)[index].tolist() == getattr(alone, name)[0].tolist()


class TestPieces:
    @settings(max_examples=examples(100))
    @given(trajectories())
    def test_they_cover_the_trajectory_without_gaps(self, flown: Trajectory) -> None:
        pieces = cut([flown], SETTINGS)
        assert pieces.at_s[0] == flown.rows[0, 0]
        assert pieces.at_s[1:] == pytest.approx(pieces.until_s[:-1])
        assert pieces.until_s[-1] == pytest.approx(flown.rows[-1, 1])
        enters, leaves = (sample([flown.rows], at_s) for at_s in (pieces.at_s, pieces.until_s))
        for ends_m, there in ((pieces.starts_m, enters), (pieces.ends_m, leaves)):
            assert ends_m[:, 0] == pytest.approx(there.east_m[0], abs=1e-6)
            assert ends_m[:, 1] == pytest.approx(there.north_m[0], abs=1e-6)
        for found, pick, name in (
            (pieces.low_m, np.minimum, "low_m"),
            (pieces.high_m, np.maximum, "high_m"),
            (pieces.radius_m, np.maximum, "radius_m"),
        ):
            expected = pick(getattr(enters, name)[0], getattr(leaves, name)[0])
            assert found == pytest.approx(expected, abs=1e-6)

    @pytest.mark.parametrize(
        ("at_s", "early_s", "late_s"),
        [(-2.0, -2.5, -1.5), (0.0, -0.5, 0.5), (2.0, 0.3, 3.7), (10.0, 6.0, 14.0)],
    )
    def test_now_is_known_to_half_a_second_and_times_ahead_less(
        self, at_s: float, early_s: float, late_s: float
    ) -> None:
        """A tenth of the time ahead, and up to 3 s."""
        writer = writer_at(0.0)
        writer.time_s = at_s - 1.0
        writer.waits(1.0, 0)
        writer.waits(1.0, 0)
        pieces = cut([writer.trajectory("A")], SETTINGS)
        assert pieces.late_s[0] == pytest.approx(late_s)
        assert pieces.early_s[1] == pytest.approx(early_s)

    @pytest.mark.parametrize(
        ("write", "count"),
        [
            (lambda writer: writer.moves(100.0, 0.0, 30.0, 0), 10),
            (lambda writer: writer.moves(0.0, 100.0, 30.0, 0), 10),
            (lambda writer: writer.moves(0.0, 0.0, 30.0, 0, band_m=(30.0, 40.0)), 10),
            (lambda writer: writer.moves(0.0, 0.0, 30.0, 0, band_m=(40.0, 50.0)), 10),
            (lambda writer: writer.grows(100.0, 30.0, 0), 10),
            (lambda writer: writer.moves(100.0, 0.0, 36_000.0, 0), MOST_PIECES),
            (lambda writer: writer.waits(30.0, 0), 1),
            (lambda writer: writer.moves(100.0, 0.0, 30.0, FlightPart.HAZARD), 1),
            (lambda writer: writer.moves(100.0, 0.0, 0.0, 0), 1),
        ],
    )
    def test_what_moves_is_cut_every_3_s_and_no_finer_than_needed(
        self, write: Callable[[TrajectoryWriter], None], count: int
    ) -> None:
        writer = writer_at(0.0)
        write(writer)
        assert len(cut([writer.trajectory("A")], SETTINGS).at_s) == count


class TestBounds:
    def flown(self) -> Trajectory:
        writer = writer_at(100.0, 50.0)
        writer.moves(130.0, 90.0, 10.0, 0, band_m=(30.0, 60.0), radius_m=5.0)
        return writer.trajectory("A")

    def test_they_hold_its_ends_their_discs_and_the_minima_around(self) -> None:
        bounds = trajectory_bounds(self.flown(), NEED, SETTINGS)
        assert (bounds.east_m, bounds.north_m) == (100.0, 50.0)
        assert bounds.radius_m == 50.0 + 5.0 + 15.0
        assert (bounds.low_m, bounds.high_m) == (30.0 - 8.0, 60.0 + 8.0)

    @pytest.mark.parametrize("delay_s", [0.0, 8.0])
    def test_traffic_is_of_interest_that_may_come_early_while_it_may_be_late(
        self, delay_s: float
    ) -> None:
        """It may end 4 s late and after its delay; others may come 10 % and 3 s early."""
        flown = replace(self.flown(), delay_s=delay_s)
        until_s = trajectory_bounds(flown, NEED, SETTINGS).until_s
        assert 0.9 * until_s - 3.0 == pytest.approx(14.0 + delay_s)
        assert until_s < FOREVER_S
