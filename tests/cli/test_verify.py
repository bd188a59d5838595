"""`recon verify` on sequences with known shadows, and on what is none."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import cv2
import numpy as np
import pytest
import rasterio
from rasterio.transform import Affine
from tests.detection.shaded_field import FIELD, DriftingShade
from tests.forecast.moving_shade import noisy_map
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.record.raster.shade_geotiff import shade_cog_bytes

BEGIN = datetime(2025, 6, 20, 16, tzinfo=UTC)
COUNT, EVERY_S = 26, 5.0


def written(folder: Path, gaps_s: list[float] | None = None) -> Path:
    """Recon's own shade maps, as `recon detect` writes them."""
    drawn, at_s = DriftingShade(5, 0.4, (5.0, 2.0)), 0.0
    for number, gap_s in enumerate(gaps_s or [EVERY_S] * COUNT):
        utc = (BEGIN + timedelta(seconds=at_s)).isoformat()
        data = shade_cog_bytes(noisy_map(drawn, at_s), utc)
        (folder / f"shade-{number:05d}.tif").write_bytes(data)
        at_s += gap_s
    return folder


def rain(folder: Path) -> Path:
    """A radar's sequence: rain in mm/h that moves 2 cells a picture, 300 s apart; no place."""
    drawn = DriftingShade(6, 0.3, (8.0, 0.0))
    for number in range(COUNT):
        light = drawn.transmittance(FIELD, float(number))
        data = np.rint(np.clip(1.0 - light, 0.0, 1.0) * 40.0).astype(np.uint8)
        cv2.imwrite(str(folder / f"radar-{number:03d}.png"), data)
    return folder


def verify(*arguments: object) -> tuple[int, str, str]:
    done = CliRunner().invoke(app, ["verify", *map(str, arguments)])
    return done.exit_code, done.stdout, done.stderr


def rows(text: str, title: str) -> dict[str, list[str]]:
    """A table's rows by their first cell."""
    _before, _title, after = text.partition(f"| {title} |")
    lines = after.partition("\n\n")[0].splitlines()[1:]
    cells = [line.strip("| ").split(" | ") for line in lines if line.startswith("| ")]
    return {first: rest for first, *rest in cells if not first.startswith("-")}


def test_recons_own_maps_by_their_times(tmp_path: Path) -> None:
    picture = tmp_path / "reliability.png"
    maps = tmp_path / "maps"
    maps.mkdir()
    code, text, problems = verify(written(maps), "--plot", picture)
    assert (code, problems) == (0, "")
    assert f"{COUNT} maps, 5 s apart" in text
    assert "| Brier | 15 s | 30 s | 60 s | 90 s | 120 s |" in text
    brier = {
        method: [float(each) for each in found] for method, found in rows(text, "Brier").items()
    }
    assert set(brier) >= {"advection", "persistence", "climatology"}
    assert brier["advection"][0] < 0.5 * brier["persistence"][0]
    drawn = cv2.imread(str(picture))
    assert drawn is not None
    assert (drawn != 255).any(axis=2).mean() > 0.01


def test_a_slow_sequence_counts_in_its_own_steps(tmp_path: Path) -> None:
    code, text, problems = verify(rain(tmp_path), "--step-s", 300, "--shade", 40, "--sun", 0)
    assert (code, problems) == (0, "")
    assert "| Brier | 900 s | 1800 s | 3600 s | 5400 s | 7200 s |" in text
    brier = rows(text, "Brier")
    assert float(brier["advection"][0]) < 0.7 * float(brier["persistence"][0])


def test_maps_at_uneven_times_have_the_scores_of_even_ones(tmp_path: Path) -> None:
    brier = []
    for name, gaps_s in (("even", [5.0] * 44), ("uneven", [5.0, 1.5, 8.5, 5.0] * 11)):
        maps = tmp_path / name
        maps.mkdir()
        code, text, problems = verify(written(maps, gaps_s))
        assert (code, problems) == (0, "")
        leads = text.partition("| Brier |")[2].splitlines()[0].strip("| ").split(" | ")
        found = rows(text, "Brier")
        brier.append({m: dict(zip(leads, each, strict=True)) for m, each in found.items()})
    assert "44 maps, 5.0 s apart (median; 1.5 to 8.5 s); truth is the map nearest to" in text
    assert "at most 2.5 s from it" in text
    even, uneven = brier
    assert even.keys() == uneven.keys()
    for method, scores in even.items():
        # No map is near enough to 30 s after the uneven ones.
        for lead in ("15 s", "60 s", "120 s"):
            assert float(uneven[method][lead]) == pytest.approx(float(scores[lead]), abs=0.04)
    assert float(uneven["advection"]["15 s"]) < 0.5 * float(uneven["persistence"]["15 s"])


def test_maps_are_read_in_the_order_of_their_times(tmp_path: Path) -> None:
    gaps_s = [5.0] * COUNT
    texts = []
    for name in ("named", "misnamed"):
        maps = tmp_path / name
        maps.mkdir()
        written(maps, gaps_s)
        if name == "misnamed":
            (maps / "shade-00004.tif").rename(maps / "zz.tif")
        texts.append(verify(maps))
    assert texts[0] == texts[1]


def no_folder(folder: Path) -> list[object]:
    return [folder / "none"]


def few(folder: Path) -> list[object]:
    return [written(folder, [5.0] * 2)]


def at_one_time(folder: Path) -> list[object]:
    return [written(folder, [5.0, 5.0, 0.0, 5.0])]


def stepped(folder: Path) -> list[object]:
    return [written(folder), "--step-s", 5]


def short(folder: Path) -> list[object]:
    return [written(folder, [1.0] * 5)]


def without_times(folder: Path) -> list[object]:
    return [rain(folder)]


def torn(folder: Path) -> list[object]:
    data = (written(folder) / "shade-00003.tif").read_bytes()
    (folder / "shade-00003.tif").write_bytes(data[: len(data) // 2])
    return [folder]


def no_raster(folder: Path) -> list[object]:
    (written(folder) / "shade-00003.tif").write_text("not a raster")
    return [folder]


def of_another_size(folder: Path) -> list[object]:
    cv2.imwrite(str(rain(folder) / "radar-009.png"), np.zeros((9, 9), np.uint8))
    return [folder, "--step-s", 300]


def huge(folder: Path) -> list[object]:
    profile = {"driver": "GTiff", "count": 1, "dtype": "uint8", "compress": "deflate"}
    for number in range(3):
        with rasterio.open(
            folder / f"{number}.tif",
            "w",
            width=40_000,
            height=40_000,
            sparse_ok=True,
            transform=Affine(2.0, 0.0, 0.0, 0.0, -2.0, 0.0),
            **profile,
        ):
            pass
    return [folder, "--step-s", 5]


def alike(folder: Path) -> list[object]:
    return [folder, "--sun", 2, "--shade", 2]


def no_step(folder: Path) -> list[object]:
    return [folder, "--step-s", 0]


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (no_folder, "none: expected a folder of maps, got: No such file"),
        (few, "expected 3 maps or more (.tif, "),
        (at_one_time, "shade-00003.tif: expected another time than that of shade-00002.tif"),
        (stepped, "expected no --step-s, for all maps have a time"),
        (short, "expected maps over more than 15 s, got 4.0 s"),
        (without_times, "expected --step-s, for not all maps have a time"),
        (torn, "shade-00003.tif: expected a raster that GDAL reads, got: "),
        (no_raster, "shade-00003.tif: expected a raster that GDAL reads, got: "),
        (of_another_size, "radar-009.png: expected (128, 128) cells as before, got (9, 9)"),
        (huge, "expected at most 250000 cells, got 40000 x 40000; resample it"),
        (alike, "expected two different numbers, got --sun 2.0 --shade 2.0"),
        (no_step, "--step-s: expected 0.1 to 86400 seconds, got 0"),
    ],
)
def test_bad_input_is_one_sentence(tmp_path: Path, made, words: str) -> None:
    code, text, problems = verify(*made(tmp_path))
    assert (code, text) == (2, "")
    assert problems.startswith("recon verify: ")
    assert len(problems.splitlines()) == 1
    assert words in problems
