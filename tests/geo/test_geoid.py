"""Sea level by EGM96: published values of its grid, and the edges of the table."""

import pytest

from recon.geo.geoid import ERROR_99_M, geoid_height_m


@pytest.mark.parametrize(
    ("latitude_deg", "longitude_deg", "height_m"),
    [
        # Values of EGM96's grid of 15 minutes at whole degrees: kept to the centimetre.
        (90.0, 0.0, 13.61),
        (0.0, 0.0, 17.16),
        (-90.0, 17.0, -29.53),
    ],
)
def test_at_whole_degrees_it_is_the_grids(
    latitude_deg: float, longitude_deg: float, height_m: float
) -> None:
    assert geoid_height_m(latitude_deg, longitude_deg) == pytest.approx(height_m, abs=0.005)


@pytest.mark.parametrize(
    ("latitude_deg", "longitude_deg", "height_m"),
    [
        # NGA's test values for its own interpolation (INPUT.DAT and OUTF477.DAT).
        (38.6281550, 269.7791550, -31.628),
        (-14.6212170, 305.0211140, -2.969),
        (46.8743190, 102.4487290, -43.575),
        (-23.6174460, 133.8747120, 15.871),
        (38.6254730, 359.9995000, 50.066),
        (-0.4667440, 0.0023000, 17.329),
    ],
)
def test_between_them_it_is_within_what_is_stated(
    latitude_deg: float, longitude_deg: float, height_m: float
) -> None:
    assert geoid_height_m(latitude_deg, longitude_deg) == pytest.approx(height_m, abs=ERROR_99_M)


def test_it_goes_on_over_the_date_line_and_greenwich() -> None:
    for latitude in (-90.0, -45.3, 0.0, 89.999, 90.0):
        assert geoid_height_m(latitude, 180.0) == pytest.approx(geoid_height_m(latitude, -180.0))
        assert geoid_height_m(latitude, 360.0) == pytest.approx(geoid_height_m(latitude, 0.0))
        assert abs(geoid_height_m(latitude, -1e-9) - geoid_height_m(latitude, 1e-9)) < 1e-6
