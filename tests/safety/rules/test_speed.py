"""The site's speed limit, as the wire's numbers have it."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.safety.cases import command, waypoint
from tests.safety.fenced import WIDE, airspace, asked, goto, here, reason, stick

from recon.model.command import Body, FlyMission, HoldPosition, Hover, Nudge
from recon.model.mission import Mission
from recon.safety import PreparedAirspace, SafetySettings
from recon.safety.rules.speed import speed


def limited(max_mps: float) -> PreparedAirspace:
    return airspace(limits=replace(WIDE, max_speed_mps=max_mps))


SLOW = limited(8.1)


def flown_at(*speeds_mps: float) -> Body:
    points = (waypoint(20.0 * n, speed_mps=speed) for n, speed in enumerate(speeds_mps))
    return FlyMission(Mission(tuple(points)))


@pytest.mark.parametrize(
    ("body", "what", "value"),
    [
        (flown_at(8.1, 8.11, 3.0), "Speed at waypoint 2", "8.11"),
        (goto(1.0, 1.0, speed_mps=8.2), "Speed", "8.20"),
        (Nudge(1.0, 0.0, 0.0, 9.0), "Speed", "9.00"),
        (stick(6.0, -6.0), "Horizontal stick speed", "8.49"),
        (flown_at(1e300, 1.0), "Speed at waypoint 1", "inf"),
        (goto(1.0, 1.0, speed_mps=float("nan")), "Speed", "nan"),
    ],
)
def test_too_fast(body: Body, what: str, value: str) -> None:
    assert reason(asked(speed, body, SLOW)) == f"{what} must be at most 8.1 m/s; got {value} m/s"


@pytest.mark.parametrize(
    "body",
    [
        flown_at(8.1, 8.1),
        goto(1.0, 1.0, speed_mps=8.1),
        Nudge(1.0, 0.0, 0.0, 8.1),
        stick(0.0, -8.1),
        stick(5.7, 5.7),
        Hover(),
        HoldPosition(),
    ],
)
def test_not_too_fast(body: Body) -> None:
    assert asked(speed, body, SLOW) is None


def test_the_limit_and_what_rounding_may_add() -> None:
    fences = replace(SafetySettings().fences, speed_rounding_mps=0.0)
    now = replace(here(limited(8.0)), settings=SafetySettings(fences=fences))
    assert speed(command(flown_at(8.0, 1.0)), now) is None
    assert speed(command(flown_at(8.000001, 1.0)), now) is not None


@given(max_mps=st.floats(1.0, 15.0), share=st.floats(0.0, 1.0))
def test_the_limit_itself_is_allowed_whatever_the_wire_makes_of_it(
    max_mps: float, share: float
) -> None:
    north_mps = share * max_mps
    east_mps = float((max_mps**2 - north_mps**2) ** 0.5)
    for body in (flown_at(max_mps, 1.0), stick(north_mps, east_mps)):
        assert asked(speed, body, limited(max_mps)) is None
    assert asked(speed, flown_at(max_mps + 1e-4, 1.0), limited(max_mps)) is not None
