"""What an aircraft's estimate of its own position is off by: GNSS and a barometer."""

from dataclasses import dataclass, field
from math import exp, sqrt
from random import Random


@dataclass(frozen=True, slots=True)
class DriftSettings:
    """Standard deviations and time constants of slow errors (first-order Gauss-Markov)."""

    position_m: float = 0.0
    """Satellite geometry and ionosphere."""
    position_time_s: float = 400.0
    height_m: float = 0.0
    """Air pressure, and the barometer warming up."""
    height_time_s: float = 900.0


FIELD_DRIFT = DriftSettings(position_m=0.7, height_m=0.8)
"""Metres, as outdoors: twice these values within a quarter of an hour is common."""


@dataclass(slots=True)
class GaussMarkov:
    """A first-order Gauss-Markov process."""

    sigma: float
    time_s: float
    value: float = 0.0

    def step(self, seconds: float, random: Random) -> float:
        """Advance by `seconds` and return the value."""
        # The noise term keeps the variance at sigma squared for any step length.
        keep = exp(-seconds / self.time_s)
        self.value = keep * self.value + sqrt(1.0 - keep * keep) * random.gauss(0.0, self.sigma)
        return self.value


@dataclass(slots=True)
class EstimateErrors:
    """Measured minus true north, east and height, metres; constant without a generator."""

    north_east_up_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    random: Random | None = None
    settings: DriftSettings = field(default_factory=DriftSettings)
    _axes: tuple[GaussMarkov, ...] = field(init=False)

    def __post_init__(self) -> None:
        s = self.settings
        self._axes = (
            GaussMarkov(s.position_m, s.position_time_s),
            GaussMarkov(s.position_m, s.position_time_s),
            GaussMarkov(s.height_m, s.height_time_s),
        )

    def step(self, seconds: float) -> None:
        """Advance by `seconds`."""
        if self.random is None:
            return
        north_m, east_m, up_m = (axis.step(seconds, self.random) for axis in self._axes)
        self.north_east_up_m = north_m, east_m, up_m
