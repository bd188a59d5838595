"""`recon shadow-record` on a flight made by construction; its files are read back by GDAL."""

import contextlib
import csv
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest
import rasterio
import shapely
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rasterio.warp import transform
from tests.product.made_flight import (
    FRAME,
    GRID,
    START_NS,
    UTC_AHEAD_NS,
    flight,
    sun,
    write_card,
    write_record,
)
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.geo import cell_centres_m, geo_from_enu
from recon.model.errors import RecordError
from recon.model.units import NS_PER_S
from recon.product.flight_reader import read_flight
from recon.product.tagged import tagged_photos
from recon.product.write import COLUMNS

MADE = flight(maps_every_s=60.0)
BEGINS_S = 0.5
"""Of the first shade map, after the flight's start."""


def run(*words: object):
    return CliRunner().invoke(app, [str(word) for word in words])


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("shadow")
    record = write_record(flight(), folder / "flight.mcap")
    write_card(folder / "card", every=10)
    tagged = run("tag", folder / "card", "--flight", record, "--out", folder / "tagged")
    assert tagged.exit_code == 0, tagged.output
    result = run("shadow-record", record, "--out", folder / "out", "--tagged", folder / "tagged")
    assert result.exit_code == 0, result.output
    return folder


def true_sunlit() -> np.ndarray:
    """(maps, R, C): the truth on the cells at the time of each map."""
    places = np.meshgrid(*cell_centres_m(GRID))
    count = len(flight().maps)
    return np.stack([sun(*places, BEGINS_S + 4.0 * n) >= 0.5 for n in range(count)])


def test_the_bands_tell_when_each_cell_was_in_sun(written: Path) -> None:
    lit, times_s = true_sunlit(), 4.0 * np.arange(len(true_sunlit()))
    never = ~lit.any(axis=0)
    first = np.where(never, np.nan, times_s[lit.argmax(axis=0)])
    last = np.where(never, np.nan, times_s[len(lit) - 1 - lit[::-1].argmax(axis=0)])
    with rasterio.open(written / "out" / "sun.tif") as dataset:
        bands = dataset.read()
        assert np.array_equal(bands[0], first, equal_nan=True)
        assert np.array_equal(bands[1], last, equal_nan=True)
        np.testing.assert_allclose(bands[2], lit.mean(axis=0), atol=1e-6)
        assert (bands[3] == len(lit)).all()
        assert dataset.tags(ns="IMAGE_STRUCTURE")["LAYOUT"] == "COG"
        assert np.isnan(dataset.nodata)
        assert dataset.units[:2] == ("s", "s")
        start_ns = UTC_AHEAD_NS + START_NS + round(BEGINS_S * NS_PER_S)
        start = datetime.fromisoformat(dataset.tags()["RECON_START_UTC"])
        assert start.timestamp() == pytest.approx(start_ns / 1e9)
        assert dataset.descriptions[0] == (
            f"first time in sun, seconds after {dataset.tags()['RECON_START_UTC']}"
        )


def test_the_place_of_a_cell_and_the_name_of_its_reference_system(written: Path) -> None:
    with rasterio.open(written / "out" / "sun.tif") as dataset:
        assert 'PROJCS["Recon site frame at 41.90000, -93.60000"' in dataset.crs.to_wkt()
        east_m, north_m = cell_centres_m(GRID)
        latitude, longitude, _height = geo_from_enu(FRAME, (east_m[140], north_m[20], 0.0))
        east, north = transform("EPSG:4326", dataset.crs, longitude, latitude)
        assert dataset.index(east[0], north[0]) == (20, 140)


def test_photos_are_counted_where_they_lie(written: Path) -> None:
    photos = tagged_photos(written / "tagged", read_flight(written / "flight.mcap"))
    with rasterio.open(written / "out" / "sun.tif") as dataset:
        in_sun, shown = dataset.read([5, 6])
        assert dataset.descriptions[4:] == (
            "photos that show the cell in sun",
            "photos that show the cell",
        )
    places = np.meshgrid(*cell_centres_m(GRID))
    on = np.stack([shapely.contains_xy(each.footprint, *places) for each in photos])
    lit = np.stack([sun(*places, (each.at_ns - START_NS) / NS_PER_S) >= 0.5 for each in photos])
    assert len(photos) == len(list((written / "card").iterdir()))
    assert np.array_equal(shown, on.sum(axis=0))
    # Between two maps the sun is known to metres: edges of shade may lie a cell aside.
    assert np.abs(in_sun - (on & lit).sum(axis=0)).sum() < 0.06 * shown.sum()
    assert 0.2 < in_sun.sum() / shown.sum() < 0.8


def test_the_stack_is_a_folder_of_cogs_with_their_times(written: Path) -> None:
    made, files = flight(), sorted((written / "out" / "shade").iterdir())
    assert len(files) == len(made.maps)
    with rasterio.open(files[3]) as dataset:
        assert dataset.descriptions == ("transmittance", "confidence")
        assert dataset.tags(ns="IMAGE_STRUCTURE")["LAYOUT"] == "COG"
        kept = made.maps[3].sun / 250.0
        np.testing.assert_allclose(dataset.read(1), kept, atol=1e-6)
        moment = datetime.fromisoformat(dataset.tags()["RECON_CAPTURED_UTC"])
        assert moment.timestamp() == pytest.approx((made.maps[3].at_ns + UTC_AHEAD_NS) / 1e9)
        assert moment.strftime("%Y%m%dT%H%M%S") in files[3].name


def test_a_folder_in_use_and_a_foreign_table_are_refused(written: Path, tmp_path: Path) -> None:
    record = written / "flight.mcap"
    used = run("shadow-record", record, "--out", written / "out")
    assert used.exit_code == 2
    assert "expected a new or empty folder" in used.stderr
    for text, sentence in (
        ("a,b\n1,2\n", "got one without"),
        (None, "run recon tag first"),
    ):
        (tmp_path / "tags.csv").unlink(missing_ok=True)
        if text is not None:
            (tmp_path / "tags.csv").write_text(text)
        with pytest.raises(RecordError, match=sentence):
            tagged_photos(tmp_path, read_flight(record))


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("utc", "yesterday"),
        ("utc", "2025-06-20T16:00:00"),
        ("footprint_wkt", "POINT (1 2)"),
        ("footprint_wkt", "POLYGON ((0 nan, 1 1, 2 2, 0 nan))"),
        ("footprint_wkt", "POLYGON ((0 0, "),
    ],
)
def test_a_damaged_table_is_refused_with_its_line(
    written: Path, tmp_path: Path, field: str, value: str
) -> None:
    with (written / "tagged" / "tags.csv").open(encoding="utf-8", newline="") as file:
        row = next(csv.DictReader(file)) | {field: value}
    with (tmp_path / "tags.csv").open("w", encoding="utf-8", newline="") as file:
        table = csv.DictWriter(file, row)
        table.writeheader()
        table.writerow(row)
    with pytest.raises(RecordError, match="line 2 is damaged"):
        tagged_photos(tmp_path, read_flight(written / "flight.mcap"))


CELLS = st.one_of(
    st.text(max_size=20),
    st.sampled_from(["2025-06-20T16:00:00Z", "+999999-01-01", "POLYGON ((1 2, 3 4, 5 6, 1 2))"]),
    st.builds(lambda n: f"POLYGON (({n} {n}, 3 4, 5 1e308, {n} {n}))", st.floats()),
)


@given(st.lists(CELLS, min_size=len(COLUMNS), max_size=len(COLUMNS)), st.booleans())
@settings(max_examples=80, deadline=None, suppress_health_check=list(HealthCheck))
def test_no_table_breaks_the_reader(tmp_path: Path, cells: list[str], has_head: bool) -> None:
    with (tmp_path / "tags.csv").open("w", encoding="utf-8", errors="surrogatepass") as file:
        csv.writer(file).writerows(([COLUMNS] if has_head else []) + [cells])
    with contextlib.suppress(RecordError):
        tagged_photos(tmp_path, MADE)
