"""What speaks against photos made on purpose: each reason alone, and none for good ones."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image
from tests.product.made_flight import HEIGHT_M, ONE, SPEED_MPS, START_NS, flight, times_s

from recon.model.units import NS_PER_S
from recon.product.footprint import Aim, PhotoView
from recon.product.photos.look import Look, look_of
from recon.product.photos.photo import GimbalAttitude, Photo
from recon.product.quality import BLANK_DETAIL, quality_of
from recon.product.shot_files import ShotFiles
from recon.product.timing import TimedPhoto

FLIGHT = flight()
GOOD = Look(0.08, 0.001, 0.01)
PHOTO = Photo(
    Path("x.JPG"), "x", 4000, 3000, 1, ("DJI", "M", "1"), 0, 1.0, 41.9, -93.6, None, 66.0, None,
    60.0,
    look=GOOD, exposure_s=1 / 1000, size_bytes=8_000_000,
)  # fmt: skip
ODD = 11


def files(**odd: object) -> ShotFiles:
    """A flight's photos, of which one differs in its facts, or in its `aim`; all lack a look if it
    does."""
    found = ShotFiles()
    for number, at_s in enumerate(times_s(ONE)[:40].tolist()):
        east, north, yaw = (float(each) for each in ONE.place(at_s))
        aim, facts = Aim(east, north, HEIGHT_M, yaw), dict(odd) if number == ODD else {}
        aim = replace(aim, **facts.pop("aim", {}))
        looks = {"look": None} if odd.get("look", GOOD) is None else {}
        photo = replace(PHOTO, name=f"{number}", **looks | facts)
        at_ns = START_NS + round(at_s * NS_PER_S)
        view = PhotoView(aim, 66.0, photo.cols, photo.rows)
        found.photos.append(TimedPhoto(photo, ONE.serial, at_ns, 0.1, view, aim.height_m))
        found.shot[photo.name] = photo.name
    return found


def test_nothing_speaks_against_good_photos() -> None:
    assert quality_of(FLIGHT, files()) == {}
    assert quality_of(FLIGHT, files(look=None, exposure_s=None)) == {}


PX_PER_M = 4000 / (2 * HEIGHT_M * np.tan(np.deg2rad(33.0)))


@pytest.mark.parametrize(
    ("odd", "reason"),
    [
        ({"exposure_s": 1 / 60}, f"moved {SPEED_MPS / 60 * PX_PER_M:.1f} pixels"),
        ({"look": Look(0.02, 0.0, 0.0)}, "blurred: 25 % of its neighbours' detail"),
        ({"look": None, "size_bytes": 3_000_000}, "perhaps blurred: its file has 38 % of its"),
        ({"look": replace(GOOD, white=0.3)}, "30 % of it is white"),
        ({"look": replace(GOOD, black=0.7)}, "70 % of it is black"),
        ({"aim": {"pitch_deg": -55.0}}, "looks 35 degrees off straight down"),
        ({"attitude": GimbalAttitude(0.0, -90.0, 30.0)}, "looks 30 degrees off straight down"),
        ({"aim": {"height_m": 25.0}}, "taken at 25 m, most at 60 m: on the way"),
        ({"aim": {"east_m": -400.0}}, "shows nothing of the surveys' regions: on the way"),
    ],
)
def test_each_reason_is_named_for_the_photo_that_has_it(odd: dict, reason: str) -> None:
    found = quality_of(FLIGHT, files(**odd))
    assert found.keys() == {str(ODD)}
    assert found[str(ODD)].startswith(reason)


def test_a_blank_photo_is_called_blank_and_no_measure_for_its_neighbours() -> None:
    blank = replace(GOOD, detail=0.0)
    said = "blank: its picture shows no detail"
    assert quality_of(FLIGHT, files(look=blank)) == {str(ODD): said}
    among_blank = files()
    for number, each in enumerate(among_blank.photos):
        look = blank if number != ODD else GOOD
        among_blank.photos[number] = replace(each, photo=replace(each.photo, look=look))
    names = {each.photo.name for each in among_blank.photos}
    assert quality_of(FLIGHT, among_blank) == dict.fromkeys(names - {str(ODD)}, said)


def test_half_the_detail_and_a_gimbal_turned_over_are_no_faults() -> None:
    assert quality_of(FLIGHT, files(look=replace(GOOD, detail=0.045))) == {}
    assert quality_of(FLIGHT, files(attitude=GimbalAttitude(0.0, -90.0, 180.0))) == {}
    assert quality_of(FLIGHT, files(kind="thermal", look=replace(GOOD, white=0.3))) == {}


def scene(cols: int, rows: int) -> np.ndarray:
    random = np.random.default_rng(4)
    coarse = random.integers(60, 190, (rows // 4, cols // 4), dtype=np.uint8)
    return cv2.resize(coarse, (cols, rows), interpolation=cv2.INTER_CUBIC)


def look(path: Path, pixels: np.ndarray, **how: object) -> Look:
    Image.fromarray(pixels).save(path, quality=90, **how)
    with Image.open(path) as image:
        found = look_of(image, path.read_bytes())
    assert found is not None
    return found


def test_blur_and_exposure_are_seen_in_small_pictures(tmp_path: Path) -> None:
    sharp = scene(640, 480)
    good = look(tmp_path / "a.jpg", sharp)
    blurred = look(tmp_path / "b.jpg", cv2.GaussianBlur(sharp, (0, 0), 6.0))
    assert BLANK_DETAIL < blurred.detail < 0.3 * good.detail
    assert look(tmp_path / "f.jpg", np.full_like(sharp, 128)).detail < BLANK_DETAIL
    darker = look(tmp_path / "c.jpg", sharp // 2)
    assert darker.detail == pytest.approx(good.detail, rel=0.1)
    bright = sharp.copy()
    bright[:, :160] = 255
    assert look(tmp_path / "d.jpg", bright).white == pytest.approx(0.25, abs=0.02)
    band = look(tmp_path / "e.tif", sharp.astype(np.uint16) << 8)
    assert band.detail == pytest.approx(good.detail, rel=0.1)


def test_a_bands_black_level_counts_as_black(tmp_path: Path) -> None:
    path = tmp_path / "a.tif"
    Image.fromarray(3_200 + scene(320, 240).astype(np.uint16)).save(path)
    with Image.open(path) as image:
        found = look_of(image, path.read_bytes(), 3_200.0)
    assert found is not None
    assert found.black == 1.0


def test_a_large_picture_is_judged_by_its_preview(tmp_path: Path) -> None:
    large, small = scene(2400, 1800), scene(640, 480)
    path = tmp_path / "a.jpg"
    Image.fromarray(large).save(
        path, format="MPO", save_all=True, append_images=[Image.fromarray(small)], quality=90
    )
    with Image.open(path) as image:
        found = look_of(image, path.read_bytes())
    assert found is not None
    assert found.detail == pytest.approx(look(tmp_path / "b.jpg", small).detail, rel=0.05)
    Image.fromarray(large).save(path, quality=90)
    with Image.open(path) as image:
        assert look_of(image, path.read_bytes()) is None


def test_the_bars_of_a_preview_are_not_black_ground(photos_data: Path) -> None:
    path = photos_data / "beach-phantom3/DJI_0024.JPG"
    with Image.open(path) as image:
        found = look_of(image, path.read_bytes())
    assert found is not None
    assert found.black < 0.05
