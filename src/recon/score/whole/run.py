"""One scenario, one seed, the whole station: flown in virtual time and scored."""

from collections.abc import Callable, Sequence

import numpy as np

from recon.model.command import Phase
from recon.model.geo import GroundGrid
from recon.model.survey import CellState
from recon.model.units import NS_PER_S
from recon.score.closed_loop import CURVE_MIN
from recon.score.errors import ScenarioError
from recon.score.photos import Imaged, imaged, phases_s
from recon.score.run_score import ENOUGH, RunScore, shares_by, time_to_share
from recon.score.scenario import Scenario
from recon.score.settings import RUN
from recon.score.simulation import sky_of
from recon.score.whole.apps import ConnectedApps
from recon.score.whole.imager import config_of, jobs_of, settings_of
from recon.score.whole.scripted_operator import SURVEY_ID, People
from recon.score.whole.sight import Sight, footprint_on
from recon.score.whole.ways import (
    TrueWay,
    breaches,
    encounters,
    photos_on_rows,
    true_way,
)
from recon.sim.fleet import IMAGER_SERIAL, build_fleet
from recon.station.kernel.build import first_state
from recon.station.kernel.virtual import VirtualDriver
from recon.station.state.survey_record import SurveyRecord

SAMPLE_S = 0.1
SAMPLES_TO_A_LOOK = 10
TOLD_EVERY_S = 300


Tell = Callable[[int, float], None]
"""Told minutes flown, and the share of the region that the survey counts as seen in sun."""


def run_whole(scenario: Scenario, seed: int, tell: Tell | None = None) -> RunScore:
    """Return the score of one run; the same for the same scenario and seed, to the bit.

    Raises `ScenarioError` for a scenario whose survey the station does not plan.
    """
    return WholeRun(scenario, seed).score(tell)


class WholeRun:
    """The station, its apps and people in virtual time, and what is noted of them."""

    def __init__(self, scenario: Scenario, seed: int) -> None:
        self.scenario, self.seed = scenario, seed
        self._sky = sky_of(scenario, seed)
        grid = _grid(scenario)
        footprint = footprint_on(grid, scenario)
        self.driver = VirtualDriver(
            first_state(scenario.site, settings_of(scenario)),
            jobs=jobs_of(scenario, self._sky, grid, footprint),
            keeps_log=False,
        )
        self.apps = ConnectedApps(self.driver, build_fleet(config_of(scenario, seed), 0))
        self._ways = {app.settings.serial: true_way(app, scenario.frame) for app in self.apps.apps}
        self._people = People(scenario.survey, scenario.fleet.serials, scenario.limit_s)
        self._sight = Sight(scenario, self._sky, footprint, grid)
        self._refused: set[int] = set()

    @property
    def now_s(self) -> float:
        """Virtual time since the run's start."""
        return self.driver.now_ns / NS_PER_S

    def score(self, tell: Tell | None = None) -> RunScore:
        """Run to the end and sum up; how far it is, is told every few minutes."""
        watch_s = 0.0 if self.scenario.methods.is_guidance_alone else RUN.watch_s
        watch_s = min(watch_s, self.scenario.limit_s)
        landed_s: float | None = None
        while landed_s is None or self.now_s < watch_s:
            self.pass_a_second()
            if landed_s is None and self._is_over():
                landed_s = self.now_s
            if tell is not None and round(self.now_s) % TOLD_EVERY_S == 0:
                tell(round(self.now_s / 60.0), self.in_sun_share)
        return self._summed_up(landed_s)

    def pass_a_second(self) -> None:
        """Fly on for a second; then people look, and may say something."""
        for _ in range(SAMPLES_TO_A_LOOK):
            self.apps.run_for(SAMPLE_S)
            for way in self._ways.values():
                way.sample(self.driver.now_ns)
        self._sight.look(self.driver.station, self.driver.now_ns)
        self._note_refusals()
        for event in self._people.says(self.driver.station, self.driver.now_ns):
            self.driver.handle(event)

    @property
    def record(self) -> SurveyRecord | None:
        """The survey as the station knows it; None before it was asked for."""
        return self.driver.station.surveys.records.get(SURVEY_ID)

    @property
    def in_sun_share(self) -> float:
        """Of the region's cells, as the survey counts them."""
        record = self.record
        if record is None or record.state is None:
            return 0.0
        inside = record.state.plan.cells.is_inside
        return float((record.state.progress.state[inside] == CellState.IN_SUN).mean())

    @property
    def drones(self) -> Sequence[TrueWay]:
        """The survey drones' true ways."""
        return [way for serial, way in self._ways.items() if serial != IMAGER_SERIAL]

    def _note_refusals(self) -> None:
        """The station forgets old orders."""
        for number, order in self.driver.station.orders.records.items():
            if order.phase is Phase.REFUSED_BY_STATION:
                self._refused.add(number)

    def _is_over(self) -> bool:
        if self.now_s >= self.scenario.limit_s + RUN.longest_way_home_s:
            return True
        record = self.record
        if record is not None and record.refusal is not None:
            name, reason = self.scenario.name, record.refusal.reason
            raise ScenarioError(f"{name}: expected a survey that can be flown, got: {reason}")
        return record is not None and record.is_over and not any(w.is_up[-1] for w in self.drones)

    def _summed_up(self, landed_s: float) -> RunScore:
        scenario, seen, record = self.scenario, self._sight.score, self.record
        assert record is not None  # or the run would not be over
        assert record.state is not None
        plan = record.state.plan
        found = self._imaged(record)
        inside = plan.cells.is_inside
        first_in_sun_s = found.first_in_sun_s[inside]
        limit_s = scenario.limit_s
        curve_s = np.array([60.0 * m for m in CURVE_MIN if 60.0 * m <= limit_s])
        errors_m = seen.boundary_errors_m
        reserve = scenario.fleet.reserve_share
        return RunScore(
            seed=self.seed,
            shade=seen.shade,
            boundary_error_m=float(np.mean(errors_m)) if errors_m else None,
            known_share=float(np.mean(seen.known_shares)) if seen.known_shares else 0.0,
            shade_share=float(np.mean(seen.shade_shares)) if seen.shade_shares else 0.0,
            leads=seen.leads,
            in_sun_share=shares_by(first_in_sun_s, curve_s),
            to_95_imaged_s=time_to_share(found.first_s[inside], ENOUGH, limit_s),
            to_95_in_sun_s=time_to_share(first_in_sun_s, ENOUGH, limit_s),
            wrongly_in_sun_share=_wrongly(record, found),
            survey_s=landed_s,
            flight_s=sum(way.flown_s for way in self.drones),
            missions=record.state.missions,
            photos=found.photos,
            shaded_photos=found.shaded_photos,
            encounters=encounters(list(self._ways.values())),
            low_landings=sum(left < reserve for w in self.drones for left in w.landed_with),
            end=record.state.reason,
            simulated_s=self.now_s,
            breaches=breaches(self.drones, scenario.site),
            refusals=len(self._refused),
        )

    def _imaged(self, record: SurveyRecord) -> Imaged:
        assert record.state is not None
        plan = record.state.plan
        interval_s = plan.survey.camera.interval_s
        phases = phases_s(self.seed, self.scenario.fleet.serials, interval_s)
        photos = [
            photos_on_rows(way, phase_s, plan)
            for way, phase_s in zip(self.drones, phases, strict=True)
        ]
        return imaged(photos, plan, self._sky)


def _wrongly(record: SurveyRecord, found: Imaged) -> float | None:
    assert record.state is not None
    inside = record.state.plan.cells.is_inside
    said = (record.state.progress.state == CellState.IN_SUN) & inside
    return float(np.isinf(found.first_in_sun_s[said]).mean()) if said.any() else None


def _grid(scenario: Scenario) -> GroundGrid:
    """The grid of what the eye sees, in the scenario's cells, inside the site's ground image."""
    imager, image = scenario.imager, scenario.site.ground_grid
    assert image is not None  # a site with an eye has one
    side_m = min(2.0 * imager.radius_m, image.cols * image.cell_m, image.rows * image.cell_m)
    count = int(side_m // imager.cell_m)
    half_m = count * imager.cell_m / 2.0
    west_m, north_m = imager.over_m[0] - half_m, imager.over_m[1] + half_m
    return GroundGrid(scenario.frame, west_m, north_m, imager.cell_m, count, count)
