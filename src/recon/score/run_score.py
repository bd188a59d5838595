"""The figures of one run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from recon.model.arrays import FloatArray
from recon.score.change_figures import ChangeScore
from recon.score.forecast_figures import LeadScore
from recon.score.forecast_scoring import ForecastKey
from recon.score.shade_figures import ShadeFigures

ENOUGH = 0.95


@dataclass(frozen=True, slots=True)
class RunScore:
    """Figures of one seed; None where a run has no such figure, or ended before reaching it."""

    seed: int
    shade: ShadeFigures
    to_right_s: float | None
    """Time until most of the scored cells were first known and right."""
    registration_m: tuple[float, float] | None
    """Median and 95th percentile of the ground images' errors."""
    forecasts: Mapping[ForecastKey, LeadScore]
    in_sun_share: tuple[float, ...]
    """Share of the region truly imaged in sun, at each of `SCORE.curve_min` within the limit."""
    to_95_imaged_s: float | None
    to_95_in_sun_s: float | None
    counted_in_sun: int
    """Cells that the survey counts as in sun."""
    wrongly_in_sun: int
    """Cells of these that are on no photo in sun in truth."""
    survey_s: float
    """Time until the survey had ended and all drones had landed."""
    flight_s: float
    """Total time in the air of all drones."""
    missions: int
    photos: int
    shaded_photos: int
    encounters: int
    """Times that two vehicles in the air came nearer than the separation."""
    landings: int
    low_landings: int
    """Landings with less than the battery reserve."""
    end: str
    """Why the survey ended."""
    changes: ChangeScore = field(default_factory=ChangeScore)
    simulated_s: float = 0.0
    breaches: int = 0
    """Times that a drone in the air left the boundary or entered a keep-out zone."""
    refusals: int = 0
    """Orders that the gate refused."""
    holds: int = 0
    """Times that a watchdog stopped a vehicle."""

    @property
    def shaded_share(self) -> float | None:
        """Return the share of the photos on rows that were taken in shade."""
        return self.shaded_photos / self.photos if self.photos else None


@dataclass(slots=True)
class MapsScore:
    """The figures of a `RunScore` that maps and forecasts have; without a survey's."""

    seed: int = 0
    shade: ShadeFigures = field(default_factory=ShadeFigures)
    to_right_s: float | None = None
    registration_m: tuple[float, float] | None = None
    forecasts: dict[ForecastKey, LeadScore] = field(default_factory=dict)
    changes: ChangeScore = field(default_factory=ChangeScore)
    simulated_s: float = 0.0


ScoredMaps = RunScore | MapsScore


def time_to_share(first_s: FloatArray, share: float, limit_s: float) -> float | None:
    """Return when a share of the cells was reached; `first_s` (N,) is each cell's time, infinite if
    never. None: not within the limit."""
    if first_s.size == 0:
        return None
    needed = int(np.ceil(share * first_s.size - 1e-9))
    at_s = float(np.sort(first_s)[max(needed, 1) - 1])
    return at_s if at_s <= limit_s else None


def shares_by(first_s: FloatArray, at_s: FloatArray) -> tuple[float, ...]:
    """Return the share of cells (N,) reached by each of some times."""
    reached = np.searchsorted(np.sort(first_s), at_s, side="right")
    return tuple((reached / max(first_s.size, 1)).tolist())


def registration_quantiles_m(errors_m: Sequence[FloatArray]) -> tuple[float, float] | None:
    """Return median and 95th percentile over all points of all images; None without images."""
    if not errors_m:
        return None
    median_m, high_m = np.nanquantile(np.concatenate(errors_m), [0.5, 0.95])
    return float(median_m), float(high_m)
