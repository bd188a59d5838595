"""Two imaging drones with cameras, survey drones, and the shade maps that their frames would give.

A map comes with each frame that a camera truly sends, over the ground that it truly sees. What
follows is the station's own: the map of all drones, its age, and the relief.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from tests.flown_once import flown_once
from tests.station.imager_world import GRID
from tests.station.imagers import with_imagers
from tests.station.returning_world import returning_world
from tests.station.surveyed_world import SurveyedWorld

from recon.detection import DetectionState, merged
from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.geo import cell_centres_m
from recon.model.control import AuthorityHolder
from recon.model.event import ReliefOrdered
from recon.model.shade import ShadeMap, SunForecast
from recon.sim.app.camera_feed import FeedSettings
from recon.sim.camera.frames import StillFrame
from recon.sim.fleet import ImagerSetup
from recon.sim.flight.battery import Battery
from recon.station.imaging.shade import READ_SHADE, ShadeRead
from recon.station.state.imager_motion import ImagerRelief
from recon.station.state.imaging import SeenShade
from recon.station.state.station import Station
from recon.station.state.steps import JobDone

CAMERAS = ("CAM-1", "CAM-2")
FIRST, SPARE = CAMERAS
PLACE_M = (60.0, 30.0)
FIRST_UP_M = 45.0
SURVEY_M = 25.0
FRAME = StillFrame(np.full((8, 8, 3), 90, np.uint8))
LATENCY_NS = 1_000_000_000
"""Of frames and detection together."""


@dataclass(slots=True)
class RelievedWorld:
    """Runs the world, gives the station shade maps, and observes their age."""

    surveyed: SurveyedWorld
    blind_cameras: set[str] = field(default_factory=set)
    """Whose frames show nothing."""
    shown_m: dict[str, float] = field(default_factory=dict)
    """The radius that a camera shows; one and a half heights where it is not given."""
    worst_age_s: float = 0.0
    """The greatest age of the newest shade map since it was set to 0."""
    nearest_m: float = float("inf")
    """Between the two imaging drones in the air, in three dimensions."""
    _frames: dict[str, int] = field(default_factory=dict)

    @property
    def station(self) -> Station:
        station: Station = self.surveyed.driver.station
        return station

    @station.setter
    def station(self, station: Station) -> None:
        self.surveyed.driver.station = station

    def runs(self, seconds: float) -> None:
        for _ in range(round(seconds * 2)):
            self.surveyed.runs(0.5)
            self._reads_shade()
            shade = self.station.shade.shade
            if shade is not None:
                age_s = (self.surveyed.driver.now_ns - shade.captured_at_ns) / 1e9
                self.worst_age_s = max(self.worst_age_s, age_s)
            if all(self.surveyed.fleet.flies(serial) for serial in CAMERAS):
                one, other = (np.array(self.place_m(serial)) for serial in CAMERAS)
                self.nearest_m = min(self.nearest_m, float(np.linalg.norm(one - other)))

    def runs_until(self, is_reached, at_most_s: float) -> bool:  # type: ignore[no-untyped-def]
        for _ in range(round(at_most_s * 2)):
            if is_reached():
                return True
            self.runs(0.5)
        return bool(is_reached())

    def place_m(self, serial: str) -> tuple[float, float, float]:
        return self.surveyed.fleet.place_m(serial)

    def app(self, serial: str):  # type: ignore[no-untyped-def]
        return self.surveyed.fleet.world.app(serial)

    def charges(self, serial: str, fraction: float) -> None:
        """The battery that is in it now; its use of 1500 s stays."""
        self.app(serial).aircraft.battery = Battery(fraction, 1500.0)

    def battery(self, serial: str) -> float:
        left: float = self.app(serial).aircraft.battery.fraction
        return left

    def orders(self, serial: str = SPARE, relieved: str = FIRST, *, takeoff: bool = True) -> None:
        event = ReliefOrdered(relieved, serial, "ann", takeoff, person="ann")
        self.surveyed.driver.handle(event)

    def newest(self) -> ImagerRelief:
        newest = self.station.imager_motions.of(ImagerRelief)
        assert newest is not None
        return newest

    def holder(self, serial: str) -> AuthorityHolder:
        return self.surveyed.holder(serial)

    def alarms(self) -> dict[str, str]:
        """Active alarms of reliefs: text by key."""
        book = self.station.alarms.alarms.values()
        found = [alarm.condition for alarm in book if alarm.is_active]
        return {each.key: each.text for each in found if each.rule == "imager_relief"}

    def _reads_shade(self) -> None:
        for serial in CAMERAS:
            feed = self.app(serial).feed
            count = len(feed.captures)
            if count == self._frames.get(serial, 0):
                continue
            self._frames[serial] = count
            if serial not in self.blind_cameras and self.surveyed.fleet.flies(serial):
                self._reads(serial)

    def _reads(self, serial: str) -> None:
        place_m = self.place_m(serial)
        taken_ns = self.surveyed.driver.now_ns - LATENCY_NS
        radius_m = self.shown_m.get(serial, 1.5 * place_m[2])
        shade, pipeline = shade_below(serial, place_m, radius_m, taken_ns), self.station.shade
        number, newest = pipeline.next_job_id, pipeline.shade
        pipeline = replace(pipeline, job_id=number, next_job_id=number + 1)
        self.station = replace(self.station, shade=pipeline)
        all_together = None
        if newest is None or taken_ns > newest.captured_at_ns:
            known = [each.shade for key, each in pipeline.own.items() if key != serial]
            recent = [each for each in known if taken_ns - each.captured_at_ns < 10_000_000_000]
            one = merged([shade, *recent])
            all_together = (SeenShade(one, one.valid), _forecast(one))
        own = SeenShade(shade, shade.valid)
        read = ShadeRead(serial, DetectionState(), ForecastState(), own, all_together)
        self.surveyed.driver.handle(JobDone(number, READ_SHADE, read))


def shade_below(
    serial: str, place_m: tuple[float, float, float], radius_m: float, taken_ns: int
) -> ShadeMap:
    """Sun on all the ground within a radius below a drone."""
    east_m, north_m = cell_centres_m(GRID)
    far_m = np.hypot(east_m[np.newaxis, :] - place_m[0], north_m[:, np.newaxis] - place_m[1])
    valid = far_m < radius_m
    values = np.where(valid, np.float32(1.0), np.float32("nan"))
    return ShadeMap(GRID, taken_ns, (serial,), values, valid, valid.astype(np.float32), values)


def _forecast(shade: ShadeMap) -> SunForecast:
    _, sun = FORECASTERS["persistence"].after(ForecastState(), shade, ForecastSettings())
    return sun


@flown_once
def relieved_world(
    surveying: int = 0, *, spare_pad_m: tuple[float, float] = (0.0, -20.0), **options: object
) -> RelievedWorld:
    """Return an imaging drone that hovers over the field, its spare on its pad, survey drones."""
    pads = [(60.0, -20.0), spare_pad_m, *((40.0 * n, -40.0) for n in range(surveying))]
    places = [(*PLACE_M, FIRST_UP_M), (*spare_pad_m, 0.0)]
    places += [(*pad, SURVEY_M) for pad in pads[2:]]
    setup = ImagerSetup(FRAME, FeedSettings(starts_on=False))
    fleet = returning_world(
        places,
        pads,
        imagers=dict.fromkeys(CAMERAS, setup),
        **options,  # type: ignore[arg-type]
    )
    world = RelievedWorld(SurveyedWorld(fleet))
    world.station = with_imagers(world.station, *CAMERAS)
    world.app(FIRST).feed.switch_on(1.0, world.surveyed.driver.now_ns)
    world.runs(3.0)
    return world
