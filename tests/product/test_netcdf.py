"""`recon export --netcdf`: read back by xarray and GDAL, and checked against CF-1.11."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest
import rasterio
import xarray
from compliance_checker.cf.cf_1_11 import CF1_11Check
from compliance_checker.suite import CheckSuite
from tests.product.made_flight import (
    FORECAST_LEADS_S,
    FRAME,
    GRID,
    ONE,
    START_NS,
    UTC_AHEAD_NS,
    flight,
    write_record,
)
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.geo import sun_position
from recon.model.geo import LatLon
from recon.model.units import NS_PER_S
from recon.product.flight import FULL
from recon.record.mcap.codec import encode_array
from recon.record.raster.geotiff import projected_crs

MADE = flight(ONE, maps_every_s=12.0)
INSIDE = np.zeros((20, 30), bool)
INSIDE[4:16, 5:25] = True
STATE = np.where(np.arange(30) < 15, 2, 1) * np.ones((20, 1))
PICTURES = Path(__file__).parents[1] / "replay/flights/pictures.mcap"
UNSIGNED_IS_NEWER = "Variable is not of type byte, short, or int"
"""The checker's rule of packed data is older than CF-1.9, which allows unsigned bytes."""


def keyframe(state: np.ndarray, velocity_mps: tuple[float, float] | None) -> dict[str, Any]:
    """What a station's keyframe states, with a survey on cells of 4 m around the origin."""
    place = {"west_m": -60.0, "north_m": 40.0, "cell_m": 4.0, "rows": 20, "cols": 30}
    cells = {"grid": place, "is_inside": encode_array(INSIDE)}
    survey = {"plan": {"cells": cells}, "progress": {"state": encode_array(state)}}
    record = {"survey": {"id": 7, "name": "wheat"}, "state": survey}
    maps = {"velocity_mps": velocity_mps}
    return {"parts": {"surveys": {"records": [[7, record]]}, "fleet": {}}, "maps": maps}


def chance(at_s: float, lead_s: float) -> np.ndarray:
    return np.full((GRID.rows, GRID.cols), (at_s + lead_s) % 256.0 / 255.0)


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    frames = [
        (2.0, keyframe(np.zeros_like(STATE, np.uint8), None)),
        (4.0, keyframe(np.zeros_like(STATE, np.uint8), (99.0, 99.0))),  # too soon after the first
        (8.0, keyframe(STATE.astype(np.uint8), (9.0, -1.5))),
    ]
    path = tmp_path_factory.mktemp("netcdf") / "flight.mcap"
    return write_record(MADE, path, forecast=chance, keyframes=frames)


@pytest.fixture(scope="module")
def netcdf(record: Path) -> Path:
    out = record.with_suffix(".nc")
    result = export(record, out, "--netcdf")
    assert result.exit_code == 0, result.output
    assert [each.name for each in record.parent.iterdir() if each.name.startswith(".")] == []
    return out


def export(record: Path, out: Path, *options: str):
    return CliRunner().invoke(app, ["export", str(record), str(out), *options])


def complaints(path: Path) -> list[str]:
    """What the CF checker finds in a file's root group."""
    suite = CheckSuite()
    suite.checkers = {"cf:1.11": CF1_11Check}
    dataset = suite.load_dataset(str(path))
    found = suite.run_all(dataset, ["cf:1.11"])
    dataset.close()
    results = [each for results, _errors in found.values() for each in results]
    unmet = [each for each in results if each.value is False or each.value[0] < each.value[1]]
    return [said for each in unmet for said in each.msgs]


def alone(path: Path, group: str, out: Path) -> Path:
    """Copy a group to a file of its own, with the projection that it finds in the root."""
    with netCDF4.Dataset(path) as source, netCDF4.Dataset(out, "w") as copy:
        copy.setncatts(source.__dict__)
        copy.setncatts(source[group].__dict__)
        for name, size in source[group].dimensions.items():
            copy.createDimension(name, len(size))
        for each in (source["crs"], *source[group].variables.values()):
            about = dict(each.__dict__)
            fill = about.pop("_FillValue", None)
            made = copy.createVariable(each.name, each.dtype, each.dimensions, fill_value=fill)
            made.setncatts(about)
            made[:] = each[:]
    return out


def test_the_cf_checker_has_no_complaint(netcdf: Path, tmp_path: Path) -> None:
    for path in (netcdf, alone(netcdf, "tracks", tmp_path / "tracks.nc")):
        assert [each for each in complaints(path) if UNSIGNED_IS_NEWER not in each] == []


def test_xarray_reads_maps_forecasts_and_states(netcdf: Path) -> None:
    with xarray.open_dataset(netcdf) as data:
        number = 5
        at_ns = MADE.maps[number].at_ns
        utc = np.datetime64(at_ns + UTC_AHEAD_NS, "ns")
        assert abs(data.time.values[number] - utc) < np.timedelta64(1, "us")
        np.testing.assert_allclose(
            data.transmittance[number], MADE.maps[number].sun / FULL, atol=0.001
        )
        sure = data.confidence[number].values
        np.testing.assert_allclose(sure, 0.9, atol=0.003)
        place = LatLon(FRAME.origin.latitude_deg, FRAME.origin.longitude_deg)
        sun = sun_position(place, (at_ns + UTC_AHEAD_NS) / NS_PER_S)
        assert float(data.solar_azimuth_angle[number]) == pytest.approx(sun.azimuth_deg)
        assert float(data.solar_elevation_angle[number]) == pytest.approx(sun.elevation_deg)

        assert data.lead.values.tolist() == list(FORECAST_LEADS_S)
        at_s = (at_ns - START_NS) / NS_PER_S
        issued = data.sun_probability[number]
        np.testing.assert_allclose(issued[2], chance(at_s, 60.0), atol=0.003)
        assert issued.valid_time.values[
            2
        ] - issued.forecast_reference_time.values == np.timedelta64(60, "s")

        assert np.isnan(data.shadow_velocity_east[0])
        velocity = (data.shadow_velocity_east[1], data.shadow_velocity_north[1])
        assert [float(each) for each in velocity] == [9.0, -1.5]
        assert data.survey_name.values.tolist() == ["wheat (7)"]
        # A place in the survey's eastern part, in shade; in its western; and outside.
        cells = data.survey_state[0].sel(y=1.0)
        assert cells.sel(x=[5.0, -5.0, -59.0])[1].values[:2].tolist() == [1.0, 2.0]
        assert np.isnan(cells.sel(x=-59.0)).all()
        assert (cells.sel(x=[5.0, -5.0])[0] == 0.0).all()


def test_xarray_reads_tracks(netcdf: Path) -> None:
    track = MADE.tracks["SIM-1"]
    with xarray.open_datatree(netcdf) as tree:
        tracks = tree["tracks"].to_dataset(inherit=False)
        assert tracks.attrs["featureType"] == "trajectory"
        assert tracks.serial.values.tolist() == ["SIM-1"]
        assert tracks.vehicle_name.values.tolist() == ["Drone 1"]
        assert tracks.sample_count.values.tolist() == [len(track.at_ns)]
        np.testing.assert_allclose(tracks.sample_x, track.east_m, atol=0.01)
        np.testing.assert_allclose(tracks.sample_y, track.north_m, atol=0.01)
        np.testing.assert_allclose(tracks.heading, track.yaw_deg, atol=0.01)
        assert tracks.latitude.values[0] == pytest.approx(FRAME.origin.latitude_deg, abs=0.002)


@pytest.mark.parametrize("name", ["transmittance", "sun_probability", "survey_state"])
def test_gdal_reads_the_maps_at_their_place(netcdf: Path, name: str) -> None:
    with rasterio.open(f"netcdf:{netcdf}:{name}") as dataset:
        assert dataset.transform[:6] == (2.0, 0.0, GRID.west_m, 0.0, -2.0, GRID.north_m)
        frame = dataset.crs.to_dict()
        wanted = rasterio.crs.CRS.from_wkt(projected_crs(FRAME)).to_dict()
        assert frame["proj"] == "tmerc"
        assert [frame[key] for key in ("lat_0", "lon_0", "k")] == pytest.approx(
            [wanted[key] for key in ("lat_0", "lon_0", "k")]
        )
        if name == "transmittance":
            assert dataset.count == len(MADE.maps)
            assert (dataset.read(6) == MADE.maps[5].sun).all()


def test_forecasts_soon_after_another_are_excluded(tmp_path: Path) -> None:
    """They are most of a file."""
    maps = [replace(MADE.maps[0], at_ns=START_NS + number * NS_PER_S) for number in range(5)]
    path = write_record(replace(MADE, maps=maps), tmp_path / "a.mcap", forecast=chance)
    assert export(path, tmp_path / "a.nc").exit_code == 0
    with xarray.open_dataset(tmp_path / "a.nc") as data:
        assert data.sizes["time"] == 5
        assert data.sizes["forecast_reference_time"] == 3


def test_a_time_of_day_that_is_unknown_gives_no_sun(tmp_path: Path) -> None:
    path = write_record(replace(MADE, maps=MADE.maps[:2]), tmp_path / "a.mcap", has_clock=False)
    assert export(path, tmp_path / "a.nc").exit_code == 0
    with xarray.open_dataset(tmp_path / "a.nc") as data:
        assert np.isnan(data.solar_elevation_angle).all()


@pytest.mark.parametrize(
    "damaged",
    [
        {"parts": {"surveys": {"records": [[1, {"state": {"plan": 3}}]]}}},
        keyframe(STATE[:5].astype(np.uint8), None),
        {"parts": {}, "maps": {"velocity_mps": "fast"}},
    ],
    ids=["plan", "shape", "velocity"],
)
def test_a_damaged_keyframe_is_a_sentence(tmp_path: Path, damaged: dict[str, Any]) -> None:
    short = replace(MADE, maps=MADE.maps[:1])
    path = write_record(short, tmp_path / "a.mcap", keyframes=[(1.0, damaged)])
    result = export(path, tmp_path / "a.nc")
    assert result.exit_code == 2
    assert "/recon/keyframes is damaged" in result.stderr
    assert list(tmp_path.iterdir()) == [path]


def test_a_record_that_is_cut_or_empty(tmp_path: Path) -> None:
    cut, whole = tmp_path / "cut.mcap", PICTURES.read_bytes()
    cut.write_bytes(whole[: len(whole) * 9 // 10])
    result = export(cut, tmp_path / "cut.nc")
    assert result.exit_code == 0, result.output
    with xarray.open_dataset(tmp_path / "cut.nc") as data:
        assert "The record ends early" in data.attrs["comment"]
    cut.write_bytes(b"")
    result = export(cut, tmp_path / "empty.nc")
    assert result.exit_code == 2
    assert "expected a flight record" in result.stderr
    bare = write_record(replace(MADE, maps=[]), tmp_path / "bare.mcap")
    assert "expected a flight with shade maps" in export(bare, tmp_path / "bare.nc").stderr
    assert not (tmp_path / "bare.nc").exists()


def test_a_keyframe_of_another_version_states_nothing(tmp_path: Path) -> None:
    short = replace(MADE, maps=MADE.maps[:1])
    path = write_record(short, tmp_path / "a.mcap", keyframes=[(1.0, {"parts": {}, "maps": None})])
    assert export(path, tmp_path / "a.nc").exit_code == 0
    with xarray.open_dataset(tmp_path / "a.nc") as data:
        assert np.isnan(data.shadow_velocity_east).all()
        assert data.sizes["survey"] == 0


def test_a_stations_own_record(tmp_path: Path) -> None:
    """What a keyframe holds is read as the station writes it."""
    assert export(PICTURES, tmp_path / "a.nc").exit_code == 0
    with xarray.open_dataset(tmp_path / "a.nc") as data:
        assert data.sizes["time"] > 1
        assert data.sizes["forecast_reference_time"] > 1
        assert data.sizes["state_time"] == 1
