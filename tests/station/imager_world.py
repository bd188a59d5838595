"""An imaging drone that hovers, SIM-1, and what a side-step makes of it."""

from dataclasses import dataclass, replace
from math import hypot

import numpy as np
from tests.flown_once import flown_once
from tests.station.imagers import with_imagers
from tests.station.station_world import HOME
from tests.station.surveyed_world import SurveyedWorld, surveyed_world

from recon.detection import DetectionState
from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.geo.sun import sun_position
from recon.model.control import AuthorityHolder
from recon.model.event import SideStepOrdered
from recon.model.geo import GroundGrid, LatLon, LocalFrame
from recon.model.shade import ShadeMap
from recon.station.imaging.shade import READ_SHADE, ShadeRead
from recon.station.kernel.virtual import EPOCH_NS
from recon.station.state.imager_motion import SideStep
from recon.station.state.imaging import SeenShade
from recon.station.state.station import Station
from recon.station.state.steps import JobDone

IMAGER = "SIM-1"
GRID = GroundGrid(LocalFrame(HOME), -100.0, 100.0, 10.0, 20, 20)


@dataclass(slots=True)
class ImagerWorld:
    """A simulated imaging drone, beside survey drones where there are any."""

    surveyed: SurveyedWorld
    start_m: tuple[float, float, float]

    @property
    def station(self) -> Station:
        station: Station = self.surveyed.driver.station
        return station

    @station.setter
    def station(self, station: Station) -> None:
        self.surveyed.driver.station = station

    def ordered(self, person: str = "ann") -> None:
        self.surveyed.driver.handle(SideStepOrdered(person, person=person))

    def newest(self) -> SideStep:
        newest = self.station.imager_motions.of(SideStep)
        assert newest is not None
        return newest

    def off_m(self) -> tuple[float, float]:
        """How far east and north of its start the imaging drone truly is."""
        east_m, north_m, _up_m = self.surveyed.fleet.place_m(IMAGER)
        return east_m - self.start_m[0], north_m - self.start_m[1]

    def farthest_while(self, seconds: float) -> float:
        """Run, and return the largest distance from its start; its height must not change."""
        farthest_m = 0.0
        for _ in range(round(seconds * 2)):
            self.surveyed.runs(0.5)
            farthest_m = max(farthest_m, hypot(*self.off_m()))
            up_m = self.surveyed.fleet.place_m(IMAGER)[2]
            assert abs(up_m - self.start_m[2]) < 1.5
        return farthest_m

    def holder(self) -> AuthorityHolder:
        return self.surveyed.holder(IMAGER)

    def alarms(self) -> dict[str, str]:
        """Active alarms of side-steps: text by key."""
        book = self.station.alarms.alarms.values()
        conditions = [alarm.condition for alarm in book if alarm.is_active]
        return {each.key: each.text for each in conditions if each.rule == "side_step"}

    def reads_shade(self, known_share: float, age_s: float = 0.0) -> None:
        """A shade map, captured so long ago, with this share of the seen cells known, in sun."""
        now_ns = self.surveyed.driver.now_ns - round(age_s * 1e9)
        valid = np.zeros(GRID.rows * GRID.cols, np.bool_)
        valid[: round(known_share * valid.size)] = True
        valid = valid.reshape(GRID.rows, GRID.cols)
        values = np.where(valid, np.float32(1.0), np.float32("nan"))
        shade = ShadeMap(GRID, now_ns, (IMAGER,), values, valid, valid.astype(np.float32), values)
        pipeline = self.station.shade
        settings = ForecastSettings()
        forecast, sun = FORECASTERS["persistence"].after(ForecastState(), shade, settings)
        number = pipeline.next_job_id
        self.station = replace(
            self.station, shade=replace(pipeline, job_id=number, next_job_id=number + 1)
        )
        own = SeenShade(shade, np.ones_like(valid))
        read = ShadeRead(IMAGER, DetectionState(), forecast, own, (own, sun))
        self.surveyed.driver.handle(JobDone(number, READ_SHADE, read))

    def sun_azimuth_deg(self) -> float:
        at_s = (EPOCH_NS + self.surveyed.driver.now_ns) / 1e9
        return sun_position(LatLon(HOME.latitude_deg, HOME.longitude_deg), at_s).azimuth_deg


@flown_once
def imager_world(
    others: int = 0,
    *,
    height_m: float = 60.0,
    place_m: tuple[float, float] = (60.0, 120.0),
    **options: object,
) -> ImagerWorld:
    """Return an imaging drone that hovers, and survey drones that hover at 40 m over their pads."""
    pads = ((place_m[0], place_m[1]), *((40.0 * number, -40.0) for number in range(others)))
    world = surveyed_world(1 + others, pads=pads, **options)
    driver = world.driver
    driver.station = with_imagers(driver.station, IMAGER)
    world.fleet.put(IMAGER, (*place_m, height_m))
    world.runs(3.0)
    return ImagerWorld(world, (*place_m, height_m))
