"""From a simulated flight's record to its report, by the commands that the guide names."""

import re
from pathlib import Path

import pytest
from studies.survey_photos import fly
from studies.true_mosaic import lights_of, places_off_m
from tests.small_field import small_field
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.score import load_scenario
from recon.sim.photos.card import CardSettings


@pytest.mark.flight
def test_the_commands_lead_from_a_simulated_flight_to_a_mosaic_that_is_true(tmp_path: Path) -> None:
    scenario = small_field(tmp_path, drones=1)
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
