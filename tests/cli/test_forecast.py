"""`recon forecast` on sequences with known shadows: its rasters, and what it refuses."""

from pathlib import Path

import numpy as np
import pytest
import rasterio
from tests.cli.test_verify import COUNT, EVERY_S, rain, written
from tests.detection.shaded_field import FIELD, DriftingShade
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.model.shade import SUNLIT_TRANSMITTANCE


def forecast(*arguments: object) -> tuple[int, str, str]:
    done = CliRunner().invoke(app, ["forecast", *map(str, arguments)])
    return done.exit_code, done.stdout, done.stderr


def bands(path: Path) -> tuple[np.ndarray, np.ndarray]:
    with rasterio.open(path) as dataset:
        probability, is_seen = dataset.read()
    return probability, is_seen > 0.5


def test_recons_own_maps_are_continued_in_their_place(tmp_path: Path) -> None:
    maps, out = tmp_path / "maps", tmp_path / "sun"
    maps.mkdir()
    code, text, problems = forecast(written(maps), "--out", out, "--leads", "15,30")
    assert (code, problems) == (0, "")
    assert [each.name for each in sorted(out.iterdir())] == ["sun-000015s.tif", "sun-000030s.tif"]
    assert f"after shade-{COUNT - 1:05d}.tif, by advection from {COUNT} maps" in text
    # 5 m/s east and 2 m/s north on cells of 4 m, 5 s apart.
    right = float(text.split(" cells right")[0].split()[-1])
    down = float(text.split(" down in 5 s")[0].split()[-1])
    assert (right, down) == (pytest.approx(6.2, abs=0.4), pytest.approx(-2.5, abs=0.4))
    with (
        rasterio.open(out / "sun-000015s.tif") as made,
        rasterio.open(maps / f"shade-{COUNT - 1:05d}.tif") as newest,
    ):
        assert (made.crs, made.transform, made.shape) == (
            newest.crs,
            newest.transform,
            newest.shape,
        )
    last_s = EVERY_S * (COUNT - 1)
    for lead_s in (15.0, 30.0):
        truth = DriftingShade(5, 0.4, (5.0, 2.0)).transmittance(FIELD, last_s + lead_s)
        probability, is_seen = bands(out / f"sun-{lead_s:06.0f}s.tif")
        assert is_seen.mean() > 0.3
        right_share = ((probability >= 0.5) == (truth >= SUNLIT_TRANSMITTANCE))[is_seen].mean()
        assert right_share > 0.9


def test_a_slower_sequence_counts_in_its_own_seconds(tmp_path: Path) -> None:
    radar, out = tmp_path / "radar", tmp_path / "sun"
    radar.mkdir()
    options = ("--step-s", 300, "--shade", 40, "--sun", 0, "--leads", 900)
    code, text, problems = forecast(rain(radar), "--out", out, *options)
    assert (code, problems) == (0, "")
    assert "| 900 |" in text
    assert float(text.split(" cells right")[0].split()[-1]) == pytest.approx(2.0, abs=0.4)
    truth = DriftingShade(6, 0.3, (8.0, 0.0)).transmittance(FIELD, COUNT - 1 + 3.0)
    probability, is_seen = bands(out / "sun-000900s.tif")
    wrong = (probability >= 0.5) != (truth >= SUNLIT_TRANSMITTANCE)
    assert wrong[is_seen].mean() < 0.1


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--leads", "soon"), "--leads: expected seconds with commas"),
        (("--leads", "0"), "--leads: expected seconds"),
        (("--method", "guess"), "--method: expected advection or"),
        (("--out", "{maps}"), "expected a new or empty folder, got one in use"),
    ],
)
def test_what_does_not_fit_is_one_sentence(
    tmp_path: Path, options: tuple[str, str], words: str
) -> None:
    maps = tmp_path / "maps"
    maps.mkdir()
    written(maps)
    given = [each.format(maps=maps) for each in options]
    code, _text, problems = forecast(maps, *(() if "--out" in given else ("--out", "x")), *given)
    assert code == 2
    assert words in problems
    assert problems.count("\n") == 1
