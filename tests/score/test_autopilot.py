"""What flight controllers make of orders, worked out ahead: by hand, and what must always hold."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.score.autopilot import Autopilot, Point
from recon.score.flight import Hop, whereabouts
from recon.sim.world import Wind, WindSettings

metres = st.floats(-400.0, 400.0)
spots = st.tuples(metres, metres, st.floats(20.0, 100.0))
points = st.builds(Point, spots, st.floats(1.0, 12.0), st.floats(0.0, 5.0), st.floats(0.5, 20.0))
winds = st.builds(
    Wind,
    st.builds(
        WindSettings, speed_10m_mps=st.floats(0.0, 12.0), heading_deg=st.floats(-180.0, 180.0)
    ),
)


def assert_joined(hops: list[Hop]) -> None:
    """Each begins where and when the one before has ended, and moves no faster than it can."""
    for one, other in pairwise(hops):
        assert other.start_s == one.end_s
        assert other.start_m == pytest.approx(one.end_m)
    at_s = np.linspace(hops[0].start_s, hops[-1].end_s, 2_000)
    places_m, _in_air = whereabouts(hops, at_s)
    gone_m = np.abs(np.diff(places_m, axis=0))
    step_s = at_s[1] - at_s[0]
    assert (np.hypot(gone_m[:, 0], gone_m[:, 1]) <= 15.0 * step_s + 1e-6).all()
    assert (gone_m[:, 2] <= 3.2 * step_s + 1e-6).all()
    assert np.isfinite(places_m).all()


@given(st.lists(points, min_size=2, max_size=6), winds, st.booleans(), st.booleans())
def test_a_flight_is_one_way_from_start_to_landing(
    mission: list[Point], wind: Wind, flies: bool, goes_home: bool
) -> None:
    autopilot = Autopilot(10.0, (0.0, 0.0, 50.0 if flies else 0.0), wind)
    if not flies:
        autopilot.take_off()
    autopilot.fly(mission)
    if goes_home:
        autopilot.go_home((5.0, -5.0), 40.0)
    else:
        autopilot.land()
    assert_joined(autopilot.hops)
    last = autopilot.hops[-1]
    assert last.lands
    assert last.end_m[2] == 0.0
    if goes_home:
        assert last.end_m[:2] == pytest.approx((5.0, -5.0), abs=0.51)
    reached = [hop.waypoint for hop in autopilot.hops if hop.waypoint is not None]
    assert reached == list(range(len(mission)))


def test_a_flight_past_rounded_corners_ends_at_the_last_waypoint() -> None:
    corners = [
        Point((x, y, 40.0), 6.0, corner_radius_m=8.0) for x, y in ((0, 0), (90, 0), (90, 60))
    ]
    autopilot = Autopilot(0.0, (0.0, 0.0, 40.0))
    autopilot.fly_curved(corners)
    assert autopilot.hops[-1].end_m == pytest.approx((90.0, 60.0, 40.0))
    assert autopilot.hops[-1].waypoint == 2
    places_m, _in_air = whereabouts(autopilot.hops, np.linspace(0.0, autopilot.now_s, 500))
    # The corner is cut: a quadratic curve passes it at a quarter of the cut's diagonal.
    nearest_m = np.hypot(*(places_m[:, :2] - (90.0, 0.0)).T).min()
    assert nearest_m == pytest.approx(8.0 * np.sqrt(2.0) / 4.0, abs=0.3)


def test_a_landing_by_hand() -> None:
    """From 36 m: 30 m at 3 m/s (0.75 s lost in speeding up); 1.1 s and 2.1 m until it sinks with
    0.8 m/s, 2.9 m so, then slower and slower from 0.7 m above the stop; a second there; down."""
    autopilot = Autopilot(0.0, (0.0, 0.0, 36.0))
    autopilot.land()
    fast, slow = autopilot.hops
    assert fast.end_s == pytest.approx((30.0 + 2.25) / 3.0)
    by_hand_s = 1.1 + 2.91 / 0.8 + np.log(0.8 / 0.15) + 1.0 + (0.35 / 0.8 + 0.2)
    assert slow.end_s - slow.start_s == pytest.approx(by_hand_s, abs=0.2)


def test_a_rise_is_pushed_downwind() -> None:
    wind = Wind(WindSettings(speed_10m_mps=6.0, heading_deg=90.0))
    still, windy = (Autopilot(0.0, (0.0, 0.0, 0.0), each) for each in (None, wind))
    for each in (still, windy):
        each.take_off()
        each.fly([Point((0.0, 0.0, 60.0), 5.0)])
    assert [hop.end_m[0] for hop in still.hops[:3]] == [0.0, 0.0, 0.0]
    assert 0.3 < windy.hops[2].end_m[0] < 2.0
    assert windy.now_s > still.now_s


def test_against_the_wind_it_gets_ahead_slowly() -> None:
    wind = Wind(WindSettings(speed_10m_mps=8.0, heading_deg=270.0, veer_deg_per_100m=0.0))
    wind_mps = -wind.mean_mps(50.0)[0]
    ends_s = []
    for east_m in (400.0, -400.0):
        autopilot = Autopilot(0.0, (0.0, 0.0, 50.0), wind)
        autopilot.fly([Point((east_m, 0.0, 50.0), 14.0)])
        ends_s.append(autopilot.now_s)
    assert ends_s[0] > 400.0 / (17.0 - wind_mps)
    assert ends_s[1] < 400.0 / 14.0 + 10.0
