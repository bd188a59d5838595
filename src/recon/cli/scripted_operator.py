"""The scripted operator over HTTP: flies a demonstration's surveys as a client of the API.

A person at the console has priority: as soon as a survey is paused or aborted, the operator stops.
It does not restart drones that were stopped one by one either, nor acts on alarms.
"""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from recon.client import ClientError, Refusal, Station, SurveyStatus, Telemetry
from recon.geo import point_from_enu
from recon.score import Scenario
from recon.score.scripted_operator import (
    AbortSurvey,
    CallFleetHome,
    CallHome,
    DismissHazard,
    DroneView,
    FieldView,
    OperatorAction,
    RequestPlan,
    ScriptedOperator,
    StartDrones,
    SurveyStage,
    TakeAuthority,
)

LOOK_EVERY_S = 1.0
LIVE_WITHIN_S = 60.0
TRY_AGAIN_S = 5.0
"""Pause after a station did not answer in time: on a busy computer it soon does again."""
STAGES = {
    "planning": SurveyStage.PLANNING,
    "created": SurveyStage.PLANNED,
    "running": SurveyStage.FLYING,
    "done": SurveyStage.FINISHED,
}
"""Phases in which the operator continues; in any other it stops."""

Report = Callable[[str], None]


async def fly_surveys(url: str, scenario: Scenario, report: Report) -> None:
    """Fly one survey after the other until someone stops one, or the station refuses one.

    A station that does not answer is asked again, and the running survey continues.
    """
    report_new, survey = _Report(report), _PlannedSurvey(scenario.name)
    while True:
        try:
            async with Station(url) as station:
                for serial in (*scenario.site.imagers, *scenario.fleet.serials):
                    await station.vehicle(serial, LIVE_WITHIN_S)
                return await _HttpOperator(station, scenario, survey, report_new).run()
        except ClientError as problem:
            # While the station shuts down, this task is cancelled here and reports nothing.
            await asyncio.sleep(TRY_AGAIN_S)
            report_new(f"scripted operator tries again: {problem}")


class _Report:
    """Reports what has changed."""

    def __init__(self, report: Report) -> None:
        self._report = report
        self._last_line = ""

    def __call__(self, line: str) -> None:
        if line != self._last_line:
            self._last_line = line
            self._report(line)


@dataclass(slots=True)
class _PlannedSurvey:
    """The survey that the operator has asked for; `id` is None before the station's answer.

    A request without an answer may have been carried out: then the newest survey of the name is it.
    """

    name: str
    id: int | None = None
    is_asked: bool = False


class _HttpOperator:
    """One connection to the station, and the operator that decides."""

    def __init__(
        self, station: Station, scenario: Scenario, planned: _PlannedSurvey, report: Report
    ) -> None:
        self._station, self._scenario, self._report = station, scenario, report
        fleet = scenario.fleet
        self._operator = ScriptedOperator(fleet.serials, fleet.kept_share, repeats=True)
        self._planned = planned

    async def run(self) -> None:
        """Look and act once a second."""
        clock = asyncio.get_running_loop()
        while True:
            survey = await self._survey()
            if survey is not None and survey.phase not in STAGES:
                self._report(f"survey {survey.id}: {survey.phase}, {survey.reason}; operator stops")
                return
            if survey is not None and survey.phase == "done":
                self._report(
                    f"survey {survey.id}: done, {survey.reason}; "
                    "another one begins when all batteries are good"
                )
            view = await self._view(survey)
            for action in self._operator.decide(view, clock.time()):
                refusal = await self._carry_out(action)
                if refusal is not None:
                    self._report(f"refused by rule {refusal.rule}: {refusal.reason}")
                if refusal is not None and (survey is None or survey.phase != "running"):
                    return
            await asyncio.sleep(LOOK_EVERY_S)

    async def _survey(self) -> SurveyStatus | None:
        planned = self._planned
        if not planned.is_asked:
            return None
        for survey in await self._station.surveys.list():
            if survey.id == planned.id or (planned.id is None and survey.name == planned.name):
                planned.id = survey.id
                return survey
        planned.id, planned.is_asked = None, False
        return None

    async def _view(self, survey: SurveyStatus | None) -> FieldView:
        serials = self._scenario.fleet.serials
        is_grounded = survey is None or survey.phase == "done"
        ready = await self._passed_checklists() if is_grounded else frozenset(serials)
        recalled = {v.serial for v in survey.vehicles if v.has_come_home} if survey else set()
        drones = [v for v in self._station.vehicles() if v.serial in serials]
        return FieldView(
            [_drone(each, each.serial in ready, each.serial in recalled) for each in drones],
            None if survey is None else STAGES[survey.phase],
        )

    async def _passed_checklists(self) -> frozenset[str]:
        passed = set()
        for serial in self._scenario.fleet.serials:
            checklist = await self._station.known(serial).preflight()
            if checklist.is_passed:
                passed.add(serial)
            elif self._planned.id is None:
                unmet = "; ".join(f"{point.name} {point.text}" for point in checklist.unmet)
                self._report(f"{serial}: preflight checklist incomplete: {unmet}")
        return frozenset(passed)

    async def _carry_out(self, action: OperatorAction) -> Refusal | None:
        surveys = self._station.surveys
        match action:
            case RequestPlan():
                self._planned.id, self._planned.is_asked = None, True
                answer = await surveys.create(**survey_request(self._scenario))
                if isinstance(answer, SurveyStatus):
                    self._planned.id = answer.id
            case StartDrones(serials):
                answer = await surveys.start(self._planned_id, serials, takeoff=True)
                if isinstance(answer, SurveyStatus):
                    self._report(f"survey {answer.id}: flown by {', '.join(serials)}")
            case AbortSurvey():
                answer = await surveys.abort(self._planned_id)
            case CallHome(serial):
                ordered = await self._station.known(serial).return_home()
                return ordered if isinstance(ordered, Refusal) else None
            case CallFleetHome(serials):
                await self._station.fleet.return_in_layers(serials)
                return None
            case DismissHazard():
                return None  # the person at the console sees to it
            case TakeAuthority(serial):
                return await self._station.known(serial).take()
        return answer if isinstance(answer, Refusal) else None

    @property
    def _planned_id(self) -> int:
        assert self._planned.id is not None  # only a planned survey is started or aborted
        return self._planned.id


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
        "side_step_allowed": survey.side_step_allowed,
        "upwind_allowed": survey.upwind_allowed,
    }


def _ring(scenario: Scenario, corners_m: list[list[float]]) -> list[list[float]]:
    places = [
        point_from_enu(scenario.frame, (east_m, north_m, 0.0))
        for east_m, north_m in (*corners_m, corners_m[0])
    ]
    return [[place.longitude_deg, place.latitude_deg] for place in places]
