"""The site as the API shows it: outlines in place, and bounded in number."""

from dataclasses import asdict, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples

from recon.api.schema import SiteView
from recon.geo import Polygon, enu_from_geo, thinned_ring
from recon.model.airspace import FlightLimits, Region, Zone, ZoneKind
from recon.model.geo import GeoPoint, LocalFrame
from recon.site import Layers, Site, default_site, demo_site_folder, load_site
from recon.station.api_views.site_view import MAX_CORNERS, MAX_RINGS, site_view

FRAME = LocalFrame(GeoPoint(45.0, -93.0, 280.0))


def star(corners: int, east_m: float = 0.0, teeth_m: float = 4.0) -> np.ndarray:
    angles = np.linspace(0.0, 2.0 * np.pi, corners, endpoint=False)
    radii = 200.0 + teeth_m * (np.arange(corners) % 2)
    return np.column_stack([east_m + radii * np.cos(angles), radii * np.sin(angles)])


def site_of(*regions: Region) -> Site:
    zones = tuple(
        Zone(f"zone {number}", ZoneKind.KEEP_OUT, region) for number, region in enumerate(regions)
    )
    return Site("many", FRAME, layers=Layers(zones=zones))


def local_m(rings: list[list[tuple[float, float]]], frame: LocalFrame) -> list[np.ndarray]:
    """Return each ring's corners in metres, the last one taken off; it must be the first."""
    assert all(ring[0] == ring[-1] for ring in rings)
    degrees = [np.array(ring[:-1]) for ring in rings]
    height_m = frame.origin.ellipsoid_height_m
    return [enu_from_geo(frame, d[:, 1], d[:, 0], height_m)[:, :2] for d in degrees]


def corner_count(view: SiteView) -> int:
    return sum(len(ring) - 1 for area in view.areas for ring in area.rings)


def test_the_demonstration_site_is_shown_whole() -> None:
    site = load_site(demo_site_folder())
    view = site_view(site)
    assert site.frame is not None
    assert (view.name, view.terrain) == ("demo field", "model")
    assert view.limits.model_dump() == asdict(site.limits)
    assert [layer.name for layer in view.layers] == [*site.layers.files, "elevation"]
    assert {layer.file for layer in view.layers} >= {"boundary.geojson", "ground.tif"}
    assert [(area.kind, area.name) for area in view.areas] == [
        ("boundary", "boundary"),
        ("keep_out", "farmyard"),
        ("height", "tree line"),
        ("survey", "west field"),
        ("survey", "south-east field"),
    ]
    trees = view.areas[2]
    assert (trees.floor_m, trees.ceiling_m, trees.datum) == (35.0, None, "ground")
    (outline_m,) = local_m(view.areas[0].rings, site.frame)
    assert site.layers.boundary is not None
    assert outline_m == pytest.approx(site.layers.boundary.outline_m, abs=0.02)
    assert (view.areas_excluded, view.areas_drawn_within_m) == (0, 0.0)
    assert [(pad.name, pad.serial, pad.altitude_m) for pad in view.pads][::8] == [
        ("Imager", "SIM-IMAGER", 275.0),
        ("spare", None, 275.0),
    ]


def test_no_site_has_the_default_limits_and_no_outlines() -> None:
    view = site_view(default_site())
    assert view.limits.model_dump() == asdict(FlightLimits())
    assert (view.terrain, view.layers, view.areas, view.pads) == ("flat assumed", [], [], [])


def test_it_is_made_once_for_each_site() -> None:
    site = site_of(Region(star(8)))
    assert site_view(site) is site_view(site)


def test_outlines_of_many_corners_are_thinned_by_as_much_as_is_stated() -> None:
    region = Region(star(6_000), (star(2_000, teeth_m=1.0) / 4.0,))
    view = site_view(site_of(region))
    assert corner_count(view) <= MAX_CORNERS
    assert 0.0 < view.areas_drawn_within_m <= 8.0
    drawn_m = local_m(view.areas[0].rings, FRAME)
    off_m = np.abs(Polygon(Region(drawn_m[0])).distance_to_edge_m(region.outline_m))
    assert off_m.max() <= view.areas_drawn_within_m + 0.02


def test_too_many_areas_are_counted_and_what_is_wished_for_goes_first() -> None:
    square = np.array([(0.0, 0.0), (5.0, 0.0), (5.0, 5.0), (0.0, 5.0)])
    site = site_of(*[Region(square + 10.0 * n) for n in range(300)])
    layers = replace(site.layers, boundary=Region(square), survey_regions={"s": Region(square)})
    view = site_view(replace(site, layers=layers))
    assert view.areas[0].kind == "boundary"
    assert {area.kind for area in view.areas[1:]} == {"keep_out"}
    assert len(view.areas) == MAX_RINGS
    assert view.areas_excluded == 302 - MAX_RINGS


def comb(teeth: int) -> np.ndarray:
    """Return an outline whose teeth nest like two hands: hard to thin without crossing itself."""
    turns = np.linspace(0.0, 20.0 * np.pi, teeth)
    out = np.column_stack([turns * np.cos(turns), turns * np.sin(turns)]) * 40.0
    back = out[::-1] * 0.98
    return np.concatenate([out[1:], back[:-1]])


def test_what_cannot_be_thinned_is_excluded() -> None:
    site = site_of(*[Region(comb(2_500)) for _ in range(8)])
    view = site_view(site)
    assert corner_count(view) <= MAX_CORNERS
    assert len(view.areas) + view.areas_excluded == 8


@settings(max_examples=examples(60), deadline=None)
@given(
    st.lists(st.integers(3, 3_000), min_size=1, max_size=130),
    st.floats(0.0, 150.0),
    st.integers(0, 3),
)
def test_it_is_never_too_much(counts: list[int], teeth_m: float, holes: int) -> None:
    regions = [
        Region(
            star(count, 500.0 * number, teeth_m),
            tuple(
                star(9, 0.0, 0.0) / 20.0 + (500.0 * number + 25.0 * h, 0.0) for h in range(holes)
            ),
        )
        for number, count in enumerate(counts)
    ]
    view = site_view(site_of(*regions))
    assert corner_count(view) <= MAX_CORNERS
    assert len(view.areas) + view.areas_excluded == len(counts)
    assert len(view.model_dump_json()) < 40_000


def test_a_ring_is_left_alone_without_a_tolerance() -> None:
    ring = star(50)
    assert thinned_ring(ring, 0.0) is ring
    assert len(thinned_ring(ring, 10.0)) < 50
