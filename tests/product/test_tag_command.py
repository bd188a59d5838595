"""`recon tag` on a record and cards made by construction, with what it leaves."""

import csv
import json
import os
import shutil
import subprocess
from datetime import datetime
from pathlib import Path

import cv2
import numpy as np
import pytest
import shapely
from PIL import Image
from tests.product.made_flight import (
    FRAME,
    HEIGHT_M,
    ONE,
    OTHER,
    START_NS,
    UTC_AHEAD_NS,
    flight,
    sun,
    write_card,
    write_photo,
    write_record,
)
from tests.product.photos.made_bands import write_band
from tests.product.photos.packets import packet
from tests.replay.flights import FOLDER
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.cli.region_file import read_region
from recon.geo import enu_from_geo
from recon.guidance.survey import SurveyPlan, plan_survey
from recon.model.airspace import Region
from recon.model.errors import RecordError
from recon.model.survey import Survey
from recon.model.units import NS_PER_S
from recon.product.flight_reader import read_flight
from recon.product.footprint import Aim, PhotoView, projected
from recon.product.write import masked_name

AHEAD_S = 7_261.4
FIELD_COLS, FIELD_ROWS = 80, 60


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_record(flight(ONE, OTHER), tmp_path_factory.mktemp("record") / "flight.mcap")


@pytest.fixture(scope="module")
def tagged(tmp_path_factory: pytest.TempPathFactory, record: Path):
    """The command's result, its folder, the card and the truth of its photos."""
    folder = tmp_path_factory.mktemp("tagged")
    truth = write_card(folder / "card", AHEAD_S, (ONE, OTHER))
    result = run(folder / "card", record, folder / "out")
    assert result.exit_code == 0, result.output
    return result, folder / "out", folder / "card", truth


def run(card: Path, record: Path, out: Path, *more: str):
    words = ["tag", str(card), "--flight", str(record), "--out", str(out), *more]
    return CliRunner().invoke(app, words)


def rows(out: Path) -> list[dict[str, str]]:
    with (out / "tags.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def true_lit(way, at_s: float) -> np.ndarray:
    east, north, yaw = (float(each) for each in way.place(at_s))
    pixels = np.stack(np.meshgrid(np.arange(FIELD_COLS), np.arange(FIELD_ROWS)), axis=-1)
    view = PhotoView(Aim(east, north, HEIGHT_M, yaw), 66.0, FIELD_COLS, FIELD_ROWS)
    ground = projected(view.homography, pixels.reshape(-1, 2).astype(float))
    return (sun(ground[:, 0], ground[:, 1], at_s) >= 0.5).reshape(FIELD_ROWS, FIELD_COLS)


def test_the_record_is_read_as_it_was_made(record: Path) -> None:
    made, found = flight(ONE, OTHER), read_flight(record)
    assert found.trouble == ""
    assert found.frame == FRAME
    assert found.utc_ahead_ns == UTC_AHEAD_NS
    assert found.surveys[0].outline_m == made.surveys[0].outline_m
    assert list(found.survey_tracks) == ["SIM-1", "SIM-2"]
    for serial, track in made.tracks.items():
        assert (found.tracks[serial].at_ns == track.at_ns).all()
        assert found.tracks[serial].east_m == pytest.approx(track.east_m, abs=1e-3)
    assert [each.at_ns for each in found.maps] == [each.at_ns for each in made.maps]
    assert (found.maps[7].sun == made.maps[7].sun).all()


def test_a_record_cut_anywhere_is_read_as_far_as_it_goes(record: Path, tmp_path: Path) -> None:
    data = record.read_bytes()
    for share in (0.4, 0.7, 0.95):
        path = tmp_path / "cut.mcap"
        path.write_bytes(data[: int(share * len(data))])
        assert read_flight(path).trouble


def test_a_record_without_the_sites_place_is_refused() -> None:
    with pytest.raises(RecordError, match="with the place of its site"):
        read_flight(FOLDER / "survey.mcap")


@pytest.mark.flight
def test_each_photo_is_called_as_the_truth_has_it(tagged) -> None:
    _result, out, _card, truth = tagged
    found = {row["name"]: row for row in rows(out)}
    assert found.keys() == truth.keys()
    errors, right = [], []
    for name, (way, at_s) in truth.items():
        if float(found[name]["known"]) < 0.98:
            continue
        lit = true_lit(way, at_s)
        share = float(found[name]["sunlit"])
        errors.append(abs(share - lit.mean()))
        right.append((share >= 0.9) == (lit.mean() >= 0.9))
        mask = cv2.imread(str(out / "masks" / masked_name(name)), cv2.IMREAD_GRAYSCALE)
        assert mask.shape == (FIELD_ROWS, FIELD_COLS)
        assert ((mask > 127) != lit).mean() < 0.35
    assert len(errors) > 100
    assert np.mean(errors) < 0.05
    assert np.mean(right) > 0.95
    utc = UTC_AHEAD_NS + START_NS + round(truth["SIM-1_0020.JPG"][1] * NS_PER_S)
    stated = datetime.fromisoformat(found["SIM-1_0020.JPG"]["utc"]).timestamp()
    assert abs(stated - utc / NS_PER_S) < 0.5


def test_clocks_and_the_list_are_printed(tagged) -> None:
    result, out, _card, _truth = tagged
    assert result.output.count("clock offset -2 h 01 min 0") == 2
    assert "is no time zone" not in result.output
    chosen = (out / "chosen.txt").read_text().split()
    assert f"{len(chosen)} photos chosen, no list has fewer than" in result.output
    assert 0 < len(chosen) < len(rows(out))


def test_chosen_photos_show_all_ground_that_was_photographed_in_sun(tagged) -> None:
    _result, out, _card, truth = tagged
    chosen = set((out / "chosen.txt").read_text().split())
    places = np.stack(np.meshgrid(np.arange(-88, 90, 8.0), np.arange(-88, 90, 8.0)), -1)
    places = places.reshape(-1, 2)
    shown, listed = np.zeros((2, len(places)), bool)
    for name, (way, at_s) in truth.items():
        east, north, yaw = (float(each) for each in way.place(at_s))
        view = PhotoView(Aim(east, north, HEIGHT_M, yaw), 66.0, FIELD_COLS, FIELD_ROWS)
        inverse = np.linalg.inv(view.homography)
        pixels = projected(inverse, places)
        on = ((pixels >= -0.5) & (pixels <= (79.5, 59.5))).all(axis=1)
        lit = on & (sun(places[:, 0], places[:, 1], at_s) >= 0.5)
        shown |= lit
        if name in chosen:
            listed |= lit
    assert shown.mean() > 0.5
    assert (shown & listed).sum() >= 0.99 * shown.sum()


def test_the_folder_for_opendronemap_follows_its_readers_rules(tagged) -> None:
    """Names and masks as OpenDroneMap pairs them; the photos state position and height."""
    _result, out, _card, _truth = tagged
    images = sorted(path.name for path in (out / "odm" / "images").iterdir())
    photos = [name for name in images if not Path(name).stem.endswith("_mask")]
    masks = {Path(name).stem: name for name in images if Path(name).stem.endswith("_mask")}
    assert photos == sorted((out / "chosen.txt").read_text().split())
    assert all(f"{Path(name).stem}_mask" in masks for name in photos)
    assert not any(" " in name for name in images)
    assert not (out / "odm" / "geo.txt").exists()


def test_regions_to_fly_again_are_surveys_that_recon_plans(tmp_path: Path, record: Path) -> None:
    write_card(tmp_path / "card", 0.0, (ONE,), every=4)
    shown = run(tmp_path / "card", record, tmp_path / "out")
    assert "to fly again:" in shown.output
    path = tmp_path / "out" / "fly-again.geojson"
    names = [each["properties"]["name"] for each in json.loads(path.read_text())["features"]]
    assert names
    name, rings = read_region(path, names[0], FRAME.origin)
    outline = np.array(rings[0][:-1])
    assert name == names[0]
    places = enu_from_geo(FRAME, outline[:, 1], outline[:, 0], FRAME.origin.ellipsoid_height_m)
    survey = Survey(1, name, Region(places[:, :2]), HEIGHT_M, 8.0)
    plan = plan_survey(survey, FRAME)
    assert isinstance(plan, SurveyPlan)
    assert plan.pieces


@pytest.mark.flight
def test_a_second_run_goes_on_where_the_first_was_ended(tagged, record: Path) -> None:
    _result, out, card, _truth = tagged
    before = (out / "tags.csv").read_text()
    kept = out / "masks" / masked_name("SIM-1_0030.JPG")
    lost = out / "masks" / masked_name("SIM-1_0031.JPG")
    kept.write_bytes(b"kept")
    lost.unlink()
    with (out / "progress.jsonl").open("a") as file:
        file.write('["SIM-1_0032.JPG", "half a li')
    result = run(card, record, out)
    assert result.exit_code == 0, result.output
    assert "photos were tagged before" in result.output
    assert kept.read_bytes() == b"kept"
    assert lost.is_file()
    assert (out / "tags.csv").read_text() == before


def test_twice_inside_the_card_gives_the_same_result(
    tmp_path: Path, record: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_card(tmp_path, 0.0, (ONE,), every=4)
    shutil.copy(tmp_path / "SIM-1_0000.JPG", tmp_path / "copy.JPG")
    (tmp_path / "SIM-1_0000.MP4").touch()
    monkeypatch.chdir(tmp_path)

    def result() -> tuple[str, dict[str, bytes]]:
        shown = CliRunner().invoke(app, ["tag", ".", "--flight", str(record)])
        assert shown.exit_code == 0, shown.output
        assert "left out: copy.JPG: copies of other photos, which count once" in shown.output
        files = (path for path in sorted(Path("tagged").rglob("*")) if path.is_file())
        return shown.output, {path.as_posix(): path.read_bytes() for path in files}

    (first, files), (second, again) = result(), result()
    assert files == again
    assert "left out: SIM-1_0000.MP4: no photos that Recon reads (.mp4)" in first
    assert "left out: tagged: written by Recon" in second
    card = CliRunner().invoke(app, ["tag", "tagged", "--flight", str(record), "--out", "other"])
    assert "what Recon wrote" in card.stderr
    there = CliRunner().invoke(app, ["tag", ".", "--flight", str(record), "--out", "."])
    assert "expected a folder without photos" in there.stderr


def test_a_shots_files_are_tagged_with_it_each_kind_in_its_own_project(
    tmp_path: Path, record: Path
) -> None:
    card = tmp_path / "card"
    write_card(card, 0.0, (ONE,), every=4)
    for path in sorted(card.glob("*.JPG")):
        write_band(card / f"{path.stem}_MS_G.TIF", path)
        thermal = packet({"drone-dji:ImageSource": "InfraredCamera"})
        with Image.open(path) as image:
            image.resize((320, 240)).save(
                card / f"{path.stem}_T.JPG", exif=image.getexif(), xmp=thermal
            )
        path.rename(card / f"{path.stem}_D.JPG")
    out = tmp_path / "out"
    result = run(card, record, out)
    assert result.exit_code == 0, result.output
    found = {row["name"]: row for row in rows(out)}
    shots = {name[: len("SIM-1_0000")] for name in found}
    assert len(found) == 3 * len(shots) == 3 * len(list(card.glob("*_D.JPG")))
    assert f"{len(shots)} band files of the same shots: in odm-bands" in result.output
    assert f"{len(shots)} thermal files of the same shots: in odm-thermal" in result.output
    assert f"\n{len(shots)} photos: " in result.output
    chosen = (out / "chosen.txt").read_text().split()
    ends = {"odm": "_D.JPG", "odm-bands": "_MS_G.TIF", "odm-thermal": "_T.JPG"}
    for folder, end in ends.items():
        named = [name for name in chosen if name.endswith(end)]
        images = {path.name for path in (out / folder / "images").iterdir()}
        assert images == {*named, *map(masked_name, named)}
    assert len(chosen) == 3 * len([name for name in chosen if name.endswith("_D.JPG")])
    (row,) = (each for each in found.values() if each["name"] == "SIM-1_0003_MS_G.TIF")
    assert (row["shot"], row["shows"]) == ("SIM-1_0003_D.JPG", "G")
    mask = cv2.imread(str(out / "masks" / masked_name(row["name"])), cv2.IMREAD_GRAYSCALE)
    assert mask.shape == (48 // 8, 64 // 8)
    # By its pixels' size on the sensor, a picture of half as many columns shows half as much.
    wide, half = (shapely.from_wkt(found[f"SIM-1_0003_{end}.JPG"]["footprint_wkt"]) for end in "DT")
    assert half.area == pytest.approx(wide.area / 4.0, rel=0.01)
    assert wide.centroid.distance(half.centroid) < 1e-6


def test_bad_photos_are_named_with_the_reason_and_the_rest_is_tagged(
    tmp_path: Path, record: Path
) -> None:
    card = tmp_path / "card"
    write_card(card, 0.0, (ONE,), every=3)
    whole = (card / "SIM-1_0000.JPG").read_bytes()
    (card / "cut.JPG").write_bytes(whole[: len(whole) // 2])
    write_photo(card / "no-time.JPG", place_m=(0.0, 0.0), clock_ns=None)
    at_ns = UTC_AHEAD_NS + START_NS + 60 * NS_PER_S
    write_photo(card / "far.JPG", place_m=(0.0, 9_000.0), clock_ns=at_ns, camera="CAM-SIM-1")
    for number in range(6):
        day_ns = at_ns + (3 * 86_400 + 2 * number) * NS_PER_S
        place = (float(number * 16 - 90), 0.0)
        write_photo(card / f"day-{number}.JPG", place_m=place, clock_ns=day_ns, camera="CAM-9")
    out = tmp_path / "out"
    result = run(card, record, out)
    assert result.exit_code == 0, result.output
    assert "cut.JPG: the file is cut off" in result.output
    assert "no-time.JPG: expected EXIF with the time" in result.output
    assert "another day" in result.output
    notes = {row["name"]: row["note"] for row in rows(out)}
    assert "another day" in notes["day-3.JPG"]
    assert notes["far.JPG"]
    assert notes["SIM-1_0000.JPG"] == ""
    assert not (out / "masks" / masked_name("far.JPG")).exists()


def test_a_clock_that_is_no_zone_off_is_warned_about(tmp_path: Path, record: Path) -> None:
    write_card(tmp_path / "card", 4_800.0, (ONE,), every=4)
    result = run(tmp_path / "card", record, tmp_path / "out")
    assert "is no time zone" in result.output
    assert "clock offset -1 h 19 min 59" in result.output or "-1 h 20 min 00" in result.output


def test_photos_of_another_flight_alone_end_with_an_error(tmp_path: Path, record: Path) -> None:
    write_card(tmp_path / "card", 3 * 86_400.0, (ONE,), every=4)
    result = run(tmp_path / "card", record, tmp_path / "out")
    assert result.exit_code == 1
    assert "another day" in result.output
    assert not (tmp_path / "out").exists()


@pytest.mark.skipif(shutil.which("exiftool") is None, reason="exiftool is not installed")
def test_exiftool_reads_the_sidecars(tagged) -> None:
    _result, out, _card, _truth = tagged
    path = out / "xmp" / "SIM-1_0020.xmp"
    call = ["exiftool", "-json", "-n", os.fspath(path)]
    (facts,) = json.loads(subprocess.run(call, capture_output=True, check=True).stdout)
    (row,) = (each for each in rows(out) if each["name"] == "SIM-1_0020.JPG")
    assert facts["SunlitFraction"] == pytest.approx(float(row["sunlit"]))
    assert facts["GPSLatitude"] == pytest.approx(float(row["latitude_deg"]), abs=1e-6)
    assert facts["Subject"] == row["state"]


def test_sidecars_are_xml_that_states_the_table(tagged) -> None:
    from xml.etree import ElementTree

    _result, out, _card, _truth = tagged
    (row,) = (each for each in rows(out) if each["name"] == "SIM-2_0007.JPG")
    text = (out / "xmp" / "SIM-2_0007.xmp").read_text(encoding="utf-8")
    description = ElementTree.fromstring(text.split("?>", 1)[1].rsplit("<?xpacket", 1)[0])[0][0]
    assert description.attrib["{urn:recon:photo:1}SunlitFraction"] == row["sunlit"]
    assert description.attrib["{urn:recon:photo:1}CapturedUTC"] == row["utc"]


@pytest.mark.parametrize("option", ["--overlap", "--sunlit", "--field", "--clock-offset"])
def test_what_is_no_number_is_refused_and_leaves_no_folder(
    tmp_path: Path, record: Path, option: str
) -> None:
    result = run(tmp_path / "card", record, tmp_path / "out", option, "nan")
    assert result.exit_code == 2
    assert f"'{option}': expected a number, got nan" in result.output
    assert not (tmp_path / "out").exists()
