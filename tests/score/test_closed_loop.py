"""Small scenarios flown to their ends: the same to the bit, and what must be so by construction."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.score.scenes import SMALL, small

from recon.score import Methods, RunScore, Scenario, run, tables
from recon.score.forecast_metrics import Ahead
from recon.score.run_score import encounters, shares_by, time_to_share
from recon.score.settings import RUN

CALM = SMALL.replace('faults = ["pilot-takes:1:40:30"]', "")
CLEAR = CALM.split("[[clouds]]", maxsplit=1)[0]
DARK = CLEAR + "[[clouds]]\ncover = 1.0\nmodulation = 0.0\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("scenarios")


def planned(scenario: Scenario, planner: str) -> Scenario:
    return replace(scenario, survey=replace(scenario.survey, planner=planner))


def ends_soon(scenario: Scenario) -> Scenario:
    return replace(scenario, methods=replace(scenario.methods, forecast="none"))


@pytest.fixture(scope="module")
def cumulus(folder: Path) -> RunScore:
    return run(small(folder), 3)


def test_a_seed_repeats_to_the_bit(folder: Path, cumulus: RunScore) -> None:
    again = run(small(folder), 3)
    assert again == cumulus
    scenario = small(folder)
    assert tables(scenario, [again]) == tables(scenario, [cumulus])


def test_another_seed_is_another_sky(folder: Path, cumulus: RunScore) -> None:
    assert run(small(folder), 4).shade_share != cumulus.shade_share


def test_under_a_clear_sky_once_is_enough(folder: Path) -> None:
    found = run(ends_soon(small(folder, CLEAR)), 0)
    assert found.end == "all that the rows reach is imaged in sun"
    assert found.missions == 2
    assert found.to_95_in_sun_s == found.to_95_imaged_s
    assert found.in_sun_share[-1] > 0.99
    assert (found.shaded_photos, found.wrongly_in_sun_share) == (0, 0.0)
    assert found.shade.iou is None
    # Two drones, of whom each flies half of the survey's time and less.
    assert found.flight_s <= 2.0 * found.survey_s


def test_under_a_closed_sky_it_is_cut_off(folder: Path) -> None:
    scenario = ends_soon(small(folder, DARK))
    found = run(scenario, 0)
    assert found.to_95_imaged_s is not None
    assert found.to_95_in_sun_s is None
    assert found.shaded_photos == found.photos > 0
    assert max(found.in_sun_share) == 0.0
    assert "600 s allowed are over" in found.end
    told = tables(scenario, [found, replace(found, seed=1)])
    assert "| time to 95 % in sun, min | at least 10.0 | 10.0 to 10.0 | 0 of 2 in time |" in told


def test_once_flies_what_again_flies_first(folder: Path) -> None:
    scenario = ends_soon(small(folder, CALM))
    once, again = (
        run(planned(scenario, name), 3) for name in ("lawnmower_once", "lawnmower_again")
    )
    assert once.to_95_imaged_s == again.to_95_imaged_s
    assert once.flight_s <= again.flight_s
    assert once.in_sun_share[-1] <= again.in_sun_share[-1]


def test_an_ideal_imager_has_no_fault(cumulus: RunScore) -> None:
    assert (cumulus.shade.iou, cumulus.known_share) == (1.0, 1.0)
    assert cumulus.boundary_error_m in (0.0, None)
    assert cumulus.wrongly_in_sun_share is not None
    assert cumulus.wrongly_in_sun_share < 0.02


def test_a_detector_is_worse_and_says_nothing_at_first(folder: Path) -> None:
    scenario = small(folder)
    found = run(replace(scenario, methods=Methods("brightness_ratio", "persistence")), 3)
    assert 0.0 < found.known_share < 1.0
    assert found.shade.iou is not None
    assert found.shade.iou < 1.0


def test_every_lead_is_scored_and_the_parts_are_the_whole(cumulus: RunScore) -> None:
    for lead_s in (60.0, 180.0, 300.0):
        seen, unseen, every = (cumulus.leads[lead_s, ahead] for ahead in Ahead)
        assert every.cells == seen.cells + unseen.cells > 0
        assert every.brier is not None
        assert 0.0 <= every.brier <= 1.0


def test_a_pilot_who_takes_a_drone_costs_time(folder: Path) -> None:
    calm = run(ends_soon(small(folder, CLEAR)), 0)
    with_fault = small(folder, SMALL.split("[[clouds]]", maxsplit=1)[0])
    taken = run(ends_soon(with_fault), 0)
    assert taken.to_95_imaged_s is not None
    assert calm.to_95_imaged_s is not None
    assert taken.to_95_imaged_s > calm.to_95_imaged_s + 10.0
    assert taken.in_sun_share[-1] > 0.99


@pytest.mark.parametrize(
    "fault", ["gnss-loss:*:50", "low-battery:1:60", "telemetry-dropout:2:60:9"]
)
def test_every_mishap_leaves_a_run_that_ends(folder: Path, fault: str) -> None:
    text = CLEAR.replace("[site]", f'faults = ["{fault}"]\n[site]', 1)
    found = run(ends_soon(small(folder, text)), 0)
    assert found.survey_s <= 600.0 + RUN.longest_way_home_s + 10.0
    assert found.flight_s > 0.0


def test_batteries_are_changed_and_the_survey_goes_on(folder: Path) -> None:
    text = CLEAR.replace("survey_drones = 2", "survey_drones = 1\nendurance_min = 5.0")
    text = text.replace("limit_min = 10.0", "limit_min = 40.0")
    found = run(ends_soon(small(folder, text)), 0)
    assert found.missions > 1
    assert found.low_landings == 0
    assert found.in_sun_share[-1] > 0.99
    assert found.flight_s < found.survey_s - 180.0


def test_time_to_a_share_is_when_the_last_needed_cell_came() -> None:
    first_s = np.array([50.0, 10.0, np.inf, 20.0])
    assert time_to_share(first_s, 0.5, 100.0) == 20.0
    assert time_to_share(first_s, 0.75, 100.0) == 50.0
    assert time_to_share(first_s, 0.75, 40.0) is None
    assert time_to_share(first_s, 0.95, 100.0) is None
    assert shares_by(first_s, np.array([0.0, 10.0, 60.0])) == (0.0, 0.25, 0.75)


def test_an_encounter_counts_once_and_only_in_the_air() -> None:
    still = np.zeros((6, 3))
    passing = np.array([[x, 0.0, 0.0] for x in (50.0, 5.0, 5.0, 50.0, 5.0, 50.0)])
    up = np.ones(6, dtype=np.bool_)
    assert encounters([still, passing], [up, up], 10.0, 6.0) == 2
    assert encounters([still, passing], [up, ~up], 10.0, 6.0) == 0
    assert encounters([still, passing + np.array((0.0, 0.0, 8.0))], [up, up], 10.0, 6.0) == 0


def test_rows_longer_than_shade_maps_are_kept_count_in_sun(folder: Path) -> None:
    text = CLEAR.replace("200.0, 0.0", "1200.0, 0.0").replace("200.0, 150.0", "1200.0, 150.0")
    text = text.replace("radius_m = 160.0", "radius_m = 700.0\ncell_m = 20.0")
    found = run(ends_soon(small(folder, text)), 0)
    assert found.end == "all that the rows reach is imaged in sun"
    assert found.missions == 2
