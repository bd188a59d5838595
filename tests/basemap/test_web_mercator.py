"""Tiles of Web Mercator: by the known numbers of places, and areas by counting."""

import numpy as np
import pytest
import shapely
from tests.basemap.made_maps import FIELD

from recon.basemap.web_mercator import (
    MOST_TILES,
    MapArea,
    area_around,
    globe_from_world,
    metres_per_pixel,
    tile_bounds_deg,
    world_from_globe,
    zoom_for,
)
from recon.geo import enu_from_geo
from recon.model.airspace import Region
from recon.model.geo import GeoPoint, LocalFrame

FRAME = LocalFrame(GeoPoint(41.9, -93.6, 275.0))


def test_two_cities_have_their_well_known_tiles() -> None:
    world = world_from_globe([-0.1275, 139.7006793], [51.507222, 35.6590699])
    assert np.floor(world[0] * 2**10).tolist() == [511, 340]
    assert np.floor(world[1] * 2**18).tolist() == [232798, 103246]


def test_world_and_globe_are_inverse() -> None:
    places = np.array([[-180.0, 85.0], [0.0, 0.0], [12.5, -47.25], [179.999, -85.0]])
    assert globe_from_world(world_from_globe(*places.T)) == pytest.approx(places, abs=1e-9)


def test_a_tile_lies_between_its_neighbours() -> None:
    west, south, east, north = tile_bounds_deg(17, 31458, 48724)
    assert tile_bounds_deg(17, 31459, 48724)[0] == east
    assert tile_bounds_deg(17, 31458, 48725)[3] == south
    assert (east - west) == pytest.approx(360.0 / 2**17)
    assert south < north


def test_pixels_have_the_usual_size() -> None:
    assert metres_per_pixel(0.0, 0) == pytest.approx(156_543.03, abs=0.01)
    assert metres_per_pixel(60.0, 19, 512) == pytest.approx(156_543.03 / 2**21, rel=1e-6)
    assert zoom_for(0.0, 0.3) == 19
    assert zoom_for(0.0, 0.0) == 24


@pytest.mark.parametrize("zoom", [14, 17, 19])
def test_the_shares_of_the_tiles_over_an_area_are_its_whole(zoom: int) -> None:
    triangle = MapArea(((-93.604, 41.900), (-93.600, 41.9004), (-93.6017, 41.903)))
    tiles = triangle.tiles(zoom)
    assert tiles is not None
    assert tiles.shares.sum() == pytest.approx(1.0)
    ring = shapely.Polygon(world_from_globe(*np.array(triangle.ring_deg).T))
    for col, row, share in zip(tiles.cols, tiles.rows, tiles.shares, strict=True):
        corners = np.array([[col, row], [col + 1, row + 1]]) / 2.0**zoom
        inside = ring.intersection(shapely.box(*corners.ravel())).area / ring.area
        assert share == pytest.approx(inside, abs=1e-9)


def test_an_area_with_too_many_tiles_is_not_listed() -> None:
    state = MapArea(((-96.0, 40.5), (-91.0, 40.5), (-91.0, 43.5), (-96.0, 43.5)))
    assert state.most_tiles(20) > MOST_TILES
    assert state.tiles(20) is None
    assert FIELD.tiles(20) is not None


def test_the_area_is_the_boundary_with_its_margin_or_what_is_in_reach() -> None:
    outline = np.array([[-200.0, -100.0], [200.0, -100.0], [200.0, 100.0], [-200.0, 100.0]])
    for boundary, reach_m, expected in [
        (Region(outline), 900.0, [(-300.0, 300.0), (-200.0, 200.0)]),
        (None, 900.0, [(-1000.0, 1000.0), (-1000.0, 1000.0)]),
    ]:
        area = area_around(FRAME, boundary, reach_m, margin_m=100.0)
        longitude, latitude = np.array(area.ring_deg).T
        corners = enu_from_geo(FRAME, latitude, longitude, np.full(len(latitude), 275.0))
        for axis, (low_m, high_m) in enumerate(expected):
            assert corners[:, axis].min() == pytest.approx(low_m, abs=3.0)
            assert corners[:, axis].max() == pytest.approx(high_m, abs=3.0)
