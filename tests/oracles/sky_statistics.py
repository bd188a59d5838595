"""The generated sky against one-second irradiance measured on 13 broken-cloud days.

Draws skies of different covers, speeds and softness and samples points far apart for some hours.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import exp
from statistics import NormalDist

import numpy as np
from scipy.stats.qmc import LatinHypercube
from tests.oracles.shadow_passages import LEADS_MIN, IndexSeries, Passages, percentiles

from recon.sim.world import LayerSettings, LightSettings, Sky, SkySettings
from recon.sim.world.light import clear_sky_light
from recon.sim.world.settings import BETWEEN_LAYERS_DEG, HIGH_SPEED_MPS, LOW_SPEED_MPS

EAST_APART_M, NORTH_APART_M = 37_013.0, 23_017.0
"""Three outer scales and more: the points have weathers of their own."""
SECONDS_AT_ONCE = 4_096
NORMAL = NormalDist()
DRAWS = 13
"""Of one sky with two layers."""

MEASURED = {
    "shadow, s": (36.0, 88.0, 640.0),
    "sunlit gap, s": (40.0, 129.0, 836.0),
    "20-80 % edge, s": (3.0, 17.0, 50.0),
    "persistence IoU": (0.80, 0.69, 0.65, 0.57, 0.52),
}
COLUMNS = ("10 %", "50 %", "90 %")


@dataclass(frozen=True, slots=True)
class Mixture:
    """What the drawn days are like: fitted, but for the layers' speeds, angles and heights."""

    cover_middle: float = -0.31
    """Of the low clouds' covers, as a normal deviate: 38 %."""
    cover_spread: float = 0.68
    """Deviation of these deviates: two days of three lie between 16 and 64 %."""
    high_share: float = 0.4
    """How many days have a second layer."""
    high_cover_middle: float = -0.85
    high_cover_spread: float = 0.7
    """Of the high clouds' covers: 20 %, mostly 6 to 44 %."""
    softness: float = 0.62
    softness_spread: float = 1.6
    """Deviation of the softness' logarithm: from hard-edged cumulus to veils."""
    softness_bounds: tuple[float, float] = (0.02, 1.0)
    ragged_share: float = 0.6
    """How many layers have the first of the spectral slopes, the others the second."""
    slopes: tuple[float, float] = (3.0, 3.43)
    finest_scale_m: float = 130.0
    lifetime_s: float = 1_100.0
    """As in the scenarios of broken cloud."""
    modulation: float = 1.24
    modulation_s: float = 4_950.0
    """Days have slower changes of cover than single broken hours."""
    low_base_m: tuple[float, float] = (900.0, 2_000.0)
    high_base_m: tuple[float, float] = (3_000.0, 6_000.0)

    def skies(self, first_seed: int, count: int) -> list[Sky]:
        """Return skies that share the mixture evenly (a Latin hypercube of all its draws)."""
        rng = np.random.default_rng(first_seed)
        return [
            self._sky(first_seed + number, Draws(row.tolist()))
            for number, row in enumerate(LatinHypercube(DRAWS, rng=rng).random(count))
        ]

    def _sky(self, seed: int, draws: "Draws") -> Sky:
        heading_deg = draws.between(0.0, 360.0)
        cover = NORMAL.cdf(draws.normal(self.cover_middle, self.cover_spread))
        low = self._layer(draws, self.low_base_m, LOW_SPEED_MPS, heading_deg, cover)
        if draws.next() >= self.high_share:
            return Sky(SkySettings(seed, layers=(low,)))
        turned_deg = (heading_deg + draws.between(*BETWEEN_LAYERS_DEG)) % 360.0
        cover = NORMAL.cdf(draws.normal(self.high_cover_middle, self.high_cover_spread))
        high = self._layer(draws, self.high_base_m, HIGH_SPEED_MPS, turned_deg, cover)
        return Sky(SkySettings(seed, layers=(low, high)))

    def _layer(
        self,
        draws: "Draws",
        base_m: tuple[float, float],
        speed_mps: tuple[float, float],
        heading_deg: float,
        cover: float,
    ) -> LayerSettings:
        softness = self.softness * exp(draws.normal(0.0, self.softness_spread))
        return LayerSettings(
            base_height_m=draws.between(*base_m),
            speed_mps=draws.between(*speed_mps),
            heading_deg=heading_deg,
            cover=min(max(cover, 0.01), 0.99),
            softness=min(max(softness, self.softness_bounds[0]), self.softness_bounds[1]),
            spectral_slope=self.slopes[0 if draws.next() < self.ragged_share else 1],
            finest_scale_m=self.finest_scale_m,
            lifetime_s=self.lifetime_s,
            modulation=self.modulation,
            modulation_s=self.modulation_s,
        )


class Draws:
    """Numbers drawn evenly from 0 to 1, taken one after the other."""

    def __init__(self, numbers: list[float]) -> None:
        self._numbers = iter(numbers)

    def next(self) -> float:
        """Return the next one."""
        return next(self._numbers)

    def between(self, low: float, high: float) -> float:
        """Return a number drawn evenly between two."""
        return low + (high - low) * self.next()

    def normal(self, middle: float, deviation: float) -> float:
        """Return a normally distributed number."""
        return middle + deviation * NORMAL.inv_cdf(min(max(self.next(), 1e-6), 1.0 - 1e-6))


def watch(skies: list[Sky], points: int, hours: float) -> Passages:
    """Return what passes over the points of these skies."""
    passages = Passages()
    for sky in skies:
        passages.add(clear_sky_indices(sky, points, hours))
    return passages


def clear_sky_indices(sky: Sky, points: int, hours: float) -> IndexSeries:
    """Return the clear-sky indices (T, P) of points with weathers of their own, one a second."""
    return np.vstack(list(_indices(sky, points, hours)))


def _indices(sky: Sky, points: int, hours: float) -> Iterator[IndexSeries]:
    """Yield clear-sky indices (T, P), one a second, some time's worth each."""
    number = np.arange(points)
    settings = LightSettings()
    for start_s in range(0, round(hours * 3600.0), SECONDS_AT_ONCE):
        end_s = min(start_s + SECONDS_AT_ONCE, round(hours * 3600.0))
        times_s = np.arange(start_s, end_s, dtype=np.float64)
        share = sky.transmittance(
            number * EAST_APART_M, number * NORTH_APART_M, times_s[:, np.newaxis]
        )
        # Within an hour the sun changes little: one light for each piece.
        light = clear_sky_light(sky.sun_at(0.5 * (start_s + end_s)), settings)
        yield light.index(share, settings.cloud_brightening)


def figures(passages: Passages) -> dict[str, np.ndarray]:
    """Return the simulator's figures under the names of `MEASURED`."""
    return {
        "shadow, s": percentiles(passages.shadows_s),
        "sunlit gap, s": percentiles(passages.gaps_s),
        "20-80 % edge, s": percentiles(passages.edges_s),
        "persistence IoU": passages.persistence,
    }


def table(found: dict[str, np.ndarray]) -> str:
    """Return the measured and the found figures side by side, as a Markdown table."""
    lines = ["| figure | at | measured | simulated | ratio |", "|---|---|---|---|---|"]
    for name, measured in MEASURED.items():
        at = COLUMNS if len(measured) == 3 else tuple(f"{lead} min" for lead in LEADS_MIN)
        for column, truth, value in zip(at, measured, found[name], strict=True):
            digits = ".2f" if truth < 1.0 else ".1f" if truth < 100.0 else ".0f"
            shown = f"{truth:.2f}" if truth < 1.0 else f"{truth:.0f}"
            lines.append(
                f"| {name} | {column} | {shown} | {value:{digits}} | {value / truth:.2f} |"
            )
    return "\n".join(lines)
