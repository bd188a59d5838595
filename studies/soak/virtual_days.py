"""Days in virtual time: surveys again and again, batteries changed, the computer's clock stepped.

The whole station and the bytes of its links, without sockets; its imaging drone sends no frames and
the survey is a lawnmower's, so that a night needs no sun. Halfway the computer's clock, of which
the station is told, goes an hour ahead: nothing may stop or be repeated for it.
"""

import os
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import psutil

from recon.cli.own_files import scenario_file
from recon.model.event import ClockRead, SurveyRequested
from recon.model.units import NS_PER_S
from recon.score import load_scenario
from recon.score.scenario import Scenario
from recon.score.scripted_operator import ScriptedOperator
from recon.score.simulation import simulation_of
from recon.score.station_operator import StationOperator
from recon.sim.connected_apps import ConnectedApps
from recon.sim.fleet import build_fleet
from recon.station.kernel.build import first_state
from recon.station.kernel.virtual import EPOCH_NS, VirtualDriver
from recon.station.kernel.worker import JobRunner
from recon.station.recovery.snapshot import encode_snapshot, take_snapshot
from studies.soak.figures import (
    HOUR_S,
    MB,
    SETTLING_SHARE,
    ProcessSample,
    Soak,
    growth_lines,
    growths,
)

SCENARIO = "eight-drones"
SEED = 1
BATTERY_GAIN = 0.3
"""A battery that is fuller by this was changed."""
SAMPLE_EVERY_S = 60.0
STEP_NS = 3_600 * NS_PER_S
LONGEST_ENDURANCE_S = 1e7
"""Of the imaging drone, which nobody starts again. Others get a full battery at each landing: one
that stays in would fall below the operator's share on the ground, and end the surveys."""


@dataclass(slots=True)
class Tally:
    """What has happened so far."""

    surveys: int = 0
    battery_changes: int = 0
    batteries: dict[str, float] = field(default_factory=dict)

    def see_batteries(self, shares: Mapping[str, float | None]) -> None:
        """Count the batteries that were changed since the last look."""
        for serial, share in shares.items():
            if share is not None:
                was = self.batteries.get(serial, share)
                self.battery_changes += share > was + BATTERY_GAIN
                self.batteries[serial] = share


class Days:
    """The station, its apps and an operator that flies one survey after the other."""

    def __init__(self, vehicles: int) -> None:
        scenario = _scenario(vehicles)
        config = simulation_of(scenario, SEED)
        endurances_s = dict.fromkeys(config.imagers, LONGEST_ENDURANCE_S)
        self.driver = VirtualDriver(
            first_state(scenario.site), jobs=JobRunner(scenario.site), keeps_log=False
        )
        self.apps = ConnectedApps(self.driver)
        config = replace(config, endurances_s=endurances_s, battery_kept_share=1.0)
        self.apps.connect_all(build_fleet(config, 0))
        fleet = scenario.fleet
        operator = ScriptedOperator(fleet.serials, fleet.kept_share, repeats=True)
        self._operator = StationOperator(scenario.survey, operator)
        self.tally = Tally()

    def fly_a_second(self) -> None:
        """Fly on, and let the operator act."""
        self.apps.advance(1.0)
        station, now_ns = self.driver.station, self.driver.now_ns
        for event in self._operator.events(station, now_ns):
            self.tally.surveys += isinstance(event, SurveyRequested)
            self.driver.handle(event)
        vehicles = station.fleet.vehicles.items()
        self.tally.see_batteries({s: v.battery_fraction.value for s, v in vehicles})

    def step_clock(self) -> None:
        """Tell the station that the computer's clock is an hour ahead."""
        self.driver.handle(ClockRead(EPOCH_NS + self.driver.now_ns + STEP_NS))

    @property
    def snapshot_bytes(self) -> int:
        """The size of the recovery snapshot."""
        return len(encode_snapshot(take_snapshot(self.driver.station, self.driver.now_ns)))


def fly_days(hours: float, vehicles: int) -> int:
    """Fly for so long; print a table each tenth and return the exit code."""
    days, soak, process = Days(vehicles), Soak(), psutil.Process()
    length_s, began_s = hours * HOUR_S, time.perf_counter()
    at_clock_step: Tally | None = None
    print(
        f"{'hours':>6}{'x real':>8}{'memory MB':>11}{'handles':>9}{'threads':>9}{'snapshot kB':>13}"
        f"{'surveys':>9}{'batteries':>11}{'orders':>8}{'alarms':>8}"
    )
    for second in range(1, round(length_s) + 1):
        days.fly_a_second()
        if at_clock_step is None and second >= length_s / 2.0:
            days.step_clock()
            at_clock_step = replace(days.tally)
            print(f"{second / HOUR_S:>6.2f}  the clock is stepped by an hour")
        if second % SAMPLE_EVERY_S == 0:
            soak.processes.append(_sample(process, float(second)))
        if second % max(1, round(length_s / 10.0)) == 0:
            _print(days, second, began_s, _sample(process, float(second)))
    return _verdict(soak, days, at_clock_step, length_s)


def _verdict(soak: Soak, days: Days, at_step: Tally | None, length_s: float) -> int:
    print("memory after the first sixth:")
    print("\n".join(growth_lines(soak, length_s)))
    faults = [
        f"memory of {each.role} grows"
        for each in growths(soak.processes, SETTLING_SHARE * length_s)
        if not each.is_flat
    ]
    if at_step is None or days.tally.battery_changes <= at_step.battery_changes:
        faults.append("no battery was changed after the clock's step: did the surveys go on?")
    for fault in faults:
        print(f"FAILED: {fault}")
    return 1 if faults else 0


def _sample(process: psutil.Process, at_s: float) -> ProcessSample:
    rss_bytes, handles = process.memory_info().rss, process.num_fds()
    return ProcessSample(at_s, "all", os.getpid(), rss_bytes, handles, process.num_threads())


def _print(days: Days, second: int, began_s: float, sample: ProcessSample) -> None:
    station, tally = days.driver.station, days.tally
    speed = second / (time.perf_counter() - began_s)
    print(
        f"{second / HOUR_S:>6.2f}{speed:>8.0f}{sample.rss_bytes / MB:>11.1f}{sample.handles:>9}"
        f"{sample.threads:>9}{days.snapshot_bytes / 1e3:>13.1f}{tally.surveys:>9}"
        f"{tally.battery_changes:>11}{len(station.orders.records):>8}"
        f"{len(station.alarms.alarms):>8}",
        flush=True,
    )


def _scenario(vehicles: int) -> Scenario:
    """Return the scenario with so many vehicles, its imaging drone among them."""
    scenario = load_scenario(scenario_file(SCENARIO))
    fleet = replace(scenario.fleet, pads_m=scenario.fleet.pads_m[: max(1, vehicles - 1)])
    return replace(scenario, fleet=fleet, survey=replace(scenario.survey, planner="lawnmower_once"))
