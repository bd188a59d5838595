"""Photos of several cameras, by their clocks and by the satellites' time."""

from pathlib import Path

import pytest
from tests.product.made_flight import ONE, START_NS, UTC_AHEAD_NS, flight, times_s, write_photo

from recon.model.units import NS_PER_S
from recon.product.photos.photo import Photo, read_photo_facts
from recon.product.timing import StatedCamera, timed_photos

FLIGHT = flight()
AHEAD_S = {"CAM-1": 3_600, "CAM-2": -7_200}
"""Of two cameras' clocks below one drone."""


def cards(folder: Path, satellites_late_s: int = 0) -> list[Photo]:
    photos = []
    for number, at_s in enumerate(times_s(ONE)[::2].tolist()):
        east, north, _yaw = ONE.place(at_s)
        true_ns = UTC_AHEAD_NS + START_NS + round(at_s * NS_PER_S)
        camera = f"CAM-{1 + number % 2}"
        path = write_photo(
            folder / f"{number}.JPG",
            place_m=(float(east), float(north)),
            clock_ns=true_ns + AHEAD_S[camera] * NS_PER_S,
            camera=camera,
            satellites_ns=true_ns + satellites_late_s * NS_PER_S,
            size=(16, 12),
        )
        photos.append(read_photo_facts(path, path.name))
    return photos


def test_two_cameras_of_one_drone_each_have_their_clock(tmp_path: Path) -> None:
    found = timed_photos(FLIGHT, cards(tmp_path), StatedCamera())
    offsets = {each.camera.split()[-1]: each.offset_s for each in found.clocks}
    assert offsets == pytest.approx({name: -ahead for name, ahead in AHEAD_S.items()}, abs=0.8)
    assert found.warnings == []
    assert found.refused == {}


def test_photos_whose_satellites_state_another_time_are_warned_about(tmp_path: Path) -> None:
    found = timed_photos(FLIGHT, cards(tmp_path, 1_800), StatedCamera())
    (warning,) = found.warnings
    assert "another flight over the same rows" in warning
    assert "1800 s off" in warning or "1799 s off" in warning or "1801 s off" in warning
