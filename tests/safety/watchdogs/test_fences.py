"""The boundary, zones and heights right ahead of each vehicle."""

from dataclasses import replace

import numpy as np
import pytest
from tests.safety.traffic import FRAME, aircraft, at, flies, route
from tests.safety.watchdogs.looks import (
    NOW,
    AuthorityHolder,
    Commanded,
    FlightMode,
    Intent,
    held,
    in_context,
    looks,
    picture,
)

from recon.model.airspace import (
    Airspace,
    ElevationModel,
    FlightLimits,
    HeightDatum,
    Region,
    Zone,
    ZoneKind,
)
from recon.model.geo import GroundGrid
from recon.model.severity import Severity
from recon.safety import PreparedAirspace
from recon.safety.watchdogs import Finding
from recon.safety.watchdogs.fences import fences


def square(east_m: float, north_m: float, half_m: float) -> Region:
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    return Region(np.array([(east_m + e * half_m, north_m + n * half_m) for e, n in corners]))


def site(*zones: Zone, **changes: object) -> PreparedAirspace:
    """A square kilometre around the origin."""
    boundary = square(0.0, 0.0, 500.0)
    return PreparedAirspace(
        Airspace(frame=FRAME, boundary=boundary, zones=zones, **changes)  # type: ignore[arg-type]
    )


SITE = site()
FAR_HOME = (-400.0, 0.0)
TREES = Zone("trees", ZoneKind.KEEP_OUT, square(0.0, 300.0, 20.0), None, 30.0, HeightDatum.GROUND)
CLOUD = Zone("cloud", ZoneKind.KEEP_OUT, square(0.0, 300.0, 20.0), 50.0, None, HeightDatum.GROUND)
WALL = Zone("wall", ZoneKind.KEEP_OUT, square(0.0, 300.0, 20.0))
LAYER = Zone("layer", ZoneKind.HEIGHT, square(0.0, 300.0, 50.0), 30.0, 60.0, HeightDatum.GROUND)


def only(findings: list[Finding]) -> Finding:
    (found,) = findings
    return found


class TestBoundary:
    @pytest.mark.parametrize(("north_m", "count"), [(450.0, 0), (462.0, 0), (463.0, 1)])
    def test_it_looks_ahead_by_a_quarter_more_than_the_way_to_stop(
        self, north_m: float, count: int
    ) -> None:
        """From 10 m/s: a second's reaction and 20 m of braking, 1.25 times in time: 37.5 m."""
        state = aircraft("A", (north_m, 0.0), velocity=(10.0, 0.0, 0.0))
        assert len(looks(fences, state, airspace=SITE)) == count

    def test_one_about_to_leave_is_held_and_reported(self) -> None:
        leaving = aircraft("A", (490.0, 0.0), velocity=(10.0, 0.0, 0.0))
        found = only(looks(fences, leaving, airspace=SITE))
        assert (found.rule, found.severity, found.holds) == ("fence_ahead", Severity.ERROR, "A")
        assert found.text == "A: is about to leave the site's boundary"
        ordered = only(looks(fences, in_context(leaving, held=held(0.1, 10.0)), airspace=SITE))
        assert ordered.text.endswith("boundary; A was ordered to hold")
        refused = only(looks(fences, in_context(leaving, hold_refused="no link"), airspace=SITE))
        assert refused.text.endswith("boundary; A could not be held (no link)")
        assert refused.holds is None

    def test_the_alarm_is_first(self) -> None:
        leaving = aircraft("A", (490.0, 0.0), velocity=(10.0, 0.0, 0.0))
        assert only(looks(fences, leaving, airspace=SITE, lasted_s=0.1)).holds is None

    @pytest.mark.parametrize(("north_mps", "holds"), [(0.0, None), (5.0, "A"), (-5.0, None)])
    def test_one_outside_is_held_only_on_its_way_farther_out(
        self, north_mps: float, holds: str | None
    ) -> None:
        state = aircraft("A", (520.0, 0.0), velocity=(north_mps, 0.0, 0.0))
        found = only(looks(fences, state, airspace=SITE))
        assert "is 20 m outside the site's boundary" in found.text
        assert (found.severity, found.holds) == (Severity.CRITICAL, holds)

    def test_a_pilot_and_one_coming_down_are_alarmed_about_only(self) -> None:
        leaving = aircraft("A", (490.0, 0.0), velocity=(10.0, 0.0, 0.0))
        for one in (
            in_context(leaving, holder=AuthorityHolder.PILOT),
            in_context(leaving, intent=Intent(Commanded.RETURN, NOW)),
            in_context(leaving, held=held(1.0, 10.0), intent=Intent()),
        ):
            finding = only(looks(fences, one, airspace=SITE))
            assert finding.holds is None

    def test_a_hold_that_does_nothing_is_given_again(self) -> None:
        leaving = aircraft("A", (490.0, 0.0), velocity=(10.0, 0.0, 0.0))
        again = in_context(leaving, held=held(5.1, 10.0))
        assert only(looks(fences, again, airspace=SITE)).holds == "A"

    def test_a_mission_that_ends_at_the_fence_is_followed_to_its_stop(self) -> None:
        flying = aircraft(
            "A", (470.0, 0.0), velocity=(10.0, 0.0, 0.0), mode=FlightMode.GPS_WAYPOINT
        )
        to_the_edge = route((0.0, 0.0), (494.0, 0.0), (494.0, 50.0))
        assert looks(fences, in_context(flying, intent=flies(to_the_edge, 1)), airspace=SITE) == []
        assert len(looks(fences, flying, airspace=SITE)) == 1

    @pytest.mark.parametrize(
        ("velocity", "count"),
        [
            ((10.0, 0.0, 0.0), 0),  # along the row it comes from
            ((7.0, 7.0, 0.0), 0),  # round the corner into the next
            ((0.0, 10.0, 0.0), 0),  # along the next row
            ((6.0, -9.0, 0.0), 1),  # carried off, 56 degrees aside
            ((2.0, -10.0, 0.0), 1),
            ((-10.0, 0.0, 0.0), 0),  # back, away from the fence
        ],
    )
    def test_one_that_flies_aside_of_its_rows_is_not_believed_to_follow_them(
        self, velocity: tuple[float, float, float], count: int
    ) -> None:
        flying = aircraft("A", (480.0, -480.0), velocity=velocity, mode=FlightMode.GPS_WAYPOINT)
        rows = route((300.0, -481.0), (484.0, -476.0), (484.0, 300.0), (300.0, 300.0))
        seen = looks(fences, in_context(flying, intent=flies(rows, 1)), airspace=SITE)
        assert len(seen) == count

    @pytest.mark.parametrize("commanded", [Commanded.STICK, Commanded.RETURN])
    @pytest.mark.parametrize(("east_mps", "count"), [(9.0, 0), (13.0, 1)])
    def test_one_that_the_wind_carries_off_its_straight_way_is_seen(
        self, commanded: Commanded, east_mps: float, count: int
    ) -> None:
        """It is to fly north at 10 m/s, 30 m from the fence in the east."""
        mode = FlightMode.JOYSTICK if commanded is Commanded.STICK else FlightMode.GO_HOME
        home = (300.0, 470.0)
        flying = aircraft("A", (0.0, 470.0), velocity=(10.0, east_mps, 0.0), mode=mode, home=home)
        target = at(*home) if commanded is Commanded.STICK else None
        watched = in_context(flying, intent=Intent(commanded, target=target))
        assert len(looks(fences, watched, airspace=SITE)) == count

    def test_over_its_target_any_direction_is_as_good(self) -> None:
        flying = aircraft("A", (494.0, 0.0), velocity=(2.5, 0.0, 0.0), mode=FlightMode.JOYSTICK)
        there = in_context(flying, intent=Intent(Commanded.STICK, target=at(494.0, 0.5)))
        assert looks(fences, there, airspace=SITE) == []

    def test_without_a_site_or_a_boundary_nothing_is_asked(self) -> None:
        leaving = aircraft("A", (490.0, 0.0), velocity=(10.0, 0.0, 0.0))
        for airspace in (
            PreparedAirspace(Airspace()),
            PreparedAirspace(Airspace(frame=FRAME)),
        ):
            assert looks(fences, leaving, airspace=airspace) == []
        assert looks(fences, airspace=SITE) == []


class TestKeepOut:
    def test_one_about_to_enter_is_held(self) -> None:
        coming = aircraft("A", (260.0, 0.0), velocity=(8.0, 0.0, 0.0))
        found = only(looks(fences, coming, airspace=site(WALL)))
        assert found.text == "A: is about to enter the keep-out zone 'wall'"
        assert (found.rule, found.severity, found.holds) == ("zone_ahead", Severity.ERROR, "A")
        assert looks(fences, aircraft("A", (260.0, 0.0)), airspace=site(WALL)) == []

    @pytest.mark.parametrize(("north_mps", "holds"), [(0.0, None), (3.0, "A"), (-3.0, None)])
    def test_one_inside_is_held_only_on_its_way_deeper(
        self, north_mps: float, holds: str | None
    ) -> None:
        state = aircraft("A", (285.0, 0.0), velocity=(north_mps, 0.0, 0.0))
        found = only(looks(fences, state, airspace=site(WALL)))
        assert "is in the keep-out zone 'wall'" in found.text
        assert (found.severity, found.holds) == (Severity.CRITICAL, holds)

    @pytest.mark.parametrize(
        ("zone", "height_m", "count"),
        [(TREES, 29.0, 1), (TREES, 31.0, 0), (CLOUD, 49.0, 0), (CLOUD, 51.0, 1)],
    )
    def test_above_the_ceiling_and_below_the_floor_it_may_be(
        self, zone: Zone, height_m: float, count: int
    ) -> None:
        over = aircraft("A", (300.0, 0.0), height_m, home=(300.0, 0.0))
        assert len(looks(fences, over, airspace=site(zone))) == count

    def test_one_that_sinks_into_it_is_found_before(self) -> None:
        sinking = aircraft("A", (300.0, 0.0), 33.0, (0.0, 0.0, -3.0))
        assert only(looks(fences, sinking, airspace=site(TREES))).rule == "zone_ahead"

    def test_an_unknown_height_is_in_it(self) -> None:
        blind = aircraft("A", (300.0, 0.0), None)
        assert only(looks(fences, blind, airspace=site(TREES))).rule == "zone_ahead"


class TestHeights:
    @pytest.mark.parametrize(("height_m", "word"), [(29.0, "low"), (31.0, ""), (61.0, "high")])
    def test_a_height_zone_is_alarmed_about_and_no_vehicle_is_held(
        self, height_m: float, word: str
    ) -> None:
        inside = aircraft("A", (300.0, 0.0), height_m)
        found = looks(fences, inside, airspace=site(LAYER))
        assert [word in f.text and f.holds is None for f in found] == ([True] if word else [])

    def test_who_takes_off_or_lands_may_be_low(self) -> None:
        low = aircraft("A", (300.0, 0.0), 10.0)
        airspace = site(LAYER)
        assert len(looks(fences, low, airspace=airspace)) == 1
        takes_off = aircraft("A", (300.0, 0.0), 10.0, home=(300.0, 5.0))
        assert looks(fences, takes_off, airspace=airspace) == []
        landing = in_context(low, intent=Intent(Commanded.LAND, NOW))
        assert looks(fences, landing, airspace=airspace) == []
        homeless = replace(low, takeoff_point=None)
        assert looks(fences, homeless, airspace=airspace) == []

    def test_zones_with_one_end_have_only_that(self) -> None:
        floor = replace(LAYER, ceiling_m=None)
        ceiling = replace(LAYER, floor_m=None)
        low, high = (aircraft("A", (300.0, 0.0), h) for h in (29.0, 61.0))
        assert [len(looks(fences, v, airspace=site(floor))) for v in (low, high)] == [1, 0]
        assert [len(looks(fences, v, airspace=site(ceiling))) for v in (low, high)] == [0, 1]

    @pytest.mark.parametrize(("height_m", "count"), [(119.0, 0), (121.0, 1)])
    def test_the_sites_ceiling_counts_above_ground(self, height_m: float, count: int) -> None:
        assert len(looks(fences, aircraft("A", (0.0, 0.0), height_m), airspace=SITE)) == count

    def test_over_lower_ground_it_is_lower(self) -> None:
        """Ground 10 m below the origin, and home on it."""
        grid = GroundGrid(FRAME, -600.0, 600.0, 100.0, 12, 12)
        ground = ElevationModel(grid, np.full((12, 12), 265.0))
        airspace = site(elevation=ground, limits=FlightLimits(max_height_above_ground_m=100.0))
        for height_m, count in ((99.0, 0), (101.0, 1)):
            found = looks(fences, aircraft("A", (0.0, 0.0), height_m), airspace=airspace)
            assert len(found) == count

    def test_an_unknown_height_is_not_called_too_high_or_too_low(self) -> None:
        assert looks(fences, aircraft("A", (0.0, 0.0), None), airspace=SITE) == []

    @pytest.mark.parametrize(("height_m", "count"), [(5.5, 0), (4.5, 1)])
    def test_the_sites_least_height_counts_above_ground(self, height_m: float, count: int) -> None:
        found = looks(fences, aircraft("A", (0.0, 0.0), height_m, home=FAR_HOME), airspace=SITE)
        text = "A: is lower above ground than 5 m, or soon will be"
        assert [(f.rule, f.text, f.holds) for f in found] == count * [("height_limit", text, None)]

    def test_over_higher_ground_it_is_lower(self) -> None:
        """A hill 40 m above the origin, and home at its foot."""
        grid = GroundGrid(FRAME, -600.0, 600.0, 100.0, 12, 12)
        heights_m = np.full((12, 12), 275.0)
        heights_m[:, 8:] = 315.0
        airspace = site(elevation=ElevationModel(grid, heights_m))
        for east_m, height_m, count in ((-100.0, 44.0, 0), (300.0, 46.0, 0), (300.0, 44.0, 1)):
            low = aircraft("A", (0.0, east_m), height_m, home=(0.0, -400.0))
            found = looks(fences, low, airspace=airspace)
            assert ["lower" in f.text for f in found] == count * [True]

    def test_one_that_sinks_is_found_before_it_is_too_low(self) -> None:
        sinking = aircraft("A", (0.0, 0.0), 8.0, (0.0, 0.0, -3.0), home=FAR_HOME)
        assert "is lower above ground than 5 m" in only(looks(fences, sinking, airspace=SITE)).text

    def test_near_home_and_on_its_way_down_it_may_be_lower(self) -> None:
        low = aircraft("A", (0.0, 0.0), 3.0, home=FAR_HOME)
        for one in (
            aircraft("A", (0.0, 0.0), 3.0, home=(10.0, 0.0)),
            in_context(low, intent=Intent(Commanded.LAND, NOW)),
            in_context(low, intent=Intent(Commanded.RETURN, NOW)),
        ):
            assert looks(fences, one, airspace=SITE) == []

    def test_over_unknown_ground_one_alarm_is_enough(self) -> None:
        grid = GroundGrid(FRAME, -600.0, 600.0, 100.0, 12, 12)
        unknown = np.full((12, 12), 275.0)
        unknown[:, 6:] = np.nan
        airspace = site(elevation=ElevationModel(grid, unknown))
        over_it = aircraft("A", (0.0, 300.0), 50.0, home=(0.0, -300.0))
        found = only(looks(fences, over_it, airspace=airspace))
        assert "is higher above ground than 120 m" in found.text


def test_a_lost_one_that_may_continue_its_mission_is_not_judged_and_others_are() -> None:
    mission = route((0.0, 0.0), (0.0, 400.0))
    lost = in_context(aircraft("G", age_s=10.0), intent=flies(mission, 1))
    outside = aircraft("A", (520.0, 0.0))
    assert [f.serial for f in looks(fences, lost, outside, airspace=SITE)] == ["A"]
    assert looks(fences, lost, airspace=SITE) == []


def test_only_vehicles_flying_in_contact_are_judged() -> None:
    stale = aircraft("A", (520.0, 0.0), age_s=5.0)
    assert picture(stale, airspace=SITE).flying == ()
    assert looks(fences, stale, airspace=SITE) == []
