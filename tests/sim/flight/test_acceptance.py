"""What DJI's SDK would reject: one case beside each limit."""

from dataclasses import replace
from math import inf, nan

import pytest

from recon import wire
from recon.sim.flight.acceptance import SdkLimits, mission_problem, stick_problem
from recon.sim.flight.mission import MissionPoint

LIMITS = SdkLimits()
A = MissionPoint(0.0, 0.0, 30.0, 5.0)
B = MissionPoint(100.0, 0.0, 30.0, 5.0)
C = MissionPoint(100.0, 80.0, 30.0, 5.0)


def test_ordinary_missions_are_accepted() -> None:
    assert mission_problem((A, B, C), False, LIMITS) is None
    assert mission_problem((A, replace(B, corner_radius_m=20.0), C), True, LIMITS) is None


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"height_m": 500.1}, "height"),
        ({"height_m": -200.1}, "height"),
        ({"height_m": nan}, "not finite"),
        ({"north_m": inf}, "not finite"),
        ({"speed_mps": 0.0}, "speed"),
        ({"speed_mps": 15.1}, "speed"),
        ({"speed_mps": nan}, "speed"),
        ({"loiter_s": 32.8}, "stay"),
        ({"gimbal_pitch_deg": 1.0}, "gimbal"),
        ({"gimbal_pitch_deg": -91.0}, "gimbal"),
        ({"north_m": 5_001.0}, "far from home"),
        ({"north_m": 100.4, "east_m": 80.0}, "apart"),
        ({"north_m": 2_101.0, "east_m": 0.0}, "apart"),
    ],
)
def test_the_reason_of_a_rejection_is_named(change: dict, words: str) -> None:
    problem = mission_problem((A, replace(B, **change), C), False, LIMITS)
    assert problem is not None
    assert words in problem


def test_counts_lengths_and_closed_loops() -> None:
    assert "1 waypoints" in str(mission_problem((A,), False, LIMITS))
    assert "0 waypoints" in str(mission_problem((), False, LIMITS))
    many = [replace(A, north_m=float(i)) for i in range(100)]
    assert "100 waypoints" in str(mission_problem(many, False, LIMITS))
    assert mission_problem(many[:99], False, LIMITS) is None
    assert "apart" in str(mission_problem((A, B, C, A), False, LIMITS))
    to_and_fro = [replace(A, north_m=1_900.0 * (i % 2), east_m=2.0 * i) for i in range(18)]
    assert "path of" in str(mission_problem(to_and_fro, False, LIMITS))


@pytest.mark.parametrize(
    ("radii", "words"),
    [
        ((0.2, 0.1, 0.2), "corner radius"),
        ((0.2, 1_001.0, 0.2), "corner radius"),
        ((5.0, 5.0, 0.2), "at an end"),
        ((0.2, 79.9, 0.2), "longer than the leg"),
    ],
)
def test_corner_radii(radii: tuple[float, float, float], words: str) -> None:
    mission = [replace(p, corner_radius_m=r) for p, r in zip((A, B, C), radii, strict=True)]
    assert words in str(mission_problem(mission, True, LIMITS))
    assert mission_problem(mission, False, LIMITS) is None


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("velocity_x_mps", 15.5),
        ("velocity_y_mps", -15.5),
        ("yaw_deg", 181.0),
        ("height_above_takeoff_m", -1.0),
        ("height_above_takeoff_m", nan),
        ("mode", 2),
        ("timeout_s", inf),
    ],
)
def test_stick_out_of_range_is_rejected_not_clamped(field: str, value: float) -> None:
    values = {
        "mode": 0,
        "yaw_deg": 0.0,
        "velocity_x_mps": 15.0,
        "velocity_y_mps": -15.0,
        "height_above_takeoff_m": 10.0,
        "timeout_s": 1.0,
    }
    assert stick_problem(wire.VirtualStickCommand(**values), LIMITS) is None
    assert stick_problem(wire.VirtualStickCommand(**(values | {field: value})), LIMITS) is not None
