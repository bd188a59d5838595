"""Small scenarios flown by the whole station in virtual time, those of several tests once."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.score.scenes import BRIEF, TINY, small

from recon.model.geo import GeoPoint
from recon.model.units import NS_PER_S
from recon.score import Methods, RunScore, Scenario, StationRun, run, tables
from recon.score.forecast_figures import SeenCells
from recon.score.run_score import shares_by, time_to_share
from recon.score.scenario import TRUE_MOTION
from recon.score.true_paths import TruePath, encounters, times_begun
from recon.sim.app.app import AppSettings, SimulatedApp
from recon.sim.app.faults import parse_fault
from recon.sim.fleet import IMAGER_SERIAL
from recon.sim.flight.aircraft import Aircraft
from recon.sim.flight.flight_modes import PositionHold
from recon.sim.flight.kinematics import AircraftMotion
from recon.sim.fork import fork

CLEAR = TINY.partition("[[clouds]]")[0]
DARK = CLEAR + "[[clouds]]\ncover = 1.0\nmodulation = 0.0\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("scenarios")


def guidance_alone(scenario: Scenario) -> Scenario:
    """A run of it ends with the survey."""
    return replace(scenario, methods=replace(scenario.methods, forecast="none"))


@pytest.fixture(scope="module")
def started(folder: Path) -> StationRun:
    """A survey of a field in sun, its drones on their rows."""
    begun = StationRun(guidance_alone(small(folder, CLEAR)), 3)
    while begun.now_s < 38.0:
        begun.advance_a_second()
    return begun


@pytest.fixture(scope="module")
def clear(started: StationRun) -> RunScore:
    return fork(started).score()


@pytest.fixture(scope="module")
def cumulus(folder: Path) -> RunScore:
    """With forecasts scored for 2 min from the first minute on."""
    return run(small(folder, TINY.replace("limit_min = 10.0", "limit_min = 3.1")), 8)


@pytest.fixture(scope="module")
def short(folder: Path) -> tuple[Scenario, RunScore]:
    scenario = small(folder, BRIEF.replace("radius_m = 80.0", "radius_m = 160.0"))
    return scenario, run(scenario, 5)


@pytest.mark.flight
def test_a_field_in_sun_is_imaged_in_one_round(clear: RunScore) -> None:
    assert clear.end == "Complete: all reachable ground photographed in sun"
    assert clear.missions == 2
    assert clear.to_95_imaged_s is not None
    assert clear.to_95_in_sun_s == clear.to_95_imaged_s
    assert clear.in_sun_share[-1] > 0.99
    assert clear.photos > 10
    assert (clear.shaded_photos, clear.wrongly_in_sun) == (0, 0)
    assert clear.shade.iou is None
    assert clear.survey_s < 300.0


@pytest.mark.flight
def test_all_drones_land_without_a_violation(clear: RunScore) -> None:
    assert (clear.encounters, clear.breaches, clear.low_landings) == (0, 0, 0)
    assert clear.landings == 2
    # Two drones, each in the air for part of the run.
    assert 0.0 < clear.flight_s <= 2.0 * clear.survey_s


@pytest.mark.flight
def test_a_seed_repeats_to_the_bit(short: tuple[Scenario, RunScore]) -> None:
    scenario, first = short
    again = run(scenario, 5)
    assert again == first
    assert tables(scenario, [again]) == tables(scenario, [first])
    skies = [StationRun(scenario, seed)._sky.settings for seed in (5, 6)]
    assert skies[0] != skies[1]


@pytest.mark.flight
def test_an_overcast_survey_ends_at_the_limit_and_all_return(folder: Path) -> None:
    text = DARK.replace("limit_min = 10.0", "limit_min = 1.5")
    scenario = guidance_alone(small(folder, text))
    found = run(scenario, 0)
    assert found.to_95_imaged_s is not None
    assert found.to_95_in_sun_s is None
    assert found.shaded_photos == found.photos > 0
    assert max(found.in_sun_share, default=0.0) == 0.0
    assert 90.0 < found.survey_s < 200.0
    assert "abort" in found.end
    assert found.holds == 0
    printed = tables(scenario, [found, replace(found, seed=1)])
    row = "| time to 95 % in sun, min | at least 1.5 | 1.5 to 1.5 | 0 of 2 within the limit |"
    assert row in printed


@pytest.mark.flight
def test_ideal_detection_errs_by_latency_and_pose_alone(cumulus: RunScore) -> None:
    shade = cumulus.shade
    assert shade.iou is not None
    assert 0.9 < shade.iou < 1.0
    assert 0 < shade.wrong < 0.03 * shade.cells
    assert shade.unknown < 0.02 * shade.cells
    assert cumulus.to_right_s is not None
    assert cumulus.to_right_s < 15.0
    assert cumulus.registration_m is not None
    median_m, high_m = cumulus.registration_m
    assert 0.0 < median_m < high_m < 8.0
    assert cumulus.counted_in_sun > 0
    assert cumulus.wrongly_in_sun < 0.02 * cumulus.counted_in_sun
    assert cumulus.to_95_imaged_s is not None
    assert cumulus.to_95_in_sun_s is not None
    assert cumulus.to_95_in_sun_s > cumulus.to_95_imaged_s


@pytest.mark.flight
def test_cells_seen_and_not_seen_add_up(cumulus: RunScore) -> None:
    shares = []
    for lead_s in (15.0, 30.0, 120.0):
        seen, unseen, every = (cumulus.forecasts["advection", lead_s, c] for c in SeenCells)
        assert every.cells == seen.cells + unseen.cells > 0
        shares.append(seen.cells / every.cells)
        assert every.brier is not None
        assert 0.0 <= every.brier <= 1.0
    assert 1.0 > shares[0] > shares[1] > shares[2] == 0.0


def test_methods_are_compared_on_the_same_maps_and_cells(short: tuple[Scenario, RunScore]) -> None:
    scenario, single = short
    compared = ("persistence", "advection", TRUE_MOTION)
    found = run(replace(scenario, methods=Methods(compared=compared)), 5).forecasts
    for lead_s in (15.0, 30.0):
        scores = [found[name, lead_s, SeenCells.SEEN] for name in compared]
        assert len({score.cells for score in scores}) == 1
        persistence, shift, true = (score.brier for score in scores)
        assert persistence is not None
        assert shift is not None
        assert true is not None
        assert true < persistence
        assert true < shift
    # The station's own is what it is without the others.
    alone = single.forecasts
    assert {key: alone[key] for key in alone} == {key: found[key] for key in alone}
    assert {name for name, _lead_s, _cells in alone} == {"advection"}


@pytest.mark.flight
def test_a_detector_reads_rendered_frames_with_errors(folder: Path) -> None:
    scenario = replace(small(folder, TINY), methods=Methods("otsu", "persistence"))
    flown = StationRun(scenario, 2)
    for _ in range(32):
        flown.advance_a_second()
    shade = flown.driver.station.shade.shade
    assert shade is not None
    assert shade.source_serials == (IMAGER_SERIAL,)
    assert 0.5 < shade.valid.mean() <= 1.0
    scored = flown.shade_score
    assert scored.shade.iou is not None
    assert scored.shade.iou < 1.0
    assert len(scored.registration_errors_m) > 3


@pytest.mark.flight
def test_frames_that_stop_leave_maps_unknown(folder: Path) -> None:
    faults = 'faults = ["camera-stops:SIM-IMAGER:30:120"]\n[site]'
    text = TINY.replace("[site]", faults)
    run_ = StationRun(small(folder, text), 0)
    while run_.now_s < 62.0:
        run_.advance_a_second()
    found = run_.shade_score.shade
    assert 0 < found.unknown < found.cells


def flown_to_the_surveys_end(flown: StationRun, at_most_s: float) -> StationRun:
    """Advance until the survey is over, landed or not."""
    while not (flown.record is not None and flown.record.is_over) and flown.now_s < at_most_s:
        flown.advance_a_second()
    return flown


def test_a_fork_of_a_run_is_the_run(started: StationRun) -> None:
    """Truth, operator and scores too: each reads the apps of its own world."""
    ends = []
    for each in (fork(started), fork(fork(started))):
        for _ in range(3):
            each.advance_a_second()
        paths = [path.places_m for path in each.drones]
        ends.append((repr(each.driver.station), repr(each.shade_score), paths))
    assert ends[0] == ends[1]
    assert [len(path.at_s) for path in each.drones] > [len(path.at_s) for path in started.drones]


@pytest.mark.flight
@pytest.mark.parametrize("fault", ["gnss-loss:1:40:10", "telemetry-dropout:2:40:9"])
def test_a_survey_is_completed_after_a_fault(started: StationRun, fault: str) -> None:
    flown, injected = fork(started), parse_fault(fault)
    serial = flown.scenario.fleet.serials[int(injected.vehicle) - 1]
    flown.apps.connected[serial].app.inject(injected)
    flown = flown_to_the_surveys_end(flown, 400.0)
    assert flown.in_sun_share > 0.99
    assert all(path.flown_s > 0.0 for path in flown.drones)


@pytest.mark.flight
def test_the_operator_resumes_drones_after_pilot_and_low_battery(
    folder: Path, clear: RunScore
) -> None:
    faults = 'faults = ["pilot-takes:1:25:40", "low-battery:2:30"]\n[site]'
    text = CLEAR.replace("[site]", faults).replace("[fleet]", "[fleet]\nswap_min = 1.0")
    flown = run(guidance_alone(small(folder, text)), 4)
    assert flown.to_95_imaged_s is not None
    assert clear.to_95_imaged_s is not None
    assert flown.to_95_imaged_s > clear.to_95_imaged_s + 10.0
    assert flown.survey_s > flown.to_95_imaged_s
    assert flown.low_landings == 1
    assert (flown.encounters, flown.breaches) == (0, 0)


@pytest.mark.flight
def test_a_survey_continues_after_a_battery_change(folder: Path) -> None:
    one = "survey_drones = 1\nendurance_min = 3.5\nswap_min = 0.1\nkept_share = 0.9"
    text = (
        CLEAR.replace("survey_drones = 2", one).replace("60.0,", "80.0,").replace("40.0]", "60.0]")
    )
    found = run(guidance_alone(small(folder, text)), 0)
    assert found.missions > 1
    assert (found.landings, found.low_landings) == (2, 0)
    assert found.in_sun_share[-1] > 0.99
    assert found.flight_s < found.survey_s - 30.0


@pytest.mark.flight
def test_rows_longer_than_the_shade_history_count_in_sun(folder: Path) -> None:
    text = (
        CLEAR.replace("60.0,", "600.0,")
        .replace("40.0]", "25.0]")
        .replace("drones = 2", "drones = 1")
    )
    wide = "field_deg = 83.0\ncoarsest_m = 70.0\nradius_m = 400.0\ncell_m = 10.0"
    text = text.replace("radius_m = 160.0", wide)
    flown = flown_to_the_surveys_end(StationRun(guidance_alone(small(folder, text)), 3), 600.0)
    assert flown.record is not None
    assert flown.record.state is not None
    assert flown.record.state.reason == "Complete: all reachable ground photographed in sun"
    assert flown.record.state.missions == 1


@pytest.mark.flight
def test_an_imaging_drone_told_to_goes_upwind_and_sees_what_comes(folder: Path) -> None:
    """Clouds go north to east of north: it hovers south of where it began, and looks back."""
    layer = "[[clouds]]\ncover = 0.5\nspeed_mps = 8.0\nheading_deg = 90.0\n"
    text = CLEAR + layer + "outer_scale_m = 2000.0\n"
    tilted = "[imager]\nupwind = true\ntilt_deg = 20.0\nreach_m = 400.0\ncell_m = 8.0"
    run_ = StationRun(small(folder, text.replace("[imager]", tilted)), 5)
    (imager,) = [p for s, p in run_._paths.items() if s == IMAGER_SERIAL]
    while run_.now_s < 35.0:
        run_.advance_a_second()
    (start, end) = (np.array(imager.places_m[0]), np.array(imager.places_m[-1]))
    velocity = run_.driver.station.shade.sun.velocity_mps
    assert velocity is not None
    upwind = -np.array(velocity) / np.hypot(*velocity)
    assert (end - start)[:2] @ upwind > 30.0
    heading = run_.driver.station.fleet.vehicles[IMAGER_SERIAL].attitude.value.yaw_deg
    toward = np.array([np.sin(np.radians(heading)), np.cos(np.radians(heading))])
    assert toward @ upwind > 0.98


@pytest.mark.flight
def test_two_imaging_drones_make_one_map(folder: Path) -> None:
    """Each sees 150 m around itself, 200 m apart: all of the scored ground is known."""
    two = "[imager]\nalso_over_m = [[245.0, 30.0]]\nreach_m = 400.0\ncell_m = 8.0"
    text = TINY.replace("[imager]", two)
    run_ = StationRun(small(folder, text), 5)
    while run_.now_s < 50.0:
        run_.advance_a_second()
    shade = run_.driver.station.shade.shade
    assert shade is not None
    assert set(shade.source_serials) == set(run_.scenario.site.imagers)
    figures = run_.shade_score.shade
    assert figures.cells > 0
    assert figures.unknown < 0.02 * figures.cells
    assert figures.shade.iou is None or figures.shade.iou > 0.9
    assert len(run_.drones) == 2


def test_time_to_a_share_is_that_of_the_last_needed_cell() -> None:
    first_s = np.array([50.0, 10.0, np.inf, 20.0])
    assert time_to_share(first_s, 0.5, 100.0) == 20.0
    assert time_to_share(first_s, 0.75, 100.0) == 50.0
    assert time_to_share(first_s, 0.75, 40.0) is None
    assert time_to_share(first_s, 0.95, 100.0) is None
    assert shares_by(first_s, np.array([0.0, 10.0, 60.0])) == (0.0, 0.25, 0.75)


def flying(east_m: list[float], height_m: float, is_up: bool = True) -> TruePath:
    """A path eastwards, one position per second."""
    app = SimulatedApp(
        AppSettings(serial="SIM-1", home=GeoPoint(41.9, -93.6, 280.0)),
        Aircraft(0, motion=AircraftMotion(height_m=height_m), active_mode=PositionHold()),
    )
    at_s = [float(second) for second in range(len(east_m))]
    places = [(east, 0.0, height_m) for east in east_m]
    return TruePath(app, (0.0, 0.0, 0.0), at_s, places, [is_up] * len(places))


def test_an_encounter_counts_once_level_and_in_the_air() -> None:
    east_m = [float(e) for e in range(0, 100, 5)]
    there, back = flying(east_m, 50.0), flying(east_m[::-1], 50.0)
    assert encounters([there, back]) == 1
    assert encounters([there, flying(east_m[::-1], 58.0)]) == 0
    assert encounters([there, flying(east_m[::-1], 50.0, is_up=False)]) == 0
    twice = [50.0, 5.0, 5.0, 50.0, 5.0, 50.0]
    assert encounters([flying([0.0] * 6, 50.0), flying(twice, 50.0)]) == 2


def test_a_landing_counts_and_a_crash_does_not() -> None:
    landing, crash = flying([], 0.5), flying([], 50.0)
    landing.app.aircraft.land()
    for second in range(30):
        for path in (landing, crash):
            path.app.aircraft.advance(second * NS_PER_S)
            path.sample(second * NS_PER_S)
        if second == 10:
            crash.app.aircraft.crash()
    assert (len(landing.landed_with), crash.landed_with) == (1, [])
    assert not any((landing.is_up[-1], crash.is_up[-1]))


def test_each_turn_to_true_counts_once() -> None:
    assert times_begun(np.array([True, True, False, True, False, False, True])) == 3
    assert times_begun(np.zeros(4, dtype=np.bool_)) == 0
