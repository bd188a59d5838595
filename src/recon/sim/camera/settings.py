"""What the eye's camera does to its pictures; a reason stands beside each number."""

from dataclasses import dataclass, field
from typing import Self

from recon.sim.world.settings import expect


@dataclass(frozen=True, slots=True)
class HoverSettings:
    """How the camera hangs: what its pose differs by from the one its aircraft believes in."""

    wobble_deg: float = 0.12
    """Standard deviation about each axis; a three-axis gimbal in a light wind."""
    wobble_s: float = 1.5
    """After which wobble has changed to 1/e: gusts push, the gimbal follows."""
    mount_error_deg: float = 0.25
    """Standard deviation about each axis, drawn once: the gimbal's level after each power-up."""
    drift_m: float = 0.5
    """Standard deviation to each side; GNSS holds a hover within a metre or two."""
    drift_up_m: float = 0.3
    """Standard deviation up and down: the barometer."""
    drift_s: float = 40.0
    """After which drift has changed to 1/e."""

    def __post_init__(self) -> None:
        for name in ("wobble_deg", "mount_error_deg"):
            expect(f"hover: {name}", getattr(self, name), 0.0, 10.0)
        for name in ("drift_m", "drift_up_m"):
            expect(f"hover: {name}", getattr(self, name), 0.0, 20.0)
        for name in ("wobble_s", "drift_s"):
            expect(f"hover: {name}", getattr(self, name), 0.1, 1e6)


@dataclass(frozen=True, slots=True)
class LensSettings:
    """What the lens does to the light."""

    rim_falloff: float = 0.42
    """Part of the light lost at the image circle's rim; it grows with the radius to the fourth."""
    soft_rim_px: float = 1.0
    """Over which the image circle's edge fades."""

    def __post_init__(self) -> None:
        expect("lens: rim_falloff", self.rim_falloff, 0.0, 0.95)
        expect("lens: soft_rim_px", self.soft_rim_px, 0.5, 50.0)


@dataclass(frozen=True, slots=True)
class ExposureSettings:
    """How the camera sets exposure and white balance by itself."""

    follows: float = 0.7
    """Part of the scene's brightness, in stops, that it takes out: cameras keep some of it."""
    lag_s: float = 1.5
    """After which a change of the scene is followed to 1/e."""
    most_stops: float = 2.5
    """Further than this it does not go from the exposure of full sun."""
    drift_stops: float = 0.05
    """Standard deviation of what it drifts by without reason (metering of grass against soil)."""
    drift_s: float = 45.0
    """After which drift has changed to 1/e."""
    white_balance: float = 0.015
    """Standard deviation of red's and blue's drift over green, as a share."""
    white_balance_s: float = 90.0
    """After which white balance has changed to 1/e: cameras turn it slowly."""

    def __post_init__(self) -> None:
        expect("exposure: follows", self.follows, 0.0, 1.0)
        expect("exposure: most_stops", self.most_stops, 0.0, 6.0)
        expect("exposure: drift_stops", self.drift_stops, 0.0, 2.0)
        expect("exposure: white_balance", self.white_balance, 0.0, 0.3)
        for name in ("lag_s", "drift_s", "white_balance_s"):
            expect(f"exposure: {name}", getattr(self, name), 0.1, 1e6)


@dataclass(frozen=True, slots=True)
class ImageSensorSettings:
    """What the sensor adds."""

    full_well: float = 6_000.0
    """Electrons of a pixel at white: a small sensor's; shot noise is the root of their number."""
    read_noise: float = 0.0008
    """Standard deviation over white: some five electrons."""

    def __post_init__(self) -> None:
        expect("sensor: full_well", self.full_well, 50.0, 1e12)
        expect("sensor: read_noise", self.read_noise, 0.0, 0.2)


@dataclass(frozen=True, slots=True)
class CameraSettings:
    """All that makes the eye's pictures less than perfect."""

    seed: int = 0
    hover: HoverSettings = field(default_factory=HoverSettings)
    lens: LensSettings = field(default_factory=LensSettings)
    exposure: ExposureSettings = field(default_factory=ExposureSettings)
    sensor: ImageSensorSettings = field(default_factory=ImageSensorSettings)
    haze_m: float = 9_000.0
    """After which 1/e of what is seen is left; a clear summer day's air (30 km of sight)."""
    hot_spot: float = 0.28
    """How much brighter crops are against the sun's direction: leaves hide their shadows."""
    hot_spot_deg: float = 7.0
    """After which the hot spot has fallen to 1/e."""

    def __post_init__(self) -> None:
        expect("eye: seed", self.seed, 0, 2**63)
        expect("eye: haze_m", self.haze_m, 100.0, 1e12)
        expect("eye: hot_spot", self.hot_spot, 0.0, 2.0)
        expect("eye: hot_spot_deg", self.hot_spot_deg, 0.1, 90.0)

    @classmethod
    def perfect(cls) -> Self:
        """Return a camera without any fault in clean air: light and lens's geometry are left."""
        return cls(
            hover=HoverSettings(wobble_deg=0.0, mount_error_deg=0.0, drift_m=0.0, drift_up_m=0.0),
            lens=LensSettings(rim_falloff=0.0),
            exposure=ExposureSettings(follows=0.0, drift_stops=0.0, white_balance=0.0),
            sensor=ImageSensorSettings(full_well=1e12, read_noise=0.0),
            haze_m=1e12,
            hot_spot=0.0,
        )
