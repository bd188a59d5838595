"""One point at a time: the same as all at once."""

from math import isnan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.geo import enu_from_geo, geo_from_enu, tangent_plane
from recon.model.geo import GeoPoint, LocalFrame

NEAR_M = 20_000.0
metres = st.floats(-NEAR_M, NEAR_M)
origins = st.builds(
    GeoPoint, st.floats(-89.0, 89.0), st.floats(-180.0, 180.0), st.floats(-400.0, 5_000.0)
)


@given(origins, metres, metres, st.floats(-500.0, 5_000.0))
def test_a_place_is_where_the_arrays_have_it(
    origin: GeoPoint, east_m: float, north_m: float, up_m: float
) -> None:
    frame = LocalFrame(origin)
    latitude, longitude, height = geo_from_enu(frame, (east_m, north_m, up_m))
    place = tangent_plane(frame).place(east_m, north_m, up_m)
    assert place[0] == pytest.approx(latitude[0], abs=1e-12)
    assert place[1] == pytest.approx(longitude[0], abs=1e-9)
    assert place[2] == pytest.approx(height[0], abs=1e-7)


@given(origins, st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.floats(-500.0, 5_000.0))
def test_a_point_is_where_the_arrays_have_it(
    origin: GeoPoint, north_deg: float, east_deg: float, height_m: float
) -> None:
    frame = LocalFrame(origin)
    latitude, longitude = origin.latitude_deg + north_deg, origin.longitude_deg + east_deg
    expected = enu_from_geo(frame, latitude, longitude, height_m)[0]
    assert tangent_plane(frame).enu_m(latitude, longitude, height_m) == pytest.approx(
        tuple(expected), abs=1e-8
    )


@given(origins, metres, metres, st.floats(-500.0, 5_000.0))
def test_there_and_back(origin: GeoPoint, east_m: float, north_m: float, up_m: float) -> None:
    plane = tangent_plane(LocalFrame(origin))
    back = plane.enu_m(*plane.place(east_m, north_m, up_m))
    assert back == pytest.approx((east_m, north_m, up_m), abs=1e-6)


def test_what_is_not_a_number_stays_none() -> None:
    plane = tangent_plane(LocalFrame(GeoPoint(45.0, -93.0, 300.0)))
    assert all(isnan(part) for part in plane.enu_m(np.nan, -93.0, 300.0))
    assert all(isnan(part) for part in plane.place(np.nan, 0.0, 0.0))
