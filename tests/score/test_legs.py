"""Legs worked out at once, against the same flown in small steps by the simulator's airframe."""

from math import hypot

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.score.legs import leg
from recon.score.settings import FLIGHT
from recon.sim.kinematics import Demand, Limits, Motion, braking_speed_mps, step

STEP_S = 0.02
lengths = st.floats(0.01, 2_000.0)
speeds = st.floats(0.5, 15.0)


def flown_s(length_m: float, speed_mps: float) -> float:
    """How long the airframe takes northwards, steered as missions are."""
    motion, time_s, limits = Motion(height_m=30.0), 0.0, Limits()
    while length_m - motion.north_m > 0.5 or motion.ground_speed_mps > FLIGHT.stopped_mps:
        left_m = length_m - motion.north_m
        wanted_mps = min(speed_mps, braking_speed_mps(left_m, FLIGHT.braking_mps2))
        motion = step(motion, Demand(velocity_north_mps=wanted_mps), STEP_S, limits)
        time_s += STEP_S
        assert time_s < 1_000.0
    return time_s


@pytest.mark.parametrize(
    ("length_m", "speed_mps"), [(20.0, 8.0), (100.0, 8.0), (400.0, 8.0), (60.0, 14.0), (300.0, 3.0)]
)
def test_a_leg_takes_as_long_as_the_airframe_within_3_percent(
    length_m: float, speed_mps: float
) -> None:
    assert leg(length_m, speed_mps, FLIGHT).duration_s == pytest.approx(
        flown_s(length_m, speed_mps), rel=0.03
    )


def test_a_long_leg_by_hand() -> None:
    found = leg(100.0, 10.0, FLIGHT)
    # 4 s and 20 m to 10 m/s; 4 s and 24 m down to 2 m/s; the last 2 m; 54 m lie between.
    assert (found.up_s, found.cruise_s, found.brake_s) == pytest.approx((4.0, 5.4, 4.0))
    assert found.along_m(np.array([4.0, 9.4, 13.4])) == pytest.approx([20.0, 74.0, 98.0])


@given(lengths, speeds)
def test_the_way_only_grows_keeps_the_speed_and_ends_at_the_end(
    length_m: float, speed_mps: float
) -> None:
    found = leg(length_m, speed_mps, FLIGHT)
    at_s = np.linspace(-1.0, found.duration_s + 1.0, 400)
    along_m = found.along_m(at_s)
    assert along_m[0] == 0.0
    assert along_m[-1] == pytest.approx(length_m)
    assert (np.diff(along_m) >= -1e-9).all()
    before = at_s < found.duration_s - 1e-9
    gone_m = np.diff(along_m[before])
    assert (gone_m <= speed_mps * (at_s[1] - at_s[0]) * (1.0 + 1e-9) + 1e-9).all()
    assert length_m - along_m[before][-1] <= 0.5 + speed_mps * (at_s[1] - at_s[0])


@given(lengths, lengths, speeds)
def test_a_longer_leg_takes_longer(first_m: float, second_m: float, speed_mps: float) -> None:
    short_m, long_m = sorted((first_m, second_m))
    short, long = (leg(length_m, speed_mps, FLIGHT) for length_m in (short_m, long_m))
    # The last half metre is left when a waypoint counts as reached, so tiny legs are all alike.
    assert long.duration_s >= short.duration_s - 0.5
    assert hypot(long.top_mps) <= speed_mps + 1e-9
