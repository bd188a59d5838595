"""The conditions of a scenario's flights: ranges from its file, drawn by the seed."""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from recon.geo import utc_at_elevation
from recon.model.geo import LatLon
from recon.score.scenario import Scenario
from recon.score.scenario_schema import RANGE, ScenarioErrors
from recon.sim.conditions import ConditionRanges, Conditions, Range, draw_conditions
from recon.sim.world import SunSettings
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
        if name in SWITCHES and not isinstance(value, bool):
            wanted = f"expected true or false, got {shown_value(value)}"
            raise errors.error(f"{name}: {wanted}", "conditions")
        given[name] = value if name in SWITCHES else range_of(name, value, "conditions", errors)
    ranges = errors.made("conditions", lambda: ConditionRanges(**given))
    if ranges.sun_elevation_deg is not None:
        try:
            utc_s_at_elevation(sun, ranges.sun_elevation_deg.high, is_morning=True)
        except ValueError as problem:
            raise errors.error(f"sun_elevation_deg: {problem}", "conditions") from problem
    return ranges


def range_of(name: str, value: Any, within: str, errors: ScenarioErrors) -> Range:
    """Return the range of a number or of two. Raises `ScenarioError`."""
    ends = value if isinstance(value, list) else [value, value]
    if len(ends) != 2 or not all(type(end) in (int, float) for end in ends):
        raise errors.error(f"{name}: expected {RANGE}, got {shown_value(value)}", within)
    return errors.made(f"{within}.{name}", lambda: Range(*map(float, ends)))


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


def utc_s_at_elevation(sun: SunSettings, elevation_deg: float, *, is_morning: bool) -> float:
    """Return when the sun has an elevation on its day. Raises `ValueError` if it never has."""
    place = LatLon(sun.place.latitude_deg, sun.place.longitude_deg)
    return utc_at_elevation(place, sun.start_utc_s, elevation_deg, is_rising=is_morning)
