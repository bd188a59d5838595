"""`recon verify` on light sensors: what they show is known by construction."""

import csv
from datetime import UTC, datetime
from pathlib import Path

import cv2
import netCDF4
import numpy as np
import pytest
from tests.cli.test_verify import rows, verify
from tests.detection.shaded_field import FIELD, FRAME, DriftingShade
from tests.product import made_flight

from recon.cli.shadow_record import shadow_record_command
from recon.geo import cells_of, geo_from_enu
from recon.light.files import read_points
from recon.light.lines import LightLines
from recon.model.event import Event
from recon.station.recording.recorded_values import values_codec

BEGIN_S = 1_750_000_000
COUNT, EVERY_S = 30, 10
SENSORS = 60
FULL_WPM2 = 800.0


def places() -> tuple[np.ndarray, np.ndarray]:
    """East and north of the sensors."""
    east_m, north_m = np.random.default_rng(7).uniform(-240.0, 240.0, (2, SENSORS))
    return east_m, north_m


def light() -> np.ndarray:
    """(T, N): a quarter of full light in shade; each sensor has its own scale."""
    drawn, cells = DriftingShade(5, 0.4, (5.0, 2.0)), cells_of(FIELD, *places())
    direct = np.stack([drawn.transmittance(FIELD, EVERY_S * n)[cells] for n in range(COUNT)])
    return FULL_WPM2 * np.linspace(0.5, 2.0, SENSORS) * (0.25 + 0.75 * direct)


TIMES_S = BEGIN_S + EVERY_S * np.arange(COUNT)
NAMES = [f"S{number:02}" for number in range(SENSORS)]


def iso(at_s: float) -> str:
    return datetime.fromtimestamp(at_s, UTC).isoformat()


def write_csv(path: Path, *lines: list[object]) -> Path:
    with path.open("w", newline="") as file:
        csv.writer(file).writerows(lines)
    return path


def wide(folder: Path) -> list[object]:
    east_m, north_m = places()
    values = [[iso(at), *row] for at, row in zip(TIMES_S, light().tolist(), strict=True)]
    head = [["time", *NAMES], ["east_m", *east_m], ["north_m", *north_m]]
    return [write_csv(folder / "wide.csv", *head, *values)]


def long(folder: Path) -> list[object]:
    """One logger after the other, each a little late in its own way; places in degrees beside."""
    east_m, north_m = places()
    lines: list[list[object]] = [["Timestamp", "Station", "ghi"]]
    for name, values, late_s in zip(NAMES, light().T, np.linspace(0.0, 2.0, SENSORS), strict=True):
        lines += [[at + late_s, name, v] for at, v in zip(TIMES_S.tolist(), values, strict=True)]
    at = np.column_stack([east_m, north_m, np.zeros(SENSORS)])
    latitude, longitude, _height = geo_from_enu(FRAME, at)
    stated = [list(each) for each in zip(NAMES, latitude, longitude, strict=True)]
    beside = write_csv(folder / "places.csv", ["sensor", "lat", "lon"], *stated)
    return [write_csv(folder / "long.csv", *lines), "--places", beside]


def npz(folder: Path) -> list[object]:
    east_m, north_m = places()
    path = folder / "points.npz"
    np.savez(path, time_unix_s=TIMES_S, ghi_wpm2=light(), east_m=east_m, north_m=north_m)
    return [path]


def netcdf(folder: Path, unit: str = "seconds", unit_s: float = 1.0) -> list[object]:
    east_m, north_m = places()
    with netCDF4.Dataset(folder / "points.nc", "w") as file:
        file.createDimension("time", COUNT)
        file.createDimension("station", SENSORS)
        for name, over, values in (
            ("time", ("time",), (TIMES_S - BEGIN_S) / unit_s),
            ("east_m", ("station",), east_m),
            ("north_m", ("station",), north_m),
            ("ghi", ("time", "station"), light()),
        ):
            file.createVariable(name, "f8", over)[:] = values
        file.variables["time"].units = f"{unit} since {iso(BEGIN_S)}"
    return [folder / "points.nc"]


def netcdf_of_days(folder: Path) -> list[object]:
    return netcdf(folder, "days", 86_400.0)


def netcdf_of_milliseconds(folder: Path) -> list[object]:
    return netcdf(folder, "milliseconds", 1e-3)


@pytest.mark.parametrize("made", [long, npz, netcdf, netcdf_of_days, netcdf_of_milliseconds])
def test_every_form_of_a_file_states_the_same(tmp_path: Path, made) -> None:
    path, *beside = made(tmp_path)
    found, truth = read_points(path, beside[1] if beside else None), read_points(*wide(tmp_path))
    assert len(found.names) == SENSORS
    assert np.abs(found.times_ns - truth.times_ns).max() < 10**9
    np.testing.assert_allclose(found.direct, truth.direct, atol=1e-6)
    for ours, other in ((found.east_m, truth.east_m), (found.north_m, truth.north_m)):
        np.testing.assert_allclose(ours - ours.mean(), other - other.mean(), atol=0.05)


def test_forecasts_at_sensors_against_both_baselines(tmp_path: Path) -> None:
    code, text, problems = verify(*wide(tmp_path))
    assert (code, problems) == (0, "")
    assert f"{SENSORS} sensors, {COUNT} times, 10 s apart" in text
    assert "| Brier | 20 s | 30 s | 60 s | 120 s |" in text
    found = {name: [float(v) for v in each] for name, each in rows(text, "Brier").items()}
    assert found["advection"][0] < 0.7 * found["persistence"][0]
    against = rows(text, "Brier over that of climatology")
    assert set(against) == {"advection", "persistence"}
    assert float(against["advection"][0]) < 0.7


def test_what_cannot_be_used_is_counted_and_named(tmp_path: Path) -> None:
    east_m, north_m = places()
    values = light()
    values[:, 1] = np.nan
    values[:, 2] = -1.0
    values[7, 3:9] = np.nan
    kept = [number for number in range(COUNT) if number not in (11, 12)]
    lines = [[iso(TIMES_S[n]), *values[n]] for n in [*kept, 4]]
    beside = [[n, e, m] for n, e, m in zip(NAMES, east_m, north_m, strict=True)][1:]
    path = write_csv(tmp_path / "a.csv", ["utc", *NAMES], *lines)
    at = write_csv(tmp_path / "at.csv", ["name", "east_m", "north_m"], *beside)
    found = read_points(path, at)
    assert found.names == tuple(NAMES[3:])
    assert found.notes == (
        "1 values or rows at a time seen before, not used",
        "1 sensors without a place: S00",
        "2 sensors without light: S01, S02",
        "1 gaps in time, the longest 30 s",
        "0.4 % of the values unknown",
    )
    code, text, problems = verify(path, "--places", at, "--plot", tmp_path / "p.png")
    assert (code, problems) == (0, "")
    assert all(f"  {note}\n" in text for note in found.notes)
    drawn = cv2.imread(str(tmp_path / "p.png"))
    assert drawn is not None
    assert (drawn != 255).any(axis=2).mean() > 0.01


BAD = [
    (
        "time,a,b,c\n2025-06-20T16:00:00,1,2,x\n",
        "row 2: expected a number such as 1480 or 0.5, got 'x'",
    ),
    ("a,b,c\n1,2,3\n", "expected a head with a column time, got a, b, c"),
    (
        "time,a,b\n2025-06-20T16:00:00,1\n",
        "row 2: expected 3 values, one for each column of the head, got 2",
    ),
    ("time,a\nyesterday,1\n", "row 2: expected a time in ISO 8601 or Unix seconds"),
    ("time,a\n1750000000000,1\n", "expected Unix seconds, got 1.75e+12 (milliseconds?)"),
    ("time,a\n1750000000,1\n", "expected places of the sensors (rows or columns lat and lon"),
    ("time,a,a\n1750000000,1,2\n", "expected each column once, got a twice"),
    ("time,sensor,ghi,par\n1750000000,a,1,2\n", "expected one column of values"),
    ("time,a,b,c\nlat,95,1,2\nlon,1,2,3\n1750000000,1,2,3\n", "expected latitudes and longitudes"),
]


@pytest.mark.parametrize(("text", "words"), BAD)
def test_bad_tables_are_one_sentence(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "bad.csv").write_text(text.replace("1750000000,1,2,3\n", THREE))
    code, out, problems = verify(tmp_path / "bad.csv")
    assert (code, out) == (2, "")
    assert len(problems.splitlines()) == 1
    assert words in problems


THREE = "".join(f"{BEGIN_S + n},1,2,3\n" for n in range(4))


@pytest.mark.parametrize(
    ("east", "north", "words"),
    [
        ("1,2,3", "1,2,3", "expected 3 places or more that are not on one line"),
        ("0,0.001,0.002", "0,0.002,0", "(degrees named east and north?)"),
        ("0,5,2e6", "0,6,0", "expected places within 20 km, got 2000 km: correct that of c"),
    ],
)
def test_places_that_cannot_be_are_one_sentence(
    tmp_path: Path, east: str, north: str, words: str
) -> None:
    (tmp_path / "bad.csv").write_text(f"time,a,b,c\neast_m,{east}\nnorth_m,{north}\n" + THREE)
    code, _out, problems = verify(tmp_path / "bad.csv")
    assert code == 2
    assert words in problems


def sensors_of_a_flight(folder: Path) -> Path:
    """Thirty sensors under the made flight's bands of shade, in degrees, UTC, each second."""
    rng = np.random.default_rng(3)
    east_m, north_m = rng.uniform(-140.0, 140.0, (2, 30))
    latitude, longitude, _height = geo_from_enu(
        made_flight.FRAME, np.column_stack([east_m, north_m, np.zeros(30)])
    )
    begin_s = (made_flight.START_NS + made_flight.UTC_AHEAD_NS) / 1e9
    values = [
        [iso(begin_s + s), *(0.25 + 0.75 * made_flight.sun(east_m, north_m, s))]
        for s in np.arange(0.0, 250.0, 1.0)
    ]
    head = [["time", *map(str, range(30))], ["lat", *latitude], ["lon", *longitude]]
    return write_csv(folder / "sensors.csv", *head, *values)


def test_maps_of_a_flight_and_its_folder_are_held_against_sensors(tmp_path: Path) -> None:
    sensors = sensors_of_a_flight(tmp_path)
    made = made_flight.flight(maps_every_s=20.0)
    record = made_flight.write_record(made, tmp_path / "flight.mcap")
    out = tmp_path / "shadow"
    shadow_record_command(record, out)
    texts = []
    for maps in (record, out / "shade"):
        code, text, problems = verify(sensors, "--maps", maps)
        assert (code, problems) == (0, "")
        texts.append(text.partition("| map says")[2])
        said = rows(text, "map says | sensor in sun | sensor in shade")
        hits = {name: [int(each) for each in cells] for name, cells in said.items()}
        right = hits["sun"][0] + hits["shade"][1]
        assert right > 0.95 * (sum(hits["sun"]) + sum(hits["shade"]))
        assert min(hits["sun"][0], hits["shade"][1]) > 20
        assert "unknown" in hits
    assert texts[0] == texts[1]


def test_the_sensors_of_a_flight_record_are_read_without_a_file(tmp_path: Path) -> None:
    """What loggers sent in the flight gives the figures of a file with the same values."""
    sensors = sensors_of_a_flight(tmp_path)
    lines, loggers = LightLines(made_flight.FRAME), []
    for line in sensors.read_bytes().splitlines(keepends=True):
        lines.push(line, 0)
        read, problems = lines.taken("mast")
        assert problems == []
        if read is not None:
            loggers.append(values_codec().to_builtins(read, Event))
    made = made_flight.flight(maps_every_s=20.0)
    events = [(made_flight.START_NS, each) for each in loggers]
    record = made_flight.write_record(made, tmp_path / "flight.mcap", events=events)
    by_file = verify(sensors, "--maps", record)
    assert verify(record) == by_file
    assert "right in 96.9 %" in by_file[1]


def test_a_flight_without_sensors_is_one_sentence(tmp_path: Path) -> None:
    record = made_flight.write_record(made_flight.flight(), tmp_path / "flight.mcap")
    code, _out, problems = verify(record)
    assert code == 2
    assert "expected a flight with light sensors (recon run --light-sensors), got none" in problems


def test_one_sensor_is_enough_to_hold_maps_against(tmp_path: Path) -> None:
    lines = sensors_of_a_flight(tmp_path).read_text().splitlines()
    one = tmp_path / "one.csv"
    one.write_text("".join(",".join(line.split(",")[:2]) + "\n" for line in lines))
    record = made_flight.write_record(made_flight.flight(), tmp_path / "flight.mcap")
    assert verify(one, "--maps", record)[0] == 0
    assert "expected 3 sensors" in verify(one)[2]
