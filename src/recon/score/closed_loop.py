"""A scenario flown to its end by events, without a station: eye, survey and drones in one loop."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from recon.guidance.survey import (
    SurveyPlan,
    SurveyState,
    create,
    observe,
    observe_shade,
    plan_survey,
    start,
    step,
)
from recon.model.survey import CellState, SurveyPhase
from recon.model.units import seconds_to_ns
from recon.score.drone import Doing, Drone
from recon.score.fault_effects import Mishap, gusty_spans, mishaps_of, with_chances
from recon.score.flight import whereabouts
from recon.score.imager import Imager
from recon.score.missions import survey_points, way_home
from recon.score.photos import Imaged, imaged, phases_s, photos_of
from recon.score.run_score import ENOUGH, RunScore, encounters, shares_by, time_to_share
from recon.score.scenario import Scenario
from recon.score.settings import FLIGHT, RUN
from recon.sim.world import Sky, Wind

CURVE_MIN = (5.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0)
"""When the area in sun is told."""


def run(scenario: Scenario, seed: int) -> RunScore:
    """Return the score of one run; the same for the same scenario and seed, to the bit.

    Raises `ValueError` for a scenario whose survey cannot be flown; one that was read can.
    """
    return EventRun(scenario, seed).score()


class EventRun:
    """One run; times are seconds since its start."""

    def __init__(self, scenario: Scenario, seed: int) -> None:
        scenario = with_chances(scenario, seed)
        self._scenario, self._seed = scenario, seed
        self._sky = Sky(replace(scenario.sky, seed=seed))
        self._imager = Imager(scenario, self._sky, seed)
        self._drones = _drones(scenario, seed)
        self._plan, self._state = _begun(scenario)
        self._mishaps: list[Mishap] = mishaps_of(scenario)
        self._looks = 0
        self._now_s = 0.0
        self._carried_s = 0.0

    @property
    def drones(self) -> Sequence[Drone]:
        """The fleet, in its order."""
        return self._drones

    def score(self) -> RunScore:
        """Run to the end and sum up."""
        is_watched = not self._scenario.methods.is_guidance_alone
        watch_s = min(RUN.watch_s, self._scenario.limit_s) if is_watched else 0.0
        landed_s: float | None = None
        while landed_s is None or self._now_s < watch_s:
            self._tick()
            if landed_s is None and self._is_over():
                landed_s = self._now_s
            self._now_s = self._next_s(landed_s is not None)
        return self._summed_up(landed_s)

    def _is_over(self) -> bool:
        if self._now_s >= self._scenario.limit_s + RUN.longest_way_home_s:
            return True
        return self._state.phase.is_final and not any(d.is_airborne for d in self._drones)

    def _next_s(self, only_watching: bool) -> float:
        """When something happens next: a look of the eye, an end, a mishap, or a wait is over."""
        due_s = [self._looks * self._scenario.imager.period_s]
        if not only_watching:
            due_s += [drone.free_at_s for drone in self._drones]
            due_s += [mishap.at_s for mishap in self._mishaps[:1]]
            due_s += [self._now_s + RUN.idle_s] * (not self._state.flights)
        return min(at_s for at_s in due_s if at_s > self._now_s)

    def _tick(self) -> None:
        while self._mishaps and self._mishaps[0].at_s <= self._now_s:
            self._mishaps.pop(0).strike(self._drones)
        for drone in self._drones:
            drone.advance(self._now_s)
        self._look()
        if self._state.phase is SurveyPhase.RUNNING and self._is_due():
            self._carry_on()
        self._send_home()

    def _look(self) -> None:
        if self._now_s < self._looks * self._scenario.imager.period_s:
            return
        self._looks += 1
        shade = self._imager.look(self._now_s)
        if shade is not None:
            self._state = observe_shade(self._state, shade)

    def _is_due(self) -> bool:
        """Whether the survey is to be looked at: rarely while all fly missions."""
        is_calm = all(drone.doing is Doing.MISSION for drone in self._drones)
        return not is_calm or self._now_s >= self._carried_s + RUN.calm_s

    def _carry_on(self) -> None:
        self._carried_s = self._now_s
        for drone in self._drones:
            self._state = observe(self._state, drone.serial, drone.seen(self._now_s))
        crew = [drone.surveyor(self._now_s) for drone in self._drones]
        self._state, missions = step(self._state, crew, seconds_to_ns(self._now_s))
        for mission in missions:
            number = self._scenario.fleet.serials.index(mission.serial)
            drone = self._drones[number]
            at_m = drone.spot_at(self._now_s)
            points, rows_from = survey_points(mission.mission, at_m, number, self._scenario)
            drone.take(mission.number, points, rows_from, self._now_s)

    def _send_home(self) -> None:
        """Who has nothing to do any more, or no battery for what is left, flies home."""
        is_over = self._state.phase.is_final
        for drone in self._drones:
            is_idle = drone.doing is Doing.HOVERING
            cannot = is_idle and drone.serial in self._state.waiting
            if drone.must_go_home(self._now_s):
                drone.go_home(self._now_s)
            elif cannot or (is_idle and is_over):
                layer = sum(other.doing is Doing.RETURNING for other in self._drones)
                at_m = drone.spot_at(self._now_s)
                drone.come_home(way_home(at_m, drone.pad_m, layer), self._now_s)

    def _summed_up(self, landed_s: float) -> RunScore:
        scenario, imager, plan = self._scenario, self._imager.score, self._plan
        found = self._imaged()
        inside = plan.cells.is_inside
        first_in_sun_s = found.first_in_sun_s[inside]
        limit_s = scenario.limit_s
        curve_s = np.array([60.0 * m for m in CURVE_MIN if 60.0 * m <= limit_s])
        errors_m = imager.boundary_errors_m
        return RunScore(
            seed=self._seed,
            shade=imager.shade,
            boundary_error_m=float(np.mean(errors_m)) if errors_m else None,
            known_share=float(np.mean(imager.known_shares)),
            shade_share=float(np.mean(imager.shade_shares)),
            leads=imager.leads,
            in_sun_share=shares_by(first_in_sun_s, curve_s),
            to_95_imaged_s=time_to_share(found.first_s[inside], ENOUGH, limit_s),
            to_95_in_sun_s=time_to_share(first_in_sun_s, ENOUGH, limit_s),
            wrongly_in_sun_share=self._wrongly(found),
            survey_s=landed_s,
            flight_s=sum(drone.flown_s for drone in self._drones),
            missions=self._state.missions,
            photos=found.photos,
            shaded_photos=found.shaded_photos,
            encounters=self._encounters(landed_s),
            low_landings=sum(drone.low_landings for drone in self._drones),
            end=self._state.reason,
            simulated_s=self._now_s,
        )

    def _imaged(self) -> Imaged:
        interval_s = self._plan.survey.camera.interval_s
        phases = phases_s(self._seed, self._scenario.fleet.serials, interval_s)
        photos = [
            photos_of(drone.hops, phase_s, self._plan)
            for drone, phase_s in zip(self._drones, phases, strict=True)
        ]
        return imaged(photos, self._plan, self._sky)

    def _wrongly(self, found: Imaged) -> float | None:
        said = (self._state.progress.state == CellState.IN_SUN) & self._plan.cells.is_inside
        if not said.any():
            return None
        return float(np.isinf(found.first_in_sun_s[said]).mean())

    def _encounters(self, until_s: float) -> int:
        at_s = np.arange(0.0, until_s + 1.0)
        ways = [whereabouts(drone.hops, at_s) for drone in self._drones]
        apart_m = (FLIGHT.separation_m, FLIGHT.separation_up_m)
        return encounters([w[0] for w in ways], [w[1] for w in ways], *apart_m)


def _begun(scenario: Scenario) -> tuple[SurveyPlan, SurveyState]:
    plan = plan_survey(scenario.survey, scenario.frame)
    state = create(plan) if isinstance(plan, SurveyPlan) else plan
    begun = start(state, scenario.fleet.serials, 0) if isinstance(state, SurveyState) else state
    if not (isinstance(plan, SurveyPlan) and isinstance(begun, SurveyState)):
        raise ValueError(f"{scenario.name}: expected a survey that can be flown, got {begun}")
    return plan, begun


def _drones(scenario: Scenario, seed: int) -> Sequence[Drone]:
    survey, fleet = scenario.survey, scenario.fleet
    wind = Wind(replace(scenario.wind, seed=seed))
    profiles = scenario.site.profiles
    return [
        Drone(
            serial,
            pad_m,
            fleet,
            survey.speed_mps,
            profiles[serial].go_home_height_m or survey.height_above_takeoff_m,
            wind,
            FLIGHT,
            gusty_s=gusty_spans(scenario, serial),
        )
        for serial, pad_m in zip(fleet.serials, fleet.pads_m, strict=True)
    ]
