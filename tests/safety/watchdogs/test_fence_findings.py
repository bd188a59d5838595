"""Findings about the boundary, zones and heights, whole: cause, severity, text and hold."""

from dataclasses import replace

import numpy as np
import pytest
from tests.safety.traffic import FRAME, aircraft, at
from tests.safety.watchdogs.looks import Commanded, Intent, in_context, looks, picture
from tests.safety.watchdogs.test_exact_findings import finding
from tests.safety.watchdogs.test_fences import FAR_HOME, LAYER, TREES, WALL, site, square

from recon.model.airspace import Airspace, ElevationModel, HeightDatum, Zone, ZoneKind
from recon.model.failsafe_matrix import FailsafeCondition
from recon.model.geo import GroundGrid
from recon.model.severity import Severity
from recon.model.temporary_zone import Circle, DrawnZone, TemporaryZone, TemporaryZoneKind
from recon.model.vehicle import VehicleState
from recon.safety import PreparedAirspace
from recon.safety.temporary_zones import prepared_temporary_zone
from recon.safety.watchdogs import Finding
from recon.safety.watchdogs.fences import fences, path_ahead

SITE = site()
ORIGIN_HEIGHT_M = 275.0
HILL_M = 40.0
INSIDE = (300.0, 0.0)
SLAB = Zone("slab", ZoneKind.KEEP_OUT, LAYER.region, 30.0, 60.0, HeightDatum.GROUND)
LEAVING = aircraft("A", (490.0, 0.0), velocity=(10.0, 0.0, 0.0))


def over_the_ellipsoid(zone: Zone) -> Zone:
    """The same zone where the ground is flat at the origin's height."""
    assert zone.floor_m is not None
    assert zone.ceiling_m is not None
    return replace(
        zone,
        floor_m=zone.floor_m + ORIGIN_HEIGHT_M,
        ceiling_m=zone.ceiling_m + ORIGIN_HEIGHT_M,
        datum=HeightDatum.WGS84,
    )


def hill_in_the_north(*zones: Zone) -> PreparedAirspace:
    """The ground under the zones is 40 m higher than at the origin."""
    grid = GroundGrid(FRAME, -600.0, 600.0, 100.0, 12, 12)
    ground = np.full((12, 12), ORIGIN_HEIGHT_M)
    ground[:5] += HILL_M
    return site(*zones, elevation=ElevationModel(grid, ground))


def drawn_round(north_m: float) -> PreparedAirspace:
    drawn = DrawnZone(TemporaryZoneKind.CREWED_AIRCRAFT, Circle(at(north_m, 0.0), 20.0), "rescue")
    return site().with_temporary_zones(
        [prepared_temporary_zone(TemporaryZone(1, drawn, "Ann", 0), FRAME)]
    )


def summary(found: list[Finding]) -> list[tuple[str, Severity, str | None]]:
    return [(each.key, each.severity, each.holds) for each in found]


class TestWhole:
    def test_boundary_and_keep_out_zone(self) -> None:
        about_to_leave = finding(
            "fence_ahead", Severity.ERROR, "is about to leave the site's boundary"
        )
        assert looks(fences, LEAVING, airspace=SITE) == [replace(about_to_leave, holds="A")]
        coming = aircraft("A", (260.0, 0.0), velocity=(8.0, 0.0, 0.0))
        text = "is about to enter the keep-out zone 'wall'"
        about_to_enter = finding("zone_ahead:wall", Severity.ERROR, text)
        assert looks(fences, coming, airspace=site(WALL)) == [replace(about_to_enter, holds="A")]

    def test_one_that_leaves_is_found_beside_one_without_a_bound(self) -> None:
        landing = in_context(aircraft("B"), intent=Intent(Commanded.LAND))
        looked_at = picture(LEAVING, landing, airspace=SITE)
        assert looked_at.reaches is None
        assert [each.serial for each in fences(looked_at)] == ["A"]

    @pytest.mark.parametrize(
        ("height_m", "text"),
        [
            (29.0, "is too low, or soon will be: at least {} in 'layer'"),
            (31.0, None),
            (59.0, None),
            (61.0, "is too high, or soon will be: at most {} in 'layer'"),
        ],
    )
    @pytest.mark.parametrize(
        ("airspace", "ground_m", "low", "high"),
        [
            (site(LAYER), 0.0, "30 m above ground", "60 m above ground"),
            (
                site(over_the_ellipsoid(LAYER)),
                0.0,
                "305 m above the ellipsoid",
                "335 m above the ellipsoid",
            ),
            (hill_in_the_north(LAYER), HILL_M, "30 m above ground", "60 m above ground"),
        ],
        ids=["flat", "ellipsoid", "hill"],
    )
    def test_height_zone(
        self,
        airspace: PreparedAirspace,
        ground_m: float,
        low: str,
        high: str,
        height_m: float,
        text: str | None,
    ) -> None:
        inside = aircraft("A", INSIDE, ground_m + height_m, home=FAR_HOME)
        expected = []
        if text is not None:
            limit = low if "least" in text else high
            expected.append(finding("height_limit:layer", Severity.ERROR, text.format(limit)))
        assert looks(fences, inside, airspace=airspace) == expected

    @pytest.mark.parametrize(
        ("height_m", "text"),
        [
            (4.0, "is lower above ground than 5 m, or soon will be"),
            (121.0, "is higher above ground than 120 m, or soon will be"),
        ],
    )
    def test_height_limits(self, height_m: float, text: str) -> None:
        beyond = aircraft("A", (0.0, 0.0), height_m, home=FAR_HOME)
        expected = finding("height_limit", Severity.ERROR, text)
        assert looks(fences, beyond, airspace=SITE) == [expected]


class TestEachByItsOwnPlace:
    def test_at_the_boundary(self) -> None:
        inside = aircraft("B", (0.0, 0.0))
        outside = aircraft("C", (-520.0, 0.0))
        assert summary(looks(fences, LEAVING, inside, outside, airspace=SITE)) == [
            ("fence_ahead:A", Severity.ERROR, "A"),
            ("fence_ahead:C", Severity.CRITICAL, None),
        ]

    def test_at_a_keep_out_zone(self) -> None:
        coming = aircraft("A", (260.0, 0.0), velocity=(8.0, 0.0, 0.0))
        inside = aircraft("B", (290.0, 10.0))
        far = aircraft("C", (-290.0, 10.0))
        assert summary(looks(fences, inside, far, coming, airspace=site(WALL))) == [
            ("zone_ahead:B:wall", Severity.CRITICAL, None),
            ("zone_ahead:A:wall", Severity.ERROR, "A"),
        ]


class TestHowNear:
    """From where on a vehicle is out, or in: the edge belongs to the region."""

    def bounded(self, north_m: float) -> PreparedAirspace:
        """A boundary whose southern edge lies there."""
        return PreparedAirspace(Airspace(frame=FRAME, boundary=square(0.0, north_m + 500.0, 500.0)))

    @pytest.mark.parametrize(
        ("edge_north_m", "severity"),
        [(-0.5, Severity.ERROR), (0.0, Severity.ERROR), (0.5, Severity.CRITICAL)],
    )
    def test_out_of_the_boundary(self, edge_north_m: float, severity: Severity) -> None:
        southward = aircraft("A", (0.0, 0.0), velocity=(-3.0, 0.0, 0.0))
        (found,) = looks(fences, southward, airspace=self.bounded(edge_north_m))
        assert (found.severity, found.holds) == (severity, "A")
        assert ("is about to leave" in found.text) is (severity is Severity.ERROR)

    @pytest.mark.parametrize(
        ("edge_north_m", "severity"),
        [(-0.5, Severity.ERROR), (0.0, Severity.CRITICAL), (0.5, Severity.CRITICAL)],
    )
    def test_in_a_keep_out_zone(self, edge_north_m: float, severity: Severity) -> None:
        zone = Zone("south", ZoneKind.KEEP_OUT, square(0.0, edge_north_m - 100.0, 100.0))
        southward = aircraft("A", (0.0, 0.0), velocity=(-3.0, 0.0, 0.0))
        (found,) = looks(fences, southward, airspace=site(zone))
        assert (found.severity, found.holds) == (severity, "A")
        assert ("is about to enter" in found.text) is (severity is Severity.ERROR)

    @pytest.mark.parametrize(("speed_mps", "is_held"), [(0.3, False), (0.4, True)])
    def test_half_a_metre_of_drift_is_not_deeper(self, speed_mps: float, is_held: bool) -> None:
        """In the second and a half that is looked ahead: 0.45 m and 0.6 m."""
        for north_m, airspace in ((520.0, SITE), (285.0, site(WALL))):
            drifting = aircraft("A", (north_m, 0.0), velocity=(speed_mps, 0.0, 0.0))
            (found,) = looks(fences, drifting, airspace=airspace)
            assert (found.holds == "A") is is_held


class TestHolds:
    @pytest.mark.parametrize(("lasted_s", "holds"), [(0.19, None), (0.2, "A")])
    def test_an_alarm_becomes_a_hold_after_its_time(
        self, lasted_s: float, holds: str | None
    ) -> None:
        (found,) = looks(fences, LEAVING, airspace=SITE, lasted_s=lasted_s)
        assert found.holds == holds

    @pytest.mark.parametrize(
        ("airspace", "place", "is_held"),
        [
            (SITE, (490.0, 0.0), False),
            (site(WALL), (260.0, 0.0), False),
            (drawn_round(300.0), (260.0, 0.0), True),
        ],
        ids=["boundary", "site's zone", "temporary zone"],
    )
    def test_a_site_may_leave_its_own_fences_to_an_alarm_and_no_temporary_zone(
        self, airspace: PreparedAirspace, place: tuple[float, float], is_held: bool
    ) -> None:
        coming = aircraft("A", place, velocity=(10.0, 0.0, 0.0))
        alarmed = in_context(coming, alarm_only=frozenset({FailsafeCondition.GEOFENCE}))
        assert [each.holds for each in looks(fences, coming, airspace=airspace)] == ["A"]
        expected = "A" if is_held else None
        assert [each.holds for each in looks(fences, alarmed, airspace=airspace)] == [expected]


class TestHeights:
    @pytest.mark.parametrize(("height_m", "count"), [(29.0, 0), (31.0, 1), (59.0, 1), (61.0, 0)])
    def test_a_keep_out_zone_is_between_its_floor_and_its_ceiling(
        self, height_m: float, count: int
    ) -> None:
        for airspace, ground_m in (
            (site(SLAB), 0.0),
            (site(over_the_ellipsoid(SLAB)), 0.0),
            (hill_in_the_north(SLAB), HILL_M),
        ):
            inside = aircraft("A", INSIDE, ground_m + height_m, home=FAR_HOME)
            assert len(looks(fences, inside, airspace=airspace)) == count

    def test_one_at_a_height_of_the_zone_hides_no_other_and_no_other_it(self) -> None:
        over = aircraft("A", INSIDE, 31.0)
        under = aircraft("B", (305.0, 5.0), 29.0)
        for order in ((over, under), (under, over)):
            found = looks(fences, *order, airspace=site(TREES))
            assert [each.serial for each in found] == ["B"]

    @pytest.mark.parametrize(
        ("height_m", "up_mps", "word"), [(4.7, 3.0, "lower"), (120.3, -3.0, "higher")]
    )
    def test_one_that_is_coming_back_into_the_limits_is_beyond_them_now(
        self, height_m: float, up_mps: float, word: str
    ) -> None:
        state = aircraft("A", (0.0, 0.0), height_m, (0.0, 0.0, up_mps), home=FAR_HOME)
        (found,) = looks(fences, state, airspace=SITE)
        assert f"is {word} above ground" in found.text

    @pytest.mark.parametrize(
        ("home", "count"),
        [
            ((300.0, 214.0), 0),
            ((286.0, 200.0), 0),
            ((300.0, 216.0), 1),
            ((284.0, 200.0), 1),
            ((-300.0, 200.0), 1),
            ((300.0, -200.0), 1),
        ],
    )
    def test_low_within_15_m_of_its_home_is_a_takeoff_or_a_landing(
        self, home: tuple[float, float], count: int
    ) -> None:
        low = aircraft("A", (300.0, 200.0), 3.0, home=home)
        assert len(looks(fences, low, airspace=SITE)) == count

    def test_of_several_that_are_low_those_near_home_and_landing_may_be(self) -> None:
        states = [
            aircraft("A", (0.0, 0.0), 3.0, home=(10.0, 0.0)),
            aircraft("B", (100.0, 0.0), 3.0, home=FAR_HOME),
            aircraft("C", (200.0, 0.0), 3.0, home=FAR_HOME),
            replace(aircraft("D", (250.0, 0.0), 3.0), takeoff_point=None),
        ]
        landing = in_context(states[2], intent=Intent(Commanded.LAND))
        found = looks(fences, states[0], states[1], landing, states[3], airspace=SITE)
        assert [each.serial for each in found] == ["B"]


class TestWayAhead:
    def corners_north_m(self, state: VehicleState, **settings: float) -> list[float]:
        now = picture(state, airspace=SITE)
        now = replace(now, settings=replace(now.settings, **settings))
        path = path_ahead(now, FRAME)
        assert path.triangles_m[0, :, 0] == pytest.approx([0.0] * 3, abs=1e-6)
        return [float(north_m) for north_m in path.triangles_m[0, :, 1]]

    def test_its_middle_is_at_half_its_time(self) -> None:
        """From 9 m/s: a second's reaction and 1.8 s of braking time, 1.25 times: 3.5 s."""
        state = aircraft("A", (100.0, 0.0), velocity=(9.0, 0.0, 0.0))
        expected = [100.0, 100.0 + 1.75 * 9.0, 100.0 + 3.5 * 9.0]
        assert self.corners_north_m(state) == pytest.approx(expected, abs=0.01)

    def test_it_ends_at_the_horizon(self) -> None:
        state = aircraft("A", (100.0, 0.0), velocity=(9.0, 0.0, 0.0))
        expected = [100.0, 100.0 + 9.0, 100.0 + 2.0 * 9.0]
        assert self.corners_north_m(state, horizon_s=2.0) == pytest.approx(expected, abs=0.01)
