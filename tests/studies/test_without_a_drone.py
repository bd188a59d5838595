"""From a simulated flight's record to its report, by the commands that the guide names."""

import re
from pathlib import Path

import pytest
from studies.survey_photos import fly
from studies.true_mosaic import lights_of, places_off_m
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.score import load_scenario
from recon.sim.photos.card import CardSettings

FEW = """about = "a small field in sun"
start_utc = 2025-06-20T16:00:00Z

[site]
latitude_deg = 41.9
longitude_deg = -93.6
ground_altitude_m = 280.0

[task]
region_m = [[0.0, 0.0], [120.0, 0.0], [120.0, 80.0], [0.0, 80.0]]
limit_min = 10.0

[fleet]
survey_drones = 1

[imager]
radius_m = 150.0
"""


@pytest.mark.flight
def test_the_commands_lead_from_a_simulated_flight_to_a_mosaic_that_is_true(tmp_path: Path) -> None:
    scenario = tmp_path / "few.toml"
    scenario.write_text(FEW, encoding="utf-8")
    settings = CardSettings(cols=640, clock_ahead_s=3600.0)
    flown = fly(scenario, load_scenario(scenario), 5, tmp_path / "record", settings, 240.0)
    photos, tagged, mosaic = (tmp_path / name for name in ("photos", "tagged", "mosaic"))

    def run(*words: str | Path) -> str:
        ran = CliRunner().invoke(app, [str(each) for each in words])
        assert ran.exit_code == 0, ran.output
        return ran.output

    ordered = ("--width", "640", "--clock-ahead", "3600", "--scenario", scenario)
    said = run("sim", "photos", flown.record, "--out", photos, *ordered)
    assert f"{len(flown.shots)} photos of DJI M3E" in said
    said = run("tag", photos, "--flight", flown.record, "--out", tagged)
    assert re.search("clock offset (-1 h 00 min 00|-0 h 59 min 59)", said), said
    run("mosaic", flown.record, photos, "--out", mosaic)
    run("report", flown.record, "--tagged", tagged, "--out", tmp_path / "report.html")
    lights = lights_of(mosaic, flown)
    assert lights.taken > 100
    assert lights.shaded == 0
    assert max(places_off_m(mosaic, flown)) < 3.0
