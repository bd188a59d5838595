"""What a forecaster remembers from map to map; bounded, and never changed in place."""

from dataclasses import dataclass

from recon.forecast.phase_correlation import ShadeSpectrum


@dataclass(frozen=True, slots=True)
class PairVelocity:
    """What one pair of shade maps said of the shadows' motion."""

    at_ns: int
    east_mps: float
    north_mps: float


@dataclass(frozen=True, slots=True, eq=False)
class ForecastState:
    """One state for all methods, so that a method may be changed in flight."""

    latest_ns: int | None = None
    sunlit_share: float | None = None
    """Mean share in sun of what was seen lately; None before anything was."""
    seen_s: float = 0.0
    """For how long that mean has been taken; no longer than it remembers."""
    kept: tuple[ShadeSpectrum, ...] = ()
    """Maps to compare with, oldest first."""
    velocities: tuple[PairVelocity, ...] = ()
    """Oldest first."""
