"""Each oracle of the closed-loop study catches a constructed breach, and is silent without one."""

from dataclasses import replace

import pytest
from tests.oracles.flown_air import (
    Breach,
    TrueGround,
    TruePlace,
    TrueSite,
    TrueZone,
    breaches,
    depth_m,
)
from tests.oracles.flown_orders import (
    PilotGuard,
    ShownAges,
    StopClock,
    TakeoffPermits,
    missing_alarm,
)

SQUARE = ((-100.0, -100.0), (100.0, -100.0), (100.0, 100.0), (-100.0, 100.0))
SMALL = ((20.0, 20.0), (60.0, 20.0), (60.0, 60.0), (20.0, 60.0))
SITE = TrueSite(SQUARE, most_distance_m=120.0)
MIDDLE = TruePlace(0.0, 0.0, 40.0)


def kinds(site: TrueSite, *places: TruePlace) -> list[str]:
    named = {f"SIM-{number}": place for number, place in enumerate(places, 1)}
    return [breach.kind for breach in breaches(site, named)]


def at(east_m: float, north_m: float, up_m: float = 40.0) -> TruePlace:
    return TruePlace(east_m, north_m, up_m)


def test_nothing_is_found_in_order() -> None:
    assert kinds(SITE, MIDDLE, at(40.0, 0.0), at(0.0, 0.0, 60.0)) == []


@pytest.mark.parametrize("away", [(14.0, 0.0, 0.0), (0.0, -10.0, 5.0), (-9.0, 9.0, -5.0)])
def test_two_too_near(away: tuple[float, float, float]) -> None:
    other = at(away[0], away[1], 40.0 + away[2])
    assert kinds(SITE, MIDDLE, other) == ["separation"]
    assert kinds(SITE, MIDDLE, replace(other, up_m=other.up_m + 12.0)) == []


def test_apart_level_or_in_height_is_apart() -> None:
    assert kinds(SITE, MIDDLE, at(15.1, 0.0)) == []
    assert kinds(SITE, MIDDLE, at(0.0, 0.0, 46.1)) == []


def test_outside_the_boundary() -> None:
    assert kinds(SITE, at(101.0, 0.0)) == ["fence"]
    assert kinds(SITE, at(99.0, 0.0)) == []


def test_too_far_from_home() -> None:
    assert kinds(SITE, replace(at(90.0, 0.0), home_m=(-40.0, 0.0))) == ["home distance"]


def test_inside_a_keep_out_zone_with_heights() -> None:
    zone = TrueZone("Z", SMALL, True, floor_m=20.0, ceiling_m=50.0)
    site = replace(SITE, zones=(zone,))
    assert kinds(site, at(40.0, 40.0)) == ["keep-out zone"]
    assert kinds(site, at(40.0, 40.0, 51.0)) == []
    assert kinds(site, at(40.0, 40.0, 19.0)) == []
    assert kinds(site, at(10.0, 40.0)) == []


def test_zone_heights_count_from_the_ground_or_the_origin() -> None:
    ground = TrueGround(rise_east=0.25)  # 10 m high at 40 m east
    zone = TrueZone("Z", SMALL, True, ceiling_m=35.0)
    assert kinds(replace(SITE, zones=(zone,), ground=ground), at(40.0, 40.0)) == ["keep-out zone"]
    wgs84 = replace(zone, over_ground=False)
    assert kinds(replace(SITE, zones=(wgs84,), ground=ground), at(40.0, 40.0)) == []


def test_off_a_height_zones_heights() -> None:
    zone = TrueZone("Z", SMALL, False, floor_m=30.0, ceiling_m=50.0)
    site = replace(SITE, zones=(zone,))
    assert kinds(site, at(40.0, 40.0, 51.0)) == ["height zone"]
    assert kinds(site, at(40.0, 40.0, 29.0)) == ["height zone"]
    assert kinds(site, at(40.0, 40.0)) == []
    assert kinds(site, replace(at(40.0, 40.0, 29.0), may_be_low=True)) == []


def test_too_high_and_too_low_above_ground() -> None:
    hill = replace(SITE, ground=TrueGround(rise_north=0.5))
    assert kinds(SITE, at(0.0, 50.0, 121.0)) == ["too high"]
    assert kinds(hill, at(0.0, 50.0, 121.0)) == []
    assert kinds(hill, at(0.0, 50.0, 29.0)) == ["too low"]
    assert kinds(hill, at(0.0, -50.0, 100.0)) == ["too high"]
    assert kinds(hill, replace(at(0.0, 50.0, 29.0), may_be_low=True)) == []
    assert kinds(hill, replace(at(0.0, 50.0, 29.0), home_m=(0.0, 40.0))) == []


def test_what_sensors_hide_is_no_breach() -> None:
    rough = replace(SITE, error_level_m=2.0, error_up_m=2.0)
    assert kinds(rough, at(101.5, 0.0)) == []
    assert kinds(rough, at(103.0, 0.0)) == ["fence"]
    assert kinds(rough, MIDDLE, at(13.5, 0.0)) == []


def test_depth_in_a_polygon_that_is_not_convex() -> None:
    notch = ((0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (50.0, 10.0), (0.0, 100.0))
    assert depth_m(notch, (50.0, 5.0)) == pytest.approx(4.4, abs=1.0)
    assert depth_m(notch, (50.0, 60.0)) < 0.0


def test_a_hold_that_is_late_or_lost_is_found() -> None:
    clock = StopClock()
    clock.ordered("A", 10.0, is_expected=True)
    clock.arrived("A", 10.3)
    assert list(clock.late(11.0)) == []
    clock.ordered("A", 20.0, is_expected=True)
    assert list(clock.late(20.4)) == []
    assert [breach.kind for breach in clock.late(20.6)] == ["hold"]
    assert list(clock.late(21.0)) == []
    assert clock.latencies_s == [pytest.approx(0.3), float("inf")]


def test_no_hold_is_expected_over_a_dead_downlink() -> None:
    clock = StopClock()
    clock.ordered("A", 10.0, is_expected=False)
    clock.ordered("B", 10.0, is_expected=True)
    clock.excuse("B")
    assert list(clock.late(20.0)) == []


def test_a_takeoff_needs_an_order_for_each() -> None:
    permits = TakeoffPermits()
    permits.allow("A", 10.0)
    assert permits.took_off("A", 12.0) is None
    assert permits.took_off("A", 13.0) is not None
    permits.allow("A", 20.0)
    assert permits.took_off("A", 60.0) is not None
    permits.allow("A", 70.0, float("inf"))
    permits.withdraw("A")
    assert permits.took_off("A", 71.0) is not None


def test_motion_to_a_pilots_vehicle_is_found() -> None:
    guard = PilotGuard()
    guard.takes("A", 10.0)
    assert guard.motion_arrived("A", 10.4, 0.1, "mission") is None
    guard.reported("A", 10.5)
    assert guard.motion_arrived("A", 10.8, 0.1, "mission") is None
    assert guard.motion_arrived("A", 11.0, 0.1, "mission") is not None
    guard.ends("A")
    assert guard.motion_arrived("A", 12.0, 0.1, "mission") is None


def test_an_age_that_is_shown_too_young_is_found() -> None:
    ages = ShownAges()
    ages.made("A", 10.0, (1.0, 2.0))
    ages.made("A", 10.1, (1.1, 2.0))
    assert ages.shown("A", 10.2, (1.1, 2.0), 0.05, 0.1) is None
    assert ages.shown("A", 13.0, (1.1, 2.0), 2.8, 0.1) is None
    live = ages.shown("A", 13.0, (1.1, 2.0), 0.1, 0.1)
    assert live is not None
    assert "shown live" in live.text
    assert ages.shown("A", 10.2, (7.0, 7.0), 0.0, 0.1) is not None


def test_a_breach_without_its_alarm_is_found() -> None:
    breach = Breach("separation", ("A", "B"), "", 1.0, "too near")
    other = ("separation", "C", "separation:C:D")
    assert missing_alarm(breach, 2.0, {other}) is not None
    assert missing_alarm(breach, 2.0, {("separation", "A", "separation:A:B")}) is None
    assert missing_alarm(breach, 2.0, {("fence_ahead", "A", "fence_ahead:A")}) is not None
    assert missing_alarm(breach, 0.5, set()) is None
