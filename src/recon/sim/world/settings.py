"""Settings of sky, wind and light, each with its reason."""

from dataclasses import dataclass
from math import inf, isfinite, sqrt

from recon.model.geo import LatLon
from recon.sim.errors import SimulationError

DEMO_FIELD = LatLon(41.9012, -93.6034)
LOW_SPEED_MPS = (5.0, 11.0)
"""Fair-weather cumulus, 1 to 2 km up, over land by day."""
HIGH_SPEED_MPS = (10.0, 18.0)
"""Clouds 3 to 6 km up."""
BETWEEN_LAYERS_DEG = (25.0, 70.0)
"""Wind turns with height; a forecaster cannot distinguish two layers that move alike."""


def expect(name: str, value: float, lowest: float, highest: float) -> None:
    """Raise `SimulationError` for NaN or a value outside the bounds."""
    if not lowest <= value <= highest:
        raise SimulationError(f"{name}: expected {lowest:g} to {highest:g}, got {value:g}")


@dataclass(frozen=True, slots=True)
class SunSettings:
    """Place and start time of the scenario."""

    place: LatLon = DEMO_FIELD
    start_utc_s: float = 1_750_435_200.0
    """2025-06-20 16:00 UTC, seconds after 1970: a summer's morning there, the sun 55 degrees up."""

    def __post_init__(self) -> None:
        if not (self.place.is_valid() and isfinite(self.start_utc_s)):
            raise SimulationError(
                f"sun: expected a place on the globe and a time, got {self.place}"
                f" at {self.start_utc_s}"
            )


@dataclass(frozen=True, slots=True)
class WindShift:
    """A linear change of the clouds' velocity to another one."""

    start_s: float
    duration_s: float
    speed_mps: float
    heading_deg: float

    def __post_init__(self) -> None:
        expect("wind shift: start_s", self.start_s, 0.0, inf)
        expect("wind shift: duration_s", self.duration_s, 1.0, inf)
        expect("wind shift: speed_mps", self.speed_mps, 0.0, 60.0)
        expect("wind shift: heading_deg", self.heading_deg, -360.0, 360.0)


@dataclass(frozen=True, slots=True)
class LayerSettings:
    """One layer of clouds."""

    base_height_m: float = 1_400.0
    """Height above the ground; fair-weather cumulus at noon."""
    speed_mps: float = 7.5
    """Speed in the middle of `LOW_SPEED_MPS`."""
    heading_deg: float = 70.0
    """Direction the clouds move to, clockwise from north."""
    cover: float = 0.4
    """Share of the ground in the layer's shade (less than half of the beam), over long times."""
    spectral_slope: float = 3.4
    """Power of the field falls with wave number to this power; 3.0 gives more ragged clouds."""
    outer_scale_m: float = 12_000.0
    """The largest structures: they make the cover differ from hour to hour."""
    finest_scale_m: float = 40.0
    """Finest scale: smaller details are lost in the penumbra of a cloud at 1.4 km."""
    softness: float = 0.28
    """Optical depth grows e-fold over this part of the field's deviation: edges of 20 to 200 m.
    Measured days have 0.02 to 1 (docs/world.md)."""
    largest_optical_depth: float = 20.0
    """Depth of thick cumulus along the beam; below 0.7 (thin cirrus) there is never shade."""
    lifetime_s: float = 900.0
    """Time in which the correlation of a 1 km structure falls to 1/e; inf: frozen."""
    lifetime_exponent: float = 2.0 / 3.0
    """Lifetime grows with scale to this power, as eddies' turnover does."""
    modulation: float = 0.5
    """Slow variation of the threshold, in standard deviations of the field: the cover varies."""
    modulation_s: float = 2_400.0
    """Time in which the correlation of that variation falls to 1/e."""
    shifts: tuple[WindShift, ...] = ()
    """Wind shifts in order, each after the end of the one before."""

    def __post_init__(self) -> None:
        expect("base_height_m", self.base_height_m, 50.0, 15_000.0)
        expect("speed_mps", self.speed_mps, 0.0, 60.0)
        expect("heading_deg", self.heading_deg, -360.0, 360.0)
        expect("cover", self.cover, 0.0, 1.0)
        expect("spectral_slope", self.spectral_slope, 2.1, 5.0)
        expect("outer_scale_m", self.outer_scale_m, 200.0, 100_000.0)
        expect("finest_scale_m", self.finest_scale_m, 10.0, self.outer_scale_m)
        expect("softness", self.softness, 0.01, 5.0)
        expect("largest_optical_depth", self.largest_optical_depth, 0.01, 200.0)
        expect("lifetime_s", self.lifetime_s, 1.0, inf)
        expect("lifetime_exponent", self.lifetime_exponent, 0.0, 2.0)
        expect("modulation", self.modulation, 0.0, 3.0)
        expect("modulation_s", self.modulation_s, 1.0, inf)
        ends = [0.0, *(shift.start_s + shift.duration_s for shift in self.shifts)]
        if any(shift.start_s < end for shift, end in zip(self.shifts, ends, strict=False)):
            raise SimulationError("wind shifts: expected each after the end of the one before")


@dataclass(frozen=True, slots=True)
class SkySettings:
    """Sun and clouds; no layers: a clear sky."""

    seed: int = 0
    sun: SunSettings = SunSettings()
    layers: tuple[LayerSettings, ...] = (LayerSettings(),)
    """One or two, the lower first."""
    clouds_ahead_s: float = 0.0
    """The clouds are those of this much later; the sun is not."""

    def __post_init__(self) -> None:
        if self.seed < 0:
            raise SimulationError(f"sky: expected a seed from 0 upwards, got {self.seed}")
        if len(self.layers) > 2:
            raise SimulationError(f"sky: expected at most two layers, got {len(self.layers)}")


@dataclass(frozen=True, slots=True)
class WindSettings:
    """Wind near the ground."""

    seed: int = 0
    speed_10m_mps: float = 3.5
    """Ten metres up; a light breeze, as with fair-weather cumulus."""
    heading_deg: float = 50.0
    """Direction the air moves to, clockwise from north: left of the clouds, because of friction."""
    shear_exponent: float = 0.16
    """Power law over crops by day."""
    veer_deg_per_100m: float = 3.0
    """The wind turns to the right with height (northern hemisphere)."""
    gust_intensity: float = 0.2
    """Standard deviation over mean speed at 10 m, along the wind, over open farmland by day."""
    gust_scale_m: float = 150.0
    """Length of the largest gusts, carried by the mean wind."""

    def __post_init__(self) -> None:
        if self.seed < 0:
            raise SimulationError(f"wind: expected a seed from 0 upwards, got {self.seed}")
        expect("wind: speed_10m_mps", self.speed_10m_mps, 0.0, 40.0)
        expect("wind: heading_deg", self.heading_deg, -360.0, 360.0)
        expect("wind: shear_exponent", self.shear_exponent, 0.0, 1.0)
        expect("wind: veer_deg_per_100m", self.veer_deg_per_100m, -45.0, 45.0)
        expect("wind: gust_intensity", self.gust_intensity, 0.0, 1.0)
        expect("wind: gust_scale_m", self.gust_scale_m, 10.0, 1_000.0)


@dataclass(frozen=True, slots=True)
class ShadeColour:
    """Light in full shade over light in full sun, as measured on the ground."""

    green: float = 0.36
    """Shade in real frames: 0.19 to 0.23 in red, 0.36 in green, 0.47 to 0.53 in blue."""
    blue_over_red: float = 2.4
    """How many times more blue than red light is left in shade."""

    def __post_init__(self) -> None:
        expect("shade: green", self.green, 0.02, 0.9)
        expect("shade: blue_over_red", self.blue_over_red, 0.5, 4.0)
        expect("shade: blue", self.ratios[2], 0.0, 1.0)

    @property
    def ratios(self) -> tuple[float, float, float]:
        """Shade over sun in red, green and blue."""
        middle, apart = RED_AND_BLUE_OVER_GREEN * self.green, sqrt(self.blue_over_red)
        return middle / apart, self.green, middle * apart


RED_AND_BLUE_OVER_GREEN = 0.95
"""Geometric mean of red's and blue's share over green's; 0.90 to 0.97 in real frames."""


@dataclass(frozen=True, slots=True)
class LightSettings:
    """The atmosphere that light passes."""

    linke_turbidity: float = 3.5
    """Number of clean dry atmospheres of equal extinction; mid-latitude farmland in summer."""
    altitude_m: float = 250.0
    """Altitude above the sea: thinner air dims less."""
    cloud_brightening: float = 1.7
    """Diffuse light between broken clouds over that of a clear sky: their sides are bright."""
    shade: ShadeColour | None = None
    """None: shade as the model of the atmosphere has it, by the sun's elevation."""

    def __post_init__(self) -> None:
        expect("light: linke_turbidity", self.linke_turbidity, 1.0, 10.0)
        expect("light: altitude_m", self.altitude_m, -500.0, 6_000.0)
        expect("light: cloud_brightening", self.cloud_brightening, 1.0, 4.0)
