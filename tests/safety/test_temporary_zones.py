"""Temporary zones in the airspace: what may be drawn, and that it is kept out of like any other."""

from dataclasses import replace
from math import cos, pi

import numpy as np
import pytest
from tests.safety.fenced import (
    FRAME,
    airspace,
    asked,
    flier,
    hills,
    keep_out_zone,
    mission,
    place,
    reason,
    square,
)

from recon.model.airspace import HeightDatum, ZoneKind
from recon.model.geo import LatLon
from recon.model.temporary_zone import (
    DEFAULT_CEILING_M,
    Circle,
    DrawnZone,
    Outline,
    TemporaryZone,
    TemporaryZoneKind,
)
from recon.safety import OPEN_AIRSPACE, PreparedAirspace
from recon.safety.rules.keep_out import keep_out
from recon.safety.temporary_zones import (
    CIRCLE_CORNERS,
    MOST_CORNERS,
    drawn_fault,
    drawn_region,
    prepared_temporary_zone,
)

PERSON = DrawnZone(
    TemporaryZoneKind.PERSON, Circle(place(150.0, 0.0), 20.0), "checks a sprinkler", ceiling_m=30.0
)
SITE = airspace(keep_out_zone(square(400.0, -50.0, 500.0, 50.0)), elevation=hills(np.zeros((9, 9))))


def outline(*corners_m: tuple[float, float]) -> Outline:
    return Outline(tuple(place(east_m, north_m) for east_m, north_m in corners_m))


def in_force(drawn: DrawnZone = PERSON) -> TemporaryZone:
    return TemporaryZone(3, drawn, "anna", 0)


def with_zone(drawn: DrawnZone = PERSON, air: PreparedAirspace = SITE) -> PreparedAirspace:
    return air.with_temporary_zones([prepared_temporary_zone(in_force(drawn), FRAME)])


def fault(**changes: object) -> str:
    return drawn_fault(replace(PERSON, **changes), FRAME) or ""  # type: ignore[arg-type]


class TestInTheAirspace:
    def test_it_stands_beside_the_sites_own_zones(self) -> None:
        names = [zone.zone.name for zone in with_zone().zones_of(ZoneKind.KEEP_OUT)]
        assert names == ["yard", "person 3 (temporary)"]
        assert [zone.name for zone in with_zone().airspace.zones] == names
        (temporary,) = with_zone().temporary_zones
        assert temporary.zone.name == "person 3 (temporary)"
        assert SITE.temporary_zones == ()

    def test_the_next_set_replaces_the_temporary_zones_only(self) -> None:
        ended = with_zone().with_temporary_zones([])
        assert [zone.zone.name for zone in ended.zones] == ["yard"]

    def test_ground_boundary_and_the_sites_zones_are_not_prepared_again(self) -> None:
        fenced = airspace(boundary=square(-900.0, -900.0, 900.0, 900.0))
        changed = with_zone(air=fenced)
        assert changed.boundary is fenced.boundary
        assert with_zone().zones[0] is SITE.zones[0]
        assert with_zone()._ground is SITE._ground
        assert [zone.zone.name for zone in SITE.zones] == ["yard"]

    def test_without_a_frame_there_is_no_place_for_one(self) -> None:
        assert OPEN_AIRSPACE.with_temporary_zones([]).zones == ()
        with pytest.raises(ValueError, match=r"^expected a frame for temporary zones, got none$"):
            with_zone(air=OPEN_AIRSPACE)

    @pytest.mark.parametrize(
        "heights_m", [(None, 30.0), (10.0, None), (10.0, 30.0), (0.0, None), (None, None)]
    )
    def test_its_heights_are_above_ground(
        self, heights_m: tuple[float | None, float | None]
    ) -> None:
        floor_m, ceiling_m = heights_m
        drawn = replace(PERSON, floor_m=floor_m, ceiling_m=ceiling_m)
        zone = prepared_temporary_zone(in_force(drawn), FRAME).zone
        assert (zone.floor_m, zone.ceiling_m) == heights_m
        assert zone.datum is (None if heights_m == (None, None) else HeightDatum.GROUND)

    def test_a_circle_is_never_drawn_smaller_and_hardly_larger(self) -> None:
        ring_m = drawn_region(PERSON, FRAME).outline_m
        middles_m = (ring_m + np.roll(ring_m, 1, axis=0)) / 2.0
        from_centre_m = np.hypot(*(middles_m - [150.0, 0.0]).T)
        assert from_centre_m == pytest.approx(20.0, abs=1e-3)
        corners_m = np.hypot(*(ring_m - [150.0, 0.0]).T)
        assert corners_m == pytest.approx(20.0 / cos(pi / CIRCLE_CORNERS), abs=1e-3)

    def test_people_and_machines_are_cleared_below_go_home_heights_aircraft_at_all(self) -> None:
        assert DEFAULT_CEILING_M == {
            TemporaryZoneKind.PERSON: 30.0,
            TemporaryZoneKind.TRACTOR: 30.0,
            TemporaryZoneKind.CREWED_AIRCRAFT: None,
        }


class TestAtTheGate:
    def test_a_path_through_it_is_refused_by_its_name(self) -> None:
        body = mission((90.0, 0.0, 25.0), (300.0, 0.0, 25.0))
        assert asked(keep_out, body, SITE, flier(0.0, 0.0, 25.0)) is None
        text = reason(asked(keep_out, body, with_zone(), flier(0.0, 0.0, 25.0)))
        assert text.startswith(
            "A: leg 1 to 2 goes through the keep-out zone 'person 3 (temporary)' (up to 30 m above"
        )

    def test_the_route_home_above_its_ceiling_is_no_reason_to_refuse(self) -> None:
        body = mission((220.0, 0.0, 25.0), (300.0, 0.0, 25.0))
        beyond = flier(220.0, 0.0, 25.0, go_home_m=60.0)
        assert asked(keep_out, body, with_zone(), beyond) is None
        aircraft = replace(PERSON, kind=TemporaryZoneKind.CREWED_AIRCRAFT, ceiling_m=None)
        text = reason(asked(keep_out, body, with_zone(aircraft), beyond))
        assert "the route home" in text
        assert "crewed aircraft 3 (temporary)" in text

    def test_a_vehicle_in_it_may_be_led_out_and_not_deeper(self) -> None:
        inside = flier(160.0, 0.0, 25.0)
        out, deeper = mission((160.0, 0.0, 25.0), (250.0, 0.0, 25.0)), mission((150.0, 0.0, 25.0))
        assert asked(keep_out, mission((250.0, 0.0, 25.0)), with_zone(), inside) is None
        assert asked(keep_out, deeper, with_zone(), inside) is not None
        assert asked(keep_out, out, with_zone(), inside) is not None


class TestWhatMayBeDrawn:
    def test_a_circle_and_a_polygon(self) -> None:
        assert drawn_fault(PERSON, FRAME) is None
        corners = outline((0.0, 0.0), (50.0, 0.0), (50.0, 50.0))
        assert fault(shape=corners, floor_m=10.0, lasts_s=600.0) == ""

    @pytest.mark.parametrize(
        "changes",
        [
            {"reason": "x"},
            {"reason": "x" * 200},
            {"lasts_s": 10.0},
            {"lasts_s": 86_400.0},
            {"lasts_s": None},
            {"floor_m": 0.0, "ceiling_m": 1_000.0},
            {"floor_m": 1_000.0, "ceiling_m": None},
            {"floor_m": None, "ceiling_m": 0.5},
        ],
    )
    def test_the_limits_themselves_are_possible(self, changes: dict[str, object]) -> None:
        assert fault(**changes) == ""

    @pytest.mark.parametrize("text", ["", "  ", "x" * 201])
    def test_a_reason_is_needed(self, text: str) -> None:
        assert fault(reason=text).startswith("a reason of 1 to 200 characters is needed")

    @pytest.mark.parametrize(("radius_m", "is_taken"), [(1.0, True), (2_000.0, True), (0.9, False)])
    def test_the_radius_has_limits(self, radius_m: float, is_taken: bool) -> None:
        text = fault(shape=Circle(place(0.0, 0.0), radius_m))
        assert text == "" if is_taken else "1 to 2000 m are possible" in text

    @pytest.mark.parametrize("radius_m", [float("nan"), float("inf"), 2_000.1, -5.0])
    def test_a_radius_that_is_no_size_is_refused(self, radius_m: float) -> None:
        assert fault(shape=Circle(place(0.0, 0.0), radius_m)).startswith("its radius is ")

    @pytest.mark.parametrize("latitude_deg", [float("nan"), float("inf"), 91.0])
    def test_so_is_a_place_off_the_globe(self, latitude_deg: float) -> None:
        text = fault(shape=Circle(LatLon(latitude_deg, 0.0), 20.0))
        assert text.startswith("a place of it is not on the globe")

    def test_a_place_far_from_the_site_is_refused(self) -> None:
        assert fault(shape=Circle(place(9_900.0, 0.0), 20.0)) == ""
        text = fault(shape=Circle(place(60_000.0, 0.0), 20.0))
        assert text == (
            "it is 60.0 km from the site's origin: 10 km at most are possible; check latitude and "
            "longitude"
        )

    def test_a_polygon_needs_corners_and_not_too_many(self) -> None:
        turns = np.linspace(0.0, 2.0 * pi, MOST_CORNERS + 1, endpoint=False)
        round_m = [(50.0 * np.cos(turn), 50.0 * np.sin(turn)) for turn in turns]
        assert fault(shape=outline(*round_m[:-1])) == ""
        assert fault(shape=outline(*round_m)) == "it has 65 corners: 3 to 64 are possible"
        assert fault(shape=outline((0.0, 0.0), (9.0, 0.0))).startswith("it has 2 corners")

    def test_a_polygon_whose_edges_cross_is_refused_with_the_place(self) -> None:
        bow = outline((0.0, 0.0), (50.0, 50.0), (50.0, 0.0), (0.0, 50.0))
        assert fault(shape=bow) == (
            "its outline cannot be used: its edges cross or overlap, 25.0 m east and 25.0 m north "
            "of the origin"
        )

    def test_a_polygon_that_is_too_large_is_refused(self) -> None:
        large = outline((-2_100.0, 0.0), (2_100.0, 0.0), (0.0, 50.0))
        assert fault(shape=large) == (
            "it is 4200 m across: 4000 m at most are possible; to clear more, use the all stop"
        )

    @pytest.mark.parametrize("far_m", [-8_000.0, 8_000.0])
    def test_far_from_the_origin_a_polygon_may_be_as_large_as_anywhere(self, far_m: float) -> None:
        east = outline((far_m, 0.0), (far_m + 1_000.0, 0.0), (far_m, 1_000.0))
        north = outline((0.0, far_m), (0.0, far_m + 1_000.0), (1_000.0, far_m))
        assert fault(shape=east) == fault(shape=north) == ""

    def test_a_corner_off_the_globe_is_refused(self) -> None:
        corners = Outline((place(0.0, 0.0), place(9.0, 0.0), LatLon(0.0, float("nan"))))
        assert fault(shape=corners).startswith("a place of it is not on the globe")

    @pytest.mark.parametrize("height_m", [-1.0, 1_001.0, float("nan")])
    @pytest.mark.parametrize("end", ["floor", "ceiling"])
    def test_heights_have_limits(self, end: str, height_m: float) -> None:
        text = fault(**{"ceiling_m": None, f"{end}_m": height_m})
        assert text.startswith(f"its {end} is {height_m:g} m: 0 to 1000 m above ground")

    def test_the_ceiling_is_above_the_floor(self) -> None:
        assert fault(floor_m=30.0) == "its ceiling of 30 m is not above its floor of 30 m"
        assert fault(ceiling_m=0.0) == "its ceiling of 0 m is not above its floor of 0 m"
        assert fault(floor_m=29.0) == ""

    @pytest.mark.parametrize("lasts_s", [9.0, 86_401.0, float("nan"), float("inf")])
    def test_it_lasts_a_day_at_most_or_without_end(self, lasts_s: float) -> None:
        assert fault(lasts_s=lasts_s) == (
            f"it would last {lasts_s:g} s: 10 to 86400 s are possible, or no end at all"
        )
