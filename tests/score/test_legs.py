"""Legs worked out at once, against the same flown in small steps by the simulator's airframe."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.score.legs import Pace, leg
from recon.sim.flight.kinematics import (
    BRAKING_MPS2,
    AircraftMotion,
    Limits,
    VelocityDemand,
    braking_speed_mps,
    step,
)
from recon.sim.flight.mission import ARRIVED_BELOW_MPS, ARRIVED_WITHIN_M

STEP_S = 0.02
lengths = st.floats(0.01, 2_000.0)
speeds = st.floats(0.5, 15.0)


def flown_s(length_m: float, speed_mps: float) -> float:
    """How long the airframe takes northwards, steered as missions are."""
    motion, time_s, limits = AircraftMotion(height_m=30.0), 0.0, Limits()

    def left_m() -> float:
        return length_m - motion.north_m

    while left_m() > ARRIVED_WITHIN_M or motion.ground_speed_mps > ARRIVED_BELOW_MPS:
        wanted_mps = min(speed_mps, braking_speed_mps(left_m(), BRAKING_MPS2))
        motion = step(motion, VelocityDemand(velocity_north_mps=wanted_mps), STEP_S, limits)
        time_s += STEP_S
        assert time_s < 1_000.0
    return time_s


@pytest.mark.parametrize(
    ("length_m", "speed_mps"), [(20.0, 8.0), (100.0, 8.0), (400.0, 8.0), (60.0, 14.0), (300.0, 3.0)]
)
def test_a_leg_takes_as_long_as_the_airframe_within_3_percent(
    length_m: float, speed_mps: float
) -> None:
    found = leg(length_m, Pace(speed_mps))
    assert found.duration_s == pytest.approx(flown_s(length_m, speed_mps), rel=0.03)


def test_a_long_leg_by_hand() -> None:
    found = leg(100.0, Pace(10.0, left_m=0.5))
    # 4 s and 20 m to 10 m/s; 4 s and 24 m down to 2 m/s; the last 2 m; 54 m lie between.
    assert (found.up_s, found.cruise_s, found.brake_s) == pytest.approx((4.0, 5.4, 4.0))
    assert found.settle_s == pytest.approx(np.log(4.0))
    assert found.along_m(np.array([4.0, 9.4, 13.4])) == pytest.approx([20.0, 74.0, 98.0])
    assert found.along_m(np.array([20.0])) == pytest.approx([99.5])
    assert found.end_mps == pytest.approx(0.5)


def test_a_leg_that_is_left_before_it_is_braked() -> None:
    """A climb from 1 m/s: 1 m/s2 up to 3 m/s in 4 m, 8 m, then by 0.5 m/s2 to 1 m/s in 8 m."""
    found = leg(21.25, Pace(3.0, 1.0, left_m=1.25, braking_mps2=0.5, start_mps=1.0))
    assert (found.up_s, found.brake_s, found.settle_s) == pytest.approx((2.0, 4.0, 0.0))
    assert found.cruise_s == pytest.approx(8.0 / 3.0)
    assert (found.way_m, found.end_mps) == pytest.approx((20.0, 1.0))


@given(lengths, speeds, st.floats(0.1, 3.0), st.floats(0.3, 4.0), st.floats(0.5, 3.0))
def test_the_way_only_grows_keeps_the_speed_and_ends_at_the_end(
    length_m: float, speed_mps: float, left_m: float, up_mps2: float, down_mps2: float
) -> None:
    found = leg(length_m, Pace(speed_mps, up_mps2, left_m, down_mps2))
    at_s = np.linspace(-1.0, found.duration_s + 1.0, 400)
    along_m = found.along_m(at_s)
    assert along_m[0] == 0.0
    assert along_m[-1] == pytest.approx(max(length_m - left_m, 0.0))
    assert (np.diff(along_m) >= -1e-9).all()
    gone_m = np.diff(along_m)
    assert (gone_m <= speed_mps * (at_s[1] - at_s[0]) + 1e-6).all()
    assert 0.0 <= found.end_mps <= speed_mps * (1.0 + 1e-9)


@given(lengths, lengths, speeds)
def test_a_longer_leg_takes_longer(first_m: float, second_m: float, speed_mps: float) -> None:
    short_m, long_m = sorted((first_m, second_m))
    short, long = (leg(length_m, Pace(speed_mps)) for length_m in (short_m, long_m))
    assert long.duration_s >= short.duration_s - 1e-9
    assert long.top_mps <= speed_mps + 1e-9
