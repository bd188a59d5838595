"""The local frame against PROJ's own topocentric chain, and against itself."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Transformer

from recon.geo import (
    enu_from_geo,
    enu_from_point,
    enu_from_points,
    geo_from_enu,
    point_from_enu,
    shift_east_north_m,
)
from recon.geo.local_frame import meridian_radius_m, prime_vertical_radius_m
from recon.model.geo import GeoPoint, LocalFrame

latitudes = st.floats(-89.9, 89.9)
longitudes = st.floats(-180.0, 180.0)
heights = st.floats(-400.0, 5000.0)


def proj_topocentric(origin: GeoPoint) -> Transformer:
    return Transformer.from_pipeline(
        "+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad "
        "+step +proj=cart +ellps=WGS84 "
        f"+step +proj=topocentric +ellps=WGS84 +lat_0={origin.latitude_deg} "
        f"+lon_0={origin.longitude_deg} +h_0={origin.ellipsoid_height_m}"
    )


@pytest.mark.parametrize(
    "origin",
    [
        GeoPoint(45.345, -93.859, 288.0),
        GeoPoint(-33.9, 151.2, 20.0),
        GeoPoint(0.0, 0.0, 0.0),
        GeoPoint(80.0, 179.9999, 3000.0),
    ],
)
def test_agrees_with_proj_within_a_tenth_of_a_millimetre(origin: GeoPoint) -> None:
    rng = np.random.default_rng(1)
    latitude = np.clip(origin.latitude_deg + rng.uniform(-0.05, 0.05, 200), -90, 90)
    longitude = origin.longitude_deg + rng.uniform(-0.05, 0.05, 200)
    height = rng.uniform(-100, 2000, 200)
    ours = enu_from_geo(LocalFrame(origin), latitude, longitude, height)
    theirs = np.stack(proj_topocentric(origin).transform(longitude, latitude, height), axis=-1)
    assert np.abs(ours - theirs).max() < 1e-4


@given(latitudes, longitudes, heights, st.lists(st.floats(-20e3, 20e3), min_size=3, max_size=3))
def test_there_and_back_is_the_same_point(
    latitude: float, longitude: float, height: float, offset: list[float]
) -> None:
    frame = LocalFrame(GeoPoint(latitude, longitude, height))
    back = enu_from_geo(frame, *geo_from_enu(frame, [offset]))
    assert np.abs(back[0] - offset).max() < 1e-6


@given(latitudes, longitudes, heights)
def test_the_axes_point_east_north_and_up(latitude: float, longitude: float, height: float) -> None:
    origin = GeoPoint(latitude, longitude, height)
    frame = LocalFrame(origin)
    assert np.abs(enu_from_point(frame, origin)).max() < 1e-6
    east = point_from_enu(frame, [10.0, 0.0, 0.0])
    north = point_from_enu(frame, [0.0, 10.0, 0.0])
    up = point_from_enu(frame, [0.0, 0.0, 10.0])
    assert (east.longitude_deg - longitude) % 360.0 < 90.0
    assert north.latitude_deg > latitude
    assert up.ellipsoid_height_m == pytest.approx(height + 10.0, abs=1e-6)


def test_scalars_give_one_row_and_arrays_broadcast() -> None:
    frame = LocalFrame(GeoPoint(45.0, -93.0, 0.0))
    assert enu_from_geo(frame, 45.0, -93.0, 5.0).shape == (1, 3)
    assert enu_from_geo(frame, [45.0, 45.1], -93.0, 5.0).shape == (2, 3)
    assert np.isnan(enu_from_geo(frame, float("nan"), -93.0, 5.0)).all()


def test_curvature_radii_at_the_equator_and_the_pole() -> None:
    at = np.deg2rad(np.array([0.0, 90.0]))
    polar_radius_m = 6_399_593.6258
    assert prime_vertical_radius_m(at) == pytest.approx([6_378_137.0, polar_radius_m])
    assert meridian_radius_m(at) == pytest.approx([6_335_439.3273, polar_radius_m])


def test_the_poles_convert_back() -> None:
    frame = LocalFrame(GeoPoint(90.0, 0.0, 100.0))
    latitude, _, height = geo_from_enu(frame, [[0.0, 0.0, 5.0]])
    assert latitude[0] == pytest.approx(90.0)
    assert height[0] == pytest.approx(105.0, abs=1e-6)


def test_many_points_and_none() -> None:
    frame = LocalFrame(GeoPoint(45.0, -93.0, 10.0))
    points = [GeoPoint(45.001, -93.0, 10.0), GeoPoint(45.0, -92.999, 15.0)]
    enu = enu_from_points(frame, points)
    assert enu[0] == pytest.approx(enu_from_point(frame, points[0]))
    assert enu[1] == pytest.approx(enu_from_point(frame, points[1]))
    assert enu_from_points(frame, []).shape == (0, 3)


@given(st.floats(-2e3, 2e3), st.floats(-2e3, 2e3))
def test_a_shift_is_east_and_north_between_two_places(east_m: float, north_m: float) -> None:
    frame = LocalFrame(GeoPoint(45.0, -93.0, 10.0))
    start = point_from_enu(frame, [100.0, -50.0, 0.0])
    end = point_from_enu(frame, [100.0 + east_m, -50.0 + north_m, 0.0])
    assert shift_east_north_m(frame, start, end) == pytest.approx([east_m, north_m], abs=2e-3)
