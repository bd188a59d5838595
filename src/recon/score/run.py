"""One scenario and one seed, flown by the whole station in virtual time and scored.

Every byte, the gate and the watchdogs take part; only sockets and clock are replaced.
"""

from collections import deque
from collections.abc import Callable, Sequence

import numpy as np

from recon.model.command import Hover, Phase
from recon.model.control import AuthorityHolder
from recon.model.survey import CellState
from recon.model.units import NS_PER_S
from recon.score.methods import config_of, jobs_of, renderers_of, sent_by, settings_of
from recon.score.run_score import (
    ENOUGH,
    RunScore,
    registration_quantiles_m,
    shares_by,
    time_to_share,
)
from recon.score.scenario import Scenario
from recon.score.scenario_schema import ScenarioError
from recon.score.scenario_sky import sky_of
from recon.score.scripted_operator import ScriptedOperator
from recon.score.settings import SCORE
from recon.score.shade_scoring import ImagerScore, ShadeScoring
from recon.score.station_operator import SURVEY_ID, StationOperator
from recon.score.true_frames import FleetFrames
from recon.score.true_paths import (
    Imaged,
    TruePath,
    breaches,
    encounters,
    imaged,
    phases_s,
    photos_on_rows,
    true_path,
)
from recon.sim.app.app import SimulatedApp
from recon.sim.app.camera_feed import CaptureTimes
from recon.sim.connected_apps import ConnectedApps
from recon.sim.fleet import build_fleet
from recon.station.kernel.build import first_state
from recon.station.kernel.virtual import VirtualDriver
from recon.station.state.survey_record import SurveyRecord

SAMPLES_PER_SECOND = round(1.0 / SCORE.sample_s)
REPORT_EVERY_S = 300

Report = Callable[[int, int, float], None]
"""Called with the seed, minutes flown, and the share of the region that the survey counts as in
sun."""


def run(scenario: Scenario, seed: int, report: Report | None = None) -> RunScore:
    """Return the score of one run; bit for bit the same for the same scenario and seed.

    Raises `ScenarioError` for a scenario whose survey the station does not plan.
    """
    return StationRun(scenario, seed).score(report)


class StationRun:
    """The station, its apps and operator in virtual time, and what is recorded of them."""

    def __init__(self, scenario: Scenario, seed: int) -> None:
        self.scenario, self.seed = scenario, seed
        self._sky = sky_of(scenario, seed)
        config = config_of(scenario, seed)
        apps = build_fleet(sent_by(config, scenario), 0)
        frames = FleetFrames.of(scenario, _captures(apps), renderers_of(config))
        self.driver = VirtualDriver(
            first_state(scenario.site, settings_of(scenario)),
            jobs=jobs_of(scenario, self._sky, frames),
            keeps_log=False,
            # The station computes the same sun as the simulator.
            epoch_ns=round(self._sky.settings.sun.start_utc_s * NS_PER_S),
        )
        self.apps = ConnectedApps(self.driver)
        self.apps.connect_all(apps)
        self._paths = {
            app.settings.serial: true_path(app, scenario.frame) for app in self.apps.apps
        }
        operator = ScriptedOperator(
            scenario.fleet.serials, scenario.fleet.kept_share, scenario.limit_s
        )
        self._operator = StationOperator(scenario.survey, operator, scenario.imager.is_upwind)
        self._shade = ShadeScoring(scenario, self._sky, frames)
        self._refused: set[int] = set()
        self._held: set[int] = set()

    @property
    def now_s(self) -> float:
        """Virtual time since the run's start."""
        return self.driver.now_ns / NS_PER_S

    def score(self, report: Report | None = None) -> RunScore:
        """Run to the end and sum up; `report` is called every few minutes."""
        least_run_s = 0.0 if self.scenario.methods.is_guidance_alone else SCORE.least_run_s
        least_run_s = min(least_run_s, self.scenario.limit_s)
        landed_s: float | None = None
        while landed_s is None or self.now_s < least_run_s:
            self.advance_a_second()
            if landed_s is None and self._is_over():
                landed_s = self.now_s
            if report is not None and round(self.now_s) % REPORT_EVERY_S == 0:
                report(self.seed, round(self.now_s / 60.0), self.in_sun_share)
        return self._summed_up(landed_s)

    def advance_a_second(self) -> None:
        """Fly for a second, score maps and forecasts, and let the operator act."""
        for _ in range(SAMPLES_PER_SECOND):
            self.apps.advance(SCORE.sample_s)
            for path in self._paths.values():
                path.sample(self.driver.now_ns)
        station, now_ns = self.driver.station, self.driver.now_ns
        if self.scenario.methods.scores_maps:
            self._shade.update(station, now_ns)
        self._record_orders()
        for event in self._operator.events(station, now_ns):
            self.driver.handle(event)

    @property
    def record(self) -> SurveyRecord | None:
        """The station's record of the survey; None before it was requested."""
        return self.driver.station.surveys.records.get(SURVEY_ID)

    @property
    def in_sun_share(self) -> float:
        """Return the share of the region's cells that the survey counts as in sun."""
        record = self.record
        if record is None or record.state is None:
            return 0.0
        inside = record.state.plan.cells.is_inside
        return float((record.state.progress.state[inside] == CellState.IN_SUN).mean())

    @property
    def shade_score(self) -> ImagerScore:
        """Shade maps and forecasts, as scored so far."""
        return self._shade.score

    @property
    def drones(self) -> Sequence[TruePath]:
        """The survey drones' true paths."""
        imagers = self.scenario.site.imagers
        return [path for serial, path in self._paths.items() if serial not in imagers]

    def _record_orders(self) -> None:
        """Remember refused orders and watchdogs' holds: the station drops old records."""
        for number, order in self.driver.station.orders.records.items():
            command = order.command
            # Guidance ends its own motions with a hold.
            is_hold = (
                isinstance(command.body, Hover) and command.role is not AuthorityHolder.GUIDANCE
            )
            if order.phase is Phase.REFUSED_BY_STATION:
                self._refused.add(number)
            elif command.is_own and is_hold:
                self._held.add(number)

    def _is_over(self) -> bool:
        if self.now_s >= self.scenario.limit_s + SCORE.longest_return_s:
            return True
        record = self.record
        if record is not None and record.refusal is not None:
            name, reason = self.scenario.name, record.refusal.reason
            raise ScenarioError(f"{name}: expected a survey that can be flown, got: {reason}")
        return record is not None and record.is_over and not any(p.is_up[-1] for p in self.drones)

    def _summed_up(self, landed_s: float) -> RunScore:
        scenario, shade, record = self.scenario, self._shade.score, self.record
        assert record is not None  # or the run would not be over
        assert record.state is not None
        found = self._imaged(record)
        inside = record.state.plan.cells.is_inside
        counted = (record.state.progress.state == CellState.IN_SUN) & inside
        first_in_sun_s = found.first_in_sun_s[inside]
        limit_s = scenario.limit_s
        curve_s = np.array([60.0 * m for m in SCORE.curve_min if 60.0 * m <= limit_s])
        reserve = scenario.fleet.reserve_share
        landed_with = [left for path in self.drones for left in path.landed_with]
        return RunScore(
            seed=self.seed,
            shade=shade.shade,
            to_right_s=shade.to_right_s,
            registration_m=registration_quantiles_m(shade.registration_errors_m),
            forecasts=shade.forecasts,
            changes=shade.changes,
            in_sun_share=shares_by(first_in_sun_s, curve_s),
            to_95_imaged_s=time_to_share(found.first_s[inside], ENOUGH, limit_s),
            to_95_in_sun_s=time_to_share(first_in_sun_s, ENOUGH, limit_s),
            counted_in_sun=int(counted.sum()),
            wrongly_in_sun=int(np.isinf(found.first_in_sun_s[counted]).sum()),
            survey_s=landed_s,
            flight_s=sum(path.flown_s for path in self.drones),
            missions=record.state.missions,
            photos=found.photos,
            shaded_photos=found.shaded_photos,
            encounters=encounters(list(self._paths.values())),
            landings=len(landed_with),
            low_landings=sum(left < reserve for left in landed_with),
            end=record.state.reason,
            simulated_s=self.now_s,
            breaches=breaches(self.drones, scenario.site),
            refusals=len(self._refused),
            holds=len(self._held),
        )

    def _imaged(self, record: SurveyRecord) -> Imaged:
        assert record.state is not None
        plan = record.state.plan
        interval_s = plan.survey.camera.interval_s
        phases = phases_s(self.seed, self.scenario.fleet.serials, interval_s)
        photos = [
            photos_on_rows(path, phase_s, plan)
            for path, phase_s in zip(self.drones, phases, strict=True)
        ]
        return imaged(photos, plan, self._sky)


def _captures(apps: Sequence[SimulatedApp]) -> dict[str, deque[CaptureTimes]]:
    """Return the imaging drones' frames, as they are taken, by serial."""
    return {app.settings.serial: app.feed.captures for app in apps if app.feed is not None}
