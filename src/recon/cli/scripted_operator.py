"""The people of a demonstration: what they would say to the station, said over its API.

They plan a survey, let the drones fly it, send those with fresh batteries off again, and begin anew
when it is done. As soon as somebody else pauses or aborts it, they say nothing any more.
"""

import asyncio
from collections.abc import Callable, Sequence
from typing import Any

from recon.client import ClientError, Refusal, Station, Survey, Telemetry
from recon.geo import point_from_enu
from recon.score import Scenario
from recon.sim.fleet import IMAGER_SERIAL

LOOK_EVERY_S = 1.0
LIVE_WITHIN_S = 60.0
REST_S = 20.0
"""Between two surveys: time to look at the first one's end."""
FRESH_FRACTION = 0.9

Say = Callable[[str], None]


async def fly_surveys(url: str, scenario: Scenario, say: Say) -> None:
    """Fly one survey after the other until somebody stops one, or the station refuses.

    Raises `ClientError` when the station cannot be reached.
    """
    serials = scenario.fleet.serials
    async with Station(url) as station:
        for serial in (IMAGER_SERIAL, *serials):
            await station.vehicle(serial, LIVE_WITHIN_S)
        while True:
            survey = await _begun(station, scenario, serials, say)
            if isinstance(survey, Refusal):
                say(f"no survey: refused by the rule {survey.rule}: {survey.reason}")
                return
            say(f"survey {survey.id} is flown by {', '.join(serials)}")
            ended = await _seen_to_its_end(station, survey.id)
            if ended.phase != "done":
                say(f"survey {ended.id} is {ended.phase}: nothing more is flown by itself")
                return
            say(f"survey {ended.id} is done: {ended.reason}")
            await _until(lambda: all(is_fresh(v) for v in _crew(station, serials)))
            await asyncio.sleep(REST_S)


async def _begun(
    station: Station, scenario: Scenario, serials: Sequence[str], say: Say
) -> Survey | Refusal:
    await _until_ready(station, serials, say)
    asked = await station.surveys.create(**survey_request(scenario))
    if isinstance(asked, Refusal):
        return asked
    while True:
        survey = await _survey(station, asked.id)
        if survey.phase == "refused":
            return Refusal("survey", survey.reason)
        if survey.phase != "planning":
            return await station.surveys.start(asked.id, serials, takeoff=True)
        await asyncio.sleep(LOOK_EVERY_S)


async def _seen_to_its_end(station: Station, survey_id: int) -> Survey:
    """Follow a survey; who stands with a fresh battery is sent off again."""
    while True:
        survey = await _survey(station, survey_id)
        if survey.phase != "running":
            return survey
        at_home = [v.serial for v in survey.vehicles if v.has_come_home]
        for vehicle in filter(is_fresh, _crew(station, at_home)):
            if vehicle.serial is not None:
                await station.surveys.start(survey_id, [vehicle.serial], takeoff=True)
        await asyncio.sleep(LOOK_EVERY_S)


def is_fresh(vehicle: Telemetry) -> bool:
    """Whether a vehicle stands, its battery nearly full."""
    share = vehicle.battery_fraction.value
    is_down = vehicle.is_live and vehicle.is_flying.value is False
    return is_down and share is not None and share >= FRESH_FRACTION


def survey_request(scenario: Scenario) -> dict[str, Any]:
    """Return what the API is asked for: the scenario's task, as a polygon on the globe."""
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


async def _survey(station: Station, survey_id: int) -> Survey:
    for survey in await station.surveys.list():
        if survey.id == survey_id:
            return survey
    raise ClientError(f"expected the station to remember survey {survey_id}, it does not")


async def _until_ready(station: Station, serials: Sequence[str], say: Say) -> None:
    """Wait until the checklists of all are passed; what each waits for is said when it changes."""
    said = ""
    for serial in serials:
        while not (checked := await station.known(serial).preflight()).is_passed:
            unmet = "; ".join(f"{point.name} {point.text}" for point in checked.unmet)
            if unmet != said:
                say(f"{serial} waits for its checklist: {unmet}")
            said = unmet
            await asyncio.sleep(LOOK_EVERY_S)


async def _until(is_so: Callable[[], bool]) -> None:
    while not is_so():
        await asyncio.sleep(LOOK_EVERY_S)


def _crew(station: Station, serials: Sequence[str]) -> list[Telemetry]:
    return [vehicle for vehicle in station.vehicles() if vehicle.serial in serials]
