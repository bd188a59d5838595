"""Photos of reflectance panels: marked by the camera, with a code, or a bright square."""

import csv
from pathlib import Path

import cv2
import numpy as np
import segno
from PIL import Image
from tests.product.made_flight import (
    ONE,
    START_NS,
    UTC_AHEAD_NS,
    flight,
    times_s,
    write_photo,
    write_record,
)
from tests.product.photos.made_bands import XMP_TAG
from tests.product.photos.packets import packet
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.model.units import NS_PER_S
from recon.product.panels import code_on, picture_of, shows_square

SERIAL = "RP04-1924106-OB"
SIZE = 320, 240
LANDS_S = ONE.starts_s + ONE.lasts_s - 0.1


def soil(seed: int = 1) -> np.ndarray:
    random = np.random.default_rng(seed)
    coarse = random.integers(50, 110, (SIZE[1] // 4, SIZE[0] // 4), dtype=np.uint8)
    return cv2.resize(coarse, SIZE, interpolation=cv2.INTER_CUBIC)


def with_square(turned_deg: float = 12.0) -> np.ndarray:
    grey = soil()
    corners = cv2.boxPoints(((160.0, 120.0), (90.0, 90.0), turned_deg))
    cv2.fillPoly(grey, [np.rint(corners).astype(np.int32)], 205)
    return grey


def with_code() -> np.ndarray:
    grey = soil(2)
    code = np.array([list(row) for row in segno.make_qr(SERIAL).matrix_iter(scale=4, border=4)])
    rows, cols = code.shape
    grey[40 : 40 + rows, 60 : 60 + cols] = np.where(code, 20, 220)
    return grey


def test_a_square_and_a_code_are_found_and_crops_are_not() -> None:
    assert shows_square(with_square())
    assert shows_square(with_square(40.0))
    assert code_on(with_code()) == SERIAL
    rows = np.where((np.arange(SIZE[0]) // 20 % 2)[np.newaxis], soil(), soil() + 60)
    for grey in (soil(), rows.astype(np.uint8), np.full_like(soil(), 90)):
        assert code_on(grey) == ""
        assert not shows_square(grey)


def test_a_picture_of_sixteen_bits_is_spread(tmp_path: Path) -> None:
    Image.fromarray(with_square().astype(np.uint16) * 30).save(tmp_path / "a.tif")
    grey = picture_of(tmp_path / "a.tif")
    assert grey is not None
    assert shows_square(grey)
    (tmp_path / "b.tif").write_bytes(b"no picture")
    assert picture_of(tmp_path / "b.tif") is None


def write_shot(folder: Path, name: str, at_s: float, grey: np.ndarray, **facts: str) -> None:
    """Bands of a shot from where the vehicle is, or waits, at a time since the start."""
    east, north, _yaw = (float(each) for each in ONE.place(np.clip(at_s, ONE.starts_s, LANDS_S)))
    like = folder / "like.jpg"
    clock_ns = UTC_AHEAD_NS + START_NS + round(at_s * NS_PER_S)
    write_photo(like, place_m=(east, north), clock_ns=clock_ns, size=SIZE)
    with Image.open(like) as image:
        exif = image.getexif()
        exif.get_ifd(0x8769)
        exif.get_ifd(0x8825)
    for number, band in enumerate(("Blue", "NIR"), start=1):
        exif[XMP_TAG] = packet({"Camera:BandName": band, **facts})
        pixels = grey.astype(np.uint16) * 200
        Image.fromarray(pixels).save(folder / f"{name}_{number}.tif", exif=exif)
    like.unlink()


def test_panels_of_before_and_after_are_kept_apart(tmp_path: Path) -> None:
    card = tmp_path / "card"
    card.mkdir()
    marked = {"Camera:CalibrationPicture": "2", "Camera:Albedo": "0.49"}
    write_shot(card, "IMG_0000", -60.0, soil(), **marked, **{"MicaSense:PanelSerial": SERIAL})
    write_shot(card, "IMG_0001", -50.0, with_square())
    write_shot(card, "IMG_0002", -40.0, soil())
    for number, at_s in enumerate(times_s(ONE)[::6].tolist(), start=3):
        write_shot(card, f"IMG_{number:04d}", at_s, soil(number))
    write_shot(card, "IMG_0099", LANDS_S + 40.0, with_code())
    record, out = write_record(flight(), tmp_path / "flight.mcap"), tmp_path / "out"
    words = ["tag", str(card), "--flight", str(record), "--out", str(out)]
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    with (out / "panels" / "panels.csv").open(encoding="utf-8", newline="") as file:
        found = {row["name"]: row for row in csv.DictReader(file)}
    expected = {
        f"IMG_{number}_{band}.tif": when
        for number, when in (("0000", "before"), ("0001", "before"), ("0099", "after"))
        for band in (1, 2)
    }
    assert {name: row["when"] for name, row in found.items()} == expected
    assert {path.name for path in (out / "panels").iterdir()} == {*expected, "panels.csv"}
    first = found["IMG_0000_1.tif"]
    assert (first["panel"], first["albedo"], first["band"]) == (SERIAL, "0.49", "Blue")
    assert found["IMG_0099_1.tif"]["panel"] == SERIAL
    assert found["IMG_0001_2.tif"]["found_by"] == "its square"
    with (out / "tags.csv").open(encoding="utf-8", newline="") as file:
        notes = {row["name"]: row["note"] for row in csv.DictReader(file)}
    assert "reflectance panel" in notes["IMG_0000_2.tif"]
    assert "panel" not in notes["IMG_0002_1.tif"]
    assert notes["IMG_0002_1.tif"]
    images = {path.name for path in (out / "odm" / "images").iterdir()}
    assert not images & expected.keys()
