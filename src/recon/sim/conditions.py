"""The conditions of a simulated flight: light, camera and link, drawn from ranges by the seed.

One value for all flights would let a method learn the simulator. The ranges are those of real
frames of this lens class, where such were measured (docs/world.md). Each value has a random stream
of its own name, so that a new one leaves the others as they are.
"""

from dataclasses import dataclass
from random import Random

from recon.sim.app.camera_feed import FeedSettings, ImageFormat
from recon.sim.camera import (
    CameraSettings,
    ExposureSettings,
    LensSettings,
    ToneSettings,
)
from recon.sim.camera.exposure import LARGEST_DEVIATION
from recon.sim.errors import SimulationError
from recon.sim.world import LightSettings, ShadeColour
from recon.sim.world.settings import expect


@dataclass(frozen=True, slots=True)
class Range:
    """Values from `low` to `high`; one value if they are the same."""

    low: float
    high: float

    def __post_init__(self) -> None:
        if not self.low <= self.high:
            text = f"expected the lower value first, got [{self.low:g}, {self.high:g}]"
            raise SimulationError(text)

    def drawn(self, seed: int, name: str) -> float:
        """Return a seed's value of a name: uniform, and the same at each call."""
        share = Random(f"{seed}/conditions/{name}").random()
        return self.low + share * (self.high - self.low)


@dataclass(frozen=True, slots=True)
class ConditionRanges:
    """What differs between flights; each range with the limits it must keep."""

    sun_elevation_deg: Range | None = None
    """Sun elevation at the start, before or after noon; None: as the start time has it."""
    shade_green: Range = Range(0.22, 0.40)
    """Light in full shade over light in full sun, in green."""
    shade_blue_over_red: Range = Range(1.4, 2.4)
    """How many times more blue than red light is left in shade."""
    highlight_level: Range = Range(218.0, 243.0)
    """Pixel value, in green, of the brightest hundredth of the land in full sun."""
    knee: Range = Range(0.55, 0.9)
    """Light, of white, above which highlights are compressed."""
    contrast: Range = Range(0.0, 0.3)
    exposure_follows: Range = Range(0.5, 0.9)
    """Share of a brightness change, in stops, that auto exposure compensates."""
    exposure_lag_s: Range = Range(1.0, 3.0)
    exposure_drift_stops: Range = Range(0.02, 0.08)
    white_balance: Range = Range(0.02, 0.1)
    """Largest drift of red and blue against green, as a share."""
    tint_red: Range = Range(0.95, 1.10)
    tint_blue: Range = Range(1.2, 1.7)
    """Gains of the camera's white balance and the season; real crops are bluer than drawn ones."""
    lens_blue_over_red: Range = Range(1.4, 1.6)
    """How many times more blue than red light passes at the rim than in the middle."""
    rim_falloff: Range = Range(0.05, 0.3)
    hot_spot: Range = Range(0.2, 0.6)
    hot_spot_deg: Range = Range(4.0, 8.0)
    yaw_error_deg: Range = Range(1.0, 2.0)
    """Error of telemetry to either side."""
    relief_m: Range = Range(0.0, 4.0)
    """Standard deviation of the ground's height."""
    period_s: Range = Range(1.0, 5.0)
    """Time between two frames."""
    jpeg_share: Range = Range(0.5, 0.5)
    """Share of the flights whose frames are JPEG."""
    jpeg_quality: Range = Range(70.0, 92.0)
    exposure_locked: bool = False
    """Whether the pilot locked exposure and white balance."""
    starts_in_shade: bool = False
    """Whether the whole view is in shade at the start."""

    def __post_init__(self) -> None:
        for name, (lowest, highest) in LIMITS.items():
            values = getattr(self, name)
            if values is None:
                continue
            expect(name, values.low, lowest, highest)
            expect(name, values.high, lowest, highest)


LIMITS = {
    "sun_elevation_deg": (5.0, 89.0),
    "shade_green": (0.05, 0.6),
    "shade_blue_over_red": (1.0, 2.6),
    "highlight_level": (40.0, 250.0),
    "knee": (0.2, 1.0),
    "contrast": (0.0, 1.0),
    "exposure_follows": (0.0, 1.0),
    "exposure_lag_s": (0.1, 60.0),
    "exposure_drift_stops": (0.0, 1.0),
    "white_balance": (0.0, 0.5),
    "tint_red": (0.5, 2.0),
    "tint_blue": (0.5, 3.0),
    "lens_blue_over_red": (0.5, 3.0),
    "rim_falloff": (0.0, 0.95),
    "hot_spot": (0.0, 2.0),
    "hot_spot_deg": (0.1, 90.0),
    "yaw_error_deg": (0.0, 20.0),
    "relief_m": (0.0, 60.0),
    "period_s": (0.2, 60.0),
    "jpeg_share": (0.0, 1.0),
    "jpeg_quality": (10.0, 100.0),
}
"""Limits of each range's values."""


@dataclass(frozen=True, slots=True)
class Conditions:
    """The conditions of one flight."""

    camera: CameraSettings
    light: LightSettings
    feed: FeedSettings
    relief_m: float
    yaw_error_deg: float
    """Signed."""
    sun_elevation_deg: float | None
    is_morning: bool


def draw_conditions(ranges: ConditionRanges, seed: int, altitude_m: float = 250.0) -> Conditions:
    """Return a seed's conditions: a pure function of its arguments.

    `altitude_m` is that of the ground above the sea.
    """
    shade = ShadeColour(
        ranges.shade_green.drawn(seed, "shade_green"),
        ranges.shade_blue_over_red.drawn(seed, "shade_blue_over_red"),
    )
    elevation = ranges.sun_elevation_deg
    yaw_error_deg = ranges.yaw_error_deg.drawn(seed, "yaw_error_deg")
    return Conditions(
        camera=_camera(ranges, seed),
        light=LightSettings(altitude_m=altitude_m, shade=shade),
        feed=_feed(ranges, seed),
        relief_m=ranges.relief_m.drawn(seed, "relief_m"),
        yaw_error_deg=yaw_error_deg if _is_drawn(seed, "yaw to the right") else -yaw_error_deg,
        sun_elevation_deg=None if elevation is None else elevation.drawn(seed, "sun_elevation_deg"),
        is_morning=_is_drawn(seed, "morning"),
    )


def _camera(ranges: ConditionRanges, seed: int) -> CameraSettings:
    def drawn(name: str) -> float:
        values: Range = getattr(ranges, name)
        return values.drawn(seed, name)

    exposure = ExposureSettings(
        follows=drawn("exposure_follows"),
        lag_s=drawn("exposure_lag_s"),
        drift_stops=drawn("exposure_drift_stops"),
        white_balance=drawn("white_balance") / LARGEST_DEVIATION,
        highlight_level=drawn("highlight_level"),
    )
    return CameraSettings(
        seed,
        lens=LensSettings(drawn("rim_falloff"), SOFT_RIM_PX, drawn("lens_blue_over_red")),
        exposure=exposure.locked() if ranges.exposure_locked else exposure,
        tone=ToneSettings(drawn("knee"), drawn("contrast")),
        tint=(drawn("tint_red"), 1.0, drawn("tint_blue")),
        hot_spot=drawn("hot_spot"),
        hot_spot_deg=drawn("hot_spot_deg"),
    )


def _feed(ranges: ConditionRanges, seed: int) -> FeedSettings:
    share = ranges.jpeg_share.drawn(seed, "jpeg_share")
    is_jpeg = Random(f"{seed}/conditions/jpeg").random() < share
    return FeedSettings(
        1.0 / ranges.period_s.drawn(seed, "period_s"),
        ImageFormat.JPEG if is_jpeg else ImageFormat.RAW,
        jpeg_quality=round(ranges.jpeg_quality.drawn(seed, "jpeg_quality")),
    )


def _is_drawn(seed: int, name: str) -> bool:
    return Random(f"{seed}/conditions/{name}").random() < 0.5


SOFT_RIM_PX = 6.0
"""Width over which the image circle's edge fades in real frames, at 1280 columns."""
