"""The conditions of a scenario's flights: ranges from its file, drawn by the seed."""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

import numpy as np

from recon.geo import utc_at_elevation
from recon.model.geo import LatLon
from recon.score.scenario import Scenario
from recon.score.scenario_schema import ScenarioErrors
from recon.sim.conditions import ConditionRanges, Conditions, Range, draw_conditions
from recon.sim.errors import SimulationError
from recon.sim.world import Sky, SunSettings
from recon.site.reading import shown_value

SWITCHES = ("exposure_locked", "starts_in_shade")
NAMES = tuple(field.name for field in fields(ConditionRanges))


def ranges_of(
    table: Mapping[str, object], sun: SunSettings, errors: ScenarioErrors
) -> ConditionRanges:
    """Return the ranges of a file's [conditions]: those that it states, else the default ones.

    Raises `ScenarioError`.
    """
    given: dict[str, Any] = {}
    for name, value in table.items():
        if name not in NAMES:
            text = f"expected only the keys {', '.join(NAMES)}, got {name!a}"
            raise errors.error(text, "conditions")
        read = _switch(value) if name in SWITCHES else _range(value)
        if read is None:
            wanted = "true or false" if name in SWITCHES else "a number or [lowest, highest]"
            raise errors.error(f"{name}: expected {wanted}, got {shown_value(value)}", "conditions")
        given[name] = read
    ranges = errors.made("conditions", lambda: ConditionRanges(**given))
    if ranges.sun_elevation_deg is not None:
        try:
            _start_utc_s(sun, ranges.sun_elevation_deg.high, is_morning=True)
        except ValueError as problem:
            raise errors.error(f"sun_elevation_deg: {problem}", "conditions") from problem
    return ranges


def _switch(value: object) -> bool | None:
    return value if isinstance(value, bool) else None


def _range(value: Any) -> Range | None:
    """Return the range of a number or of two; None for anything else."""
    ends = value if isinstance(value, list) else [value, value]
    if len(ends) != 2 or not all(type(end) in (int, float) for end in ends):
        return None
    return Range(float(ends[0]), float(ends[1]))


def with_exposure(scenario: Scenario, is_locked: bool) -> Scenario:
    """Return the scenario with exposure automatic or locked, and the station informed of it."""
    imager = scenario.site.imager
    assert imager is not None  # or it would not have been read
    site = scenario.site.with_imager(replace(imager, exposure_locked=is_locked))
    conditions = replace(scenario.conditions, exposure_locked=is_locked)
    return replace(scenario, site=site, conditions=conditions)


def conditions_of(scenario: Scenario, seed: int) -> Conditions:
    """Return the conditions of a seed's flight."""
    return draw_conditions(scenario.conditions, seed, scenario.frame.origin.ellipsoid_height_m)


LOW_SUN_DEG = 40.0
"""A lower sun rises, so that no survey ends at dusk."""


def sky_of(scenario: Scenario, seed: int) -> Sky:
    """Return the sky of a seed's flight."""
    conditions, sun = conditions_of(scenario, seed), scenario.sky.sun
    if conditions.sun_elevation_deg is not None:
        is_morning = conditions.is_morning or conditions.sun_elevation_deg < LOW_SUN_DEG
        start_utc_s = _start_utc_s(sun, conditions.sun_elevation_deg, is_morning=is_morning)
        sun = replace(sun, start_utc_s=start_utc_s)
    sky = Sky(replace(scenario.sky, seed=seed, sun=sun))
    return _from_shade(sky, scenario) if scenario.conditions.starts_in_shade else sky


def _start_utc_s(sun: SunSettings, elevation_deg: float, *, is_morning: bool) -> float:
    place = LatLon(sun.place.latitude_deg, sun.place.longitude_deg)
    return utc_at_elevation(place, sun.start_utc_s, elevation_deg, is_rising=is_morning)


SEARCH_STEP_S, SEARCHED_S = 30.0, 36_000.0
POINTS_ACROSS = 9
SHADED_BELOW = 0.5
"""Transmittance of shade, as in the score."""


def _from_shade(sky: Sky, scenario: Scenario) -> Sky:
    """Return the sky with its clouds of the first moment at which they shade the whole view.

    Raises `SimulationError` when no such moment comes within hours.
    """
    imager = scenario.imager
    steps_m = np.linspace(-imager.radius_m, imager.radius_m, POINTS_ACROSS)
    east_m, north_m = (part.ravel() for part in np.meshgrid(steps_m, steps_m))
    is_seen = np.hypot(east_m, north_m) <= imager.radius_m
    east_m, north_m = east_m[is_seen] + imager.over_m[0], north_m[is_seen] + imager.over_m[1]
    for ahead_s in np.arange(0.0, SEARCHED_S, SEARCH_STEP_S).tolist():
        later = Sky(replace(sky.settings, clouds_ahead_s=ahead_s))
        if float(later.transmittance(east_m, north_m, 0.0).max()) < SHADED_BELOW:
            return later
    raise SimulationError(
        f"{scenario.name}: expected clouds that shade the whole view, got none in"
        f" {SEARCHED_S / 3600.0:g} h; use more cover"
    )
