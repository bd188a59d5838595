"""What the app says of its aircraft: the truth, as GNSS and barometer would tell it."""

from dataclasses import dataclass, field
from math import exp, sqrt
from random import Random

from recon import wire
from recon.geo import geo_from_enu
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.vehicle import CameraState
from recon.sim.aircraft import Aircraft
from recon.sim.camera_feed import CameraFeed

FEW_SATELLITES = 3
"""One fewer than a position takes."""


@dataclass(frozen=True, slots=True)
class SensorSettings:
    """How wrong the sensors are; the wander is a slow random walk that is pulled back to 0."""

    altitude_bias_m: float = 0.0
    position_sigma_m: float = 0.15
    height_sigma_m: float = 0.10
    wander_time_s: float = 30.0


@dataclass(slots=True)
class Wander:
    """A first-order Gauss-Markov process."""

    sigma: float
    time_s: float
    value: float = 0.0

    def step(self, seconds: float, random: Random) -> float:
        """Go on for `seconds` and return the value."""
        keep = exp(-seconds / self.time_s)
        self.value = keep * self.value + sqrt(1.0 - keep * keep) * random.gauss(0.0, self.sigma)
        return self.value


@dataclass(slots=True)
class Sensors:
    """Turns an aircraft's true state into telemetry packets."""

    home: GeoPoint
    settings: SensorSettings
    random: Random
    _north: Wander = field(init=False)
    _east: Wander = field(init=False)
    _height: Wander = field(init=False)
    _satellites: int = field(init=False)

    def __post_init__(self) -> None:
        time_s = self.settings.wander_time_s
        self._north = Wander(self.settings.position_sigma_m, time_s)
        self._east = Wander(self.settings.position_sigma_m, time_s)
        self._height = Wander(self.settings.height_sigma_m, time_s)
        self._satellites = self.random.randint(14, 19)

    def core(self, aircraft: Aircraft, seconds: float) -> wire.CoreTelemetry:
        """Return core telemetry, `seconds` after the last one."""
        motion = aircraft.motion
        latitude, longitude = position_deg(
            self.home,
            motion.north_m + self._north.step(seconds, self.random),
            motion.east_m + self._east.step(seconds, self.random),
        )
        height = motion.height_m + self._height.step(seconds, self.random)
        return wire.CoreTelemetry(
            is_flying=int(aircraft.is_flying),
            latitude_deg=latitude,
            longitude_deg=longitude,
            # takeoffLocationAltitude + altitude (ICD 3.1.1): the bias cancels in differences.
            altitude_m=self.home.ellipsoid_height_m + self.settings.altitude_bias_m + height,
            height_above_takeoff_m=height,
            velocity_north_mps=motion.velocity_north_mps,
            velocity_east_mps=motion.velocity_east_mps,
            velocity_down_mps=-motion.velocity_up_mps,
            yaw_deg=motion.yaw_deg,
            pitch_deg=motion.pitch_deg,
            roll_deg=motion.roll_deg,
        )

    def extended(
        self, aircraft: Aircraft, feed: CameraFeed | None, serial: bytes, has_gnss: bool = True
    ) -> wire.ExtendedTelemetry:
        """Return extended telemetry."""
        return wire.ExtendedTelemetry(
            gnss_satellite_count=self._satellites if has_gnss else FEW_SATELLITES,
            gnss_signal_level=5 if has_gnss else 0,
            max_height_reached=0,
            max_distance_reached=0,
            battery_percent=aircraft.battery.percent,
            battery_warning=aircraft.battery.warning,
            wind_level=0,
            camera_state=_camera_state(feed),
            flight_mode=aircraft.flight_mode,
            mission_id=aircraft.mission_id,
            serial=serial,
        )


def position_deg(home: GeoPoint, north_m: float, east_m: float) -> tuple[float, float]:
    """Return latitude and longitude of a place in home metres."""
    latitude, longitude, _ = geo_from_enu(LocalFrame(home), (east_m, north_m, 0.0))
    return float(latitude[0]), float(longitude[0])


def _camera_state(feed: CameraFeed | None) -> CameraState:
    if feed is None:
        return CameraState.NOT_CONNECTED
    return CameraState.FEED_ON if feed.is_on else CameraState.FEED_OFF
