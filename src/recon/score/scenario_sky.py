"""The sky of a scenario: clouds from its file, their velocity and the sun drawn by the seed.

Heading and speed differ between flights: guidance and placement could learn a wind that is the same
for all. A layer above another veers from that one, and a shift of the wind turns the clouds from
where they went before, whatever was drawn.
"""

from dataclasses import replace

import numpy as np

from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.score.scenario import CloudRanges, Scenario
from recon.score.scenario_conditions import conditions_of, range_of, utc_s_at_elevation
from recon.score.scenario_schema import CloudsTable, ScenarioErrors, ShiftTable
from recon.sim.conditions import Range
from recon.sim.errors import SimulationError
from recon.sim.world import LayerSettings, Sky, SkySettings, WindShift
from recon.sim.world.settings import BETWEEN_LAYERS_DEG, LOW_SPEED_MPS

ALL_AROUND_DEG = (0.0, 360.0)


def clouds_of(tables: list[CloudsTable], errors: ScenarioErrors) -> tuple[CloudRanges, ...]:
    """Return the layers of a file, the lower first. Raises `ScenarioError`."""
    return tuple(_ranges(number, table, errors) for number, table in enumerate(tables))


def drawn_layers(clouds: tuple[CloudRanges, ...], seed: int) -> tuple[LayerSettings, ...]:
    """Return the layers of a seed's sky."""
    layers: list[LayerSettings] = []
    heading_deg = 0.0
    for number, ranges in enumerate(clouds):
        heading_deg += ranges.turn_deg.drawn(seed, f"clouds[{number}].heading_deg")
        speed_mps = ranges.speed_mps.drawn(seed, f"clouds[{number}].speed_mps")
        layers.append(_moving(ranges.layer, speed_mps, heading_deg))
    return tuple(layers)


def _moving(layer: LayerSettings, speed_mps: float, heading_deg: float) -> LayerSettings:
    shifts = tuple(
        replace(shift, heading_deg=(shift.heading_deg + heading_deg) % 360.0)
        for shift in layer.shifts
    )
    return replace(layer, speed_mps=speed_mps, heading_deg=heading_deg % 360.0, shifts=shifts)


def _ranges(number: int, table: CloudsTable, errors: ScenarioErrors) -> CloudRanges:
    within = f"clouds[{number}]"
    key, other = ("heading_deg", "veer_deg") if number == 0 else ("veer_deg", "heading_deg")
    if getattr(table, other) is not None:
        raise errors.error(f"{other}: expected {key} in this layer, got {other}", within)

    def drawn_from(key: str, usual: tuple[float, float]) -> Range:
        value = getattr(table, key)
        return Range(*usual) if value is None else range_of(key, value, within, errors)

    turn_deg = drawn_from(key, ALL_AROUND_DEG if number == 0 else BETWEEN_LAYERS_DEG)
    speed_mps = drawn_from("speed_mps", LOW_SPEED_MPS)
    drawn = {"speed_mps", "heading_deg", "veer_deg", "shifts"}
    given = {key: getattr(table, key) for key in table.__struct_fields__ if key not in drawn}
    layer = errors.made(
        within, lambda: LayerSettings(**given, shifts=_shifts(table.shifts, within, errors))
    )
    for speed, heading in ((speed_mps.low, turn_deg.low), (speed_mps.high, turn_deg.high)):
        errors.made(within, lambda s=speed, h=heading: replace(layer, speed_mps=s, heading_deg=h))  # type: ignore[misc]
    return CloudRanges(replace(layer, heading_deg=0.0), speed_mps, turn_deg)


def _shifts(tables: list[ShiftTable], within: str, errors: ScenarioErrors) -> tuple[WindShift, ...]:
    """Return the shifts with headings that count from the clouds' first one."""
    shifts: list[WindShift] = []
    for index, table in enumerate(tables):
        heading_deg = table.turn_deg + (shifts[-1].heading_deg if shifts else 0.0)
        given = (table.start_s, table.duration_s, table.speed_mps, heading_deg)
        place = f"{within}.shifts[{index}]"
        shifts.append(errors.made(place, lambda given=given: WindShift(*given)))  # type: ignore[misc]
    return tuple(shifts)


LOW_SUN_DEG = 40.0
"""A lower sun rises, so that no survey ends at dusk."""


def sky_of(scenario: Scenario, seed: int) -> Sky:
    """Return the sky of a seed's flight."""
    conditions, sun = conditions_of(scenario, seed), scenario.sun
    if conditions.sun_elevation_deg is not None:
        is_morning = conditions.is_morning or conditions.sun_elevation_deg < LOW_SUN_DEG
        start_utc_s = utc_s_at_elevation(sun, conditions.sun_elevation_deg, is_morning=is_morning)
        sun = replace(sun, start_utc_s=start_utc_s)
    sky = Sky(SkySettings(seed, sun, drawn_layers(scenario.clouds, seed)))
    return _from_shade(sky, scenario) if scenario.conditions.starts_in_shade else sky


SEARCH_STEP_S, SEARCHED_S = 30.0, 36_000.0
POINTS_ACROSS = 9


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
        if float(later.transmittance(east_m, north_m, 0.0).max()) < SUNLIT_TRANSMITTANCE:
            return later
    raise SimulationError(
        f"{scenario.name}: expected clouds that shade the whole view, got none in"
        f" {SEARCHED_S / 3600.0:g} h; use more cover"
    )
