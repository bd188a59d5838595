"""Findings of the separation watchdog, whole: cause, severity, text, and exactly when a hold."""

from dataclasses import replace

import pytest
from tests.safety.traffic import ORIGIN, aircraft, flies, route
from tests.safety.watchdogs.looks import held, in_context, looks

from recon.model.geo import GeoPoint
from recon.model.severity import Severity
from recon.model.vehicle import Failsafe, VehicleState
from recon.safety.watchdogs import Finding
from recon.safety.watchdogs.separation import separation

NORTH, SOUTH = (10.0, 0.0, 0.0), (-10.0, 0.0, 0.0)


def head_on(gap_m: float, speed_mps: float = 10.0) -> tuple[VehicleState, VehicleState]:
    a = aircraft("A", (0.0, 0.0), velocity=(speed_mps, 0.0, 0.0))
    b = aircraft("B", (gap_m, 3.0), 42.0, velocity=(-speed_mps, 0.0, 0.0))
    return a, replace(b, link_id=2)


def finding(
    key: str, text: str, severity: Severity = Severity.ERROR, holds: str | None = None
) -> Finding:
    """About B, by link 2."""
    name_text = f"B: {text}"
    return Finding(f"separation:{key}", "separation", severity, "B", name_text, "B", 2, holds)


def test_a_pair_in_either_order() -> None:
    a, b = head_on(140.0)
    text = "comes too near in 6 s to A: 3 m, and 2 m in height"
    for pair in ((a, b), (b, a)):
        assert looks(separation, *pair) == [finding("A:B", text, holds="B")]
    names = in_context(a, held=held(3.0)), in_context(b, hold_refused="no link")
    (told,) = looks(separation, *names)
    assert told.text == f"B: {text}; A was ordered to hold; B could not be held (no link)"
    (off,) = looks(separation, a, in_context(b, hold_refused="no link"), is_hold_on=False)
    assert off == finding("A:B", f"{text}; holding is switched off: act now")


def test_each_pair_has_a_cause_of_its_own() -> None:
    places = {"A": (0.0, 0.0), "B": (12.0, 0.0), "C": (24.0, 0.0)}
    found = looks(separation, *(aircraft(name, place) for name, place in places.items()))
    assert [each.key for each in found] == ["separation:A:B", "separation:B:C"]
    assert found[0].text == "B: is too near to A: 12 m, and 0 m in height"


@pytest.mark.parametrize(
    ("gap_m", "in_s", "severity"),
    [(114.0, 5.0, Severity.CRITICAL), (119.0, 5.25, Severity.ERROR)],
)
def test_five_seconds_are_critical(gap_m: float, in_s: float, severity: Severity) -> None:
    """17 m remain of the gap, at 20 m/s, in whole quarters of a second."""
    assert gap_m - 20.0 * in_s < 16.7 < gap_m - 20.0 * (in_s - 0.25)
    (found,) = looks(separation, *head_on(gap_m))
    assert found.severity is severity


@pytest.mark.parametrize(("gap_m", "holds"), [(41.0, "B"), (42.5, None)])
def test_a_hold_is_due_when_both_just_need_the_time_to_stop(
    gap_m: float, holds: str | None
) -> None:
    """At 2.5 m/s each stops in 1 s, after 1 s of reaction, and 2 s are kept: 5 s, and 5.25 s."""
    (found,) = looks(separation, *head_on(gap_m, 2.5))
    assert found.holds == holds


@pytest.mark.parametrize(("age_s", "holds"), [(0.19, None), (0.2, "B")])
def test_a_hold_is_due_when_the_alarm_has_lasted(age_s: float, holds: str | None) -> None:
    (found,) = looks(separation, *head_on(80.0), lasted_s=age_s)
    assert found.holds == holds


def test_only_a_gap_in_height_below_the_minimum_is_too_near() -> None:
    for up_m, count in ((46.99, 1), (47.0, 0)):
        for up_mps in (0.0, 1.0):
            a = aircraft("A", velocity=(0.0, 0.0, up_mps))
            b = aircraft("B", (3.0, 0.0), up_m, (0.0, 0.0, up_mps))
            assert len(looks(separation, a, b)) == count


class TestHazardAreas:
    hazard = aircraft("G", (0.0, 0.0), velocity=NORTH, age_s=10.0, failsafe=Failsafe.HOVER)

    def test_one_that_flies_into_it(self) -> None:
        """It is 100 m wide and grows at 10 m/s: 57 m to go at 20 m/s."""
        coming = aircraft("B", (0.0, 174.0), velocity=(0.0, -10.0, 0.0))
        where = "the hazard area of G, telemetry lost for 10 s"
        assert looks(separation, self.hazard, replace(coming, link_id=2)) == [
            finding(
                "B:hazard area of G",
                f"comes too near in 3 s to {where}: 0 m, and 0 m in height",
                Severity.CRITICAL,
                "B",
            )
        ]

    def test_one_beside_it_and_above(self) -> None:
        """It has grown to 150 m; the other is 12 m beside it and 2 m higher."""
        old = aircraft("G", velocity=NORTH, age_s=60.0, failsafe=Failsafe.HOVER)
        beside = replace(aircraft("B", (0.0, 162.0), 42.0), link_id=2)
        text = "is too near to the hazard area of G, telemetry lost for 60 s: 12 m, and 2 m in"
        could = "; B could not be held (no link)"
        told = in_context(beside, hold_refused="no link")
        assert looks(separation, old, told) == [
            finding("B:hazard area of G", f"{text} height{could}", Severity.CRITICAL)
        ]
        for up_m, count in ((46.99, 1), (47.0, 0)):
            assert len(looks(separation, old, aircraft("B", (0.0, 100.0), up_m))) == count

    def test_one_that_may_continue_its_mission_and_one_beside_its_way(self) -> None:
        mission = flies(route((0.0, 0.0), (0.0, 900.0)), 1)
        state = aircraft("G", velocity=(0.0, 5.0, 0.0), age_s=100.0, failsafe=Failsafe.HOVER)
        lost = in_context(state, intent=mission)
        beside = replace(aircraft("B", (0.0, 540.0), 43.0), link_id=2)
        who = "G (telemetry lost for 100 s, if it continues its mission)"
        for traffic in ((lost, beside), (beside, lost)):
            assert looks(separation, *traffic) == [
                finding("B:G", f"is too near to {who}: 0 m, and 3 m in height", Severity.CRITICAL)
            ]


class TestHeightsThatCannotBeCompared:
    """The lost one took off 80 m beside the others, which are above it."""

    lost = aircraft("G", (0.0, 0.0), 40.0, home=(80.0, 0.0), age_s=10.0, failsafe=Failsafe.HOVER)

    def with_pad(self, state: VehicleState, north_m: float) -> VehicleState:
        assert state.profile is not None
        pad = GeoPoint(ORIGIN.latitude_deg + north_m / 111_070.7, ORIGIN.longitude_deg, 275.0)
        return replace(state, profile=replace(state.profile, pad=pad))

    def above(self, serial: str, east_m: float, home_m: float) -> VehicleState:
        return aircraft(serial, (0.0, east_m), 100.0, home=(home_m, 0.0))

    def test_each_vehicle_is_compared_by_its_own_takeoff_point(self) -> None:
        a, b, beside = self.above("A", 0.0, 0.0), self.above("B", 20.0, 0.0), 78.0
        for fleet, alarmed in (
            ((a, b), ["A", "B"]),
            ((self.above("A", 0.0, beside), b), ["B"]),
            ((a, self.above("B", 20.0, beside)), ["A"]),
            ((self.above("A", 0.0, beside), self.above("B", 20.0, beside)), []),
        ):
            found = looks(separation, *fleet, self.lost)
            assert [each.serial for each in found] == alarmed
        on_pads = self.with_pad(a, 0.0), self.with_pad(self.lost, 80.0)
        assert looks(separation, *on_pads) == []

    def test_no_hold_is_thought_to_help_by_height(self) -> None:
        (inside,) = looks(separation, self.above("B", 20.0, 0.0), self.lost)
        assert inside.holds is None
