"""`recon export` beyond tracks: read back by the rules of the formats."""

import json
import xml.etree.ElementTree as ET
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import cv2
import numpy as np
import pyogrio
import pytest
import rasterio
from tests.product.made_flight import FRAME, ONE, OTHER, flight, write_record
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.geo import enu_from_geo
from recon.model.units import NS_PER_S
from recon.product.charts import NOT_SHOWN, SHADE_ONLY, SUNLIT, WELL_SUNLIT
from recon.product.exports import FLIGHT_FORMATS, coverage_picture, kml
from recon.product.flight import FlownSurvey
from recon.product.flight_reader import read_flight

HOSTILE = '<b>&"]]>\x00\x1b\ud800'


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("exports") / "flight.mcap"
    return write_record(flight(ONE, OTHER, maps_every_s=12.0), path)


def export(record: Path, out: Path):
    return CliRunner().invoke(app, ["export", str(record), str(out)])


def names(path: Path, layer: str) -> list[str]:
    about, _fids, _shapes, columns = pyogrio.raw.read(path, layer=layer)
    return columns[list(about["fields"]).index("Name")].tolist()


def test_kml_is_read_by_gdal_at_its_place(record: Path, tmp_path: Path) -> None:
    out = tmp_path / "a.kml"
    assert export(record, out).exit_code == 0
    assert [name for name, _kind in pyogrio.list_layers(out)] == ["Surveys", "Tracks"]
    assert pyogrio.read_info(out, layer="Surveys")["crs"] == "EPSG:4326"
    assert names(out, "Surveys") == ["field"]
    assert names(out, "Tracks") == ["Drone 1", "Drone 2"]
    root = ET.parse(out).getroot()
    text = next(root.iter("{http://www.opengis.net/kml/2.2}coordinates")).text
    assert text is not None
    corners = np.array([[float(n) for n in each.split(",")] for each in text.split()])
    ground_m = np.full(len(corners), FRAME.origin.ellipsoid_height_m)
    enu_m = enu_from_geo(FRAME, corners[:, 1], corners[:, 0], ground_m)
    outline = np.array(flight().surveys[0].outline_m)
    np.testing.assert_allclose(enu_m[:, :2], [*outline, outline[0]], atol=0.01)


def test_hostile_names_are_text_in_kml() -> None:
    made = flight()
    hole = ((0.0, 0.0), (5.0, 0.0), (5.0, 5.0))
    survey = FlownSurvey(made.surveys[0].outline_m, (hole,), 60.0, 8.0, HOSTILE)
    made = replace(made, surveys=[survey], names={"SIM-1": HOSTILE})
    root = ET.fromstring(kml(made).decode())
    space = "{http://www.opengis.net/kml/2.2}"
    names = [each.text for each in root.iter(f"{space}name")]
    assert names.count('<b>&"]]>\ufffd\ufffd\ufffd') == 2
    assert len(list(root.iter(f"{space}innerBoundaryIs"))) == 1


def test_the_sun_by_cell_and_the_figures(record: Path, tmp_path: Path) -> None:
    assert export(record, tmp_path / "sun.tif").exit_code == 0
    with rasterio.open(tmp_path / "sun.tif") as dataset:
        assert dataset.count == 4
        assert "Recon site frame" in dataset.crs.to_wkt()
    assert export(record, tmp_path / "coverage.png").exit_code == 0
    picture = cv2.imread(str(tmp_path / "coverage.png"), cv2.IMREAD_UNCHANGED)
    assert picture is not None
    # 180 m in cells of 2 m, all photographed.
    assert picture.shape == (90, 90, 4)
    assert (picture[..., 3] == 255).all()
    result = export(record, tmp_path / "figures.json")
    assert result.exit_code == 0, result.output
    found = json.loads((tmp_path / "figures.json").read_text())
    assert found["site"] == "made field"
    assert found["vehicles"] == ["Drone 1", "Drone 2"]
    assert found["region_m2"] == pytest.approx(180.0**2)
    assert 0.5 < found["well_sunlit_share"] <= found["sunlit_share"] <= 1.0


def test_ground_of_the_region_without_photos_has_a_colour_of_its_own() -> None:
    made = flight(maps_every_s=30.0)
    track = made.tracks["SIM-1"]
    # The first row only, 100 m west; and a region without its corner in the south-east.
    cut = np.searchsorted(track.at_ns, track.at_ns[0] + 36 * NS_PER_S)
    fields = ("at_ns", "east_m", "north_m", "height_m", "yaw_deg")
    track = replace(track, **{name: getattr(track, name)[:cut] for name in fields})
    outline = ((-90.0, -90.0), (0.0, -90.0), (0.0, 0.0), (90.0, 0.0), (90.0, 90.0), (-90.0, 90.0))
    surveys = [replace(made.surveys[0], outline_m=outline)]
    data = coverage_picture(replace(made, tracks={"SIM-1": track}, surveys=surveys))
    picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    assert picture is not None
    pixels = cv2.cvtColor(picture, cv2.COLOR_BGRA2RGBA)
    assert pixels[20, 80].tolist() == list(NOT_SHOWN)
    assert pixels[80, 80].tolist() == [0, 0, 0, 0]
    assert pixels[40, 3].tolist() in [list(each) for each in (SHADE_ONLY, SUNLIT, WELL_SUNLIT)]
    key = files("recon.product").joinpath("report.html").read_text()
    console = Path("web/src/panels/flights/flights.css").read_text()
    for red, green, blue, _alpha in (NOT_SHOWN, SHADE_ONLY, SUNLIT, WELL_SUNLIT):
        colour = f"#{red:02x}{green:02x}{blue:02x}"
        assert colour in key
        assert colour in console


def test_long_reading_shows_its_progress(
    record: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rich.console.Console.is_terminal", True)
    for name, words in (
        ("a.csv", "reading tracks"),
        ("a.png", "reading the flight"),
        ("a.nc", "writing NetCDF"),
    ):
        result = export(record, tmp_path / name)
        assert words in result.stderr
        assert words not in result.stdout
    report = CliRunner().invoke(app, ["report", str(record), "--out", str(tmp_path / "r.html")])
    assert "reading decisions and forecasts" in report.stderr
    out = ["shadow-record", str(record), "--out", str(tmp_path / "sr")]
    assert "reading the flight" in CliRunner().invoke(app, out).stderr


def test_what_cannot_be_exported_is_refused(record: Path, tmp_path: Path) -> None:
    bare = write_record(replace(flight(), maps=[], surveys=[]), tmp_path / "bare.mcap")
    result = export(bare, tmp_path / "sun.tif")
    assert result.exit_code == 2
    assert "expected a flight with shade maps" in result.stderr
    assert not (tmp_path / "sun.tif").exists()
    found = json.loads(FLIGHT_FORMATS[".json"](read_flight(bare)))
    assert found["region_m2"] is None
    assert export(record, tmp_path / "a.shp").exit_code == 2
    (tmp_path / "a.kml").write_text("mine")
    assert export(record, tmp_path / "a.kml").exit_code == 2
    assert (tmp_path / "a.kml").read_text() == "mine"
