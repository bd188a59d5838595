"""Surveys above ground, by the whole station in virtual time over ground of known shape."""

from dataclasses import dataclass, field
from math import hypot

import numpy as np
import pytest
from tests.guidance.survey.grounds import model, slope
from tests.station.operations.test_survey_zones import person
from tests.station.returning_world import FRAME
from tests.station.surveyed_world import (
    SURVEY_ID,
    SurveyedWorld,
    asked,
    surveyed_world,
)
from tests.station.surveyed_world import field as field_of

from recon.guidance.survey import SurveyPlan
from recon.guidance.survey.route import route_of
from recon.guidance.survey.settings import DEFAULT
from recon.model.command import Phase
from recon.model.event import SurveyRequested
from recon.model.geo import GroundGrid
from recon.model.replacing import replace
from recon.model.shade import ShadeMap
from recon.model.survey import Survey, SurveyPhase, WhenDone
from recon.record.mcap.codec import CodecError
from recon.record.mcap.digest import digest
from recon.safety import PreparedAirspace
from recon.sim.flight.mission import MissionFlight
from recon.station.api_views.operation_views import survey_view
from recon.station.api_views.survey_preview import survey_preview
from recon.station.operations.survey.availability import NO_TAKEOFF_HEIGHT
from recon.station.operations.survey.execution import on_shade
from recon.station.recording.recorded_values import values_codec

HEIGHT_M = 40.0
APART = ((0.0, -40.0), (240.0, -40.0))
"""On the slope, the second pad is 24 m higher."""
ARRIVED_WITHIN_M = 0.7
"""A waypoint counts as reached from half a metre, at whatever height; and reports are rounded."""


def above_ground(**changes: object) -> Survey:
    what = {"height_above_takeoff_m": None, "height_above_ground_m": HEIGHT_M, **changes}
    dense = {"front_overlap": 0.7, "side_overlap": 0.6, "speed_mps": 5.0}
    return asked(field_of(240.0, 60.0), **dense, **what)


def on_the_slope(count: int = 2, *, height_m: float = 0.0) -> SurveyedWorld:
    elevation = model(slope, frame=FRAME)
    return surveyed_world(count, height_m=height_m, pads=APART, elevation=elevation)


@dataclass(slots=True)
class Flown:
    """A survey flown to its end, with the true heights of its vehicles on rows."""

    world: SurveyedWorld
    above_ground_m: list[float] = field(default_factory=list)

    def run(self, at_most_s: int) -> bool:
        """Fly until the survey is done, or so long."""
        for _ in range(10 * at_most_s):
            self.world.runs(0.1)
            for serial in self.world.fleet.pads_m:
                self._measure(serial)
            if self.world.phase() is SurveyPhase.DONE:
                return True
        return False

    def _measure(self, serial: str) -> None:
        mode = self.world.fleet.world.app(serial).aircraft.active_mode
        if isinstance(mode, MissionFlight) and _is_on_rows(mode):
            east_m, north_m, up_m = self.world.fleet.place_m(serial)
            ground_m = float(slope(np.array(east_m), np.array(north_m)))
            self.above_ground_m.append(up_m - ground_m)

    @property
    def range_m(self) -> tuple[float, float]:
        """The least and the largest height above the true ground."""
        return min(self.above_ground_m), max(self.above_ground_m)


def _is_on_rows(mode: MissionFlight) -> bool:
    """Whether it has passed its first row's beginning and is not on the climb off its last."""
    gimbal = [point.gimbal_pitch_deg is not None for point in mode.points]
    if True not in gimbal or not gimbal.index(True) < mode.next_index < len(mode.points):
        return False
    a, b = mode.points[mode.next_index - 1 : mode.next_index + 1]
    return hypot(b.north_m - a.north_m, b.east_m - a.east_m) > 1.0


@pytest.fixture(scope="module")
def flown() -> Flown:
    """Two vehicles whose pads differ by 24 m survey a field on a slope of a tenth."""
    world = on_the_slope()
    world.asks(above_ground())
    world.starts("SIM-1", "SIM-2", takeoff=True)
    found = Flown(world)
    assert found.run(300), world.record()
    return found


@pytest.mark.flight
class TestOnASlope:
    def test_rows_are_flown_at_their_height_above_the_true_ground(self, flown: Flown) -> None:
        least_m, most_m = flown.range_m
        assert len(flown.above_ground_m) > 1_000
        assert least_m >= HEIGHT_M - DEFAULT.terrain_below_m - ARRIVED_WITHIN_M
        assert most_m <= HEIGHT_M + DEFAULT.terrain_above_m + ARRIVED_WITHIN_M

    def test_all_of_the_region_is_photographed_in_one_round(self, flown: Flown) -> None:
        figures = flown.world.figures()
        assert figures.reached_m2 == pytest.approx(figures.region_m2)
        assert figures.not_yet_m2 < 0.01 * figures.region_m2
        assert flown.world.state().round == 1

    def test_both_fly_and_the_gate_refuses_nothing(self, flown: Flown) -> None:
        orders = flown.world.driver.station.orders.records.values()
        assert [each.refusal for each in orders if each.refusal is not None] == []
        given = flown.world.missions()
        assert {each.command.serial for each in given} == {"SIM-1", "SIM-2"}
        assert Phase.DONE in {each.phase for each in given}

    def test_the_two_keep_apart(self, flown: Flown) -> None:
        assert flown.world.fleet.nearest.level_m > 15.0

    def test_the_same_survey_above_takeoff_leaves_the_height(self, flown: Flown) -> None:
        world = on_the_slope(1)
        world.asks(asked(field_of(240.0, 60.0), height_above_takeoff_m=HEIGHT_M))
        world.starts("SIM-1", takeoff=True)
        level = Flown(world)
        level.run(88)
        assert level.range_m[0] < HEIGHT_M - 20.0
        assert flown.range_m[0] > HEIGHT_M - 3.0


class TestSunlitFirst:
    @pytest.mark.flight
    def test_what_is_in_sun_first_is_flown_at_its_height_and_straight_from_row_to_row(
        self,
    ) -> None:
        """Bands of shade move over the slope: vehicles get short missions, and some wait."""
        world = on_the_slope()
        world.asks(above_ground(planner="sunlit_first"))
        world.starts("SIM-1", "SIM-2", takeoff=True)
        flown = Flown(world)
        for second in range(160):
            shade = shade_map(second, world.driver.now_ns)
            world.driver.station = on_shade(world.driver.station, shade)
            flown.run(1)
        assert flown.range_m[0] >= HEIGHT_M - DEFAULT.terrain_below_m - ARRIVED_WITHIN_M
        assert flown.range_m[1] <= HEIGHT_M + DEFAULT.terrain_above_m + ARRIVED_WITHIN_M
        orders = world.driver.station.orders.records.values()
        assert [each.refusal for each in orders if each.refusal is not None] == []
        assert world.fleet.nearest.level_m > 15.0
        bodies = [each.command.body for each in world.missions()]
        straight = [b for b in bodies if b.mission.waypoints[0].gimbal_pitch_deg is not None]
        assert len(straight) >= 2
        assert world.figures().in_sun_m2 > 0.3 * world.figures().region_m2


def shade_map(second: int, at_ns: int) -> ShadeMap:
    """Bands of sun 110 m wide that move east at 2 m/s, with 90 m of shade between."""
    grid = GroundGrid(FRAME, -20.0, 100.0, 5.0, 28, 56)
    east_m = grid.west_m + grid.cell_m * (np.arange(grid.cols) + 0.5)
    shape = grid.rows, grid.cols
    lit = np.broadcast_to(np.mod(east_m - 2.0 * second, 200.0) < 110.0, shape)
    known = np.ones(shape, np.bool_)
    return ShadeMap(
        grid,
        at_ns,
        ("IMAGER",),
        lit.astype(np.float32),
        known,
        np.ones(shape, np.float32),
        np.ones(shape, np.float32),
    )


class TestZones:
    def test_rows_planned_anew_round_a_zone_follow_the_ground_too(self) -> None:
        world = on_the_slope(1)
        world.asks(above_ground(when_done=WhenDone.HOVER))
        world.starts("SIM-1", takeoff=True)
        flown = Flown(world)
        flown.run(30)
        world.driver.handle(person(world, (120.0, 30.0), 10.0))
        missions = len(world.missions())
        flown.above_ground_m.clear()
        flown.run(60)
        assert len(world.missions()) > missions
        assert len(flown.above_ground_m) > 100
        assert flown.range_m[0] >= HEIGHT_M - DEFAULT.terrain_below_m - ARRIVED_WITHIN_M
        assert flown.range_m[1] <= HEIGHT_M + DEFAULT.terrain_above_m + ARRIVED_WITHIN_M


class TestShown:
    @pytest.mark.flight
    def test_the_view_says_which_height_it_is(self, flown: Flown) -> None:
        driver = flown.world.driver
        view = survey_view(driver.station, flown.world.record(), driver.now_ns)
        assert (view.height_above_takeoff_m, view.height_above_ground_m) == (None, HEIGHT_M)

    @pytest.mark.parametrize(
        ("survey", "range_m"),
        [
            (above_ground(), (40.0, 40.0)),
            # From the lower pad 24 m of slope below, from the higher one 24 m of it above.
            (asked(field_of(240.0, 60.0), height_above_takeoff_m=HEIGHT_M), (16.0, 64.0)),
        ],
        ids=["above ground", "above takeoff"],
    )
    def test_the_preview_has_the_range_of_heights_above_ground(
        self, survey: Survey, range_m: tuple[float, float]
    ) -> None:
        world = on_the_slope()
        world.asks(survey)
        preview = survey_preview(world.driver.station, world.state().plan, ("SIM-1", "SIM-2"))
        shown = preview()
        assert shown.refusal is None
        found_m = shown.least_height_above_ground_m, shown.most_height_above_ground_m
        assert found_m == pytest.approx(range_m, abs=0.6)

    def test_without_serials_it_is_for_a_takeoff_at_the_regions_corner(self) -> None:
        world = on_the_slope()
        world.asks(asked(field_of(240.0, 60.0), height_above_takeoff_m=HEIGHT_M))
        preview = survey_preview(world.driver.station, world.state().plan, ())
        assert preview().least_height_above_ground_m == pytest.approx(16.0, abs=0.6)
        assert preview().most_height_above_ground_m == pytest.approx(40.0, abs=0.6)


class TestRefused:
    def test_without_an_elevation_model_it_is_not_planned(self) -> None:
        world = surveyed_world(1)
        world.asks(above_ground())
        refusal = world.record().refusal
        assert refusal is not None
        assert "needs the site's elevation model" in refusal.reason

    def test_a_vehicle_without_a_takeoff_height_gets_no_mission_and_says_why(self) -> None:
        """It was in the air before the station was, and has no pad."""
        world = on_the_slope(1, height_m=HEIGHT_M)
        world.asks(above_ground())
        driver, fleet = world.driver, world.driver.station.fleet
        vehicle = fleet.vehicles["SIM-1"]
        profile = replace(vehicle.profile, pad=None)
        vehicles = {"SIM-1": replace(vehicle, profile=profile, takeoff_point=None)}
        known = replace(fleet, vehicles=vehicles, profiles={"SIM-1": profile})
        airspace = replace(driver.station.airspace.airspace, landing_pads=())
        driver.station = replace(driver.station, fleet=known, airspace=PreparedAirspace(airspace))
        world.starts("SIM-1")
        world.runs(5.0)
        view = survey_view(driver.station, world.record(), driver.now_ns)
        assert world.missions() == []
        assert [each.not_flying_reason for each in view.vehicles] == [NO_TAKEOFF_HEIGHT]


class TestRecorded:
    def test_a_plan_read_from_a_record_is_the_same(self) -> None:
        world = on_the_slope(1)
        world.driver.handle(SurveyRequested(above_ground(), "ann"))
        world.runs(0.5)
        plan = world.state(SURVEY_ID).plan
        before = digest(plan)
        assert plan.track(route_of(plan.pieces, plan.lattice, None)) is not None
        codec = values_codec()
        again = codec.decode(codec.encode(plan, SurveyPlan), SurveyPlan)
        assert again.terrain is not None
        assert plan.terrain is not None
        leg = (10.0, 30.0), (230.0, 30.0)
        assert again.terrain.between(*leg) == plan.terrain.between(*leg)
        damaged = codec.to_builtins(plan, SurveyPlan)
        damaged["terrain"]["grid"]["rows"] += 1
        with pytest.raises(CodecError, match="finite heights"):
            codec.from_builtins(damaged, SurveyPlan)
        # The waypoints that it remembers of its legs are no part of the value.
        assert digest(plan) == before == digest(again)
