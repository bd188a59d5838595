"""Telemetry packets: the aircraft's estimate of its state, with the noise of GNSS and barometer."""

from dataclasses import dataclass, field
from random import Random

from recon import wire
from recon.geo import TangentPlane, tangent_plane
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.units import wrap_degrees
from recon.model.vehicle import CameraState
from recon.sim.app.camera_feed import CameraFeed
from recon.sim.flight.aircraft import Aircraft
from recon.sim.flight.estimate import GaussMarkov

FEW_SATELLITES = 3
"""One fewer than a position fix needs."""


@dataclass(frozen=True, slots=True)
class TelemetrySensorSettings:
    """Standard deviations and time constants of the fast errors, in telemetry alone (first-order
    Gauss-Markov); slow ones are in what an aircraft flies by (`DriftSettings`)."""

    position_sigma_m: float = 0.15
    height_sigma_m: float = 0.10
    wander_time_s: float = 30.0
    """Time constant of both: satellites change, gusts change the static pressure."""
    yaw_error_deg: float = 0.0
    """Reported minus true yaw: the compass near metal and motors, for a whole flight."""


@dataclass(slots=True)
class HomeAltitude:
    """The takeoff altitude in the app: DJI's is tens of metres off, or worse.

    An app adds it to the heights it reports and subtracts it from waypoint altitudes (ICD 3.1.1,
    3.2.3): a constant error cancels, one that changes in between does not.
    """

    true_m: float
    bias_m: float = 0.0
    fault_m: float = 0.0
    """Error added by a fault: NaN when DJI gives none, a step when it gives another flight's."""

    @property
    def believed_m(self) -> float:
        """The app's takeoff altitude, WGS84, in metres; NaN when unknown."""
        return self.true_m + self.bias_m + self.fault_m


@dataclass(slots=True)
class TelemetrySensors:
    """Makes telemetry packets from an aircraft's estimate of its state, with fast errors."""

    home: GeoPoint
    altitude: HomeAltitude
    settings: TelemetrySensorSettings
    random: Random
    _noise: tuple[GaussMarkov, ...] = field(init=False)
    """Noise of north, east and height."""
    _satellites: int = field(init=False)
    _plane: TangentPlane = field(init=False)

    def __post_init__(self) -> None:
        s = self.settings
        sigmas_m = (s.position_sigma_m, s.position_sigma_m, s.height_sigma_m)
        self._noise = tuple(GaussMarkov(sigma_m, s.wander_time_s) for sigma_m in sigmas_m)
        self._satellites = self.random.randint(14, 19)
        self._plane = tangent_plane(LocalFrame(self.home))

    def core(
        self,
        aircraft: Aircraft,
        seconds: float,
        *,
        is_flying: bool | None = None,
        north_deg: float = 0.0,
    ) -> wire.CoreTelemetry:
        """Return core telemetry (ICD 3.1.1), `seconds` after the previous packet.

        `is_flying` replaces the aircraft's flag and `north_deg` is added to its latitude: faults.
        """
        motion = aircraft.estimate
        north_m, east_m, up_m = (axis.step(seconds, self.random) for axis in self._noise)
        latitude, longitude, _ = self._plane.place(
            motion.east_m + east_m, motion.north_m + north_m, 0.0
        )
        height = motion.height_m + up_m
        return wire.CoreTelemetry(
            is_flying=int(aircraft.is_flying if is_flying is None else is_flying),
            latitude_deg=latitude + north_deg,
            longitude_deg=longitude,
            # takeoffLocationAltitude + altitude (ICD 3.1.1): the bias cancels in differences.
            altitude_m=self.altitude.believed_m + height,
            height_above_takeoff_m=height,
            velocity_north_mps=motion.velocity_north_mps,
            velocity_east_mps=motion.velocity_east_mps,
            velocity_down_mps=-motion.velocity_up_mps,
            yaw_deg=wrap_degrees(motion.yaw_deg + self.settings.yaw_error_deg),
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
        """Return extended telemetry (ICD, ExtendedTelemetry)."""
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
    """Return latitude and longitude, degrees, of a point in metres from home."""
    latitude_deg, longitude_deg, _ = tangent_plane(LocalFrame(home)).place(east_m, north_m, 0.0)
    return latitude_deg, longitude_deg


def _camera_state(feed: CameraFeed | None) -> CameraState:
    if feed is None:
        return CameraState.NOT_CONNECTED
    return CameraState.FEED_ON if feed.is_on else CameraState.FEED_OFF
