"""NaN and infinity never leave the station."""

from dataclasses import replace
from math import inf, nan

import numpy as np
import pytest
from tests.safety.cases import STICK, command, mission, refused_by, situation, waypoint

from recon.model.command import Body, Refusal, StartCamera
from recon.safety import approve
from recon.safety.rules.finite_numbers import finite_numbers

BAD = [nan, inf, -inf, np.float32("nan"), np.float64("inf"), 10**400]
MISSION_FIELDS = [
    "latitude_deg",
    "longitude_deg",
    "height_above_takeoff_m",
    "speed_mps",
    "corner_radius_m",
    "loiter_s",
    "gimbal_pitch_deg",
]
STICK_FIELDS = [
    "yaw_deg",
    "velocity_x_mps",
    "velocity_y_mps",
    "height_above_takeoff_m",
    "timeout_s",
]


def rule(body: Body) -> str:
    return refused_by(approve(command(body), situation()))


@pytest.mark.parametrize("value", BAD)
@pytest.mark.parametrize("name", MISSION_FIELDS)
def test_in_any_field_of_a_waypoint(name: str, value: float) -> None:
    assert rule(mission(waypoint(0.0), waypoint(50.0, **{name: value}))) == "finite_numbers"


@pytest.mark.parametrize("value", BAD)
@pytest.mark.parametrize("name", STICK_FIELDS)
def test_in_any_field_of_a_stick_command(name: str, value: float) -> None:
    assert rule(replace(STICK, **{name: value})) == "finite_numbers"


@pytest.mark.parametrize("value", BAD)
def test_in_a_frame_rate(value: float) -> None:
    assert rule(StartCamera(value)) == "finite_numbers"


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        (
            mission(waypoint(0.0), waypoint(50.0, speed_mps=nan)),
            "mission waypoints 2 speed_mps must be a finite number; got nan",
        ),
        (replace(STICK, yaw_deg=-inf), "yaw_deg must be a finite number; got -inf"),
        (StartCamera(10**400), f"fps_hz must be a finite number; got {10**400}"),
    ],
)
def test_a_refusal_states_where_it_is(body: Body, reason: str) -> None:
    assert finite_numbers(command(body), situation()) == Refusal("finite_numbers", reason)


@pytest.mark.parametrize("body", [mission(), STICK, StartCamera(1.0)])
def test_finite_ones_pass(body: Body) -> None:
    assert finite_numbers(command(body), situation()) is None
