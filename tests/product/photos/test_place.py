"""Positions by EXIF and by XMP, with what is missing."""

import pytest
from PIL.ExifTags import GPS
from tests.product.photos.packets import packet

from recon.product.photos.photo_error import PhotoError
from recon.product.photos.place import place_of
from recon.product.photos.xmp import Xmp, read_xmp

NUMBERS = {GPS.GPSLatitude: (41, 54, 0), GPS.GPSLongitude: (93, 36, 0)}
SIDES = {GPS.GPSLatitudeRef: "N", GPS.GPSLongitudeRef: "W"}
HERE = (41.9, -93.6)


def by_xmp(names: tuple[str, str], place: tuple[str, str] = ("+41.9000", "-93.6000")) -> Xmp:
    return read_xmp(packet(dict(zip(names, place, strict=True))))


DJI_NAMES = ("drone-dji:GpsLatitude", "drone-dji:GpsLongitude")


def test_exif_alone_is_enough() -> None:
    found = place_of({**NUMBERS, **SIDES}, Xmp())
    assert (found.latitude_deg, found.longitude_deg) == pytest.approx(HERE)
    assert found.is_in_exif


@pytest.mark.parametrize(
    "names",
    [
        DJI_NAMES,
        ("drone-dji:GpsLatitude", "drone-dji:GpsLongtitude"),
        ("drone-dji:Latitude", "drone-dji:Longitude"),
    ],
)
@pytest.mark.parametrize("gps", [{}, NUMBERS, {GPS.GPSLatitude: (0, 0, 0)} | SIDES])
def test_xmp_states_what_exif_lacks(names: tuple[str, str], gps: dict[int, object]) -> None:
    found = place_of(gps, by_xmp(names))
    assert (found.latitude_deg, found.longitude_deg) == pytest.approx(HERE)
    assert (found.is_in_exif, found.note) == (False, "")


def test_xmp_in_the_words_of_exif_is_read() -> None:
    found = place_of(
        NUMBERS, by_xmp(("exif:GPSLatitude", "exif:GPSLongitude"), ("41,54N", "93,36,0.0W"))
    )
    assert (found.latitude_deg, found.longitude_deg) == pytest.approx(HERE)


def test_a_contradiction_is_named_and_xmp_counts() -> None:
    found = place_of(
        {**NUMBERS, GPS.GPSLatitudeRef: "N", GPS.GPSLongitudeRef: "E"}, by_xmp(DJI_NAMES)
    )
    assert (found.latitude_deg, found.longitude_deg) == pytest.approx(HERE)
    assert "the one of XMP is taken" in found.note


def test_metres_between_exif_and_xmp_are_no_contradiction() -> None:
    found = place_of({**NUMBERS, **SIDES}, by_xmp(DJI_NAMES, ("+41.9001", "-93.6001")))
    assert (found.is_in_exif, found.note) == (True, "")


@pytest.mark.parametrize(
    ("gps", "sentence"),
    [
        ({}, "expected EXIF with a position, got none"),
        (NUMBERS, r"expected GPSLatitudeRef \(N or S\) and GPSLongitudeRef \(E or W\) beside"),
        (NUMBERS | {GPS.GPSLatitudeRef: "N"}, r"expected GPSLongitudeRef \(E or W\) beside"),
        (NUMBERS | {GPS.GPSLatitude: (0, 0, 0), GPS.GPSLongitude: (0, 0, 0)}, "no GNSS fix"),
        (NUMBERS | SIDES | {GPS.GPSLatitude: (141, 0, 0)}, "position on earth"),
    ],
)
def test_without_a_position_what_is_missing_is_named(gps: dict[int, object], sentence: str) -> None:
    for xmp in (Xmp(), by_xmp(DJI_NAMES, ("+0.0", "+0.0")), by_xmp(DJI_NAMES, ("+95", "+7"))):
        with pytest.raises(PhotoError, match=sentence):
            place_of(gps, xmp)
