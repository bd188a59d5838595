"""The airframe keeps its limits, whatever is asked of it."""

from math import hypot

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.model.units import wrap_degrees
from recon.sim.flight.kinematics import (
    AircraftMotion,
    Limits,
    VelocityDemand,
    braking_speed_mps,
    hold_height_mps,
    step,
)

LIMITS = Limits()
SECONDS = 0.05

speeds = st.floats(-100.0, 100.0)
demands = st.builds(VelocityDemand, speeds, speeds, speeds, st.none() | st.floats(-720.0, 720.0))


@given(st.lists(demands, min_size=1, max_size=60), st.integers(1, 20))
def test_no_limit_is_exceeded_whatever_is_demanded(
    orders: list[VelocityDemand], repeats: int
) -> None:
    motion = AircraftMotion()
    for demand in orders:
        for _ in range(repeats):
            after = step(motion, demand, SECONDS, LIMITS)
            assert_within_limits(motion, after)
            motion = after


def assert_within_limits(before: AircraftMotion, after: AircraftMotion) -> None:
    assert after.ground_speed_mps <= LIMITS.speed_mps + 1e-9
    assert -LIMITS.descent_mps - 1e-9 <= after.velocity_up_mps <= LIMITS.climb_mps + 1e-9
    acceleration = hypot(
        after.velocity_north_mps - before.velocity_north_mps,
        after.velocity_east_mps - before.velocity_east_mps,
    )
    assert acceleration <= LIMITS.acceleration_mps2 * SECONDS + 1e-9
    upward = abs(after.velocity_up_mps - before.velocity_up_mps)
    assert upward <= LIMITS.vertical_acceleration_mps2 * SECONDS + 1e-9
    turn = abs(wrap_degrees(after.yaw_deg - before.yaw_deg))
    assert turn <= LIMITS.yaw_rate_dps * SECONDS + 1e-9
    assert -180.0 <= after.yaw_deg <= 180.0
    assert max(abs(after.pitch_deg), abs(after.roll_deg)) < 35.0


@pytest.mark.parametrize(("start_m", "target_m"), [(0.0, 120.0), (120.0, 5.0), (30.0, 30.5)])
def test_height_is_reached_without_overshoot(start_m: float, target_m: float) -> None:
    motion, heights = AircraftMotion(height_m=start_m), []
    for _ in range(2000):
        up = hold_height_mps(motion.height_m, target_m, LIMITS)
        motion = step(motion, VelocityDemand(velocity_up_mps=up), SECONDS, LIMITS)
        heights.append(motion.height_m)
    assert heights[-1] == pytest.approx(target_m, abs=0.02)
    assert max(heights) < max(start_m, target_m) + 0.3
    assert min(heights) > min(start_m, target_m) - 0.3


def test_a_stop_is_possible_from_the_braking_speed() -> None:
    for distance_m in (0.5, 3.0, 20.0, 200.0):
        speed = braking_speed_mps(distance_m, 1.2)
        assert speed * speed / (2.0 * 1.2) <= distance_m + 0.01


def test_accelerating_forward_noses_down_and_rightward_rolls_right() -> None:
    north = step(AircraftMotion(), VelocityDemand(velocity_north_mps=10.0), SECONDS, LIMITS)
    east = step(AircraftMotion(), VelocityDemand(velocity_east_mps=10.0), SECONDS, LIMITS)
    assert north.pitch_deg < 0.0
    assert north.roll_deg == pytest.approx(0.0)
    assert east.roll_deg > 0.0
    assert east.pitch_deg == pytest.approx(0.0)


def test_the_shorter_way_round_is_turned() -> None:
    motion = step(AircraftMotion(yaw_deg=170.0), VelocityDemand(yaw_deg=-170.0), SECONDS, LIMITS)
    assert motion.yaw_deg == pytest.approx(173.0)
