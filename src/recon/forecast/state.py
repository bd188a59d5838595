"""The state of a forecaster, and what follows from it alone: the prior, and each cell now."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from recon.forecast.matching import MatchedMap, Mismatch
from recon.forecast.phase_correlation import ShadeSpectrum
from recon.forecast.settings import ForecastSettings
from recon.model.geo import GroundGrid
from recon.model.shade import SUNLIT_TRANSMITTANCE, FloatMap, MaskMap, ShadeMap, SunForecast
from recon.model.units import ns_to_seconds


@dataclass(frozen=True, slots=True, eq=False)
class Agreement:
    """The faded sum of all pairs' agreement by velocity, and when it was faded last."""

    at_ns: int
    began_ns: int
    """Time of the first map."""
    by_velocity: FloatMap
    """(N, N): rows from north to south, columns from west to east."""
    recent: Mismatch
    """Faded as the agreement is."""
    long: Mismatch
    """Faded over minutes."""


@dataclass(frozen=True, slots=True)
class SpatialCorrelation:
    """Faded sums over the maps so far, of pairs of cells a fixed distance apart; in seconds."""

    at_ns: int
    covariance_s: float = 0.0
    """Sum of the mean product of their deviations from the prior."""
    variance_s: float = 0.0
    """Sum of the mean square of these."""
    change_s: float = 0.0
    """Sum of the mean square of their difference in transmittance, weighted by how near they are to
    half shade."""
    partly_shaded_s: float = 0.0
    """Sum of how near they are to half shade: 1 there, 0 in full sun and in full shade."""


@dataclass(frozen=True, slots=True)
class EdgeErrors:
    """Faded sums over pairs of maps, one moved on to the other."""

    at_ns: int
    sums: tuple[float, ...] = (0.0,) * 5
    """Of the share of cells that change over a metre, the same times the pair's seconds, times
    their square; of the share that differs in the pair, the same times its seconds."""

    def faded(self, share: float) -> npt.NDArray[np.float64]:
        """Return the sums, of which this share is left."""
        return np.array(self.sums) * share


@dataclass(frozen=True, slots=True)
class Comparison:
    """Faded sums over forecasts of one lead: cells that were right, and cells compared."""

    right: float = 0.0
    cells: float = 0.0

    def __add__(self, other: "Comparison") -> "Comparison":
        return Comparison(self.right + other.right, self.cells + other.cells)

    def faded(self, share: float) -> "Comparison":
        """Return the sums, of which this share is left."""
        return Comparison(self.right * share, self.cells * share)


@dataclass(frozen=True, slots=True, eq=False)
class IssuedForecast:
    """A forecast, kept to be compared with what came; masks are (R, C)."""

    grid: GroundGrid
    issued_at_ns: int
    sunlit: Mapping[float, MaskMap]
    """Sunlit cells by lead in seconds."""
    seen: MaskMap
    """The cells with a value in its map."""


@dataclass(frozen=True, slots=True, eq=False)
class ForecastState:
    """One state for all methods, so that the method can be changed in flight; bounded."""

    shade: ShadeMap | None = None
    """The newest map."""
    sunlit_share: float | None = None
    """Recent mean share of visible cells in sun; None before the first map."""
    seen_s: float = 0.0
    """Time that mean covers, at most `cover_memory_s`."""
    kept: tuple[ShadeSpectrum, ...] = ()
    """Spectra of earlier maps to compare with, oldest first."""
    matched: tuple[MatchedMap, ...] = ()
    """Coarse spectra of the same maps."""
    agreement: Agreement | None = None
    """Agreement of all recent pairs of maps."""
    correlation: SpatialCorrelation | None = None
    edge_errors: EdgeErrors | None = None
    recent: tuple[ShadeMap, ...] = ()
    """Whole maps, oldest first."""
    in_view: MaskMap | None = None
    """(R, C): the cells that the newest map's frames show, unknown ones too; None if not given."""
    followed: ShadeMap | None = None
    """The newest map, and the shade that has left the view where it is by now; None if the method
    follows none."""
    issued: tuple[IssuedForecast, ...] = ()
    """Oldest first."""
    compared: Mapping[float, Comparison] = field(default_factory=dict)
    """Comparisons by lead in seconds."""

    @property
    def newest(self) -> ShadeMap:
        """The newest map; raises `ValueError` without one."""
        if self.shade is None:
            raise ValueError("expected a shade map before a forecast, got none yet")
        return self.shade


NO_KNOWLEDGE = 0.5
"""Prior before the first map."""


def with_map(state: ForecastState, shade: ShadeMap, settings: ForecastSettings) -> ForecastState:
    """Return the state with a map's share in sun added; a map on another grid drops the motion.

    Raises `ValueError` for a map that is not newer than the last one.
    """
    passed_s = 0.0
    if state.shade is not None:
        passed_s = ns_to_seconds(shade.captured_at_ns - state.shade.captured_at_ns)
        if passed_s <= 0.0:
            raise ValueError(
                f"expected a newer shade map than the last one, got one {-passed_s:.1f} s older"
            )
    if state.kept and state.kept[-1].grid != shade.grid:
        state = replace(state, kept=(), matched=(), agreement=None)
    state = replace(state, shade=shade, followed=None)
    return _with_share(state, shade, passed_s, settings.cover_memory_s)


def prior_sunlit(state: ForecastState, settings: ForecastSettings) -> float:
    """Return the prior: the probability of sun where nothing is known."""
    if state.sunlit_share is None:
        return NO_KNOWLEDGE
    # Bayesian mean with one pseudo-observation of 0.5.
    views = state.seen_s / settings.cover_view_s
    return (views * state.sunlit_share + NO_KNOWLEDGE) / (views + 1.0)


def sun_chance(transmittance: FloatMap, settings: ForecastSettings) -> FloatMap:
    """Return the probability of sun where a map says this transmittance, of the same shape."""
    probability = (transmittance - SUNLIT_TRANSMITTANCE) / (2.0 * settings.soft_edge) + 0.5
    found: FloatMap = np.clip(probability, 1.0 - settings.surest, settings.surest)
    return found


def sunlit_now(shade: ShadeMap, prior: float, settings: ForecastSettings) -> FloatMap:
    """Return (R, C): each cell's probability of sun at the map's capture time.

    `prior` where the map is invalid; the lower the detection's confidence, the nearer to `prior`.
    """
    probability = sun_chance(shade.transmittance, settings)
    mixed = np.where(shade.valid, prior + shade.confidence * (probability - prior), prior)
    return mixed.astype(np.float32)


def forecast_of(
    shade: ShadeMap,
    settings: ForecastSettings,
    prior: float,
    method: str,
    probability: npt.NDArray[np.uint8],
    horizon_s: npt.ArrayLike,
    velocity_mps: tuple[float, float] | None = None,
) -> SunForecast:
    """Return a map's forecast: `probability` (L, R, C) in 255ths; `horizon_s` (R, C) or one number,
    for the cells that the map knows: NaN elsewhere."""
    return SunForecast(
        grid=shade.grid,
        issued_at_ns=shade.captured_at_ns,
        lead_s=np.array(settings.lead_s, dtype=np.float64),
        sun_probability=probability,
        horizon_s=np.where(shade.valid, np.asarray(horizon_s, np.float32), np.float32(np.nan)),
        prior_sunlit=prior,
        method=method,
        velocity_mps=velocity_mps,
    )


def _with_share(
    state: ForecastState, shade: ShadeMap, passed_s: float, memory_s: float
) -> ForecastState:
    """Return the state with a map in the running mean, if the map shows anything."""
    if not shade.valid.any():
        return state
    share = float(shade.is_sunlit[shade.valid].mean())
    before = share if state.sunlit_share is None else state.sunlit_share
    # A plain mean until the averaging time is reached, then an exponential one.
    seen_s = min(state.seen_s + passed_s, memory_s)
    # Weight by time, not by map: the frame rate must not change the prior.
    weight = min(passed_s / seen_s, 1.0) if seen_s > 0.0 else 1.0
    return replace(state, sunlit_share=before + weight * (share - before), seen_s=seen_s)
