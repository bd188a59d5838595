"""What faults do to flights that go by events, one by one."""

from dataclasses import replace
from math import inf
from pathlib import Path

import pytest
from tests.score.scenes import SMALL, small

from recon.score import Scenario, run
from recon.score.autopilot import Point
from recon.score.drone import Doing, Drone
from recon.score.fault_effects import blind_spans, mishaps_of, without_effect
from recon.score.scenario import Fleet
from recon.score.settings import FLIGHT
from recon.sim.app.faults import FaultKind, parse_fault
from recon.sim.world import Wind, WindSettings

CLEAR = SMALL.replace('faults = ["pilot-takes:1:40:30"]', "").split("[[clouds]]", maxsplit=1)[0]
WIND = Wind(WindSettings(speed_10m_mps=4.0, heading_deg=90.0, veer_deg_per_100m=0.0))
ROWS = [
    Point((0.0, 0.0, 40.0), 8.0),
    Point((0.0, 200.0, 40.0), 8.0),
    Point((30.0, 200.0, 40.0), 8.0),
    Point((30.0, 0.0, 40.0), 8.0),
]


def drone(**changes: object) -> Drone:
    fleet = Fleet(((0.0, 0.0),), 1_500.0, 0.2, 180.0)
    return Drone("SIM-1", (0.0, 0.0), fleet, 8.0, 40.0, WIND, FLIGHT, **changes)  # type: ignore[arg-type]


def on_a_mission() -> Drone:
    """It has flown its rows for ten seconds at 60 s."""
    flying = drone()
    flying.take(1, ROWS, 1, 0.0)
    flying.advance(60.0)
    assert flying.doing is Doing.MISSION
    return flying


def faulty(folder: Path, *faults: str) -> Scenario:
    scenario = small(folder, CLEAR)
    methods = replace(scenario.methods, forecast="none")
    faults_of_it = tuple(parse_fault(text) for text in faults)
    return replace(scenario, methods=methods, faults=faults_of_it)


def test_a_pilot_holds_it_where_it_is_and_gives_it_back() -> None:
    taken = on_a_mission()
    taken.hold(60.0, 160.0)
    assert taken.spot_at(150.0) == taken.spot_at(60.0)
    assert not taken.surveyor(150.0).is_able
    assert taken.surveyor(150.0).ended_mission == 1
    taken.advance(160.0)
    assert taken.surveyor(160.0).is_able


def test_who_was_stopped_for_a_moment_is_looked_at_first() -> None:
    taken = on_a_mission()
    taken.hold(60.0, 61.0)
    assert taken.free_at_s == 60.0 + FLIGHT.looked_s


def test_without_satellites_the_wind_carries_it_along() -> None:
    lost = on_a_mission()
    east_m, north_m, up_m = lost.spot_at(60.0)
    lost.drift(60.0, 80.0)
    wind_mps = WIND.mean_mps(40.0)[0]
    assert lost.spot_at(80.0) == pytest.approx((east_m + 20.0 * wind_mps, north_m, up_m))
    assert lost.spot_at(200.0) == lost.spot_at(80.0)
    on = on_a_mission()
    on.drift(60.0, inf)
    assert on.spot_at(inf)[0] == pytest.approx(east_m + FLIGHT.drifts_s * wind_mps)


def test_unheard_it_flies_on_and_what_it_does_is_told_late_or_never() -> None:
    quiet, heard = on_a_mission(), on_a_mission()
    for each in (quiet, heard):
        each.seen(60.0)
    ends_s = quiet.free_at_s
    quiet.lose_word(60.0, ends_s + 20.0)
    for each in (quiet, heard):
        each.advance(ends_s)
    assert quiet.seen(ends_s) == []
    assert len(heard.seen(ends_s)) > 5
    assert quiet.spot_at(ends_s) == heard.spot_at(ends_s)
    assert (quiet.surveyor(ends_s).ended_mission, heard.surveyor(ends_s).ended_mission) == (0, 1)
    assert quiet.surveyor(ends_s).is_able
    assert quiet.surveyor(ends_s + 20.0).ended_mission == 1


def test_on_the_ground_nobody_who_is_not_heard_is_able() -> None:
    quiet = drone()
    quiet.lose_word(0.0, 10.0)
    assert not quiet.surveyor(5.0).is_able
    assert quiet.surveyor(10.0).is_able


@pytest.mark.parametrize("flies", [False, True])
def test_a_mission_that_is_ignored_is_not_flown_and_somebody_has_to_look(flies: bool) -> None:
    deaf = drone()
    if flies:
        deaf.take(1, ROWS, 1, 0.0)
        deaf.advance(deaf.free_at_s)
    now_s = 200.0
    deaf.advance(now_s)
    before = deaf.spot_at(now_s)
    deaf.ignore_missions(now_s + 1.0)
    deaf.take(2, ROWS, 1, now_s)
    later_s = now_s + FLIGHT.unheeded_s + FLIGHT.looked_s
    assert deaf.spot_at(later_s) == before
    told = deaf.surveyor(later_s - 0.1)
    assert (told.is_able, told.ended_mission) == (False, 2)
    deaf.advance(later_s)
    assert deaf.surveyor(later_s).is_able


def test_who_falls_lies_there_and_is_never_had_again() -> None:
    fallen = on_a_mission()
    east_m, north_m, _up_m = fallen.spot_at(60.0)
    flown_s = 60.0
    fallen.fall(60.0)
    assert fallen.spot_at(500.0) == (east_m, north_m, 0.0)
    assert not fallen.is_airborne
    assert not fallen.surveyor(500.0).is_able
    assert not fallen.must_go_home(500.0)
    fallen.advance(1_000.0)
    assert fallen.flown_s == pytest.approx(flown_s)


def test_the_others_fly_what_a_fallen_one_has_left(tmp_path: Path) -> None:
    found = run(faulty(tmp_path, "falls-silent:1:50"), 0)
    assert found.end == "all that the rows reach is imaged in sun"
    assert found.in_sun_share[-1] > 0.99
    assert found.missions > 2


def test_with_a_cell_less_it_flies_home_at_once() -> None:
    weak, whole = on_a_mission(), on_a_mission()
    weak.fail_cell(60.0, 0.2)
    assert (weak.must_go_home(60.0), whole.must_go_home(60.0)) == (True, False)


def test_gusts_cost_time_at_each_stop() -> None:
    calm, gusty = drone(), drone(gusty_s=((0.0, 500.0),))
    later = drone(gusty_s=((500.0, 600.0),))
    for each in (calm, gusty, later):
        each.take(1, ROWS, 1, 0.0)
    assert gusty.free_at_s - calm.free_at_s == pytest.approx(0.65 * len(ROWS))
    assert later.free_at_s == calm.free_at_s


@pytest.mark.parametrize(
    "kind",
    [
        "camera-stops",
        "frames-black",
        "frames-repeated",
        "frames-torn",
        "telemetry-dropout",
        "restart",
    ],
)
def test_without_pictures_the_imager_tells_nothing(tmp_path: Path, kind: str) -> None:
    scenario = faulty(tmp_path, f"{kind}:SIM-IMAGER:30:120")
    assert blind_spans(scenario) == ((30.0, 150.0),)
    assert mishaps_of(scenario) == []
    found, sees = run(scenario, 0), run(faulty(tmp_path), 0)
    assert sees.known_share == 1.0
    assert 0.0 < found.known_share < 1.0
    assert found.missions > sees.missions


def test_an_imager_that_fell_never_tells_anything_again(tmp_path: Path) -> None:
    assert blind_spans(faulty(tmp_path, "falls-silent:*:30")) == ((30.0, inf),)


def test_faults_that_change_nothing_here_are_named(tmp_path: Path) -> None:
    felt = ["gusts:1", "camera-stops:*", "telemetry-dropout:SIM-IMAGER", "ignored-missions:2"]
    unfelt = ["bursts:1", "camera-stops:1", "gusts:SIM-IMAGER", "half-open:2"]
    assert without_effect(faulty(tmp_path, *felt)) == []
    assert without_effect(faulty(tmp_path, *felt, *unfelt)) == [
        "bursts",
        "camera-stops",
        "gusts",
        "half-open",
    ]
    every = [f"{kind.value}:*" for kind in FaultKind]
    assert set(without_effect(faulty(tmp_path, *every))) == {
        "no-ack",
        "half-open",
        "second-link",
        "placeholder-serial",
        "bursts",
        "delayed-acks",
        "corrupted-bytes",
        "slow-reader",
        "takeoff-altitude-lost",
        "takeoff-altitude-stale",
        "exposure-jumps",
    }
