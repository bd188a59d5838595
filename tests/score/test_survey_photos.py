"""Which photos a recorded simulated flight's drones would have taken, and who is refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.product.made_flight import HEIGHT_M, ONE, START_NS, flight, write_record
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.cli.sim_photos import TRUTH_FILE, simulated_truth, write_photos
from recon.model.units import NS_PER_S
from recon.product.photos.photo import read_photo_facts
from recon.score import ScenarioError
from recon.score.survey_photos import shots_of
from recon.score.truth import world_text
from recon.sim.photos.card import CardSettings

SCENARIO = Path(__file__).parents[2] / "scenarios" / "cumulus-40.toml"
SEED = 7
SIMULATED = replace(flight(), scenario=world_text(SCENARIO, SEED, START_NS))
TRUTH = simulated_truth(SIMULATED, SCENARIO)


def test_the_timer_takes_a_photo_each_interval_where_the_drone_is() -> None:
    shots = shots_of(SIMULATED, TRUTH)
    at_s = np.array([shot.at_s for shot in shots])
    assert np.diff(at_s) == pytest.approx(2.0)
    assert len(shots) == pytest.approx(SIMULATED.tracks["SIM-1"].at_ns.size / 20, abs=1)
    east, north, _yaw = ONE.place(at_s)
    places = np.array([shot.place_m for shot in shots])
    assert places[:, 0] == pytest.approx(east, abs=0.3)
    assert places[:, 1] == pytest.approx(north, abs=0.3)
    assert {shot.height_above_takeoff_m for shot in shots} == {HEIGHT_M}


def test_photos_are_at_the_surveys_height_only() -> None:
    track = SIMULATED.tracks["SIM-1"]
    rising = np.clip(track.at_ns - START_NS, 0, 30 * NS_PER_S) / NS_PER_S * 2.0
    low = replace(SIMULATED, tracks={"SIM-1": replace(track, height_m=rising)})
    assert min(shot.at_s for shot in shots_of(low, TRUTH)) == pytest.approx(28.0, abs=1.01)
    on_ground = replace(SIMULATED, tracks={"SIM-1": replace(track, height_m=0.0 * rising)})
    with pytest.raises(ScenarioError, match="expected a survey that was flown, got none"):
        shots_of(on_ground, TRUTH)


@pytest.mark.flight
def test_the_folder_holds_the_photos_and_a_table_of_their_truth(tmp_path) -> None:
    count = write_photos(tmp_path, SIMULATED, TRUTH, CardSettings(cols=400), every=70)
    head, *rows = (tmp_path / TRUTH_FILE).read_text(encoding="utf-8").splitlines()
    assert len(rows) == count == len(list(tmp_path.glob("*.JPG")))
    row = dict(zip(head.split(","), rows[0].split(","), strict=True))
    found = read_photo_facts(tmp_path / row["name"], row["name"])
    assert float(row["latitude_deg"]) == pytest.approx(found.latitude_deg, abs=5e-5)
    assert float(row["kappa_deg"]) == pytest.approx(-found.flight_yaw_deg, abs=1.0)
    assert 0.0 <= float(row["sunlit"]) <= 1.0


def test_a_record_of_real_drones_is_refused_in_one_sentence(tmp_path) -> None:
    record = write_record(flight(), tmp_path / "real.mcap")
    ran = CliRunner().invoke(app, ["sim", "photos", str(record), "--out", str(tmp_path / "out")])
    assert ran.exit_code == 2
    assert "expected a simulated flight, as recon demo records one" in ran.stderr
    assert not (tmp_path / "out").exists()


def test_another_scenario_than_the_flown_one_is_refused(tmp_path) -> None:
    other = tmp_path / SCENARIO.name
    other.write_text(SCENARIO.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    with pytest.raises(ScenarioError, match="not the scenario as it was flown"):
        simulated_truth(SIMULATED, other)
