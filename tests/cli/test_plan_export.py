"""`recon plan --export`: files of flights for other programs, and sentences of what they lack."""

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from recon.cli.commands import app

ROOT = Path(__file__).parents[2]
FIELD = ROOT / "examples/river-field.geojson"


def recon(*words: object) -> tuple[int, str]:
    arguments = ["plan", str(FIELD), "--gsd", "2cm", *(str(word) for word in words)]
    result = CliRunner().invoke(app, arguments)
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.output


def exports(*words: object) -> list[dict[str, Any]]:
    code, out = recon(*words, "--json")
    assert code == 0, out
    found: list[dict[str, Any]] = json.loads(out)["exports"]
    return found


def test_several_formats_are_written_at_once_one_file_a_flight(tmp_path: Path) -> None:
    kmz, kml = tmp_path / "river.kmz", tmp_path / "river.kml"
    chosen = ("--export", kmz, "--export", kml, "--drones", 2, "--aircraft", "mavic 3m")
    of_kmz, of_kml = exports(*chosen)
    names = ["river-drone-1-flight-1.kmz", "river-drone-2-flight-1.kmz"]
    assert list(of_kmz["files"]) == names
    assert list(of_kml["files"]) == ["river.kml"]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([*names, "river.kml"])
    assert of_kmz["by_hand"] == []
    assert sum(of_kmz["files"].values()) == of_kml["files"]["river.kml"]


def test_the_table_says_what_is_set_by_hand(tmp_path: Path) -> None:
    code, out = recon("--export", tmp_path / "river.csv")
    assert code == 0
    assert "Litchi  river.csv, " in out
    assert "by hand in Litchi  the end: set it to return home in the program" in out


def test_photos_may_be_by_distance(tmp_path: Path) -> None:
    exports("--export", tmp_path / "river.csv", "--by-distance")
    header, first, *_ = (tmp_path / "river.csv").read_text().splitlines()
    row = dict(zip(header.split(","), first.split(","), strict=True))
    # 9.9 m/s, a photo every 2 s.
    assert (row["photo_timeinterval"], row["photo_distinterval"]) == ("-1", "19.8")


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("--export", "a.kmz"), "a .kmz names its aircraft: choose one of Mavic 3E"),
        (("--export", "a.kmz", "--aircraft", "Mavic 4"), "no aircraft 'Mavic 4': known are"),
        (("--export", "a.txt"), "expected a file named .kmz, .plan"),
        (("--export", "a.csv", "--export", "a.csv"), "expected a file of its own"),
        (("--export", "a.csv", "--geojson", "a.csv"), "expected a file of its own"),
        (("--export", "nowhere/a.csv"), "cannot be written: No such file or directory"),
    ],
)
def test_wrong_options_are_a_sentence_and_write_nothing(
    words: tuple[str, ...], expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    code, out = recon(*words)
    assert code == 2
    assert expected in out
    assert list(tmp_path.iterdir()) == []


def test_the_region_is_never_written_over(tmp_path: Path) -> None:
    copy = tmp_path / "river.plan"
    copy.write_bytes(FIELD.read_bytes())
    arguments = ["plan", str(copy), "--gsd", "2cm", "--export", str(copy)]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 2
    assert copy.read_bytes() == FIELD.read_bytes()
