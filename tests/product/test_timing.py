"""Photos of several cameras, by their clocks and by the satellites' time."""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.product.made_flight import ONE, START_NS, UTC_AHEAD_NS, flight, times_s, write_photo

from recon.model.units import NS_PER_S
from recon.product.headings import COURSE, signed_deg
from recon.product.photos.photo import GimbalAttitude, Photo, read_photo_facts
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


@pytest.mark.parametrize(
    ("attitude", "pitch_deg"),
    [
        (GimbalAttitude(0.0, -90.0, 0.0), -90.0),
        # Rolled over and turned by as many: the same picture, stated the other way round.
        (GimbalAttitude(180.0, -88.0, 180.0), -92.0),
        (GimbalAttitude(-180.0, -90.0, -180.0), -90.0),
    ],
)
def test_a_gimbal_rolled_over_states_the_same_picture(
    tmp_path: Path, attitude: GimbalAttitude, pitch_deg: float
) -> None:
    # On the first row to the north the picture's top looks to the north.
    photos = [replace(each, attitude=attitude) for each in cards(tmp_path)[:5]]
    for timed in timed_photos(FLIGHT, photos, StatedCamera(-AHEAD_S["CAM-1"])).photos:
        assert signed_deg(timed.view.aim.yaw_deg) == pytest.approx(0.0)
        assert timed.view.aim.pitch_deg == pytest.approx(pitch_deg)
        assert timed.headings_deg[COURSE] == pytest.approx(0.0, abs=1.0)


def test_a_gimbal_that_contradicts_all_others_is_not_believed(tmp_path: Path) -> None:
    wrong = GimbalAttitude(53.0, -90.0)
    photos = [replace(each, attitude=wrong, flight_yaw_deg=1.0) for each in cards(tmp_path)[:5]]
    found = timed_photos(FLIGHT, photos, StatedCamera(-AHEAD_S["CAM-1"])).photos
    assert len(found) > 0
    assert all(abs(signed_deg(each.view.aim.yaw_deg)) < 3.0 for each in found)
