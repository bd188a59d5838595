"""Whole surveys in gears 2 and 3: when each row was flown, each mission ended, each drone landed.

Used by `studies.gears`. The sky is clear, every row is flown once: so both gears fly the same.
"""

from dataclasses import dataclass, field, replace
from pathlib import Path
from random import Random

from recon.model.event import Event
from recon.model.survey import WhenDone
from recon.score import Methods, Scenario, load_scenario
from recon.score.autopilot import Autopilot, Point
from recon.score.closed_loop import EventRun
from recon.score.flight import Spot
from recon.score.settings import FLIGHT
from recon.score.whole.run import WholeRun
from recon.sim.flight.aircraft import Aircraft
from recon.sim.flight.flight_modes import Grounded, TakeOff
from recon.sim.flight.mission import MissionFlight
from recon.sim.world import Wind
from recon.station.state.station import Station

TASK = """about = "a survey for both gears"
start_utc = 2025-06-20T16:00:00Z
[site]
latitude_deg = 41.9
longitude_deg = -93.6
ground_altitude_m = 280.0
[task]
region_m = [[0.0, 0.0], [{east}, 0.0], [{east}, {north}], [0.0, {north}]]
height_m = {height}
speed_mps = {speed}
front_overlap = 0.3
limit_min = 60.0
[fleet]
survey_drones = {drones}
endurance_min = 60.0
[imager]
radius_m = {radius}
height_m = 120.0
period_s = 5
cell_m = 20.0
[methods]
planner = "lawnmower_once"
[wind]
speed_10m_mps = {wind}
"""

LANDED = "landed"
Way = dict[str, float]
"""What was reached, and when."""


def drawn_survey(folder: Path, seed: int, drones: int = 1) -> Scenario:
    """Return a survey of a field of a size, height and speed of its own."""
    random = Random(f"survey {seed}")
    text = TASK.format(
        east=round(random.uniform(120.0, 420.0)),
        north=round(random.uniform(80.0, 200.0)),
        height=round(random.uniform(35.0, 80.0)),
        speed=round(random.uniform(4.0, 9.0), 1),
        wind=random.choice((0.0, 3.5)),
        radius=200.0,
        drones=drones,
    )
    path = folder / f"survey-{seed}.toml"
    path.write_text(text, encoding="utf-8")
    scenario = load_scenario(path)
    survey = replace(scenario.survey, when_done=WhenDone.RETURN_HOME)
    return replace(scenario, survey=survey, methods=Methods("ideal", "none"))


def by_events(scenario: Scenario, seed: int) -> dict[str, Way]:
    """Return when each drone reached what, in seconds since the survey's first mission (gear 3)."""
    run = EventRun(scenario, seed)
    run.score()
    begun_s = min(drone.hops[0].start_s for drone in run.drones) - FLIGHT.acts_after_s
    found: dict[str, Way] = {}
    for drone in run.drones:
        way: Way = {}
        number = 0
        for hop in drone.hops:
            number += hop.waypoint == 0
            if hop.waypoint is not None:
                way[f"mission {number}, {_name(hop.waypoint)}"] = hop.end_s - begun_s
            elif hop.lands:
                way[LANDED] = hop.end_s - begun_s
        found[drone.serial] = way
    return found


@dataclass(slots=True)
class FlownMission:
    """One mission as the simulator flew it, and when each waypoint was reached."""

    mission: MissionFlight
    begun_s: float
    start_m: Spot
    takes_off: bool
    reached_s: Way = field(default_factory=dict)

    def worked_out_s(self, wind: Wind) -> Way:
        """Return the same by events, from the same place and moment."""
        autopilot = Autopilot(self.begun_s, self.start_m, wind)
        if self.takes_off:
            autopilot.take_off()
        points = [
            Point((p.east_m, p.north_m, p.height_m), p.speed_mps, p.loiter_s or 0.0)
            for p in self.mission.points
        ]
        autopilot.fly(points)
        if self.mission.lands_at_end:
            autopilot.land()
        return {
            _name(hop.waypoint): hop.end_s
            for hop in autopilot.hops
            if hop.waypoint is not None or hop.lands
        }


@dataclass(slots=True)
class _Watched:
    """One aircraft as it is watched."""

    aircraft: Aircraft
    missions: list[FlownMission] = field(default_factory=list)
    was_down: bool = True

    def look(self, now_s: float) -> None:
        """Note what was reached since the last look; a mission object is one mission."""
        active_mode, motion = self.aircraft.active_mode, self.aircraft.motion
        takes_off = isinstance(active_mode, TakeOff)
        flying = active_mode.then if isinstance(active_mode, TakeOff) else active_mode
        newest = self.missions[-1] if self.missions else None
        if isinstance(flying, MissionFlight) and (not newest or flying is not newest.mission):
            spot_m = (motion.east_m, motion.north_m, motion.height_m)
            newest = FlownMission(flying, now_s, spot_m, takes_off)
            self.missions.append(newest)
        if newest is not None:
            for number in range(newest.mission.next_index):
                newest.reached_s.setdefault(_name(number), now_s)
            if isinstance(active_mode, Grounded) and not self.was_down:
                newest.reached_s[LANDED] = now_s
        self.was_down = isinstance(active_mode, Grounded)


@dataclass(frozen=True, slots=True)
class StationSurvey:
    """A survey through the whole station (gear 2): each drone's missions, in order."""

    begun_s: float
    missions: dict[str, list[FlownMission]]

    def ways(self) -> dict[str, Way]:
        """Return when each drone reached what, in seconds since the survey's first mission."""
        return {
            serial: {
                LANDED if what == LANDED else f"mission {number}, {what}": at_s - self.begun_s
                for number, mission in enumerate(missions, 1)
                for what, at_s in mission.reached_s.items()
            }
            for serial, missions in self.missions.items()
        }


def by_the_station(scenario: Scenario, seed: int) -> StationSurvey:
    """Fly a survey through the whole station."""
    run = WholeRun(scenario, seed)
    watched = {app.settings.serial: _Watched(app.aircraft) for app in run.apps.apps}
    begun_s: list[float] = []

    def observe(before: Station, after: Station, event: Event) -> None:
        if not begun_s and after.orders.records:
            begun_s.append(run.now_s)
        for each in watched.values():
            each.look(run.now_s)

    run.driver.observe = observe
    run.score()
    serials = scenario.fleet.serials
    return StationSurvey(begun_s[0], {serial: watched[serial].missions for serial in serials})


def _name(waypoint: int | None) -> str:
    return LANDED if waypoint is None else f"waypoint {waypoint + 1}"
