"""Shade maps against light sensors: was this sensor in sun when the map said so?

Each map is compared with the row of values nearest to its time, at most `near_enough_s` from it. A
sensor off the map or in a cell that it does not know counts as unknown; one without a value then is
not counted.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from recon.forecast import ForecastSettings
from recon.forecast.state import sun_chance
from recon.light.agreement import MapAgreement, compared, near_enough_s
from recon.light.points import LightPoints, is_sunlit
from recon.model.shade import SUNLIT_TRANSMITTANCE, FloatMap
from recon.model.units import NS_PER_S
from recon.score.forecast_figures import LeadScore, SeenCells, score_cells

SETTINGS = ForecastSettings()


@dataclass(frozen=True, slots=True, eq=False)
class MapAtPlaces:
    """One map's transmittance at N sensors, NaN where it knows nothing."""

    at_ns: int
    """UTC."""
    transmittance: FloatMap


@dataclass(slots=True)
class MapScore:
    """Sums over maps and sensors."""

    score: LeadScore = field(default_factory=LeadScore)
    agreement: MapAgreement = field(default_factory=MapAgreement)
    maps: int = 0
    alone: int = 0
    """Maps without a value near their time."""


def score_maps(points: LightPoints, maps: Iterable[MapAtPlaces]) -> MapScore:
    """Return how right maps are at the sensors."""
    found, direct = MapScore(), points.direct
    near_s = near_enough_s(points.step_s)
    for each in maps:
        found.maps += 1
        row = int(np.argmin(np.abs(points.times_ns - each.at_ns)))
        if abs(int(points.times_ns[row]) - each.at_ns) > near_s * NS_PER_S:
            found.alone += 1
        else:
            _add(found, each.transmittance, direct[row])
    return found


def _add(found: MapScore, transmittance: FloatMap, direct: FloatMap) -> None:
    has_value, known = np.isfinite(direct), np.isfinite(transmittance)
    truth = is_sunlit(direct)
    # As a forecast reads a map at its own moment.
    read = np.where(known, transmittance, SUNLIT_TRANSMITTANCE)
    chances = sun_chance(read, SETTINGS).astype(np.float64)
    everywhere = np.ones_like(known)
    found.score += score_cells(chances, truth, everywhere, has_value & known)[SeenCells.ALL]
    found.agreement += compared(transmittance, direct)
