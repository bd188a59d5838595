"""Forecast methods at the places of light sensors: each is compared with what they then showed.

The methods see maps between the places up to the forecast's moment, never a later value. A lead is
rounded up to a whole number of the sensors' steps. Sensors without a value at a lead's moment, and
moments without a row, are not counted.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from recon.forecast import Forecaster, ForecastSettings, ForecastState
from recon.light.points import LightPoints, is_sunlit
from recon.model.arrays import IntArray
from recon.model.errors import RecordError
from recon.model.shade import SURE, SunForecast
from recon.model.units import NS_PER_S
from recon.score.forecast_figures import LeadScore, score_cells
from recon.score.forecast_scoring import ForecastKey
from recon.score.point_maps import PointMaps

LEADS_S = (15.0, 30.0, 60.0, 120.0, 300.0)
EVERY_S = 30.0
"""Time between forecasts."""
LEAST_STEP_S = 5.0
"""Methods keep a map each five seconds: faster sensors are read so often."""
SLOWEST_STEP_S = 60.0
"""Shadows cross a field in a minute: nothing can be followed between slower maps."""


@dataclass(frozen=True, slots=True)
class PointScores:
    """What methods reached at the places."""

    leads_s: tuple[float, ...]
    sums: Mapping[ForecastKey, LeadScore]
    velocities_mps: Mapping[str, Sequence[tuple[float, float] | None]]
    """The shadows' velocity of each forecast by method; None where it claims none."""


def verified_at_points(
    points: LightPoints, methods: Mapping[str, Forecaster], every_s: float = EVERY_S
) -> PointScores:
    """Return the scores of all methods at the places; raises `RecordError` for slow sensors."""
    step_s = points.step_s
    if step_s > SLOWEST_STEP_S:
        raise RecordError(
            f"expected sensors with a value each {SLOWEST_STEP_S:g} s or more often, "
            f"got one each {step_s:g} s"
        )
    maps = PointMaps(points)
    leads_s = tuple(sorted({ceil(lead_s / step_s - 1e-9) * step_s for lead_s in LEADS_S}))
    settings = ForecastSettings(lead_s=(0.0, *leads_s))
    states = dict.fromkeys(methods, ForecastState())
    sums: dict[ForecastKey, LeadScore] = {}
    velocities: dict[str, list[tuple[float, float] | None]] = {name: [] for name in methods}
    due_ns = int(points.times_ns[0])
    chosen = _spaced(points.times_ns, LEAST_STEP_S)
    for shade in maps.each(chosen):
        is_due = shade.captured_at_ns >= due_ns
        due_ns += round(is_due * every_s * NS_PER_S)
        for name, method in methods.items():
            states[name] = method.observed(states[name], shade, settings)
            if is_due:
                sun = method.forecast(states[name], settings)
                velocities[name].append(sun.velocity_mps)
                for key, found in _scores(maps, name, sun):
                    sums[key] = sums.get(key, LeadScore()) + found
    return PointScores(leads_s, sums, velocities)


def _spaced(times_ns: IntArray, least_s: float) -> list[int]:
    """Return the numbers of times that are at least so far apart."""
    found: list[int] = []
    for number, at_ns in enumerate(times_ns.tolist()):
        if not found or at_ns - times_ns[found[-1]] >= least_s * NS_PER_S:
            found.append(number)
    return found


def _scores(maps: PointMaps, name: str, sun: SunForecast) -> list[tuple[ForecastKey, LeadScore]]:
    """Return the score of one forecast at each lead that has a row of values."""
    points, (rows, cols), found = maps.points, maps.cells, []
    half_step_ns = points.step_s * NS_PER_S / 2.0
    for index, lead_s in enumerate(sun.lead_s.tolist()):
        at_ns = sun.issued_at_ns + round(lead_s * NS_PER_S)
        row = int(np.argmin(np.abs(points.times_ns - at_ns)))
        if lead_s == 0.0 or abs(int(points.times_ns[row]) - at_ns) > half_step_ns:
            continue
        direct = maps.direct[row]
        chances = sun.sun_probability[index, rows, cols] / SURE
        with np.errstate(invalid="ignore"):
            is_seen = sun.horizon_s[rows, cols] >= lead_s
        by_cells = score_cells(chances, is_sunlit(direct), is_seen, np.isfinite(direct))
        found += [((name, lead_s, cells), score) for cells, score in by_cells.items()]
    return found
