"""Vehicles that fly a survey's missions, with camera timers of unknown phase.

The motion is a trapezium of speed on each leg, standing at its ends; positions come at some hertz,
late and a little off. What photos truly show is kept beside, for the tests alone.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from math import atan2, hypot, tan

import numpy as np
import numpy.typing as npt
from tests.guidance.survey.fields import planned

from recon.geo import enu_from_geo
from recon.guidance.survey import (
    ClosedArea,
    PositionSample,
    Surveyor,
    SurveyPlan,
    SurveyState,
    create,
    observe,
    observe_shade,
    start,
    step,
)
from recon.model.geo import GroundGrid
from recon.model.mission import Mission
from recon.model.shade import ShadeMap, SunForecast
from recon.model.survey import MissionAssignment, Survey, SurveyPhase
from recon.model.units import NS_PER_S, seconds_to_ns

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
Place = tuple[float, float]

STEP_S = 0.1
ACCELERATION_MPS2 = 2.5
TURN_S = 1.5
"""Standing at each waypoint, while the aircraft turns."""

Sky = Callable[[FloatArray, float], BoolArray]
"""Which of (N, 2) east-north places are in sun at a time in seconds."""


def clear(places_m: FloatArray, time_s: float) -> BoolArray:
    return np.ones(len(places_m), dtype=np.bool_)


@dataclass(slots=True)
class Flyer:
    """One vehicle. Without a mission it hovers; `endurance_s` is what it can fly in all."""

    serial: str
    place_m: Place
    rng: np.random.Generator
    endurance_s: float | None = None
    is_available: bool = True
    height_m: float = 60.0
    late_s: float = 0.3
    off_m: float = 0.3
    every: int = 2
    """Positions are reported every so many steps."""
    home_m: Place | None = None
    ended_mission: int = 0
    flown_s: float = 0.0
    path: list[tuple[Place, float]] = field(default_factory=list)
    number: int | None = None
    heading_rad: float = 0.0
    next_photo_s: float = 0.0
    waited_s: float = 0.0
    speed_mps: float = 0.0

    def take(self, given: MissionAssignment, plan: SurveyPlan) -> None:
        """Begin a mission."""
        places = east_north(given.mission, plan)
        speeds = [point.speed_mps for point in given.mission.waypoints]
        self.path = list(zip(places, [speeds[0], *speeds], strict=False))
        self.number = given.number

    def move(self) -> None:
        """Fly on for one step: stop at each corner of the way."""
        if not self.is_flying:
            return
        self.flown_s += STEP_S
        if self.waited_s > 0.0:
            self.waited_s -= STEP_S
            return
        (goal, cruise_mps), *_ = self.path
        east_m, north_m = goal[0] - self.place_m[0], goal[1] - self.place_m[1]
        far_m = hypot(east_m, north_m)
        braking_mps = (2.0 * ACCELERATION_MPS2 * far_m) ** 0.5
        self.speed_mps = min(cruise_mps, braking_mps, self.speed_mps + ACCELERATION_MPS2 * STEP_S)
        if far_m <= max(self.speed_mps * STEP_S, 0.05):
            self._arrive(goal)
            return
        self.heading_rad = atan2(east_m, north_m)
        share = self.speed_mps * STEP_S / far_m
        self.place_m = (self.place_m[0] + share * east_m, self.place_m[1] + share * north_m)

    @property
    def is_flying(self) -> bool:
        """Whether it has a mission."""
        return bool(self.path)

    def _arrive(self, goal: Place) -> None:
        self.place_m, self.speed_mps, self.waited_s = goal, 0.0, TURN_S
        self.path.pop(0)
        if not self.path and self.number is not None:
            self.ended_mission, self.number = self.number, None

    def stop(self) -> None:
        """Give the mission up."""
        self.path = []
        if self.number is not None:
            self.ended_mission, self.number = self.number, None

    def surveyor(self) -> Surveyor:
        """Return what the planner gets."""
        left_s = None if self.endurance_s is None else self.endurance_s - self.flown_s
        return Surveyor(
            self.serial, self.place_m, self.is_available, self.ended_mission, left_s, self.home_m
        )


@dataclass(slots=True)
class Flights:
    """A survey flown to its end, or for a time; and what the photos truly showed."""

    state: SurveyState
    flyers: list[Flyer]
    sky: Sky = clear
    time_s: float = 0.0
    tells_shade: bool = True
    view: Sky | None = None
    """Which ground shade maps show; None: all."""
    foresees: bool = False
    """Whether the planner gets the sky of the next five minutes, as a forecast that is right."""
    closed: tuple[ClosedArea, ...] = ()
    shown: BoolArray | None = None
    shown_in_sun: BoolArray | None = None
    given: list[MissionAssignment] = field(default_factory=list)
    tracks: list[tuple[str, Place]] = field(default_factory=list)

    def run(
        self,
        most_s: float = 20_000.0,
        each_second: Callable[["Flights"], None] | None = None,
    ) -> SurveyState:
        """Fly until the survey is no longer running, or so long."""
        until_s = self.time_s + most_s
        while self.state.phase is SurveyPhase.RUNNING and self.time_s < until_s:
            self._second()
            if each_second is not None:
                each_second(self)
        return self.state

    def _second(self) -> None:
        if self.tells_shade:
            self.state = observe_shade(self.state, self.shade_map())
        for index in range(round(1.0 / STEP_S)):
            self.time_s += STEP_S
            for flyer in self.flyers:
                flyer.move()
                self._photograph(flyer)
                if index % flyer.every == 0:
                    self._tell(flyer)
        positions = [flyer.surveyor() for flyer in self.flyers]
        self.state, missions = step(
            self.state,
            positions,
            seconds_to_ns(self.time_s),
            lambda: self.forecast() if self.foresees else None,
            self.closed,
        )
        self.given += missions
        for mission in missions:
            next(f for f in self.flyers if f.serial == mission.serial).take(mission, self.plan)

    @property
    def plan(self) -> SurveyPlan:
        """The survey's plan."""
        return self.state.plan

    def shade_map(self) -> ShadeMap:
        """Return the shade map of an ideal imaging drone, on a grid around the field."""
        cells = self.plan.cells.grid
        grid = GroundGrid(
            cells.frame,
            cells.west_m - 13.0,
            cells.north_m + 13.0,
            5.0,
            cells.rows * round(cells.cell_m) // 5 + 8,
            cells.cols * round(cells.cell_m) // 5 + 8,
        )
        lit = self.sky(middles_m(grid), self.time_s).reshape(grid.rows, grid.cols)
        shape = (grid.rows, grid.cols)
        is_shown = (self.view or clear)(middles_m(grid), self.time_s).reshape(shape)
        return ShadeMap(
            grid,
            seconds_to_ns(self.time_s),
            (),
            lit.astype(np.float32),
            is_shown,
            np.ones(shape, np.float32),
            np.ones(shape, np.float32),
        )

    def forecast(self) -> SunForecast:
        """Return the true sky of the next five minutes, in cells of 15 m."""
        cells = self.plan.cells.grid
        size = (
            cells.rows * round(cells.cell_m) // 15 + 2,
            cells.cols * round(cells.cell_m) // 15 + 2,
        )
        grid = GroundGrid(cells.frame, cells.west_m, cells.north_m, 15.0, *size)
        leads_s = np.arange(0.0, 301.0, 20.0)
        lit = [self.sky(middles_m(grid), self.time_s + lead_s).reshape(size) for lead_s in leads_s]
        return SunForecast(
            grid=grid,
            issued_at_ns=seconds_to_ns(self.time_s),
            lead_s=leads_s,
            sun_probability=np.where(lit, 255, 0).astype(np.uint8),
            horizon_s=np.full(size, 300.0, np.float32),
            prior_sunlit=0.5,
            method="true",
            velocity_mps=(2.0, 2.0),
        )

    def _tell(self, flyer: Flyer) -> None:
        east_m, north_m = (float(at + flyer.rng.normal(0.0, flyer.off_m)) for at in flyer.place_m)
        at_ns = round((self.time_s + flyer.late_s) * NS_PER_S)
        seen = PositionSample(at_ns, east_m, north_m, flyer.height_m)
        self.state = observe(self.state, flyer.serial, [seen])

    def _photograph(self, flyer: Flyer) -> None:
        if self.shown is None or self.shown_in_sun is None:
            shape = self.plan.cells.is_inside.shape
            self.shown, self.shown_in_sun = np.zeros(shape, np.bool_), np.zeros(shape, np.bool_)
        if self.time_s < flyer.next_photo_s:
            return
        interval_s = self.plan.survey.camera.interval_s
        if flyer.next_photo_s == 0.0:
            flyer.next_photo_s = self.time_s + float(flyer.rng.uniform(0.0, interval_s))
            return
        flyer.next_photo_s += interval_s
        if flyer.is_flying:
            shown = self._footprint(flyer)
            self.shown |= shown
            lit = self.sky(middles_m(self.plan.cells.grid), self.time_s).reshape(shown.shape)
            self.shown_in_sun |= shown & lit

    def _footprint(self, flyer: Flyer) -> BoolArray:
        """Which cells a photo shows now, (R, C)."""
        camera, grid = self.plan.survey.camera, self.plan.cells.grid
        half_across_m = flyer.height_m * tan(np.deg2rad(camera.across_deg / 2.0))
        half_along_m = flyer.height_m * tan(np.deg2rad(camera.along_deg / 2.0))
        east_m, north_m = (middles_m(grid) - np.array(flyer.place_m)).T
        sin, cos = np.sin(flyer.heading_rad), np.cos(flyer.heading_rad)
        along_m, across_m = east_m * sin + north_m * cos, east_m * cos - north_m * sin
        shown = (np.abs(along_m) <= half_along_m) & (np.abs(across_m) <= half_across_m)
        return np.asarray(shown.reshape(grid.rows, grid.cols))


@lru_cache(maxsize=8)
def middles_m(grid: GroundGrid) -> FloatArray:
    """The middles of a grid's cells, (R * C, 2) east-north; not to be changed."""
    east_m = grid.west_m + grid.cell_m * (np.arange(grid.cols) + 0.5)
    north_m = grid.north_m - grid.cell_m * (np.arange(grid.rows) + 0.5)
    east, north = np.meshgrid(east_m, north_m)
    middles = np.column_stack([east.ravel(), north.ravel()])
    middles.flags.writeable = False
    return middles


def east_north(mission: Mission, plan: SurveyPlan) -> list[Place]:
    """A mission's waypoints in the site's metres."""
    enu_m = enu_from_geo(
        plan.frame,
        [point.latitude_deg for point in mission.waypoints],
        [point.longitude_deg for point in mission.waypoints],
        plan.frame.origin.ellipsoid_height_m,
    )
    return [(float(east_m), float(north_m)) for east_m, north_m, _ in enu_m]


def fleet(count: int, seed: int = 1, **changes: object) -> list[Flyer]:
    """Vehicles on a line south of the field."""
    made = [
        Flyer(f"S-{i + 1}", (60.0 * i, -40.0), np.random.default_rng((seed, i)))
        for i in range(count)
    ]
    return [replace(flyer, **changes) for flyer in made]


def begun(survey: Survey, flyers: list[Flyer]) -> SurveyState:
    """The survey as started with these vehicles."""
    created = create(planned(survey))
    assert isinstance(created, SurveyState)
    started = start(created, serials(flyers), 0)
    assert isinstance(started, SurveyState)
    return started


def serials(flyers: Sequence[Flyer]) -> list[str]:
    return [flyer.serial for flyer in flyers]
