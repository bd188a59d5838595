"""Barometers drift: the longer two vehicles are in the air, the more height is kept between."""

from dataclasses import replace

import pytest
from tests.safety.traffic import AIR, NOW, SETTINGS, S, aircraft, judged, route, seen
from tests.safety.watchdogs.looks import looks, picture

from recon.model.control import Commanded, Intent
from recon.model.vehicle import Failsafe, VehicleState
from recon.safety.prediction import hazard_area_of, height_drift_m
from recon.safety.watchdogs.separation import separation

MINUTE = 60 * S


def flown(minutes: float, serial: str, place: tuple[float, float], height_m: float) -> VehicleState:
    state = aircraft(serial, place, height_m)
    return replace(state, airborne_since_ns=NOW - round(minutes * MINUTE))


def test_it_grows_with_the_time_in_the_air_and_is_none_before_takeoff() -> None:
    assert height_drift_m(aircraft(), NOW, SETTINGS) == 0.0
    assert height_drift_m(flown(30.0, "A", (0.0, 0.0), 40.0), NOW, SETTINGS) == 0.25
    ahead = height_drift_m(flown(30.0, "A", (0.0, 0.0), 40.0), NOW, SETTINGS, 1_800.0)
    assert ahead == 0.5


@pytest.mark.parametrize(("minutes", "passes"), [(0.0, True), (25.0, True), (35.0, False)])
def test_the_gate_lets_layers_of_8_m_pass_for_a_usual_flight(minutes: float, passes: bool) -> None:
    own = flown(minutes, "A", (0.0, 0.0), 48.0)
    other = flown(minutes, "B", (60.0, 0.0), 40.0)
    over = route((0.0, 0.0, 48.0), (120.0, 0.0, 48.0))
    assert (judged(over, own, other, airspace=AIR) is None) is passes


@pytest.mark.parametrize(("minutes", "count"), [(0.0, 0), (40.0, 1)])
def test_the_watchdog_keeps_more_too(minutes: float, count: int) -> None:
    above = flown(minutes, "A", (0.0, 0.0), 47.5)
    below = flown(minutes, "B", (5.0, 0.0), 40.0)
    assert len(looks(separation, above, below)) == count


def test_limits_and_zones_are_compared_with_the_height_as_reported() -> None:
    now = picture(flown(60.0, "A", (0.0, 0.0), 40.0))
    assert now.ahead.as_it_flies.high_m[0, 0] == 40.0
    assert now.ahead_apart.as_it_flies.high_m[0, 0] == 40.5
    fresh = picture(aircraft())
    assert fresh.ahead_apart is fresh.ahead


def test_a_hazard_area_is_as_uncertain() -> None:
    lost = aircraft("B", age_s=10.0, failsafe=Failsafe.HOVER)
    old = replace(lost, airborne_since_ns=NOW - 60 * MINUTE)
    areas = [hazard_area_of(seen(it), Intent(Commanded.HOLD), SETTINGS) for it in (lost, old)]
    assert areas[0] is not None
    assert areas[1] is not None
    assert areas[1].high_m == areas[0].high_m + 0.5
    assert areas[1].corridor_low_m == areas[0].corridor_low_m - 0.5
