"""The whole pipeline: ground images, shade maps, and cells imaged in sun or in shade."""

from dataclasses import replace

import numpy as np
import pytest
from tests.station.imagers import with_imagers
from tests.station.station_world import HOME
from tests.station.surveyed_world import SurveyedWorld, asked, surveyed_world

from recon.guidance.survey.state import SurveyState
from recon.model.command import Command, FlyMission, Phase, Refusal
from recon.model.control import AuthorityHolder
from recon.model.event import AuthorityTaken, Event
from recon.model.geo import GroundGrid, LocalFrame
from recon.model.imagery import CameraPose, GroundImage
from recon.model.survey import CellState, SurveyBudget, SurveyPhase
from recon.safety import gate
from recon.safety.situation import Situation
from recon.station.imaging.frames import PROJECT_FRAME
from recon.station.imaging.projection import ProjectedFrame
from recon.station.state.steps import JobDone

GRID = GroundGrid(LocalFrame(HOME), -40.0, 100.0, 1.0, 140, 200)
POSE = CameraPose(np.eye(3), np.array([60.0, 30.0, 120.0]))
TEXTURE = np.random.default_rng(3).integers(120, 150, (140, 200, 1))
SHADE_ENDS_M = 60.0
"""West of it the field lies in shade: half of it."""


def ground_image(number: int, at_ns: int, is_shaded: bool) -> GroundImage:
    east_m = GRID.west_m + 0.5 + np.arange(200)
    light = np.where((east_m < SHADE_ENDS_M) & is_shaded, 0.25, 1.0)[np.newaxis, :, np.newaxis]
    rgb = np.broadcast_to((TEXTURE * light**0.45).astype(np.uint8), (140, 200, 3)).copy()
    rgb[0, 0] = number % 200 + 20
    return GroundImage(
        GRID, number, at_ns, rgb, np.ones((140, 200), np.bool_), POSE, serial="IMAGER"
    )


def flown_under_an_imager(planner: str, sunny_from_s: float) -> SurveyedWorld:
    """A frame a second: half of the field in shade until a moment, then all in sun."""
    world = under_an_imager()
    world.asks(asked(planner=planner, budget=SurveyBudget(rounds=3)))
    world.starts("SIM-1")
    for number in range(41, 500):
        if world.phase() is not SurveyPhase.RUNNING:
            break
        world.driver.handle(seen(world, number, number < sunny_from_s))
        world.runs(1.0)
    return world


def under_an_imager(vehicles: int = 1) -> SurveyedWorld:
    """The field has been seen in sun, and half of it in shade, for 40 s."""
    world = surveyed_world(vehicles)
    world.driver.station = with_imagers(world.driver.station, "IMAGER")
    settings = world.driver.station.settings
    # It maps a drawn field at once; over two minutes, shade that lasts the whole flight would come
    # to look like sun.
    detection = replace(settings.detection, method="brightness_ratio", window_s=600.0, samples=120)
    world.driver.station = replace(
        world.driver.station, settings=replace(settings, detection=detection)
    )
    for number in range(1, 41):
        # The field must be imaged in sun first: else shade looks like dark soil.
        world.driver.handle(seen(world, number, number > 30))
        world.runs(1.0)
    return world


def seen(world: SurveyedWorld, number: int, is_shaded: bool) -> Event:
    image = ground_image(number, world.driver.now_ns, is_shaded)
    return JobDone(number, PROJECT_FRAME, ProjectedFrame(image))


def states(state: SurveyState, is_west: bool) -> np.ndarray:
    """The cells of one half, away from the shade's edge."""
    cells = state.plan.cells
    east_m = cells.grid.west_m + (np.arange(cells.grid.cols) + 0.5) * cells.grid.cell_m
    chosen = east_m < SHADE_ENDS_M - 8.0 if is_west else east_m > SHADE_ENDS_M + 8.0
    return state.progress.state[cells.is_reached & chosen[np.newaxis, :]]


def test_cells_flown_in_shade_and_in_sun_are_distinguished() -> None:
    world = flown_under_an_imager("lawnmower_once", sunny_from_s=10_000.0)
    assert world.phase() is SurveyPhase.DONE
    assert (states(world.state(), is_west=True) == CellState.IN_SHADE).mean() > 0.9
    assert (states(world.state(), is_west=False) == CellState.IN_SUN).mean() > 0.9
    assert world.figures().sun_unknown_m2 == 0.0


@pytest.mark.flight
def test_cells_in_shade_are_flown_again_until_imaged_in_sun() -> None:
    world = flown_under_an_imager("lawnmower_again", sunny_from_s=150.0)
    assert world.phase() is SurveyPhase.DONE
    assert "in sun" in world.state().reason
    assert world.state().round > 1
    assert world.figures().in_sun_m2 > 0.97 * world.figures().reached_m2


class TestHandedOn:
    """A vehicle that its operator gives back finds another one on all rows."""

    @staticmethod
    def flown(most_s: int) -> SurveyedWorld:
        world = under_an_imager(2)
        dense = {"front_overlap": 0.7, "side_overlap": 0.6, "speed_mps": 3.0}
        world.asks(asked(planner="sunlit_first", budget=SurveyBudget(rounds=3), **dense))
        for number in range(41, 56 + most_s):
            world.driver.handle(seen(world, number, is_shaded=False))
            world.runs(1.0)
            if number == 55:
                world.starts("SIM-1", "SIM-2")
                taken = AuthorityTaken("SIM-2", AuthorityHolder.OPERATOR, "bob", "bob")
                world.driver.handle(taken)
            if number == 75:
                given = AuthorityTaken("SIM-2", AuthorityHolder.GUIDANCE, "bob", "bob")
                world.driver.handle(given)
            if number > 55 and world.phase() is not SurveyPhase.RUNNING:
                break
        return world

    @pytest.mark.flight
    def test_it_gets_half_of_them_and_neither_is_stopped(self) -> None:
        world = self.flown(500)
        assert world.phase() is SurveyPhase.DONE
        first, second, *_more = world.missions("SIM-1")
        assert first.phase is Phase.SUPERSEDED
        assert first.note == f"Replaced by order {second.command.id}"
        assert second.phase is Phase.DONE
        assert world.missions("SIM-2")
        assert {each.stop_reason for each in world.record().members.values()} == {None}
        assert world.figures().in_sun_m2 > 0.97 * world.figures().reached_m2

    @pytest.mark.flight
    def test_a_battery_too_low_for_the_new_mission_is_no_reason_to_call_it_home(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def of_few_waypoints(command: Command, _situation: Situation) -> Refusal | None:
            body = command.body
            is_new = isinstance(body, FlyMission) and len(body.mission.waypoints) < 6
            low = Refusal("battery", "too low for this")
            return low if is_new and command.serial == "SIM-1" else None

        monkeypatch.setattr(gate, "RULES", (*gate.RULES, of_few_waypoints))
        world = self.flown(100)
        refused = [m for m in world.missions("SIM-1") if m.refusal is not None]
        assert [m.refusal.rule for m in refused if m.refusal] == ["battery"]
        assert world.missions("SIM-1")[0].phase is Phase.STARTED
        assert world.record().members["SIM-1"].return_reason is None
        decision = world.state().decisions["SIM-1"]
        assert decision.text == "flies on with rows 1 to 2: other rows were refused"
