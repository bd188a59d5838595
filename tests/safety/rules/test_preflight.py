"""Missions are flown by vehicles whose checklist is passed, or overridden with a reason."""

from dataclasses import replace

import pytest
from tests.safety.cases import MOVES, command, mission, situation, vehicle, waypoint

from recon.model.command import Body, FlyMission, Hover
from recon.model.geo import LatLon
from recon.model.vehicle import VehicleState
from recon.safety import OPEN_AIRSPACE, Override, Situation
from recon.safety.rules.preflight import preflight
from recon.safety.situation import NO_FACTS

TOWARDS_HOME = FlyMission(replace(mission(waypoint(50.0), waypoint(0.0)).mission, land_at_end=True))
OVERRIDE = Override("Ann", "the fence comes tomorrow", 5)


def reason(
    body: Body, state: VehicleState | None = None, now: Situation | None = None
) -> str | None:
    answer = preflight(command(body), replace(now or situation(), vehicle=state or vehicle()))
    assert answer is None or answer.rule == "preflight"
    return None if answer is None else answer.reason


UNFENCED = replace(situation(), airspace=OPEN_AIRSPACE)
"""One point of the list fails."""


def test_a_vehicle_whose_list_is_passed_flies() -> None:
    assert reason(mission()) is None


def test_a_failed_list_names_the_point_and_what_to_do() -> None:
    assert reason(mission(), now=UNFENCED) == (
        "A: preflight checklist not passed: Fence: no boundary is loaded (name one in "
        "site.toml under [layers]). Resolve these points, or override the checklist with a reason"
    )


def test_all_points_are_listed_at_once() -> None:
    both = replace(UNFENCED, facts=NO_FACTS)
    refusal_text = reason(mission(), now=both)
    assert refusal_text is not None
    assert (
        "Fence: no boundary is loaded (name one in site.toml under [layers]); Clock: "
        in refusal_text
    )


def test_a_point_that_only_wants_attention_holds_nothing_back() -> None:
    assert reason(mission(), vehicle(battery_fraction=0.4, wind_level=2)) is None


def test_somebodys_word_lets_it_fly() -> None:
    assert reason(mission(), now=replace(UNFENCED, preflight_override=OVERRIDE)) is None


@pytest.mark.parametrize(
    "body",
    [Hover(), *MOVES[1:]],
)
def test_the_list_is_for_missions(body: Body) -> None:
    assert reason(body, now=UNFENCED) is None


def test_coming_home_needs_no_list() -> None:
    out = vehicle(position=LatLon(waypoint(60.0).latitude_deg, -93.6))
    assert reason(TOWARDS_HOME, out, UNFENCED) is None
    assert reason(mission(waypoint(50.0), waypoint(0.0)), out, UNFENCED) is not None


def test_a_missing_vehicle_is_another_rules_matter() -> None:
    assert preflight(command(mission()), replace(UNFENCED, vehicle=None)) is None
