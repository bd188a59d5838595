"""Flights of a survey above ground: its height is over the ground, not above takeoff."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely  # type: ignore[import-untyped, unused-ignore]
from tests.product.made_flight import HEIGHT_M, ONE, flight, track, write_record
from tests.product.test_timing import cards

from recon.product.exports import kml
from recon.product.flight import FlightData
from recon.product.flight_log import FlightLog
from recon.product.flight_reader import read_flight
from recon.product.report import flight_report
from recon.product.timing import StatedCamera, timed_photos

TAKEOFF_UP_M = 45.0
"""The pad's height above the field, so that rows are flown 15 m above takeoff."""


def above_ground(maps_every_s: float = 60.0) -> FlightData:
    """The rows of a made flight, flown 60 m above a field that lies 45 m below the pad."""
    made = flight(maps_every_s=maps_every_s)
    (survey,) = made.surveys
    survey = replace(survey, height_above_takeoff_m=None, height_above_ground_m=HEIGHT_M)
    flown = track(ONE)
    lower = replace(flown, height_m=np.full_like(flown.height_m, HEIGHT_M - TAKEOFF_UP_M))
    return replace(made, surveys=[survey], tracks={ONE.serial: lower})


def test_a_record_has_the_height_and_its_reference(tmp_path: Path) -> None:
    read = read_flight(write_record(above_ground(), tmp_path / "a.mcap"))
    (survey,) = read.surveys
    assert (survey.height_above_takeoff_m, survey.height_above_ground_m) == (None, HEIGHT_M)
    assert "60 m above ground, 8 m/s" in kml(read).decode()
    assert "60 m above takeoff, 8 m/s" in kml(flight()).decode()


def test_photos_show_what_lies_under_the_height_above_ground(tmp_path: Path) -> None:
    photos = cards(tmp_path)
    found, level = (
        timed_photos(made, photos, StatedCamera()) for made in (above_ground(), flight())
    )
    assert found.refused == {}
    for each, other in zip(found.photos, level.photos, strict=True):
        assert each.height_above_takeoff_m == pytest.approx(HEIGHT_M - TAKEOFF_UP_M)
        assert other.height_above_takeoff_m == pytest.approx(HEIGHT_M)
        shown, shown_level = (shapely.Polygon(timed.view.corners_m).area for timed in (each, other))
        assert shown == pytest.approx(shown_level)


def test_a_drone_on_its_pad_takes_no_photo_of_the_field(tmp_path: Path) -> None:
    made = above_ground()
    on_pad = replace(made.tracks[ONE.serial], height_m=np.zeros(len(made.tracks[ONE.serial].at_ns)))
    found = timed_photos(
        replace(made, tracks={ONE.serial: on_pad}), cards(tmp_path), StatedCamera()
    )
    assert found.photos == []
    assert "a photo on the ground" in next(iter(found.refused.values()))


def test_its_rows_are_of_the_report() -> None:
    covered = flight_report(above_ground(), FlightLog(), None).covered
    assert covered is not None
    assert covered.share(0) > 0.95
