"""Link, battery, heights, jumps and sticks."""

from dataclasses import replace

import pytest
from tests.safety.traffic import flies, route
from tests.safety.watchdogs.looks import (
    NOW,
    Commanded,
    FlightMode,
    Intent,
    aircraft,
    in_context,
    looks,
)

from recon.model.severity import Severity
from recon.model.units import Stamped
from recon.model.vehicle import AltitudeReference, VehicleState
from recon.safety.watchdogs import Finding
from recon.safety.watchdogs.battery_home import battery_home
from recon.safety.watchdogs.telemetry import heights, link, sticks


def severities(findings: list[Finding]) -> list[Severity]:
    return [finding.severity for finding in findings]


class TestLink:
    @pytest.mark.parametrize(("age_s", "count"), [(0.9, 0), (1.0, 1), (2.9, 1), (3.0, 0)])
    def test_it_warns_from_1_s_until_it_is_lost(self, age_s: float, count: int) -> None:
        found = looks(link, aircraft("A", age_s=age_s))
        assert severities(found) == [Severity.WARNING] * count

    def test_an_app_without_an_aircraft_is_not_late(self) -> None:
        assert looks(link, VehicleState("A", link_id=1)) == []


class TestBattery:
    def state(self, fraction: float | None, **changes: object) -> VehicleState:
        """800 m from home: some 125 s of flight and landing, a good tenth of 1,500 s."""
        state = aircraft("A", (800.0, 0.0), **changes)  # type: ignore[arg-type]
        assert state.profile is not None
        profile = replace(state.profile, endurance_s=1_500.0)
        return replace(state, profile=profile, battery_fraction=Stamped(fraction, NOW))

    @pytest.mark.parametrize(
        ("fraction", "expected"),
        [(0.9, []), (0.3, [Severity.WARNING]), (0.15, [Severity.CRITICAL]), (None, [])],
    )
    def test_it_compares_with_what_the_route_home_takes(
        self, fraction: float | None, expected: list[Severity]
    ) -> None:
        assert severities(looks(battery_home, self.state(fraction))) == expected

    def test_its_text_has_both_numbers(self) -> None:
        (found,) = looks(battery_home, self.state(0.15))
        assert found.text.startswith("A: battery 15%, route home 1")

    @pytest.mark.parametrize(("fraction", "count"), [(0.3, 0), (0.2, 0), (0.05, 1)])
    def test_one_coming_home_needs_only_the_way_itself(self, fraction: float, count: int) -> None:
        coming = in_context(self.state(fraction), intent=Intent(Commanded.RETURN, NOW))
        assert len(looks(battery_home, coming)) == count

    def test_without_an_endurance_it_is_unknown(self) -> None:
        blind = replace(aircraft("A", (800.0, 0.0)), battery_fraction=Stamped(0.05, NOW))
        assert looks(battery_home, blind) == []


class TestHeights:
    def drifted(self, by_m: float | None, reference: AltitudeReference) -> VehicleState:
        state = aircraft("A")
        assert state.profile is not None
        return replace(
            state,
            profile=replace(state.profile, waypoint_altitude=reference),
            altitude_offset_m=Stamped(None if by_m is None else 260.0 + by_m, NOW),
            altitude_offset_at_takeoff_m=260.0,
        )

    @pytest.mark.parametrize(
        ("by_m", "reference", "expected"),
        [
            (9.0, AltitudeReference.TAKEOFF, []),
            (-11.0, AltitudeReference.TAKEOFF, [Severity.WARNING]),
            (1.9, AltitudeReference.WGS84, []),
            (2.1, AltitudeReference.WGS84, [Severity.ERROR]),
            (None, AltitudeReference.WGS84, []),
        ],
    )
    def test_altitude_and_height_must_not_drift_apart(
        self, by_m: float | None, reference: AltitudeReference, expected: list[Severity]
    ) -> None:
        assert severities(looks(heights, self.drifted(by_m, reference))) == expected

    def test_without_a_profile_or_a_takeoff_it_asks_less(self) -> None:
        drifted = self.drifted(11.0, AltitudeReference.WGS84)
        assert severities(looks(heights, replace(drifted, profile=None))) == [Severity.WARNING]
        assert looks(heights, replace(drifted, altitude_offset_at_takeoff_m=None)) == []

    @pytest.mark.parametrize(
        ("height_m", "word"), [(25.0, "5 m below"), (27.0, ""), (53.0, ""), (55.0, "5 m above")]
    )
    def test_on_a_leg_it_must_be_between_its_ends(self, height_m: float, word: str) -> None:
        leg = route((0.0, 0.0, 30.0), (200.0, 0.0, 50.0))
        state = aircraft("A", (100.0, 0.0), height_m, mode=FlightMode.GPS_WAYPOINT)
        found = looks(heights, in_context(state, intent=flies(leg, 1)))
        assert [word in finding.text for finding in found] == ([True] if word else [])

    def test_off_a_leg_nothing_is_known(self) -> None:
        leg = route((0.0, 0.0, 30.0), (200.0, 0.0, 50.0))
        flying = aircraft("A", (100.0, 0.0), 90.0, mode=FlightMode.GPS_WAYPOINT)
        manual = aircraft("A", (100.0, 0.0), 90.0)
        blind = aircraft("A", (100.0, 0.0), None, mode=FlightMode.GPS_WAYPOINT)
        for one in (
            in_context(flying, intent=flies(leg, 0)),
            in_context(flying, intent=flies(leg, 2)),
            in_context(flying, intent=Intent(Commanded.MISSION)),
            in_context(flying),
            in_context(manual, intent=flies(leg, 1)),
            in_context(blind, intent=flies(leg, 1)),
        ):
            assert looks(heights, one) == []


class TestSticks:
    @pytest.mark.parametrize(("quiet_s", "count"), [(None, 0), (0.5, 0), (0.6, 1)])
    def test_a_stream_that_has_run_dry(self, quiet_s: float | None, count: int) -> None:
        found = looks(sticks, in_context(aircraft("A"), stick_quiet_s=quiet_s))
        assert len(found) == count
        assert all("0.6 s" in finding.text for finding in found)
