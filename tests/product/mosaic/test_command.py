"""`recon mosaic` on a record and a card made by construction, and its picture in the report."""

import json
from pathlib import Path

import pytest
import rasterio
from tests.product.made_flight import (
    ONE,
    UTC_AHEAD_NS,
    flight,
    write_card,
    write_photo,
    write_record,
)
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.model.errors import RecordError
from recon.product.mosaic.finished import finished_mosaic
from recon.product.photos.card import card_of


@pytest.fixture(scope="module")
def card(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the record, and the card beside it."""
    folder = tmp_path_factory.mktemp("made")
    write_record(flight(ONE), folder / "flight.mcap")
    write_card(folder / "card", every=10)
    (folder / "card" / "SIM-1_0000.MP4").touch()
    odd = {"place_m": (0.0, 9_000.0), "clock_ns": UTC_AHEAD_NS, "camera": "CAM-9"}
    write_photo(folder / "card" / "odd.JPG", **odd, xmp=b"<!DOCTYPE x []>")
    return folder


def run(*words: object):
    return CliRunner().invoke(app, [str(word) for word in words])


@pytest.fixture(scope="module")
def printed(card: Path) -> str:
    result = run("mosaic", card / "flight.mcap", card / "card", "--out", card / "out")
    assert result.exit_code == 0, result.output
    return result.output


def test_the_command_prints_what_the_mosaic_shows(card: Path, printed: str) -> None:
    stated = json.loads((card / "out" / "mosaic.json").read_text())
    total_m2 = sum(stated["areas_m2"].values())
    share = 100.0 * stated["areas_m2"]["sun"] / total_m2
    assert 0.0 < share < 100.0
    assert f"{share:5.1f} %" in printed
    assert "in sun" in printed
    # Four pixels of 12 cm, rounded up.
    assert stated["resolution_m"] == 0.5
    assert "50 cm a pixel" in printed
    with rasterio.open(card / "out" / "mosaic.tif") as dataset:
        assert dataset.transform.a == 0.5
        assert dataset.tags()["RECON_BRIGHTNESS"].startswith("evened to full sun")


def test_the_card_is_read_as_for_tags_and_never_the_mosaic(card: Path, printed: str) -> None:
    assert "left out: SIM-1_0000.MP4: no photos that Recon reads (.mp4)" in printed
    assert "warning: odd.JPG: its XMP is not read: a document type" in printed
    assert "warning: not used: odd.JPG: " in printed
    assert card_of([card]).left["written by Recon"] == [card / "out"]
    there = run("mosaic", card / "flight.mcap", card / "card", "--out", card)
    assert "--out: expected a folder without photos" in there.stderr


def test_the_report_shows_it(card: Path, printed: str, tmp_path: Path) -> None:
    out = tmp_path / "report.html"
    words = ("report", card / "flight.mcap", "--mosaic", card / "out", "--out", out)
    assert run(*words).exit_code == 0
    page = out.read_text()
    share = finished_mosaic(card / "out", "flight.mcap").percent
    assert 'src="data:image/png;base64,iVBOR' in page
    assert all(f"{share(light):.1f} %" in page for light in (0, 1, 2, 3))


def test_ground_of_a_site_without_elevation_is_refused(card: Path, tmp_path: Path) -> None:
    origin = "latitude_deg = 41.9\nlongitude_deg = -93.6\nground_altitude_m = 290.0\n"
    (tmp_path / "site.toml").write_text(f'name = "made"\n[origin]\n{origin}')
    result = run("mosaic", card / "flight.mcap", card / "card", "--site", tmp_path)
    assert result.exit_code == 2
    assert "expected a site with an [elevation]" in result.stderr


@pytest.mark.parametrize(
    ("name", "data", "sentence"),
    [
        ("mosaic.json", b"{", "expected the report of recon mosaic"),
        ("mosaic.json", b'{"format": "other"}', "expected the report of recon mosaic"),
        ("preview.png", b"<svg onload=alert(1)>", "expected a PNG"),
    ],
)
def test_another_programs_folder_is_refused(
    card: Path, printed: str, tmp_path: Path, name: str, data: bytes, sentence: str
) -> None:
    for each in ("mosaic.json", "preview.png"):
        (tmp_path / each).write_bytes((card / "out" / each).read_bytes())
    with pytest.raises(RecordError, match=r"got one of 'flight\.mcap'"):
        finished_mosaic(tmp_path, "another.mcap")
    (tmp_path / name).write_bytes(data)
    with pytest.raises(RecordError, match=sentence):
        finished_mosaic(tmp_path, "flight.mcap")
    (tmp_path / name).unlink()
    with pytest.raises(RecordError, match="run recon mosaic first"):
        finished_mosaic(tmp_path, "flight.mcap")
