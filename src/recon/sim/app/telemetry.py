"""What the app says of its aircraft: the truth, as GNSS and barometer would tell it."""

from dataclasses import dataclass, field
from math import exp, sqrt
from random import Random

from recon import wire
from recon.geo import tangent_plane
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.vehicle import CameraState
from recon.sim.app.camera_feed import CameraFeed
from recon.sim.flight.aircraft import Aircraft

FEW_SATELLITES = 3
"""One fewer than a position takes."""


@dataclass(frozen=True, slots=True)
class TelemetrySensorSettings:
    """How wrong the sensors are; each wander is a random walk that is pulled back to 0.

    Errors count from takeoff, where the home point is recorded with the same ones.
    """

    position_sigma_m: float = 0.15
    height_sigma_m: float = 0.10
    wander_time_s: float = 30.0
    """Of the two above: satellites come and go, gusts press on the barometer."""
    position_drift_m: float = 0.0
    """As satellites move on and the ionosphere changes."""
    position_drift_time_s: float = 400.0
    height_drift_m: float = 0.0
    """As the air pressure changes and the barometer warms up."""
    height_drift_time_s: float = 900.0


FIELD_SENSORS = TelemetrySensorSettings(position_drift_m=0.7, height_drift_m=0.8)
"""Good to metres, as outside: twice these within a quarter of an hour is nothing unusual."""


@dataclass(slots=True)
class HomeAltitude:
    """The takeoff altitude that the app believes in: DJI's is tens of metres off, or worse.

    An app adds it to heights it tells, and subtracts it from waypoints' altitudes (ICD 3.1.1,
    3.2.3), so that a constant error cancels and one that changes in between does not.
    """

    true_m: float
    bias_m: float = 0.0
    fault_m: float = 0.0
    """What a fault adds: NaN where DJI tells none, a jump where it tells that of another flight."""

    @property
    def believed_m(self) -> float:
        """WGS84, in metres; NaN when unknown."""
        return self.true_m + self.bias_m + self.fault_m


@dataclass(slots=True)
class GaussMarkov:
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
class SensorError:
    """What one sensor is off by: something quick and something slow."""

    quick: GaussMarkov
    slow: GaussMarkov

    def step(self, seconds: float, random: Random, slow_random: Random) -> float:
        """Go on for `seconds` and return the sum."""
        return self.quick.step(seconds, random) + self.slow.step(seconds, slow_random)


@dataclass(slots=True)
class TelemetrySensors:
    """Turns an aircraft's true state into telemetry packets."""

    home: GeoPoint
    altitude: HomeAltitude
    settings: TelemetrySensorSettings
    random: Random
    slow_random: Random
    """Of the slow errors, which go on however often the quick ones are drawn."""
    _north: "SensorError" = field(init=False)
    _east: "SensorError" = field(init=False)
    _height: "SensorError" = field(init=False)
    _satellites: int = field(init=False)

    def __post_init__(self) -> None:
        s = self.settings
        level = (s.position_sigma_m, s.position_drift_m, s.position_drift_time_s)
        upright = (s.height_sigma_m, s.height_drift_m, s.height_drift_time_s)
        self._north, self._east, self._height = (
            SensorError(GaussMarkov(quick, s.wander_time_s), GaussMarkov(slow, slow_s))
            for quick, slow, slow_s in (level, level, upright)
        )
        self._satellites = self.random.randint(14, 19)

    def core(self, aircraft: Aircraft, seconds: float) -> wire.CoreTelemetry:
        """Return core telemetry, `seconds` after the last one."""
        motion = aircraft.motion
        latitude, longitude = position_deg(
            self.home,
            motion.north_m + self._north.step(seconds, self.random, self.slow_random),
            motion.east_m + self._east.step(seconds, self.random, self.slow_random),
        )
        height = motion.height_m + self._height.step(seconds, self.random, self.slow_random)
        return wire.CoreTelemetry(
            is_flying=int(aircraft.is_flying),
            latitude_deg=latitude,
            longitude_deg=longitude,
            # takeoffLocationAltitude + altitude (ICD 3.1.1): the bias cancels in differences.
            altitude_m=self.altitude.believed_m + height,
            height_above_takeoff_m=height,
            velocity_north_mps=motion.velocity_north_mps,
            velocity_east_mps=motion.velocity_east_mps,
            velocity_down_mps=-motion.velocity_up_mps,
            yaw_deg=motion.yaw_deg,
            pitch_deg=motion.pitch_deg,
            roll_deg=motion.roll_deg,
        )

    def extended(
        self,
        aircraft: Aircraft,
        feed: CameraFeed | None,
        serial: bytes,
        reports_mission_id: bool = True,
    ) -> wire.ExtendedTelemetry:
        """Return extended telemetry."""
        return wire.ExtendedTelemetry(
            gnss_satellite_count=self._satellites if aircraft.has_gnss else FEW_SATELLITES,
            gnss_signal_level=5 if aircraft.has_gnss else 0,
            max_height_reached=int(aircraft.is_at_max_height),
            max_distance_reached=int(aircraft.is_at_max_distance),
            battery_percent=aircraft.battery.percent,
            battery_warning=aircraft.battery.warning,
            wind_level=aircraft.air.warning_level,
            camera_state=_camera_state(feed),
            flight_mode=aircraft.flight_mode,
            mission_id=aircraft.mission_id if reports_mission_id else 0,
            serial=serial,
        )


def position_deg(home: GeoPoint, north_m: float, east_m: float) -> tuple[float, float]:
    """Return latitude and longitude of a place in home metres."""
    latitude_deg, longitude_deg, _ = tangent_plane(LocalFrame(home)).place(east_m, north_m, 0.0)
    return latitude_deg, longitude_deg


def _camera_state(feed: CameraFeed | None) -> CameraState:
    if feed is None:
        return CameraState.NOT_CONNECTED
    return CameraState.FEED_ON if feed.is_on else CameraState.FEED_OFF
