"""What is unknown refuses motion, and never a stop."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.safety.cases import STICK, TAKEOFF, command, mission, situation, vehicle

from recon.model.command import Body, GoTo, HoldPosition, Hover, LandNow, Nudge, Refusal, ReturnHome
from recon.model.geo import LatLon
from recon.model.units import Stamped
from recon.safety import ApprovedCommand, approve, judge
from recon.safety.checks import checklist

UNKNOWN: dict[str, object] = {
    "position": Stamped(),
    "height_above_takeoff_m": Stamped(),
    "battery_fraction": Stamped(),
    "battery_warning": Stamped(),
    "gnss_satellite_count": Stamped(),
    "gnss_signal_level": Stamped(),
    "flight_mode": Stamped(),
    "is_flying": Stamped(),
    "core_received_at_ns": None,
    "extended_received_at_ns": None,
    "takeoff_point": None,
    "profile": None,
}
UNSET: dict[str, object] = {"endurance_s": None, "go_home_height_m": None, "failsafe": None}
AWAY: list[Body] = [
    mission(),
    GoTo(LatLon(42.001, -93.6), 40.0, 5.0),
    Nudge(20.0, 0.0, 0.0),
    STICK,
]
STOPS: list[Body] = [Hover(), LandNow(), ReturnHome()]


@pytest.mark.parametrize("name", UNKNOWN)
@pytest.mark.parametrize("body", AWAY)
def test_one_unknown_is_enough_to_refuse_what_leads_away(body: Body, name: str) -> None:
    state = replace(vehicle(), **{name: UNKNOWN[name]})  # type: ignore[arg-type]
    assert judge(command(body), situation(vehicle())) is None
    assert isinstance(judge(command(body), situation(state)), Refusal)


@pytest.mark.parametrize("name", UNSET)
def test_an_unset_value_refuses_missions(name: str) -> None:
    profile = replace(TAKEOFF, **{name: UNSET[name]})  # type: ignore[arg-type]
    assert isinstance(judge(command(mission()), situation(vehicle(profile))), Refusal)


ON_GROUND = [name for name in UNKNOWN if name not in ("takeoff_point", "height_above_takeoff_m")]
"""On the ground home is where it stands; whether the height is known, is asked of sticks alone."""


@pytest.mark.parametrize("name", ON_GROUND)
@pytest.mark.parametrize("body", [mission(), STICK, Hover()])
def test_one_unknown_is_enough_to_refuse_a_takeoff(body: Body, name: str) -> None:
    ready = vehicle(flying=False)
    state = replace(ready, **{name: UNKNOWN[name]})  # type: ignore[arg-type]
    assert judge(command(body, takeoff=True), situation(ready)) is None
    assert isinstance(judge(command(body, takeoff=True), situation(state)), Refusal)


@pytest.mark.parametrize("name", UNSET)
@pytest.mark.parametrize("body", [STICK, Hover()])
def test_an_unset_value_refuses_takeoffs(body: Body, name: str) -> None:
    profile = replace(TAKEOFF, **{name: UNSET[name]})  # type: ignore[arg-type]
    grounded = situation(vehicle(profile, flying=False))
    assert isinstance(judge(command(body, takeoff=True), grounded), Refusal)


@given(st.sets(st.sampled_from(sorted(UNKNOWN))), st.sampled_from([*AWAY, HoldPosition()]))
def test_any_unknowns_are_a_refusal_and_no_error(names: set[str], body: Body) -> None:
    lost = {name: UNKNOWN[name] for name in names}
    now = situation(replace(vehicle(), **lost))  # type: ignore[arg-type]
    assert now.vehicle is not None
    assert (judge(command(body), now) is None) or names
    assert {check.key for check in checklist(now.vehicle, now)} >= {"battery", "home"}


@given(st.sets(st.sampled_from(sorted(UNKNOWN)).filter(lambda name: name != "is_flying")))
def test_a_stop_asks_for_nothing_but_that_it_flies(names: set[str]) -> None:
    lost = {name: UNKNOWN[name] for name in names}
    now = situation(replace(vehicle(), **lost))  # type: ignore[arg-type]
    for body in STOPS:
        assert isinstance(approve(command(body), now), ApprovedCommand)
