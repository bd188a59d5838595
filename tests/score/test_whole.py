"""A scenario flown by the whole station in virtual time, and what is said of it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.score.scenes import SMALL, small

from recon.model.geo import GeoPoint
from recon.score import Methods, RunScore, Scenario, run
from recon.score.whole import run_whole
from recon.score.whole.run import WholeRun
from recon.score.whole.ways import TrueWay, begins, encounters
from recon.sim.app.app import AppSettings, SimulatedApp
from recon.sim.fleet import IMAGER_SERIAL
from recon.sim.flight.aircraft import Aircraft
from recon.sim.flight.flight_modes import Hold
from recon.sim.flight.kinematics import AircraftMotion

CLEAR = SMALL.replace('faults = ["pilot-takes:1:40:30"]', "").partition("[[clouds]]")[0]
SHORT = CLEAR.replace("limit_min = 10.0", "limit_min = 1.5")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("scenarios")


@pytest.fixture(scope="module")
def clear(folder: Path) -> tuple[Scenario, RunScore]:
    scenario = small(folder, CLEAR)
    return scenario, run_whole(scenario, 3)


def test_a_field_in_sun_is_imaged_and_all_come_home(clear: tuple[Scenario, RunScore]) -> None:
    _scenario, flown = clear
    assert flown.to_95_in_sun_s is not None
    assert flown.in_sun_share[0] > 0.97
    assert flown.shaded_photos == 0
    assert flown.photos > 30
    assert flown.survey_s < 300.0
    assert (flown.encounters, flown.breaches, flown.low_landings) == (0, 0, 0)


def test_flights_by_events_come_to_the_same(clear: tuple[Scenario, RunScore]) -> None:
    scenario, flown = clear
    guessed = run(scenario, 3)
    assert guessed.missions == flown.missions
    assert guessed.to_95_imaged_s is not None
    assert flown.to_95_imaged_s is not None
    # The station's people wait until all are heard, and the checklist is passed.
    assert flown.to_95_imaged_s - guessed.to_95_imaged_s == pytest.approx(0.0, abs=25.0)
    assert flown.photos == pytest.approx(guessed.photos, rel=0.1)


def test_the_same_seed_gives_the_same_score(folder: Path) -> None:
    scenario = small(folder, SHORT)
    assert run_whole(scenario, 5) == run_whole(scenario, 5)


def test_shade_is_read_from_rendered_frames(folder: Path) -> None:
    scenario = small(folder, SHORT + "[[clouds]]\ncover = 0.4\nouter_scale_m = 2000.0\n")
    scenario = replace(scenario, methods=Methods("otsu", "persistence"))
    whole = WholeRun(scenario, 2)
    for _ in range(20):
        whole.pass_a_second()
    shade = whole.driver.station.shade.shade
    assert shade is not None
    assert shade.source_serials == (IMAGER_SERIAL,)
    assert 0.5 < shade.valid.mean() <= 1.0


def test_when_the_time_is_over_all_are_called_home(folder: Path) -> None:
    scenario = small(folder, SHORT.replace("[200.0, 0.0],", "[600.0, 0.0],"))
    flown = run_whole(scenario, 1)
    assert flown.to_95_imaged_s is None
    assert 90.0 < flown.survey_s < 400.0
    assert "abort" in flown.end


def flying(east_m: list[float], height_m: float) -> TrueWay:
    """A way eastwards, a place a second, that is in the air all the time."""
    app = SimulatedApp(
        AppSettings(serial="SIM-1", home=GeoPoint(41.9, -93.6, 280.0)),
        Aircraft(0, motion=AircraftMotion(height_m=height_m), active_mode=Hold()),
    )
    places = [(east, 0.0, height_m) for east in east_m]
    return TrueWay(
        app, (0.0, 0.0, 0.0), list(map(float, range(len(places)))), places, [True] * len(places)
    )


def test_two_that_pass_each_other_level_meet_once_and_layers_never() -> None:
    east_m = [float(e) for e in range(0, 100, 5)]
    there, back = flying(east_m, 50.0), flying(east_m[::-1], 50.0)
    assert encounters([there, back]) == 1
    assert encounters([there, flying(east_m[::-1], 58.0)]) == 0


def test_what_begins_is_counted_once_each_time() -> None:
    assert begins(np.array([True, True, False, True, False, False, True])) == 3
    assert begins(np.zeros(4, dtype=np.bool_)) == 0


def test_people_see_to_what_goes_wrong_and_the_field_is_imaged(folder: Path) -> None:
    faults = 'faults = ["pilot-takes:1:25:40", "low-battery:2:30"]\n'
    text = CLEAR.replace("[site]", f"{faults}\n[site]").replace(
        "[fleet]", "[fleet]\nswap_min = 1.0"
    )
    flown = run_whole(small(folder, text), 4)
    assert flown.to_95_imaged_s is not None
    assert flown.survey_s > flown.to_95_imaged_s
    assert flown.low_landings == 1
    assert (flown.encounters, flown.breaches) == (0, 0)
