"""How far from home anything may be flown."""

from dataclasses import replace

import numpy as np
import pytest
from tests.safety.cases import command
from tests.safety.fenced import (
    WIDE,
    airspace,
    asked,
    flier,
    goto,
    here,
    mission,
    place,
    reason,
    stick,
)

from recon.model.command import Body, HoldPosition, Hover
from recon.model.units import Stamped
from recon.model.vehicle import VehicleState
from recon.safety import OPEN_AIRSPACE
from recon.safety.path.pieces import PathVolume
from recon.safety.path.volumes import path_volume
from recon.safety.rules.home_distance import home_distance

NEAR = airspace(limits=replace(WIDE, max_distance_from_home_m=300.0))


def is_allowed(body: Body, state: VehicleState | None = None) -> bool:
    return asked(home_distance, body, NEAR, state) is None


def refusal_text(body: Body, state: VehicleState | None = None) -> str:
    return reason(asked(home_distance, body, NEAR, state))


@pytest.mark.parametrize(("east_m", "allowed"), [(239.9, True), (240.1, False)])
def test_every_waypoint_counts(east_m: float, allowed: bool) -> None:
    body = mission((0.0, 0.0, 400.0), (east_m, 180.0, 40.0), (0.0, 0.0, 40.0))
    assert is_allowed(body) is allowed
    assert allowed or refusal_text(body) == (
        "A: leg 1 to 2 must stay within 300 m of home; got 300.1 m"
    )


@pytest.mark.parametrize(("beyond_m", "allowed"), [(0.0, True), (5e-7, False), (1e-3, False)])
def test_the_limit_itself_is_allowed_and_nothing_beyond(beyond_m: float, allowed: bool) -> None:
    body = mission((250.0, 0.0, 40.0), (0.0, 0.0, 40.0))
    path = path_volume(command(body), here(NEAR))
    assert isinstance(path, PathVolume)
    offsets_m = path.pieces.triangles_m - path.home_m[:2]
    exact_m = float(np.linalg.norm(offsets_m, axis=-1).max())
    limited = airspace(limits=replace(WIDE, max_distance_from_home_m=exact_m - beyond_m))
    assert (asked(home_distance, body, limited) is None) is allowed


def test_home_is_where_it_took_off() -> None:
    body = mission((290.0, 0.0, 40.0), (290.0, 50.0, 40.0))
    assert is_allowed(body)
    assert not is_allowed(body, flier(takeoff_point=place(-50.0, 0.0)))


def test_the_first_way_is_judged() -> None:
    body = mission((310.0, 0.0, 40.0), (290.0, 50.0, 40.0))
    assert (
        refusal_text(body) == "A: the leg to waypoint 1 must stay within 300 m of home; got 310.0 m"
    )


@pytest.mark.parametrize(("north_m", "allowed"), [(296.9, True), (297.1, False)])
def test_a_goto_with_what_it_may_pass_its_target_by(north_m: float, allowed: bool) -> None:
    assert is_allowed(goto(0.0, north_m)) is allowed


@pytest.mark.parametrize(("speed_mps", "allowed"), [(9.9, True), (10.1, False)])
def test_a_stick_with_its_braking(speed_mps: float, allowed: bool) -> None:
    assert is_allowed(stick(0.0, speed_mps), flier(270.0, 0.0)) is allowed


class TestAlreadyTooFar:
    far = flier(400.0, 0.0)

    def test_it_may_come_nearer(self) -> None:
        assert is_allowed(stick(0.0, -5.0), self.far)
        assert is_allowed(goto(100.0, 0.0), self.far)
        assert is_allowed(mission((100.0, 0.0, 40.0), (0.0, 0.0, 40.0)), self.far)
        assert is_allowed(HoldPosition(), self.far)

    def test_it_counts_from_home_not_from_the_sites_origin(self) -> None:
        state = flier(400.0, 0.0, takeoff_point=place(-100.0, 0.0))
        assert is_allowed(stick(0.0, -5.0), state)
        assert is_allowed(stick(0.5, 0.0), flier(-400.0, 0.0, takeoff_point=place(300.0, 0.0)))
        assert not is_allowed(stick(0.0, -1.0), flier(-400.0, 0.0, takeoff_point=place(300.0, 0.0)))

    def test_no_farther_and_nothing_later(self) -> None:
        assert "got 401.2 m" in refusal_text(stick(0.0, 1.0), self.far)
        assert "leg 1 to 2 must stay within 300 m of home; got 350.0 m" in refusal_text(
            mission((350.0, 0.0, 40.0), (0.0, 0.0, 40.0)), self.far
        )


def test_without_a_site_the_default_limit_holds() -> None:
    body = mission((990.0, 0.0, 40.0), (900.0, 50.0, 40.0))
    assert asked(home_distance, body, OPEN_AIRSPACE) is None
    body = mission((1_010.0, 0.0, 40.0), (900.0, 50.0, 40.0))
    assert "within 1000 m of home" in reason(asked(home_distance, body, OPEN_AIRSPACE))


def test_an_unknown_home_refuses_every_motion() -> None:
    lost = flier(takeoff_point=None)
    for body in (mission((9.0, 0.0, 40.0), (0.0, 0.0, 40.0)), goto(1.0, 1.0), stick(1.0, 0.0)):
        assert "home unknown" in refusal_text(body, lost)


def test_stops_are_not_asked() -> None:
    lost = flier(takeoff_point=None)
    for state in (lost, flier(900.0, 0.0), flier(position=Stamped())):
        assert is_allowed(Hover(), state)
        assert is_allowed(stick(0.0, 0.0), state)
