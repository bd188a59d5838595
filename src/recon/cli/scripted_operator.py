"""The scripted operator over HTTP: flies a demonstration's surveys as a client of the API.

A person at the console has priority: as soon as a survey is paused or aborted, the operator stops.
It does not restart drones that were stopped one by one either, nor acts on alarms.
"""

import asyncio
from collections.abc import Callable
from typing import Any

from recon.client import ClientError, Refusal, Station, SurveyStatus, Telemetry
from recon.geo import point_from_enu
from recon.score import Scenario
from recon.score.scripted_operator import (
    AbortSurvey,
    CallHome,
    DroneView,
    FieldView,
    OperatorAction,
    RequestPlan,
    ScriptedOperator,
    StartDrones,
    SurveyStage,
    TakeAuthority,
)
from recon.sim.fleet import IMAGER_SERIAL

LOOK_EVERY_S = 1.0
LIVE_WITHIN_S = 60.0
STAGES = {
    "planning": SurveyStage.PLANNING,
    "created": SurveyStage.PLANNED,
    "running": SurveyStage.FLYING,
    "done": SurveyStage.FINISHED,
}
"""Phases in which the operator goes on; in any other it stops."""

Report = Callable[[str], None]


async def fly_surveys(url: str, scenario: Scenario, report: Report) -> None:
    """Fly one survey after the other until someone stops one, or the station refuses one.

    Raises `ClientError` when the station cannot be reached.
    """
    async with Station(url) as station:
        for serial in (IMAGER_SERIAL, *scenario.fleet.serials):
            await station.vehicle(serial, LIVE_WITHIN_S)
        await _HttpOperator(station, scenario, report).run()


class _HttpOperator:
    """The newest survey, what was last reported of it, and the operator that decides."""

    def __init__(self, station: Station, scenario: Scenario, report: Report) -> None:
        self._station, self._scenario, self._report_line = station, scenario, report
        self._operator = ScriptedOperator(scenario.fleet.serials, repeats=True)
        self._survey_id: int | None = None
        self._last_line = ""

    async def run(self) -> None:
        """Look and act once a second."""
        clock = asyncio.get_running_loop()
        while True:
            survey = await self._survey()
            if survey is not None and survey.phase not in STAGES:
                self._report(f"survey {survey.id}: {survey.phase}, {survey.reason}; operator stops")
                return
            if survey is not None and survey.phase == "done":
                self._report(f"survey {survey.id}: done, {survey.reason}")
            view = await self._view(survey)
            for action in self._operator.decide(view, clock.time()):
                refusal = await self._carry_out(action)
                if refusal is not None:
                    self._report(f"refused by rule {refusal.rule}: {refusal.reason}")
                if refusal is not None and (survey is None or survey.phase != "running"):
                    return
            await asyncio.sleep(LOOK_EVERY_S)

    async def _survey(self) -> SurveyStatus | None:
        if self._survey_id is None:
            return None
        for survey in await self._station.surveys.list():
            if survey.id == self._survey_id:
                return survey
        raise ClientError(f"survey {self._survey_id} is missing from the station's list")

    async def _view(self, survey: SurveyStatus | None) -> FieldView:
        serials = self._scenario.fleet.serials
        is_grounded = survey is None or survey.phase == "done"
        ready = await self._passed_checklists() if is_grounded else frozenset(serials)
        called_home = {v.serial for v in survey.vehicles if v.has_come_home} if survey else set()
        drones = [v for v in self._station.vehicles() if v.serial in serials]
        return FieldView(
            [_drone(each, each.serial in ready, each.serial in called_home) for each in drones],
            None if survey is None else STAGES[survey.phase],
        )

    async def _passed_checklists(self) -> frozenset[str]:
        passed = set()
        for serial in self._scenario.fleet.serials:
            checklist = await self._station.known(serial).preflight()
            if checklist.is_passed:
                passed.add(serial)
            elif self._survey_id is None:
                unmet = "; ".join(f"{point.name} {point.text}" for point in checklist.unmet)
                self._report(f"{serial}: preflight checklist incomplete: {unmet}")
        return frozenset(passed)

    async def _carry_out(self, action: OperatorAction) -> Refusal | None:
        surveys = self._station.surveys
        match action:
            case RequestPlan():
                answer = await surveys.create(**survey_request(self._scenario))
                if isinstance(answer, SurveyStatus):
                    self._survey_id = answer.id
            case StartDrones(serials):
                answer = await surveys.start(self._planned_id, serials, takeoff=True)
                if isinstance(answer, SurveyStatus):
                    self._report(f"survey {answer.id}: flown by {', '.join(serials)}")
            case AbortSurvey():
                answer = await surveys.abort(self._planned_id)
            case CallHome(serial):
                ordered = await self._station.known(serial).return_home()
                return ordered if isinstance(ordered, Refusal) else None
            case TakeAuthority(serial):
                return await self._station.known(serial).take()
        return answer if isinstance(answer, Refusal) else None

    @property
    def _planned_id(self) -> int:
        assert self._survey_id is not None  # only a planned survey is started or aborted
        return self._survey_id

    def _report(self, line: str) -> None:
        """Report what has changed."""
        if line != self._last_line:
            self._last_line = line
            self._report_line(line)


def _drone(vehicle: Telemetry, is_ready: bool, is_called_home: bool) -> DroneView:
    """`is_stopped` and `has_battery_alarm` stay False: the person at the console sees to these."""
    return DroneView(
        vehicle.serial or "",
        is_ready=is_ready and vehicle.is_live,
        is_live=vehicle.is_live,
        is_flying=vehicle.is_flying.value,
        battery_fraction=vehicle.battery_fraction.value,
        is_called_home=is_called_home,
    )


def survey_request(scenario: Scenario) -> dict[str, Any]:
    """Return the fields of the API's `SurveyRequest` for the scenario's task."""
    survey = scenario.survey
    rings = (survey.region.outline_m, *survey.region.holes_m)
    return {
        "name": scenario.name,
        "polygon": [_ring(scenario, ring.tolist()) for ring in rings],
        "height_above_takeoff_m": survey.height_above_takeoff_m,
        "speed_mps": survey.speed_mps,
        "front_overlap": survey.front_overlap,
        "side_overlap": survey.side_overlap,
        "planner": survey.planner,
        "camera": {"interval_s": survey.camera.interval_s},
        "budget": {"rounds": survey.budget.rounds},
    }


def _ring(scenario: Scenario, corners_m: list[list[float]]) -> list[list[float]]:
    places = [
        point_from_enu(scenario.frame, (east_m, north_m, 0.0))
        for east_m, north_m in (*corners_m, corners_m[0])
    ]
    return [[place.longitude_deg, place.latitude_deg] for place in places]
