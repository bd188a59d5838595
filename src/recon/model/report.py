"""Reports of companion apps, decoded from packets by `vehicles`.

A field is None when the app reports it as unknown or out of range.
"""

from dataclasses import dataclass
from enum import IntEnum

from recon.model.app_report import AppFacts, OutcomeReport, PhotosReport
from recon.model.geo import LatLon
from recon.model.imagery import RgbImage
from recon.model.vehicle import Attitude, BatteryWarning, CameraState, FlightMode, VelocityNed


@dataclass(frozen=True, slots=True)
class CoreReport:
    """Core telemetry (ICD 3.1.1)."""

    is_flying: bool | None
    position: LatLon | None
    """None without a fix: the app then sends 0, 0."""
    reported_altitude_m: float | None
    height_above_takeoff_m: float | None
    velocity_ned: VelocityNed | None
    attitude: Attitude | None


@dataclass(frozen=True, slots=True)
class ExtendedReport:
    """Extended telemetry (ICD 3.1.2). `serial` is None for the placeholder or an empty one."""

    serial: str | None
    gnss_satellite_count: int
    gnss_signal_level: int | None
    max_height_reached: bool | None
    max_distance_reached: bool | None
    battery_fraction: float | None
    battery_warning: BatteryWarning | None
    wind_level: int | None
    camera_state: CameraState | None
    flight_mode: FlightMode | None
    mission_id: int


@dataclass(frozen=True, slots=True, eq=False)
class ImageReport:
    """One image of the video feed: exactly one of `rgb` and `jpeg` is set."""

    target_fps_hz: float | None
    rgb: RgbImage | None = None
    jpeg: bytes | None = None


class AnsweredKind(IntEnum):
    """Which kind of command an acknowledgment names: the command packet's PID."""

    EMERGENCY = 255
    CAMERA = 254
    MISSION = 253
    STICK = 252


@dataclass(frozen=True, slots=True)
class AckReport:
    """An acknowledgment (ICD 3.1.4)."""

    answered: AnsweredKind
    positive: bool


class MessageSeverity(IntEnum):
    """Type of a message string (PID 4)."""

    DEBUG = 0
    INFO = 1
    WARNING = 2
    ERROR = 3


@dataclass(frozen=True, slots=True)
class MessageReport:
    """A text from the app, sanitised for screens and logs."""

    severity: MessageSeverity
    text: str


@dataclass(frozen=True, slots=True)
class IgnoredReport:
    """A well-framed packet that is not acted on: wrong direction, unknown PID, out of range."""

    reason: str


Report = (
    CoreReport
    | ExtendedReport
    | ImageReport
    | AckReport
    | MessageReport
    | AppFacts
    | PhotosReport
    | OutcomeReport
    | IgnoredReport
)
