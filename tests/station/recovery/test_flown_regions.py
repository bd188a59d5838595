"""What is kept of a flown region: as the flight goes, through a restart, for the next survey."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.flown_once import flown_once
from tests.station.surveyed_world import SURVEY_ID, SurveyedWorld, asked, field, surveyed_world

from recon.model.event import SurveyRequested, SurveyStarted, Tick
from recon.model.flown_region import FlownRegion
from recon.model.survey import CellState, Survey, SurveyPhase
from recon.model.units import NS_PER_S
from recon.station.operations.survey.commands import start_refusal
from recon.station.recording.recorded_values import values_codec
from recon.station.recovery.flown_regions import FlownRegions
from recon.station.state.steps import StepTaken

REST_ID = 501
FIELD = field(240.0, 60.0)


def kept(flown: FlownRegions, world: SurveyedWorld) -> FlownRegion:
    """What is kept of the one region once the newest station is noted."""
    station = world.driver.station
    before = replace(station, surveys=replace(station.surveys))
    flown.observe(StepTaken(Tick(), world.driver.now_ns, before, station, ()))
    flown.note()
    (region,) = flown.all
    return region


def rest_of(region: FlownRegion, **changes: object) -> Survey:
    cells = region.cells_since(region.begun_s)
    return replace(
        region.survey,
        **{"id": REST_ID, "lattice": region.lattice, "flown": cells, **changes},  # type: ignore[arg-type]
    )


@flown_once
def half_flown() -> SurveyedWorld:
    """A survey that was aborted when a part of it was imaged."""
    world = surveyed_world()
    world.asks(asked(FIELD, region_name="north"))
    world.starts("SIM-1")
    while world.figures().not_yet_m2 > 0.6 * world.figures().region_m2:
        world.runs(1.0)
    world.aborts()
    world.runs(1.0)
    return world


def test_what_was_imaged_is_kept_through_a_restart(tmp_path: Path) -> None:
    world = half_flown()
    region = kept(FlownRegions(tmp_path), world)
    state = world.state()
    assert np.array_equal(region.imaged_s > 0, state.progress.state > CellState.NOT_YET)
    assert set(np.unique(region.imaged_s)) <= {0, world.driver.now_ns // NS_PER_S}
    assert region.is_simulated
    (read,) = FlownRegions(tmp_path).all
    assert np.array_equal(read.imaged_s, region.imaged_s)
    assert read.lattice == region.lattice
    left = float(read.is_left(read.begun_s).sum()) / float(read.is_reached.sum())
    assert 0.2 < left < 0.7


def test_the_rest_is_flown_and_nothing_else(tmp_path: Path) -> None:
    world, flown = half_flown(), FlownRegions(tmp_path)
    region = kept(flown, world)
    missions = len(world.missions())
    world.runs(5.0)
    assert len(world.missions()) == missions, "nothing may fly before a person starts it"
    world.asks(rest_of(region))
    state = world.state(REST_ID)
    assert np.array_equal(
        state.plan.lattice.rows_across_m, world.state(SURVEY_ID).plan.lattice.rows_across_m
    )
    left_m2 = state.plan.cells.area_m2(state.missing())
    world.starts("SIM-1", number=REST_ID)
    while world.phase(REST_ID) is SurveyPhase.RUNNING:
        world.runs(1.0)
    after = world.state(REST_ID)
    assert after.phase is SurveyPhase.DONE
    rows_m = sum(piece.length_m for piece in after.plan.pieces)
    assert after.flown_m < 0.85 * rows_m
    whole = kept(flown, world)
    assert whole.begun_s == region.begun_s
    assert float(whole.is_left(whole.begun_s).sum()) * 16.0 < 0.05 * left_m2
    was_imaged = region.imaged_s > 0
    assert np.array_equal(whole.imaged_s[was_imaged], region.imaged_s[was_imaged])


def test_a_rest_is_recorded_and_read_with_its_cells(tmp_path: Path) -> None:
    codec, rest = values_codec(), rest_of(kept(FlownRegions(tmp_path), half_flown()))
    asked_for = SurveyRequested(rest, "ann")
    read = codec.decode(codec.encode(asked_for, SurveyRequested), SurveyRequested).survey
    assert read.lattice == rest.lattice
    assert rest.flown is not None
    assert np.array_equal(read.flown.state, rest.flown.state)
    assert np.array_equal(read.flown.is_light_known, rest.flown.is_light_known)


def test_a_survey_of_all_begins_anew_and_keeps_the_days_of_before(tmp_path: Path) -> None:
    world = half_flown()
    flown = FlownRegions(tmp_path)
    first = kept(flown, world)
    world.asks(replace(asked(FIELD, region_name="north"), id=REST_ID))
    world.starts("SIM-1", number=REST_ID)
    world.runs(1.0)
    second = kept(flown, world)
    assert second.begun_s == second.started_s > first.started_s
    assert np.array_equal(second.imaged_s, first.imaged_s)
    assert np.array_equal(second.is_left(second.begun_s), second.is_reached)


def test_a_real_drone_may_not_fly_the_rest_of_simulated_ones(tmp_path: Path) -> None:
    world = half_flown()
    world.asks(rest_of(kept(FlownRegions(tmp_path), world)))
    station = world.driver.station
    real = replace(station.fleet.vehicles["SIM-1"], is_simulated=False)
    fleet = replace(station.fleet, vehicles={**station.fleet.vehicles, "SIM-1": real})
    event = SurveyStarted(REST_ID, ("SIM-1",), "ann", takeoff=True)
    refusal = start_refusal(replace(station, fleet=fleet), event, world.driver.now_ns)
    assert refusal is not None
    assert "is a real drone" in refusal.reason
    assert start_refusal(station, event, world.driver.now_ns) is None


def test_a_disk_that_is_full_is_a_problem_until_it_is_not(tmp_path: Path) -> None:
    failing = [True]

    def write(folder: Path, region: FlownRegion) -> None:
        if failing:
            raise OSError(28, "No space left on device")

    world, flown = half_flown(), FlownRegions(tmp_path, write)
    kept(flown, world)
    assert flown.problem == "surveyed regions: No space left on device"
    failing.clear()
    flown.note()
    assert flown.problem is None


@pytest.mark.parametrize("name", [None, ""])
def test_nothing_is_kept_of_a_drawn_region(name: str | None, tmp_path: Path) -> None:
    world = surveyed_world()
    world.asks(asked(region_name=name))
    world.starts("SIM-1")
    flown = FlownRegions(tmp_path)
    station = world.driver.station
    before = replace(station, surveys=replace(station.surveys))
    flown.observe(StepTaken(Tick(), world.driver.now_ns, before, station, ()))
    flown.note()
    assert list(flown.all) == []
    assert list(tmp_path.iterdir()) == []
