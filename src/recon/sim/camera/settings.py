"""Settings of the imaging drone's camera, each with its reason."""

from dataclasses import dataclass, field, replace
from typing import Self

from recon.sim.world.settings import expect


@dataclass(frozen=True, slots=True)
class HoverSettings:
    """Differences between the camera's true pose and the one computed from telemetry."""

    wobble_deg: float = 0.12
    """Standard deviation about each axis; a three-axis gimbal in a light wind."""
    wobble_s: float = 1.5
    """Time in which its correlation falls to 1/e: gusts push, the gimbal follows."""
    mount_error_deg: float = 0.25
    """Standard deviation about each axis, drawn once: gimbal calibration at power-up."""
    drift_m: float = 0.5
    """Standard deviation per axis; GNSS holds a hover within a metre or two."""
    drift_up_m: float = 0.3
    """Standard deviation of the height: the barometer."""
    drift_s: float = 40.0
    """Time in which its correlation falls to 1/e."""

    def __post_init__(self) -> None:
        for name in ("wobble_deg", "mount_error_deg"):
            expect(f"hover: {name}", getattr(self, name), 0.0, 10.0)
        for name in ("drift_m", "drift_up_m"):
            expect(f"hover: {name}", getattr(self, name), 0.0, 20.0)
        for name in ("wobble_s", "drift_s"):
            expect(f"hover: {name}", getattr(self, name), 0.1, 1e6)


@dataclass(frozen=True, slots=True)
class LensSettings:
    """Vignetting and colour of the lens."""

    rim_falloff: float = 0.42
    """Share of light lost at the image circle's rim; grows with the radius to the fourth."""
    soft_rim_px: float = 1.0
    """Width over which the edge of the image circle fades."""
    rim_blue_over_red: float = 1.0
    """How many times more blue than red light passes at the rim than in the middle."""

    def __post_init__(self) -> None:
        expect("lens: rim_falloff", self.rim_falloff, 0.0, 0.95)
        expect("lens: soft_rim_px", self.soft_rim_px, 0.5, 50.0)
        expect("lens: rim_blue_over_red", self.rim_blue_over_red, 0.5, 3.0)


@dataclass(frozen=True, slots=True)
class ExposureSettings:
    """Automatic exposure and white balance."""

    follows: float = 0.7
    """Share of a brightness change, in stops, that auto exposure compensates."""
    lag_s: float = 1.5
    """Time constant of auto exposure."""
    most_stops: float = 2.5
    """Largest deviation from the exposure of full sun."""
    drift_stops: float = 0.05
    """Standard deviation of exposure drift from other causes (metering of grass against soil)."""
    drift_s: float = 45.0
    """Time in which its correlation falls to 1/e."""
    white_balance: float = 0.015
    """Standard deviation of the gains of red and blue relative to green."""
    white_balance_s: float = 90.0
    """Time in which its correlation falls to 1/e: cameras adjust it slowly."""
    highlight_level: float | None = None
    """Pixel value, in green, of the brightest hundredth of the land in full sun: cameras expose for
    the highlights. None: the land is as bright as it is drawn."""

    def __post_init__(self) -> None:
        if self.highlight_level is not None:
            expect("exposure: highlight_level", self.highlight_level, 1.0, 254.0)
        expect("exposure: follows", self.follows, 0.0, 1.0)
        expect("exposure: most_stops", self.most_stops, 0.0, 6.0)
        expect("exposure: drift_stops", self.drift_stops, 0.0, 2.0)
        expect("exposure: white_balance", self.white_balance, 0.0, 0.3)
        for name in ("lag_s", "drift_s", "white_balance_s"):
            expect(f"exposure: {name}", getattr(self, name), 0.1, 1e6)

    def locked(self) -> Self:
        """Return the settings with exposure and white balance as they were set on the ground."""
        return replace(self, follows=0.0, drift_stops=0.0, white_balance=0.0)


@dataclass(frozen=True, slots=True)
class ToneSettings:
    """The tone curve, from light to pixel values."""

    knee: float = 1.0
    """Light, of white, above which highlights are compressed; 1: they are cut off at white."""
    contrast: float = 0.0
    """Strength of the S-shaped contrast, 0 to 1."""

    def __post_init__(self) -> None:
        expect("tone: knee", self.knee, 0.2, 1.0)
        expect("tone: contrast", self.contrast, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class ImageSensorSettings:
    """Sensor noise."""

    full_well: float = 6_000.0
    """Electrons per pixel at white, of a small sensor; shot noise is the square root of it."""
    read_noise: float = 0.0008
    """Standard deviation relative to white: about five electrons."""

    def __post_init__(self) -> None:
        expect("sensor: full_well", self.full_well, 50.0, 1e12)
        expect("sensor: read_noise", self.read_noise, 0.0, 0.2)


@dataclass(frozen=True, slots=True)
class CameraSettings:
    """All effects that make the imaging drone's frames less than perfect."""

    seed: int = 0
    hover: HoverSettings = field(default_factory=HoverSettings)
    lens: LensSettings = field(default_factory=LensSettings)
    exposure: ExposureSettings = field(default_factory=ExposureSettings)
    sensor: ImageSensorSettings = field(default_factory=ImageSensorSettings)
    tone: ToneSettings = field(default_factory=ToneSettings)
    tint: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """Gains of red, green and blue from the camera's white balance and the season's colours."""
    haze_m: float = 9_000.0
    """Distance at which contrast falls to 1/e; clear summer air (visibility about 30 km)."""
    hot_spot: float = 0.28
    """Gain of brightness exactly opposite the sun: leaves hide their own shadows."""
    hot_spot_deg: float = 7.0
    """Angle at which the hot spot falls to 1/e."""

    def __post_init__(self) -> None:
        expect("camera: seed", self.seed, 0, 2**63)
        expect("camera: haze_m", self.haze_m, 100.0, 1e12)
        for gain in self.tint:
            expect("camera: tint", gain, 0.2, 5.0)
        expect("camera: hot_spot", self.hot_spot, 0.0, 2.0)
        expect("camera: hot_spot_deg", self.hot_spot_deg, 0.1, 90.0)

    @classmethod
    def perfect(cls) -> Self:
        """Return a camera without defects, in clean air: only light and lens geometry remain."""
        return cls(
            hover=HoverSettings(wobble_deg=0.0, mount_error_deg=0.0, drift_m=0.0, drift_up_m=0.0),
            lens=LensSettings(rim_falloff=0.0),
            exposure=ExposureSettings(follows=0.0, drift_stops=0.0, white_balance=0.0),
            sensor=ImageSensorSettings(full_well=1e12, read_noise=0.0),
            haze_m=1e12,
            hot_spot=0.0,
        )
