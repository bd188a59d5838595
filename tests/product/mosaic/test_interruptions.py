"""What ends a mosaic's run, and what the next one finds: damaged photos, a kill, a full disk."""

import json
import resource
import signal
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import rasterio
from PIL import ExifTags, Image
from tests.product.mosaic.made_mosaic import MadeMosaic
from tests.product.mosaic.test_mosaic import pixels

from recon.product.mosaic import Light, read_jpeg
from recon.product.mosaic.pixels import Box, Cut, PhotoCuts
from recon.product.photos.photo_error import PhotoError

ALL: Box = (0, 0, 10_000, 10_000)
FOUR_WINDOWS_M = 0.2
"""Pixels that make four windows."""


@pytest.fixture
def made(tmp_path: Path) -> MadeMosaic:
    return MadeMosaic(tmp_path, every=12, size=(320, 240))


class Killed(BaseException):
    """What no code catches."""


@pytest.mark.flight
def test_a_killed_run_goes_on_where_it_was(made: MadeMosaic, tmp_path: Path) -> None:
    whole = tmp_path / "whole"
    made.build(whole, resolution_m=FOUR_WINDOWS_M).run()
    out = tmp_path / "out"

    def dying(index: int, shrink: int, box: Box) -> np.ndarray:
        if any("mosaic" in path.name for path in out.rglob("*.tif")):
            raise Killed
        return made.read(index, shrink, box)

    with pytest.raises(Killed):
        made.build(out, resolution_m=FOUR_WINDOWS_M, read=dying).run()
    (store,) = out.glob("windows-*")
    finished = {path.name: path.stat().st_mtime_ns for path in store.glob("*.tif")}
    assert any("mosaic" in name for name in finished)
    build = made.build(out, resolution_m=FOUR_WINDOWS_M)
    build.over = lambda items, title, count: seen(items, title, store, finished)
    report = build.run()
    assert report.decoded < report.used
    assert (out / "mosaic.tif").read_bytes() == (whole / "mosaic.tif").read_bytes()
    assert not store.exists()


def seen(items, title: str, store: Path, finished: dict[str, int]) -> Iterator:
    """Check before rasters are written that no finished window was made again."""
    if title == "writing rasters":
        now = {name: (store / name).stat().st_mtime_ns for name in finished}
        assert now == finished
    yield from items


def test_other_settings_begin_anew(made: MadeMosaic, tmp_path: Path) -> None:
    def dying(_index: int, _shrink: int, box: Box) -> np.ndarray:
        raise Killed

    with pytest.raises(Killed):
        made.build(tmp_path / "out", resolution_m=0.4, read=dying).run()
    (before,) = (tmp_path / "out").glob("windows-*")
    with pytest.raises(Killed):
        made.build(tmp_path / "out", resolution_m=0.4, fills=True, read=dying).run()
    (after,) = (tmp_path / "out").glob("windows-*")
    assert after != before


def test_ground_of_a_damaged_photo_is_taken_from_others(made: MadeMosaic, tmp_path: Path) -> None:
    best = made.build(tmp_path / "best", resolution_m=0.4).run()
    index = int(np.nanmin(pixels(tmp_path / "best", "provenance")[0][0]))
    name = made.photos[index].photo.name

    def reading(number: int, shrink: int, box: Box) -> np.ndarray:
        if number == index:
            raise PhotoError(f"{name}: its picture is damaged")
        return made.read(number, shrink, box)

    report = made.build(tmp_path / "out", resolution_m=0.4, read=reading).run()
    assert report.failed == {name: f"{name}: its picture is damaged"}
    values, _east, _north = pixels(tmp_path / "out", "provenance")
    assert not (values[0] == index).any()
    # What no other photo shows in sun is counted so.
    assert 0.9 * best.areas_m2[Light.SUN] < report.areas_m2[Light.SUN] < best.areas_m2[Light.SUN]
    assert json.loads((tmp_path / "out" / "mosaic.json").read_text())["photos_not_read"]


@pytest.fixture
def limited() -> Iterator[None]:
    """Let the test limit the size of files, as a disk does that is full."""
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)
    signal.signal(signal.SIGXFSZ, handler)


def test_a_full_disk_leaves_the_old_mosaic_and_all_that_is_finished(
    made: MadeMosaic, tmp_path: Path, limited: None
) -> None:
    out = tmp_path / "out"
    made.build(out, resolution_m=0.4, fills=True).run()
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    hard = resource.getrlimit(resource.RLIMIT_FSIZE)[1]
    # The first window, a window of pixels, the raster of all windows do not fit.
    for most_bytes in (100, 4_000, 20_000):
        resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, hard))
        with pytest.raises(OSError, match=r"."):
            made.build(out, resolution_m=0.4).run()
        resource.setrlimit(resource.RLIMIT_FSIZE, (hard, hard))
        after = {path.name: path.read_bytes() for path in out.iterdir() if path.is_file()}
        assert after == before
    report = made.build(out, resolution_m=0.4).run()
    assert report.filled_m2 == 0.0
    with rasterio.open(out / "mosaic.tif") as dataset:
        assert dataset.tags()["RECON_SHADE"] == "empty"
        assert dataset.read().any()


@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
@pytest.mark.parametrize("scale", [1, 20])
def test_a_jpeg_is_read_smaller_and_not_turned(tmp_path: Path, scale: int) -> None:
    """Small pictures and large ones are made smaller in two ways."""
    picture = np.zeros((48 * scale, 64 * scale, 3), dtype=np.uint8)
    picture[: 24 * scale, : 32 * scale] = (200, 100, 50)
    path = tmp_path / "photo.jpg"
    turned = Image.Exif()
    turned[ExifTags.Base.Orientation] = 6
    Image.fromarray(picture).save(path, quality=100, exif=turned)
    for shrink in (1, 2, 4, 8):
        found = read_jpeg(path, shrink, ALL)
        assert found.shape == (48 * scale // shrink, 64 * scale // shrink, 3)
        assert np.allclose(found[1, 1], (200, 100, 50), atol=4)
        assert np.allclose(found[-2, -2], 0, atol=4)
        part = read_jpeg(path, shrink, (1, 2, 4, 5))
        assert np.array_equal(part, found[1:4, 2:5])


@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
@pytest.mark.parametrize("data", [b"", b"\xff\xd8\xff", b"no photo"])
def test_a_damaged_jpeg_is_a_sentence(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "photo.jpg").write_bytes(data)
    with pytest.raises(PhotoError, match=r"photo\.jpg: its picture cannot be read"):
        read_jpeg(tmp_path / "photo.jpg", 1, ALL)
    with pytest.raises(PhotoError, match="its picture cannot be read"):
        read_jpeg(tmp_path / "none.jpg", 1, ALL)


def test_pieces_of_photos_stay_within_the_memory_that_is_given() -> None:
    """Of 20 photos each of 10 windows takes a piece; a third of the pieces have room."""
    photos, windows = range(20), range(10)

    def read(index: int, _shrink: int, box: Box) -> np.ndarray:
        top, left, bottom, right = box
        found = np.zeros((bottom - top, right - left, 2), dtype=np.uint8)
        found[..., 0] = np.arange(top, bottom)[:, np.newaxis]
        found[..., 1] = index
        return found

    def edges(number: int) -> tuple[float, float, float, float]:
        return 20.0 * number + 10.0, 20.0, 20.0 * number + 29.0, 79.0

    taken = {index: {number: edges(number) for number in windows} for index in photos}
    cuts = PhotoCuts(read, 1, taken, most_bytes=160_000)
    for number in windows:
        for index in photos:
            cut: Cut = cuts.get(number, index)
            assert cut.first == (20 * number + 6, 16)
            assert cut.pixels.shape == (28, 68, 2)
            assert cut.pixels[0, 0].tolist() == [20 * number + 6, index]
            assert sum(each.pixels.nbytes for each in cuts._kept.values()) <= 160_000
    assert not cuts._kept
    assert len(photos) < cuts.decoded < 0.5 * len(photos) * len(windows)


def test_a_piece_larger_than_the_memory_is_read_all_the_same() -> None:
    cuts = PhotoCuts(
        lambda _index, _shrink, box: np.zeros((box[2] - box[0], box[3] - box[1], 3), np.uint8),
        1,
        {0: dict.fromkeys(range(3), (0.0, 0.0, 99.0, 99.0))},
        most_bytes=1_000,
    )
    assert [cuts.get(number, 0).pixels.shape for number in range(3)] == [(104, 104, 3)] * 3
    assert cuts.decoded == 3
