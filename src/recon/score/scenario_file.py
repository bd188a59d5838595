"""Reading a scenario: the whole file is checked before anything is made of it."""

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from math import isnan
from pathlib import Path
from typing import TypeVar

import msgspec
import numpy as np

from recon.guidance.survey import SurveyPlan, plan_survey
from recon.model.geo import GeoPoint, LatLon, LocalFrame
from recon.model.survey import Survey, SurveyBudget, SurveyCamera
from recon.model.zone import Region
from recon.score.errors import ScenarioError
from recon.score.scenario import Fleet, Methods, Scenario, ScenarioEye
from recon.score.scenario_schema import CloudsTable, ScenarioFile, TaskTable
from recon.score.toml_lines import key_lines, line_of
from recon.sim.errors import SimulationError
from recon.sim.faults import parse_fault
from recon.sim.world import (
    LayerSettings,
    LightSettings,
    SkySettings,
    SunSettings,
    WindSettings,
    WindShift,
)
from recon.site.complaints import complaint

Made = TypeVar("Made")

LARGEST_BYTES = 1_000_000
PADS_APART_M = 20.0
PADS_OFF_M = 30.0
"""South of the region."""
PLACE = re.compile(r"((?:\w+(?:\[\d+\])*\.?)+): expected")
AT_LINE = re.compile(r"at line (\d+)")
UNKNOWN = re.compile(r"expected only the keys .*, got '(\w+)'")


def load_scenario(path: Path) -> Scenario:
    """Return the scenario of a TOML file.

    Raises `ScenarioError` with file, line, what was expected and what came.
    """
    text = _text(path)
    try:
        data = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as problem:
        line = AT_LINE.search(str(problem))
        where = f"{path}:{line[1]}" if line else f"{path}"
        raise ScenarioError(f"{where}: expected a TOML file, got: {problem}") from problem
    complain = _Complaints(path, key_lines(text))
    for key in _nans(data, ""):
        raise complain.about(f"{key}: expected a number, got nan")
    try:
        file = msgspec.convert(data, ScenarioFile, strict=True)
    except msgspec.ValidationError as problem:
        raise complain.about(complaint(problem, data, ScenarioFile, "")) from problem
    return _scenario(path.stem, file, complain)


class _Complaints:
    """Makes errors that name the file and the line of a key."""

    def __init__(self, path: Path, lines: Mapping[str, int]) -> None:
        self._path, self._lines = path, lines

    def about(self, said: str, within: str = "") -> ScenarioError:
        """Return the error; what is said begins with a key, inside `within` if that is given."""
        place = PLACE.match(said)
        key = place[1] if place else ""
        unknown = UNKNOWN.search(said)
        path = ".".join(part for part in (within, key, unknown[1] if unknown else "") if part)
        line = line_of(self._lines, path)
        where = f"{self._path}:{line}" if line is not None else f"{self._path}"
        lead = within + ("." if place else ": ") if within else ""
        return ScenarioError(f"{where}: {lead}{said}")

    def made(self, within: str, make: Callable[[], Made]) -> Made:
        """Return what is made of a table, its complaint in the file's words."""
        try:
            return make()
        except SimulationError as problem:
            said = str(problem).removeprefix("wind: ").removeprefix("wind shift: ")
            raise self.about(said, within) from problem


def _nans(value: object, key: str) -> Iterator[str]:
    """Yield the keys of what is no number: ranges let it pass."""
    if isinstance(value, float) and isnan(value):
        yield key
    elif isinstance(value, dict):
        for name, item in value.items():
            yield from _nans(item, f"{key}.{name}" if key else name)
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _nans(item, f"{key}[{index}]")


def _text(path: Path) -> str:
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST_BYTES + 1)
        text = data.decode("utf-8")
    except OSError as problem:
        why = problem.strerror or str(problem)
        raise ScenarioError(f"{path}: expected a scenario's file, got: {why}") from problem
    except UnicodeDecodeError as problem:
        line = data[: problem.start].count(b"\n") + 1
        raise ScenarioError(f"{path}:{line}: expected UTF-8 text, got other bytes") from problem
    if len(data) > LARGEST_BYTES:
        raise ScenarioError(f"{path}: expected at most {LARGEST_BYTES} bytes, got more")
    return text


def _scenario(name: str, file: ScenarioFile, complain: _Complaints) -> Scenario:
    site = file.site
    origin = GeoPoint(site.latitude_deg, site.longitude_deg, site.ground_altitude_m)
    survey = _survey(name, file.task, file.methods.planner)
    scenario = Scenario(
        name=name,
        about=file.about,
        frame=LocalFrame(origin),
        fleet=_fleet(file, survey.region, complain),
        eye=_eye(file, survey.region),
        sky=_sky(file, origin, complain),
        light=LightSettings(altitude_m=site.ground_altitude_m),
        wind=complain.made(
            "wind",
            lambda: WindSettings(
                speed_10m_mps=file.wind.speed_10m_mps,
                heading_deg=file.wind.heading_deg,
                gust_intensity=file.wind.gust_intensity,
            ),
        ),
        faults=tuple(
            complain.made(f"faults[{i}]", lambda text=text: parse_fault(text))  # type: ignore[misc]
            for i, text in enumerate(file.faults)
        ),
        survey=survey,
        methods=Methods(file.methods.detection, file.methods.forecast),
        limit_s=60.0 * file.task.limit_min,
    )
    plan = plan_survey(survey, scenario.frame)
    if not isinstance(plan, SurveyPlan):
        raise complain.about(f"expected a survey that can be flown, got: {plan.reason}", "task")
    _check_faulty(scenario, complain)
    return scenario


def _survey(name: str, task: TaskTable, planner: str) -> Survey:
    rings = [np.array(ring, dtype=np.float64) for ring in (task.region_m, *task.holes_m)]
    return Survey(
        id=1,
        name=name,
        region=Region(rings[0], tuple(rings[1:])),
        height_above_takeoff_m=task.height_m,
        speed_mps=task.speed_mps,
        camera=SurveyCamera(interval_s=task.photo_interval_s),
        front_overlap=task.front_overlap,
        side_overlap=task.side_overlap,
        planner=planner,
        budget=SurveyBudget(rounds=task.rounds, time_s=60.0 * task.limit_min),
    )


def _fleet(file: ScenarioFile, region: Region, complain: _Complaints) -> Fleet:
    fleet = file.fleet
    if fleet.pads_m is None:
        middle_m = float(region.outline_m[:, 0].mean())
        south_m = float(region.outline_m[:, 1].min()) - PADS_OFF_M
        first_m = middle_m - PADS_APART_M * (fleet.survey_drones - 1) / 2.0
        pads = [(first_m + PADS_APART_M * i, south_m) for i in range(fleet.survey_drones)]
    else:
        pads = [(pad[0], pad[1]) for pad in fleet.pads_m]
    if len(pads) != fleet.survey_drones:
        said = f"pads_m: expected {fleet.survey_drones} places, one a drone, got {len(pads)}"
        raise complain.about(said, "fleet")
    return Fleet(
        tuple(pads), 60.0 * fleet.endurance_min, fleet.reserve_share, 60.0 * fleet.swap_min
    )


def _eye(file: ScenarioFile, region: Region) -> ScenarioEye:
    eye = file.eye
    least, most = region.outline_m.min(axis=0), region.outline_m.max(axis=0)
    middle = ((least + most) / 2.0).tolist() if eye.over_m is None else eye.over_m
    return ScenarioEye(
        (middle[0], middle[1]), eye.height_m, eye.radius_m, float(eye.period_s), eye.cell_m
    )


def _sky(file: ScenarioFile, origin: GeoPoint, complain: _Complaints) -> SkySettings:
    place = LatLon(origin.latitude_deg, origin.longitude_deg)
    sun = SunSettings(place, file.start_utc.timestamp())
    layers = tuple(_layer(i, clouds, complain) for i, clouds in enumerate(file.clouds))
    return complain.made("clouds", lambda: SkySettings(sun=sun, layers=layers))


def _layer(number: int, clouds: CloudsTable, complain: _Complaints) -> LayerSettings:
    within = f"clouds[{number}]"
    values = {name: getattr(clouds, name) for name in clouds.__struct_fields__ if name != "shifts"}

    def shift(index: int) -> WindShift:
        given = clouds.shifts[index]
        return WindShift(given.start_s, given.duration_s, given.speed_mps, given.heading_deg)

    shifts = tuple(
        complain.made(f"{within}.shifts[{i}]", lambda i=i: shift(i))  # type: ignore[misc]
        for i in range(len(clouds.shifts))
    )
    return complain.made(within, lambda: LayerSettings(**values, shifts=shifts))


def _check_faulty(scenario: Scenario, complain: _Complaints) -> None:
    serials = scenario.fleet.serials
    for index, fault in enumerate(scenario.faults):
        if not any(fault.is_for(serial, i + 1) for i, serial in enumerate(serials)):
            known = ", ".join(serials)
            said = f"expected a vehicle of {known}, its number or *, got {fault.vehicle!a}"
            raise complain.about(said, f"faults[{index}]")
