"""Findings of the watchdogs that compare values, whole: cause, severity, text and delay."""

from dataclasses import replace

import pytest
from tests.safety.fenced import FRAME, airspace, flier, place
from tests.safety.traffic import flies, route
from tests.safety.watchdogs.looks import (
    NOW,
    Commanded,
    FlightMode,
    Intent,
    S,
    aircraft,
    in_context,
    looks,
    picture,
)

from recon.model.airspace import Airspace, FlightLimits
from recon.model.severity import Severity
from recon.model.temporary_zone import Circle, DrawnZone, TemporaryZone, TemporaryZoneKind
from recon.model.units import Stamped
from recon.model.vehicle import AltitudeReference, GoHomeFlight, VehicleState
from recon.safety import PreparedAirspace
from recon.safety.energy import fraction_to_get_home
from recon.safety.temporary_zones import prepared_temporary_zone
from recon.safety.watchdogs import Finding
from recon.safety.watchdogs.battery_home import battery_home
from recon.safety.watchdogs.go_home import go_home
from recon.safety.watchdogs.route_home_zones import route_home_zones
from recon.safety.watchdogs.telemetry import heights, link, sticks


def finding(
    key: str, severity: Severity, text: str, after_s: float = 0.0, serial: str = "A"
) -> Finding:
    rule, _, about = key.partition(":")
    key = f"{rule}:{serial}:{about}" if about else f"{rule}:{serial}"
    name_text = f"{serial}: {text}"
    return Finding(key, rule, severity, serial, name_text, serial, 1, after_s=after_s)


def test_late_telemetry() -> None:
    never = VehicleState("B", link_id=2)
    assert looks(link, never, aircraft("A", age_s=2.0)) == [
        finding("link_late", Severity.WARNING, "no telemetry for more than a second")
    ]


def test_a_quiet_stream_of_sticks() -> None:
    assert looks(sticks, in_context(aircraft("A"), stick_quiet_s=0.6)) == [
        finding(
            "stick_starved",
            Severity.ERROR,
            "no stick has left for it for 0.6 s though it is steered; its app should stop it "
            "within 1 s: if it moves on, hold it, or have its pilot stop it",
        )
    ]


class TestBatteryForTheWayHome:
    def out(self, fraction: float | None, serial: str = "A") -> VehicleState:
        state = aircraft(serial, (800.0, 0.0))
        assert state.profile is not None
        profile = replace(state.profile, endurance_s=1_500.0)
        return replace(state, profile=profile, battery_fraction=Stamped(fraction, NOW))

    def test_whole(self) -> None:
        assert looks(battery_home, self.out(None, "B"), self.out(0.15)) == [
            finding(
                "battery_home",
                Severity.CRITICAL,
                "battery 15%, route home 16%: it may not reach home; land it or recall it now",
                1.0,
            )
        ]
        assert looks(battery_home, self.out(0.3)) == [
            finding(
                "battery_home",
                Severity.WARNING,
                "battery 30%, route home 16%: less than the reserve of 25% would be left; "
                "recall it",
                1.0,
            )
        ]

    def test_at_its_limits(self) -> None:
        """What is left is exactly enough; a hair less is not."""
        now = picture(self.out(0.5))
        needs = fraction_to_get_home(now.flying[0].state, now.airspace, now.energy)
        assert needs is not None
        reserve = now.airspace.airspace.limits.battery_reserve_fraction
        least = now.energy.landing_fraction

        def severities(fraction: float, commanded: Commanded | None = None) -> list[Severity]:
            intent = Intent() if commanded is None else Intent(commanded, NOW)
            found = looks(battery_home, in_context(self.out(fraction), intent=intent))
            return [each.severity for each in found]

        assert severities(needs + reserve) == []
        assert severities(needs + reserve - 1e-9) == [Severity.WARNING]
        assert severities(needs + least) == [Severity.WARNING]
        assert severities(needs + least - 1e-9) == [Severity.CRITICAL]
        assert severities(needs, Commanded.RETURN) == []
        assert severities(needs - 1e-9, Commanded.RETURN) == [Severity.CRITICAL]

    def test_an_unknown_go_home_height_is_the_highest_of_the_site(self) -> None:
        """Higher by 400 m: at 2 m/s up and 1.5 m/s down some 8 min, a third of the battery."""
        state = self.out(0.5)
        assert state.profile is not None
        state = replace(state, profile=replace(state.profile, go_home_height_m=None))
        high = PreparedAirspace(Airspace(FlightLimits(max_height_above_ground_m=520.0)))
        assert looks(battery_home, state) == []
        assert len(looks(battery_home, state, airspace=high)) == 1


class TestHeightsThatContradict:
    def test_a_drift(self) -> None:
        for reference, severity, limit_m in (
            (AltitudeReference.TAKEOFF, Severity.WARNING, 10.0),
            (AltitudeReference.WGS84, Severity.ERROR, 2.0),
        ):
            state = aircraft("A")
            assert state.profile is not None
            state = replace(
                state,
                profile=replace(state.profile, waypoint_altitude=reference),
                altitude_offset_m=Stamped(260.0 - limit_m, NOW),
                altitude_offset_at_takeoff_m=260.0,
            )
            assert looks(heights, state) == []
            state = replace(state, altitude_offset_m=Stamped(249.0, NOW))
            assert looks(heights, state) == [
                finding(
                    "altitude_mismatch:drift",
                    severity,
                    "its altitude and its height above takeoff have drifted 11 m apart since "
                    "takeoff; one of them is wrong",
                    1.0,
                )
            ]

    @pytest.mark.parametrize(
        ("height_m", "where"), [(26.0, ""), (54.0, ""), (25.0, "5 m below"), (55.0, "5 m above")]
    )
    def test_off_the_leg(self, height_m: float, where: str) -> None:
        leg = route((0.0, 0.0, 30.0), (200.0, 0.0, 50.0))
        now = picture(aircraft("A"))
        settings = replace(now.settings, height_off_m=4.0)
        state = aircraft("A", (100.0, 0.0), height_m, mode=FlightMode.GPS_WAYPOINT)
        watched = picture(in_context(state, intent=flies(leg, 1)))
        found = list(heights(replace(watched, settings=settings)))
        text = f"it flies {where} the heights of the leg it was sent"
        expected = finding("altitude_mismatch:leg", Severity.ERROR, text, 3.0)
        assert found == ([expected] if where else [])


class TestGoingHome:
    FLIGHT = GoHomeFlight(NOW - 20 * S, 30.0, 0.0, 300.0, 60.0, NOW - 12 * S)

    def state(self, mode: FlightMode, height_m: float = 60.0) -> VehicleState:
        state = aircraft("A", (200.0, 0.0), height_m, (-10.0, 0.0, 0.0), mode=mode)
        return replace(state, go_home=self.FLIGHT)

    def test_each_deviation_is_a_finding_of_its_own(self) -> None:
        low, late = looks(go_home, self.state(FlightMode.GO_HOME, 20.0))
        assert low == replace(finding("go_home:height", Severity.CRITICAL, "", 1.5), text=low.text)
        assert low.text.startswith("A: goes home too low: expected 60 m above takeoff, seen 20 m")
        assert late == replace(finding("go_home:progress", Severity.ERROR, "", 0.0), text=late.text)
        assert "without progress for 12 s" in late.text

    def test_limits_are_those_of_the_settings(self) -> None:
        now = picture(self.state(FlightMode.GO_HOME, 20.0))
        lenient = replace(now.go_home, height_off_m=50.0, no_progress_s=60.0)
        assert len(list(go_home(now))) == 2
        assert list(go_home(replace(now, go_home=lenient))) == []

    def test_an_ordered_landing_hides_no_other_vehicles_and_no_other_deviation(self) -> None:
        lands = self.state(FlightMode.AUTO_LANDING)
        ordered = in_context(lands, intent=Intent(Commanded.LAND, NOW))
        other = replace(self.state(FlightMode.GO_HOME, 20.0), serial="B")
        rules = [each.key for each in looks(go_home, ordered, other)]
        assert rules == ["go_home:B:height", "go_home:B:progress"]
        returns = in_context(lands, intent=Intent(Commanded.RETURN, NOW))
        assert [each.key for each in looks(go_home, returns)] == ["go_home:A:landing"]
        still = in_context(self.state(FlightMode.GO_HOME), intent=Intent(Commanded.LAND, NOW))
        assert [each.key for each in looks(go_home, still)] == ["go_home:A:progress"]


class TestTheWayHome:
    def zone(self, ceiling_m: float | None = None, east_m: float = 100.0) -> PreparedAirspace:
        """A zone of 20 m round a place on the route home from the east, with a margin of 10 m."""
        kind = TemporaryZoneKind.CREWED_AIRCRAFT
        drawn = DrawnZone(kind, Circle(place(east_m, 0.0), 20.0), "rescue", ceiling_m=ceiling_m)
        zone = prepared_temporary_zone(TemporaryZone(1, drawn, "Ann", 0), FRAME)
        return airspace().with_temporary_zones([zone])

    def test_whole(self) -> None:
        name = "crewed aircraft 1 (temporary)"
        assert looks(route_home_zones, flier(200.0, 0.0), airspace=self.zone()) == [
            finding(
                f"route_home_zone:{name}",
                Severity.WARNING,
                f"its route home leads through the keep-out zone {name!r}: without its link it "
                "would fly through it; lead it to the other side, or land it",
                1.0,
            )
        ]

    def test_one_above_it_hides_no_other(self) -> None:
        above = flier(200.0, 0.0, 25.0, go_home_m=60.0)
        low = replace(flier(200.0, 0.0, 25.0, go_home_m=28.0), serial="B", link_id=2)
        for state in ((above, low), (low, above)):
            found = looks(route_home_zones, *state, airspace=self.zone(30.0))
            assert [each.serial for each in found] == ["B"]

    def test_the_boundary_margin_belongs_to_the_zone(self) -> None:
        """Past its edge within the margin, and a home that lies there."""
        margin_m = airspace().airspace.limits.boundary_margin_m
        assert margin_m > 2.0
        for beside_m, count in ((21.0, 1), (20.5 + margin_m, 0)):
            path = flier(200.0, beside_m, 25.0, go_home_m=60.0, takeoff_point=place(0.0, beside_m))
            assert len(looks(route_home_zones, path, airspace=self.zone())) == count
        for east_m, count in ((21.0, 1), (21.0 + margin_m, 0)):
            path = flier(200.0, 0.0, 25.0, go_home_m=60.0)
            found = looks(route_home_zones, path, airspace=self.zone(30.0, east_m))
            assert len(found) == count
