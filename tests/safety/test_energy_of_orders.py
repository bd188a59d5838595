"""Where each kind of order leads, and whether that is away from home."""

from dataclasses import replace

import pytest
from tests.safety.cases import mission, situation, vehicle, waypoint

from recon.model.command import (
    Body,
    GoTo,
    HoldPosition,
    Nudge,
    StickFrame,
    VirtualStick,
)
from recon.model.geo import LatLon
from recon.model.units import Stamped
from recon.model.vehicle import VehicleState
from recon.safety.energy import (
    consumption,
    leads_away,
    mission_need,
    mission_points,
    need_of,
    path_need,
    path_of,
    place_of,
)

NOW = situation()
AIRSPACE, ENERGY = NOW.airspace, NOW.settings.energy


def north(metres: float) -> LatLon:
    at = waypoint(metres)
    return LatLon(at.latitude_deg, at.longitude_deg)


OUT = vehicle(position=north(100.0))
"""100 m north of home, 40 m high."""


def goto(metres: float) -> GoTo:
    return GoTo(north(metres), 55.0, 4.0)


def stick(x: float, y: float, frame: StickFrame = StickFrame.GROUND) -> VirtualStick:
    return VirtualStick(frame, 0.0, x, y, 45.0, 2.0)


@pytest.mark.parametrize(
    ("body", "end", "speed_mps"),
    [
        (goto(150.0), (150.0, 0.0, 55.0), 4.0),
        (Nudge(10.0, -20.0, 5.0, 3.0), (110.0, -20.0, 45.0), 3.0),
        (stick(3.0, 4.0), (106.0, 8.0, 45.0), 5.0),
        (stick(-3.0, 4.0, StickFrame.BODY), (110.0, 0.0, 45.0), 5.0),
    ],
)
def test_a_way_leads_from_here_to_the_end(
    body: Body, end: tuple[float, float, float], speed_mps: float
) -> None:
    path = path_of(body, OUT, ENERGY)
    assert path is not None
    assert path[0][0] == place_of(OUT) == pytest.approx((100.0, 0.0, 40.0), abs=0.05)
    assert path[0][1] == pytest.approx(end, abs=0.05)
    assert path[1] == pytest.approx(speed_mps)


def test_a_bodys_velocity_counts_as_away_from_home_wherever_that_is() -> None:
    south_west = replace(OUT, position=Stamped(LatLon(41.9991, -93.6012), 0))
    path = path_of(stick(10.0, 0.0, StickFrame.BODY), south_west, ENERGY)
    assert path is not None
    (north_m, east_m, _), (end_north_m, end_east_m, _) = path[0]
    assert end_north_m / end_east_m == pytest.approx(north_m / east_m)
    assert end_north_m < north_m < 0.0


def test_holding_leads_nowhere() -> None:
    assert path_of(HoldPosition(), OUT, ENERGY) == ([place_of(OUT)], 0.0)


@pytest.mark.parametrize(
    ("body", "is_away"),
    [
        (goto(100.9), False),
        (goto(101.1), True),
        (goto(-100.9), False),
        (goto(-101.1), True),
        (Nudge(0.0, 14.0, 100.0), False),
        (Nudge(0.0, 15.0, 0.0), True),
        (stick(0.4, 0.0), False),
        (stick(0.6, 0.0), True),
        (stick(-5.0, 0.0), False),
        (stick(-5.0, 0.0, StickFrame.BODY), True),
        (HoldPosition(), False),
        (mission(waypoint(100.0), waypoint(0.0)), True),
        (
            replace(
                mission(), mission=replace(mission(waypoint(100.0), waypoint(0.0)).mission,
                                           land_at_end=True)
            ),
            False,
        ),
    ],
)  # fmt: skip
def test_what_ends_a_metre_farther_from_home_leads_away(body: Body, is_away: bool) -> None:
    assert leads_away(body, OUT, AIRSPACE, ENERGY) is is_away


@pytest.mark.parametrize(("speed_mps", "is_away"), [(0.5, False), (0.51, True)])
def test_as_far_as_a_place_being_held_does_not(speed_mps: float, is_away: bool) -> None:
    """Over home: the stick's 2 s lead exactly `nearer_m` away from it."""
    assert ENERGY.nearer_m == 1.0
    assert leads_away(stick(speed_mps, 0.0), vehicle(), AIRSPACE, ENERGY) is is_away


@pytest.mark.parametrize("lost", [{"position": Stamped()}, {"takeoff_point": None}])
def test_the_unknown_leads_away_and_has_no_need(
    lost: dict[str, object],
) -> None:
    state: VehicleState = replace(OUT, **lost)  # type: ignore[arg-type]
    uses = consumption(state, NOW.airspace, NOW.settings.energy)
    assert uses is not None
    for body in (goto(0.0), mission(), HoldPosition()):
        assert leads_away(body, state, AIRSPACE, ENERGY)
        assert need_of(uses, state, body) is None


def test_what_it_needs_is_that_of_its_way() -> None:
    uses = consumption(OUT, NOW.airspace, NOW.settings.energy)
    assert uses is not None
    for body in (goto(300.0), stick(3.0, 4.0)):
        path = path_of(body, OUT, ENERGY)
        assert path is not None
        assert need_of(uses, OUT, body) == path_need(uses, *path)
    points = mission_points(OUT, mission().mission)
    assert points is not None
    assert need_of(uses, OUT, mission()) == mission_need(uses, points, mission().mission)
