"""The figures of one run."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import numpy.typing as npt

from recon.score.forecast_metrics import Ahead, LeadScore
from recon.score.shade_metrics import Overlap

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
ENOUGH = 0.95


@dataclass(frozen=True, slots=True)
class RunScore:
    """Figures of one seed; None where a run has no such figure, or did not come so far."""

    seed: int
    shade: Overlap
    boundary_error_m: float | None
    known_share: float
    shade_share: float
    """Of the eye's footprint, in truth."""
    leads: Mapping[tuple[float, Ahead], LeadScore]
    in_sun_share: tuple[float, ...]
    """Of the region, truly on a photo in sun, at whole steps of `minutes`."""
    to_95_imaged_s: float | None
    to_95_in_sun_s: float | None
    wrongly_in_sun_share: float | None
    """Of what the survey counts as in sun: on no photo in sun in truth."""
    survey_s: float
    """Until the survey had ended and all had landed."""
    flight_s: float
    """In the air, all drones together."""
    missions: int
    photos: int
    shaded_photos: int
    encounters: int
    """Times that two in the air came nearer than the separation."""
    low_landings: int
    """Landings with less than the reserve."""
    end: str
    """Why the survey ended."""
    simulated_s: float = 0.0
    """What was flown and watched."""
    breaches: int | None = None
    """Times that a drone in the air left the boundary or entered what is to be kept out of; None
    where nobody looked: flights by events know no fence."""
    refusals: int | None = None
    """Orders that the gate refused; None where there was no gate."""

    @property
    def shaded_share(self) -> float | None:
        """Of the photos on rows, taken in shade."""
        return self.shaded_photos / self.photos if self.photos else None


def time_to_share(first_s: FloatArray, share: float, limit_s: float) -> float | None:
    """Return when so much of the cells (N,) had come, by when each came; None: not by the limit."""
    if first_s.size == 0:
        return None
    needed = int(np.ceil(share * first_s.size - 1e-9))
    at_s = float(np.sort(first_s)[max(needed, 1) - 1])
    return at_s if at_s <= limit_s else None


def shares_by(first_s: FloatArray, at_s: FloatArray) -> tuple[float, ...]:
    """Return the share of cells (N,) that had come at each of some times."""
    came = np.searchsorted(np.sort(first_s), at_s, side="right")
    return tuple((came / max(first_s.size, 1)).tolist())


def encounters(
    places_m: list[FloatArray], in_air: list[BoolArray], level_m: float, up_m: float
) -> int:
    """Return how often two of several vehicles came too near, both in the air, at common times.

    Each item is one vehicle's (N, 3) places and whether it is in the air, (N,). Too near is both
    nearer than `level_m` over the ground and than `up_m` in height.
    """
    count = 0
    for i, j in combinations(range(len(places_m)), 2):
        east_m, north_m, height_m = (places_m[i] - places_m[j]).T
        near = (np.hypot(east_m, north_m) < level_m) & (np.abs(height_m) < up_m)
        near &= in_air[i] & in_air[j]
        count += int(near[:1].sum()) + int((near[1:] & ~near[:-1]).sum())
    return count
