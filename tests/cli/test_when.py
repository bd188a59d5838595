"""`recon when` and the weather that `recon site fetch` brings: hours, reasons, ages."""

import json
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.fetching.file_server import file_server, send
from tests.site.weather_answer import FIRST, OFFSET_S, answer
from typer.testing import CliRunner, Result

from recon.cli.commands import app
from recon.model.airspace import Region
from recon.site import load_site
from recon.site.expected_wind import wind_report

QUERY = "/v1/forecast?latitude={latitude}&longitude={longitude}&hourly=cloud_cover"
PATH = "/v1/forecast?latitude=41.90&longitude=-93.60&hourly=cloud_cover"
MIDNIGHT_S = FIRST.timestamp() - OFFSET_S
CLOUD = [80 if 8 <= hour % 24 < 10 else 20 for hour in range(48)]


def run(*words: str) -> Result:
    return CliRunner().invoke(app, words, catch_exceptions=False)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "field"
    run("site", "new", str(made), "--at", "41.9012,-93.6034", "--ground-altitude-m", "275")
    return made


def at(seconds: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Set the clock of the commands, in seconds from the first hour of the weather."""
    monkeypatch.setattr(time, "time", lambda: MIDNIGHT_S + seconds)


def test_hours_follow_from_fetched_weather(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    at(-3 * 86_400.0, monkeypatch)
    with file_server({PATH: json.dumps(answer(CLOUD)).encode()}) as server:
        found = run("site", "fetch", str(folder), "--weather", server.address + QUERY)
    assert server.asked == [PATH]
    assert "weather.json written: 48 hours from 127.0.0.1, 2026-06-21 00:00 to" in found.output
    assert "wind aloft at 850 hPa" in found.output
    at(7 * 3600.0, monkeypatch)
    lines = run("when", str(folder), "--camera", "mavic3m").output.splitlines()
    assert lines[0] == (
        "site field: camera Mavic 3M, RGB (JPEG only); times are UTC-05:00, America/Chicago, as "
        "the weather states"
    )
    assert lines[1] == (
        "weather of 127.0.0.1, fetched 3 days ago, until 2026-06-22 23:00; after that the sun alone"
    )
    assert lines[2:5] == [
        "Sun 2026-06-21  09:30 - 10:15, 16:15 - 17:55",
        "Mon 2026-06-22  09:30 - 10:15, 16:15 - 17:55",
        "Tue 2026-06-23  08:35 - 10:20, 16:15 - 17:55",
    ]
    assert lines[5:9] == [
        "Sun 2026-06-21 07:00 - 08:35: the sun is below 30 degrees, 29 at most",
        "Sun 2026-06-21 08:35 - 09:30: clouds cover 80 % of the sky, more than 60 %",
        "Sun 2026-06-21 10:15 - 16:15: the hot spot is in the picture: the sun is 49 to 72 degrees "
        "high, more than 49",
        "Sun 2026-06-21 17:55 - 24:00: the sun is below 30 degrees, 30 at most",
    ]
    checked = run("site", "check", str(folder)).output
    assert "weather of 127.0.0.1, fetched 3 days ago, until 2026-06-22 23:00 there\n" in checked
    site = load_site(folder)
    (line,) = wind_report(site, time.time())
    assert line == (
        "until maps show the shadows' motion, 10.0 m/s towards 45 degrees is expected: the wind at "
        "850 hPa by the weather, fetched 3 days ago"
    )
    field = Region(np.array([[0.0, 0.0], [300.0, 0.0], [300.0, 300.0], [0.0, 300.0]]))
    bounded = replace(site, layers=replace(site.layers, boundary=field))
    _, crossed = wind_report(bounded, time.time())
    assert crossed.startswith("shade crosses the site in 42 s then")  # its diagonal at 10 m/s
    at(60 * 3600.0, monkeypatch)
    assert "there: it is over, and is not used" in run("site", "check", str(folder)).output
    assert wind_report(load_site(folder), time.time()) == ()


def test_without_weather_the_sun_decides_and_the_command_states_it(folder: Path) -> None:
    words = ("--from", "2026-06-21", "--days", "1", "--utc-offset", "-05:00")
    lines = run("when", str(folder), *words).output.splitlines()
    assert lines[0].endswith("as the site names none; times are UTC-05:00")
    assert lines[1].startswith("no weather: the sun alone; recon site fetch --weather")
    assert lines[2] == "Sun 2026-06-21  08:35 - 10:15, 16:15 - 17:55"
    found = json.loads(run("when", str(folder), *words, "--json").output)
    assert (found["utc_offset_s"], found["weather"]) == (-18_000.0, None)
    (day,) = found["days"]
    assert [span["fit"] for span in day["spans"]] == [
        *("low sun", "fits", "hot spot", "fits", "low sun"),
    ]
    assert day["spans"][1]["from"] == "08:35"
    assert not day["spans"][1]["has_weather"]


def test_a_file_and_the_sites_own_table(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "answer.json").write_text(json.dumps(answer(CLOUD)))
    site_file = folder / "site.toml"
    table = f'\n[fetch]\nweather = "{tmp_path}/answer.json"\n'
    site_file.write_text(site_file.read_text() + table)
    assert "from answer.json" in run("site", "fetch", str(folder)).output
    assert (folder / "weather.json").exists()


@pytest.mark.parametrize(
    ("reply", "sentence"),
    [
        (b"<html>", "127.0.0.1: expected Open-Meteo's JSON, got"),
        (b"[" * 3_000_000, "127.0.0.1: expected weather, got: expected weather of at most"),
        (b'{"error":true,"reason":"too many"}', "got the server's refusal: too many"),
        (None, "127.0.0.1: expected weather, got none"),
    ],
)
def test_hostile_weather_is_refused_and_changes_nothing(
    folder: Path, reply: bytes | None, sentence: str
) -> None:
    with file_server({} if reply is None else {PATH: reply}) as server:
        found = run("site", "fetch", str(folder), "--weather", server.address + QUERY)
    assert found.exit_code != 0
    assert sentence in found.stderr
    assert not (folder / "weather.json").exists()


def test_a_server_that_refuses_is_not_asked_again(folder: Path) -> None:
    with file_server({PATH: b""}, lambda handler, _: send(handler, b"", 403)) as server:
        found = run("site", "fetch", str(folder), "--weather", server.address + QUERY)
    assert "status 403" in found.stderr
    assert len(server.asked) == 1


@pytest.mark.parametrize(
    "words",
    [("--from", "1999-01-01"), ("--from", "soon"), ("--utc-offset", "5"), ("--camera", "x")],
)
def test_options_that_mean_nothing_are_refused(folder: Path, words: tuple[str, str]) -> None:
    assert run("when", str(folder), *words).exit_code == 2
