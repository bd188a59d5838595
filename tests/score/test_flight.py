"""Hops in time: where they are asked for, and when positions are told."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.score.flight import Hop, Steady, whereabouts
from recon.score.legs import Pace, leg

OUT = Hop(10.0, 20.0, (0.0, 0.0, 30.0), (50.0, 0.0, 30.0), Steady(50.0, 10.0), 1.0)
WAIT = Hop(20.0, 25.0, (50.0, 0.0, 30.0), (50.0, 0.0, 30.0), None, 1.0)
DOWN = Hop(25.0, 35.0, (50.0, 0.0, 30.0), (50.0, 0.0, 0.0), Steady(30.0, 10.0), 1.0, lands=True)


def test_a_vehicle_is_nowhere_before_its_first_hop_and_on_the_ground_after_its_last() -> None:
    at_s = np.array([5.0, 10.0, 15.0, 15.0, 22.0, 30.0, 35.0, 99.0])
    places_m, in_air = whereabouts([OUT, WAIT, DOWN], at_s)
    assert np.isnan(places_m[0]).all()
    assert places_m[1:, 0] == pytest.approx([0.0, 25.0, 25.0, 50.0, 50.0, 50.0, 50.0])
    assert places_m[1:, 2] == pytest.approx([30.0, 30.0, 30.0, 30.0, 15.0, 0.0, 0.0])
    assert in_air.tolist() == [False, True, True, True, True, True, False, False]


@given(st.floats(0.0, 600.0), st.floats(0.5, 12.0), st.floats(0.5, 5.0), st.floats(0.1, 1.0))
def test_positions_are_told_from_start_to_end_and_on_straight_lines_in_between(
    length_m: float, speed_mps: float, every_s: float, flown: float
) -> None:
    motion = leg(length_m, Pace(speed_mps))
    end_s = 7.0 + flown * motion.duration_s
    hop = Hop(7.0, end_s, (0.0, 0.0, 9.0), (motion.way_m, 0.0, 9.0), motion, 1.0)
    at_s = hop.samples_s(every_s)
    assert (at_s[0], at_s[-1]) == (7.0, max(end_s, 7.0))
    assert (np.diff(at_s) > 0.0).all()
    assert (np.diff(at_s) <= every_s + 1e-9).all()
    # Between two of them speed changes evenly at most: half-way it is off by a t^2 / 8.
    middles_s = (at_s[1:] + at_s[:-1]) / 2.0
    along_m = hop.places_m(at_s)[:, 0]
    off_m = hop.places_m(middles_s)[:, 0] - (along_m[1:] + along_m[:-1]) / 2.0
    assert (np.abs(off_m) <= 2.5 * np.diff(at_s) ** 2 / 8.0 + 1e-9).all()
