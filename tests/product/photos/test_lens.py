"""Fields of view by film equivalents, of whole and of cut pictures."""

from math import atan, degrees
from pathlib import Path

import pytest
from PIL.ExifTags import Base

from recon.product.photos.lens import field_deg
from recon.product.photos.photo import read_photo_facts


def field(make: str, model: str, film_mm: float, cols: int, rows: int) -> float | None:
    names = {Base.Make: make, Base.Model: model}
    return field_deg(names, {Base.FocalLengthIn35mmFilm: film_mm}, cols, rows)


def across(wide_mm: float, focal_mm: float) -> float:
    return degrees(2.0 * atan(wide_mm / 2.0 / focal_mm))


FOUR_TO_THREE_MM = 43.2666 * 0.8
"""Longer side of a 4:3 sensor with the diagonal of film."""


@pytest.mark.parametrize(
    ("camera", "size", "wide_mm"),
    [
        (("DJI", "FC300S", 20), (4000, 3000), FOUR_TO_THREE_MM),
        (("DJI", "FC300S", 20), (4000, 2250), FOUR_TO_THREE_MM),
        (("DJI", "FC300S", 20), (2250, 4000), FOUR_TO_THREE_MM),
        (("DJI", "FC300S", 20), (4000, 2664), FOUR_TO_THREE_MM),
        (("Hasselblad", "L2D-20c", 24), (5280, 2970), FOUR_TO_THREE_MM),
        (("DJI", "FC6310R", 24), (5472, 3648), 36.0),
        (("DJI", "FC6310R", 24), (5472, 3078), 36.0),
        (("DJI", "FC6310R", 24), (4864, 3648), 32.0),
        (("Hasselblad", "L1D-20c", 28), (5472, 3648), 36.0),
        (("Autel Robotics", "XT705", 29), (5472, 3078), 36.0),
        (("SONY", "ILCE-6000", 24), (6000, 4000), 36.0),
        (("SONY", "ILCE-6000", 24), (6000, 3376), 36.0),
        (("OLYMPUS", "E-M5", 24), (4608, 3456), FOUR_TO_THREE_MM),
    ],
)
def test_a_cut_picture_is_as_wide_as_its_sensor(
    camera: tuple[str, str, float], size: tuple[int, int], wide_mm: float
) -> None:
    assert field(*camera, *size) == pytest.approx(across(wide_mm, camera[2]), abs=0.05)


def test_a_picture_made_smaller_keeps_its_field() -> None:
    sensor = {
        Base.FocalLength: 8.8,
        Base.FocalPlaneXResolution: 5472 / 13.2,
        Base.FocalPlaneResolutionUnit: 4,
        Base.ExifImageWidth: 5472,
        Base.ExifImageHeight: 3648,
    }
    for cols, rows in ((5472, 3648), (1368, 912)):
        assert field_deg({}, sensor, cols, rows) == pytest.approx(across(13.2, 8.8), abs=0.01)


def test_a_real_wide_picture_is_as_wide_as_its_sensor(photos_data: Path) -> None:
    path = photos_data / "beach-phantom3/DJI_0024.JPG"
    found = read_photo_facts(path, path.name)
    assert (found.cols, found.rows) == (4000, 2250)
    assert found.across_deg == pytest.approx(81.7, abs=0.1)
