"""Every rule that judges a number gives the value and its limit as parameters of its refusal."""

from dataclasses import replace
from numbers import Real

import pytest
from tests.safety.cases import AIRSPACE, NOW, STICK, WGS84, S, command, situation, vehicle
from tests.safety.fenced import (
    WIDE,
    airspace,
    flier,
    goto,
    height_zone,
    here,
    keep_out_zone,
    mission,
    square,
)

from recon.model.command import Body, Command, GoTo, Hover, Nudge, Refusal, StartCamera
from recon.model.geo import LatLon
from recon.model.stamped import Stamped
from recon.safety import Situation, Traffic
from recon.safety.rules import RULES
from recon.safety.rules.dji_limits import dji_limits

FAR = mission((0.0, 50.0, 40.0), (300.0, 50.0, 40.0))
FLAT = airspace(limits=WIDE)
LIMITED = airspace(limits=replace(WIDE, max_distance_from_home_m=100.0, max_speed_mps=4.0))
LOW = airspace(limits=replace(WIDE, min_height_above_ground_m=45.0))
HIGH = airspace(limits=replace(WIDE, max_height_above_ground_m=30.0))
FENCED = airspace(boundary=square(-100.0, -100.0, 100.0, 100.0))
YARD = square(100.0, 0.0, 200.0, 100.0)


def among(other_east_m: float) -> Situation:
    other = replace(flier(other_east_m, 50.0), serial="B", link_id=2)
    return replace(here(FLAT), traffic=(Traffic(other),))


def late(command: Command) -> Command:
    return replace(command, expires_at_ns=NOW - S)


CASES: dict[str, tuple[Command, Situation, set[str], set[str]]] = {
    "not_expired": (late(command(FAR)), here(FLAT), {"late_s"}, {"max_s"}),
    "dji_limits": (
        command(GoTo(LatLon(42.0, -93.6), -1.0, 5.0)),
        here(FLAT),
        {"height_above_takeoff_m"},
        {"min_m", "max_m"},
    ),
    "altitude_reference": (
        command(FAR),
        situation(vehicle(WGS84, offset_m=257.0)),
        {"jump_m"},
        {"max_m"},
    ),
    "flying": (command(Hover()), situation(vehicle(age_s=3.5)), {"age_s"}, {"max_s"}),
    "link_age": (
        command(FAR),
        situation(vehicle(core_received_at_ns=NOW - 2 * S)),
        {"age_s"},
        {"max_s"},
    ),
    "gnss": (
        command(FAR),
        situation(vehicle(gnss_satellite_count=Stamped(7, NOW))),
        {"satellite_count"},
        {"min_count"},
    ),
    "battery": (
        command(FAR),
        situation(vehicle(battery_fraction=Stamped(0.1, NOW))),
        {"battery_fraction"},
        {"min_fraction", "reserve_fraction"},
    ),
    "speed": (command(goto(1.0, 1.0)), here(LIMITED), {"speed_mps"}, {"max_mps"}),
    "home_distance": (command(FAR), here(LIMITED), {"distance_from_home_m"}, {"max_m"}),
    "boundary": (command(FAR), here(FENCED), {"distance_inside_m"}, {"min_m"}),
    "keep_out": (
        command(FAR),
        here(airspace(keep_out_zone(YARD))),
        {"gap_m", "zone"},
        {"min_m", "min_vertical_m"},
    ),
    "height_zones": (
        command(FAR),
        here(airspace(height_zone(YARD, floor_m=50.0, ceiling_m=60.0))),
        {"lowest_above_takeoff_m", "highest_above_takeoff_m", "zone"},
        {"min_m", "max_m"},
    ),
    "min_height": (command(FAR), here(LOW), {"height_above_ground_m"}, {"min_m"}),
    "max_height": (command(FAR), here(HIGH), {"height_above_ground_m"}, {"max_m"}),
    "separation": (
        command(FAR),
        among(150.0),
        {"other", "time_s", "horizontal_m", "vertical_m"},
        {"min_horizontal_m", "min_vertical_m"},
    ),
}

NO_NUMBERS = {
    "known_order": "a type",
    "reachable": "a link",
    "identified": "a serial",
    "finite_numbers": "a value that is no number",
    "authority": "a holder",
    "preflight": "a checklist",
}
"""What the other rules judge."""


def test_every_rule_is_listed() -> None:
    assert {rule.__name__ for rule in RULES} == set(CASES) | set(NO_NUMBERS)


@pytest.mark.parametrize("name", CASES)
def test_a_refusal_has_the_value_and_its_limit(name: str) -> None:
    order, now, values, limits = CASES[name]
    rule = next(rule for rule in RULES if rule.__name__ == name)
    refusal = rule(order, now)
    assert refusal is not None
    assert set(refusal.parameters) == values | limits
    for parameter in (values | limits) - {"zone", "other"}:
        assert isinstance(refusal.parameters[parameter], Real), parameter


def test_the_value_breaks_its_limit() -> None:
    order, now, _, _ = CASES["dji_limits"]
    refusal = dji_limits(order, now)
    assert refusal == Refusal("dji_limits", "Height must be 0 to 500 m above takeoff; got -1 m")
    assert refusal.parameters == {"height_above_takeoff_m": -1.0, "min_m": 0.0, "max_m": 500.0}


@pytest.mark.parametrize(
    ("body", "parameters"),
    [
        (
            mission((0.0, 50.0, 40.0), (50.0, 50.0, 501.0)),
            {"waypoint": 2, "height_above_takeoff_m": 501.0, "min_m": -200.0, "max_m": 500.0},
        ),
        (StartCamera(31.0), {"frame_rate_hz": 31.0, "min_hz": 0.0, "max_hz": 30.0}),
        (Nudge(0.0, 101.0, 0.0), {"east_m": 101.0, "min_m": -100.0, "max_m": 100.0}),
        (
            replace(STICK, velocity_x_mps=16.0),
            {"velocity_x_mps": 16.0, "min_mps": -15.0, "max_mps": 15.0},
        ),
        (replace(STICK, timeout_s=6.0), {"timeout_s": 6.0, "min_s": 0.0, "max_s": 5.0}),
        (
            mission((0.0, 50.0, 40.0)),
            {"waypoint_count": 1, "min_count": 2, "max_count": 99},
        ),
    ],
)
def test_dji_limits_name_the_value_with_its_unit(body: Body, parameters: object) -> None:
    refusal = dji_limits(command(body), here(AIRSPACE))
    assert refusal is not None
    assert refusal.parameters == parameters


def test_a_later_sentence_keeps_the_parameters_apart() -> None:
    """Equality of refusals is of rule and sentence; parameters are for programs."""
    assert Refusal("a", "b", parameters={"c_m": 1.0}) == Refusal("a", "b")
