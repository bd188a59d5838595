"""Reading a scenario file; the whole file is checked first."""

import re
import tomllib
from collections.abc import Iterator
from math import isnan
from pathlib import Path

import msgspec
import numpy as np

from recon.geo import sun_position
from recon.guidance.survey import SurveyPlan, plan_survey
from recon.model.airspace import Region
from recon.model.geo import GeoPoint, LatLon
from recon.model.survey import Survey, SurveyBudget, SurveyCamera
from recon.score.scenario import Methods, Scenario
from recon.score.scenario_conditions import ranges_of, with_exposure
from recon.score.scenario_schema import (
    ScenarioError,
    ScenarioErrors,
    ScenarioFile,
    TaskTable,
    key_lines,
)
from recon.score.scenario_sky import clouds_of
from recon.score.staging import site_folder, staged
from recon.sim.app.fault_file import FaultScript, load_faults
from recon.sim.app.faults import InjectedFault, RandomFault, parse_fault
from recon.sim.world import SunSettings, WindSettings
from recon.site.reading import validation_error

LARGEST_BYTES = 1_000_000
LOWEST_SUN_DEG = 5.0
"""Lowest sun: below it there is no shade to distinguish from sun."""
AT_LINE = re.compile(r"at line (\d+)")


def load_scenario(path: Path) -> Scenario:
    """Return the scenario of a TOML file.

    Raises `ScenarioError` with file, line, expected and actual value.
    """
    text = _text(path)
    try:
        data = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as problem:
        line = AT_LINE.search(str(problem))
        where = f"{path}:{line[1]}" if line else f"{path}"
        raise ScenarioError(f"{where}: expected a TOML file, got: {problem}") from problem
    errors = ScenarioErrors(path, key_lines(text))
    for key in _nans(data, ""):
        raise errors.error(f"{key}: expected a number, got nan")
    try:
        file = msgspec.convert(data, ScenarioFile, strict=True)
    except msgspec.ValidationError as problem:
        raise errors.error(validation_error(problem, data, ScenarioFile, "")) from problem
    return _scenario(path, file, errors)


def _files(path: Path, file: ScenarioFile) -> tuple[Path, ...]:
    """Return what a scenario is read from besides its own file."""
    folder, faults = file.site.folder, file.fault_file
    site = () if folder is None else (site_folder(path, folder),)
    return site if faults is None else (*site, path.parent / faults)


def _nans(value: object, key: str) -> Iterator[str]:
    """Yield the keys of NaN values: range checks let them pass."""
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
        raise ScenarioError(f"{path}: cannot read scenario file: {why}") from problem
    except UnicodeDecodeError as problem:
        line = data[: problem.start].count(b"\n") + 1
        raise ScenarioError(f"{path}:{line}: expected UTF-8 text, got other bytes") from problem
    if len(data) > LARGEST_BYTES:
        raise ScenarioError(f"{path}: expected at most {LARGEST_BYTES} bytes, got more")
    return text


def _scenario(path: Path, file: ScenarioFile, errors: ScenarioErrors) -> Scenario:
    survey = _survey(path.stem, file.task, file.methods.planner)
    methods = Methods(file.methods.detection, file.methods.forecast)
    if methods.conflict is not None:
        raise errors.error(methods.conflict, "methods")
    place = staged(path, file, survey, errors)
    script = _script(path, file, errors)
    sun = _sun(file, place.frame.origin, errors)
    scenario = Scenario(
        name=path.stem,
        about=file.about,
        site=place.site,
        fleet=place.fleet,
        imager=place.imager,
        sun=sun,
        clouds=clouds_of(file.clouds, errors),
        wind=_wind(file, errors),
        conditions=ranges_of(file.conditions, sun, errors),
        faults=(*_faults(file, errors), *script.faults),
        chances=script.chances,
        survey=survey,
        methods=methods,
        limit_s=60.0 * file.task.limit_min,
        files=_files(path, file),
    )
    plan = plan_survey(survey, scenario.frame)
    if not isinstance(plan, SurveyPlan):
        raise errors.error(f"expected a survey that can be flown, got: {plan.reason}", "task")
    _check_faults(scenario, errors)
    return with_exposure(scenario, scenario.conditions.exposure_locked)


def _faults(file: ScenarioFile, errors: ScenarioErrors) -> tuple[InjectedFault, ...]:
    return tuple(
        errors.made(f"faults[{i}]", lambda text=text: parse_fault(text))  # type: ignore[misc]
        for i, text in enumerate(file.faults)
    )


def _script(path: Path, file: ScenarioFile, errors: ScenarioErrors) -> FaultScript:
    """Return the faults of the separate fault file, if there is one."""
    name = file.fault_file
    if name is None:
        return FaultScript()
    return errors.made("fault_file", lambda: load_faults(path.parent / name))


def _wind(file: ScenarioFile, errors: ScenarioErrors) -> WindSettings:
    wind = file.wind
    return errors.made(
        "wind",
        lambda: WindSettings(
            speed_10m_mps=wind.speed_10m_mps,
            heading_deg=wind.heading_deg,
            gust_intensity=wind.gust_intensity,
        ),
    )


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
        side_step_allowed=task.side_step,
        upwind_allowed=task.upwind,
    )


def _sun(file: ScenarioFile, origin: GeoPoint, errors: ScenarioErrors) -> SunSettings:
    place = LatLon(origin.latitude_deg, origin.longitude_deg)
    sun = errors.made("site", lambda: SunSettings(place, file.start_utc.timestamp()))
    elevation_deg = sun_position(place, sun.start_utc_s).elevation_deg
    if elevation_deg < LOWEST_SUN_DEG and "sun_elevation_deg" not in file.conditions:
        raise errors.error(
            f"start_utc: expected a time at which the sun is {LOWEST_SUN_DEG:g} degrees high or "
            f"more, got one at which it is at {elevation_deg:.0f} degrees"
        )
    return sun


def _check_faults(scenario: Scenario, errors: ScenarioErrors) -> None:
    serials = scenario.fleet.serials
    all_faults: list[InjectedFault | RandomFault] = [*scenario.faults, *scenario.chances]
    for index, fault in enumerate(all_faults):
        if any(fault.is_for(serial, 0) for serial in scenario.site.imagers):
            continue
        if not any(fault.is_for(serial, i + 1) for i, serial in enumerate(serials)):
            known = ", ".join((*serials, *scenario.site.imagers))
            text = f"expected a vehicle of {known}, its number or *, got {fault.vehicle!a}"
            if fault.source:
                raise errors.error(f"{fault.source}{text}", "fault_file")
            raise errors.error(text, f"faults[{index}]")
