"""What an app reports of its aircraft, against the site and what is planned."""

from collections.abc import Callable
from dataclasses import replace

import pytest
from tests.safety.cases import FACTS, NOW, PLACE, TAKEOFF, S, command, mission, situation, vehicle
from tests.safety.checks.checked import ATTENTION, FAILS, OK, UNKNOWN, checked
from tests.safety.checks.test_checklist import KEYS

from recon.model.app_report import AppFacts, AppOrder
from recon.model.command import LockCamera
from recon.model.units import Stamped
from recon.model.vehicle import Failsafe, VehicleProfile, VehicleState
from recon.safety.check import Check, CheckState
from recon.safety.checks import checklist, reported, site_facts
from recon.safety.reported_facts import FRESH_FACTS_S, NO_APP_FACTS, reported_facts
from recon.safety.rules.dji_limits import dji_limits
from recon.safety.situation import PlannedFlights, Situation

HOME = AppFacts(home_latitude_deg=PLACE.latitude_deg, home_longitude_deg=PLACE.longitude_deg)
AWAY = AppFacts(home_latitude_deg=PLACE.latitude_deg + 0.003, home_longitude_deg=-93.6)
HOVERS = replace(TAKEOFF, failsafe=Failsafe.HOVER)


def reporting(facts: AppFacts, profile: VehicleProfile = TAKEOFF, **state: object) -> VehicleState:
    return replace(vehicle(profile, **state), app_facts=Stamped(facts, NOW))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("point", "state", "expected", "words"),
    [
        (
            site_facts.go_home_height,
            reporting(AppFacts(go_home_height_m=60.0)),
            OK,
            "60 m above takeoff, as the aircraft reports",
        ),
        (
            site_facts.go_home_height,
            reporting(AppFacts(go_home_height_m=40.0)),
            FAILS,
            "the aircraft reports 40 m; site.toml states 60 m",
        ),
        (
            site_facts.go_home_height,
            reporting(AppFacts(go_home_height_m=40.0), VehicleProfile("A")),
            UNKNOWN,
            "go-home height not set",
        ),
        (
            site_facts.camera_interval,
            reporting(AppFacts(photo_interval_s=3.0)),
            ATTENTION,
            "the camera's timer is set to 3 s; site.toml states 2 s",
        ),
        (
            site_facts.failsafe,
            reporting(AppFacts(failsafe="go_home")),
            OK,
            "goes home when it loses its controller, as the aircraft reports",
        ),
        (
            site_facts.failsafe,
            reporting(AppFacts(failsafe="hover")),
            FAILS,
            "the aircraft reports hover; site.toml states go_home",
        ),
        (
            site_facts.failsafe,
            reporting(AppFacts(failsafe="hover"), HOVERS),
            ATTENTION,
            "the aircraft reports hover, and not go_home",
        ),
        (
            site_facts.failsafe,
            reporting(AppFacts(failsafe="land"), VehicleProfile("A")),
            UNKNOWN,
            "failsafe for a lost controller not set",
        ),
    ],
)
def test_settings_are_compared_with_the_site(
    point: Callable[[VehicleState, Situation], Check],
    state: VehicleState,
    expected: CheckState,
    words: str,
) -> None:
    found = checked(point, state)
    assert (found.state, found.text) == (expected, words)


def test_a_reported_value_is_proposed_where_the_site_has_none() -> None:
    state = reporting(AppFacts(go_home_height_m=45.0, failsafe="land"), VehicleProfile("A"))
    assert "go_home_height_m = 45 " in checked(site_facts.go_home_height, state).to_do
    assert 'failsafe = "land"' in checked(site_facts.failsafe, state).to_do


def planned(highest_m: float | None = None, photos: int | None = None) -> dict[str, object]:
    return {"facts": replace(FACTS, planned=PlannedFlights(highest_m, photos))}


@pytest.mark.parametrize(
    ("point", "state", "now", "expected", "words"),
    [
        (reported.home_point, reporting(HOME), {}, OK, "0 m from where it takes off"),
        (reported.home_point, reporting(AWAY), {}, FAILS, "333 m from where it took off"),
        (reported.aircraft_limits, reporting(AppFacts(max_height_m=50.0)), {}, OK, "up to 50 m"),
        (
            reported.aircraft_limits,
            reporting(AppFacts(max_distance_m=900.0)),
            {},
            OK,
            "up to 900 m from home",
        ),
        (
            reported.aircraft_limits,
            reporting(AppFacts(max_height_m=50.0)),
            planned(60.0),
            FAILS,
            "maximum height is 50 m above takeoff; the survey is flown at up to 60 m",
        ),
        (reported.storage, reporting(AppFacts(storage_left_photos=90)), {}, OK, "90 photos"),
        (
            reported.storage,
            reporting(AppFacts(storage_left_photos=90)),
            planned(None, 120),
            FAILS,
            "has room for 90 photos; the survey takes about 120 more",
        ),
        (reported.dji_check, reporting(AppFacts(dji_check_passed=True)), {}, OK, "passed"),
        (
            reported.dji_check,
            reporting(AppFacts(dji_check_passed=False, dji_check="no network")),
            {},
            FAILS,
            "failed: no network",
        ),
    ],
)
def test_what_is_reported_is_a_point(
    point: Callable[[VehicleState, Situation], Check],
    state: VehicleState,
    now: dict[str, object],
    expected: CheckState,
    words: str,
) -> None:
    found = checked(point, state, **now)
    assert found.state is expected
    assert words in found.text


def test_on_the_ground_another_home_point_needs_attention_only() -> None:
    state = replace(reporting(AWAY), is_flying=Stamped(False, NOW))
    assert checked(reported.home_point, state).state is ATTENTION


def test_a_home_point_that_cannot_be_compared_needs_attention() -> None:
    state = replace(reporting(HOME), takeoff_point=None, profile=None)
    assert checked(reported.home_point, state).state is ATTENTION


def test_a_plain_app_has_the_list_it_had() -> None:
    assert [check.key for check in checklist(vehicle(), situation())] == KEYS


def test_what_is_not_reported_is_no_point() -> None:
    state = reporting(AppFacts(firmware="1"))
    assert [check.key for check in checklist(state, situation(state))] == KEYS
    full = reporting(replace(HOME, max_height_m=90.0, dji_check_passed=True))
    keys = [check.key for check in checklist(full, situation(full))]
    assert keys == [*KEYS, "home_point", "aircraft_limits", "dji_check"]


def test_old_facts_are_unknown() -> None:
    state = reporting(HOME)
    late_ns = NOW + round(FRESH_FACTS_S * S)
    assert reported_facts(state, late_ns) == HOME
    assert reported_facts(state, late_ns + 1) == NO_APP_FACTS
    assert reported_facts(None, NOW) == NO_APP_FACTS


@pytest.mark.parametrize(
    ("facts", "words"),
    [
        (AppFacts(max_height_m=39.0), "39 m above takeoff, the maximum height set in the aircraft"),
        (AppFacts(max_waypoints=1), "Mission must have 2 to 1 waypoints"),
    ],
)
def test_a_mission_beyond_the_aircrafts_own_limits_is_refused(facts: AppFacts, words: str) -> None:
    state = reporting(facts)
    refused = dji_limits(command(mission()), situation(state))
    assert refused is not None
    assert words in refused.reason


def test_only_an_app_that_takes_it_is_sent_a_lock() -> None:
    lock = command(LockCamera(True))
    plain, able = vehicle(), reporting(AppFacts(orders=(AppOrder.LOCK_CAMERA,)))
    refused = dji_limits(lock, situation(plain))
    assert refused is not None
    assert "lock them in the app" in refused.reason
    assert dji_limits(lock, situation(able)) is None


def test_a_mission_within_the_aircrafts_own_limits_is_not() -> None:
    state = reporting(AppFacts(max_height_m=40.0, max_waypoints=2))
    assert dji_limits(command(mission()), situation(state)) is None
