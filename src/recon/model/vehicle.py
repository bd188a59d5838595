"""Vehicles: their profiles (configuration) and states (telemetry)."""

from dataclasses import dataclass, field
from enum import Enum, IntEnum

from recon.model.app_report import AppFacts, PhotoTally
from recon.model.geo import GeoPoint, LatLon
from recon.model.mission import DJI
from recon.model.trust import NO_TRUST, Trust
from recon.model.units import Stamped


class FlightMode(IntEnum):
    """DJI flight modes as the ICD numbers them (table 3)."""

    MANUAL = 0
    ATTI = 1
    ATTI_COURSE_LOCK = 2
    GPS_ATTI = 3
    GPS_COURSE_LOCK = 4
    GPS_HOME_LOCK = 5
    GPS_HOT_POINT = 6
    ASSISTED_TAKEOFF = 7
    AUTO_TAKEOFF = 8
    AUTO_LANDING = 9
    GPS_WAYPOINT = 10
    GO_HOME = 11
    JOYSTICK = 12
    GPS_ATTI_WRISTBAND = 13
    DRAW = 14
    GPS_FOLLOW_ME = 15
    ACTIVE_TRACK = 16
    TAP_FLY = 17
    GPS_SPORT = 18
    GPS_NOVICE = 19
    UNKNOWN = 20
    CONFIRM_LANDING = 21
    TERRAIN_FOLLOW = 22
    TRIPOD = 23
    ACTIVE_TRACK_SPOTLIGHT = 24
    MOTORS_JUST_STARTED = 25
    OTHER = 255


class CameraState(IntEnum):
    """State of the DJI camera as the app reports it (field DJICam)."""

    NOT_CONNECTED = 0
    FEED_OFF = 1
    FEED_ON = 2


class BatteryWarning(IntEnum):
    """Warning by the aircraft's own thresholds (field BatWarning)."""

    NONE = 0
    LOW = 1
    SERIOUS = 2


class MissionNumbers(IntEnum):
    """What is known of MissionID in an app's extended telemetry; higher values are known better."""

    UNKNOWN = 0
    """None reported yet: some apps always send 0."""
    COUNTED = 1
    """Each mission has its own, as far as is known."""
    REPEATED = 2
    """Several missions had the same one: it shows nothing."""


class AltitudeReference(Enum):
    """What a waypoint's altitude field means to a vehicle's app. Never guessed."""

    UNSET = "unset"
    WGS84 = "wgs84"
    TAKEOFF = "takeoff"


class Mount(Enum):
    """Camera mount: a gimbal keeps it level, a fixed mount tilts with the aircraft."""

    GIMBAL = "gimbal"
    FIXED = "fixed"


class Failsafe(Enum):
    """What the aircraft does when its controller signal is lost."""

    GO_HOME = "go_home"
    HOVER = "hover"
    LAND = "land"


LIVE_UNDER_S = 1.0
"""Core telemetry comes at 10 Hz: a second is ten missing packets."""
LATE_UNDER_S = 3.0
"""Running video causes dropouts of a second or two in the field: until then it may just be late."""
LOST_UNDER_S = 10.0
ENOUGH_SATELLITES = 8
"""With fewer a position may be off by tens of metres."""


class Staleness(Enum):
    """Age of the newest core telemetry: under 1 s, 3 s, 10 s, or older / never received."""

    LIVE = "live"
    LATE = "late"
    LOST = "lost"
    SILENT = "silent"


def staleness_at(age_s: float | None) -> Staleness:
    """Return the tier of an age of core telemetry in seconds; None: never received."""
    if age_s is None or age_s >= LOST_UNDER_S:
        return Staleness.SILENT
    if age_s >= LATE_UNDER_S:
        return Staleness.LOST
    return Staleness.LATE if age_s >= LIVE_UNDER_S else Staleness.LIVE


@dataclass(frozen=True, slots=True)
class VehicleProfile:
    """Configuration of a vehicle, by serial in site.toml."""

    serial: str
    name: str = ""
    model: str = "unknown model"
    number: int | None = None
    """The number a person gave it; None: the station gives it one."""
    camera: str | None = None
    """The name of its survey camera; None when not configured."""
    waypoint_altitude: AltitudeReference = AltitudeReference.UNSET
    mount: Mount = Mount.GIMBAL
    pad: GeoPoint | None = None
    max_waypoints: int = DJI.max_waypoints
    """0: its aircraft takes no missions; the station steers it along its paths."""
    battery_factor: float = 1.0
    """Multiplies the reported battery fraction: 2 for an app that halves it."""
    video_latency_s: float = 0.5
    """Capture-to-receive latency of image packets, which carry no time of their own."""
    video_latency_sigma_s: float = 0.25
    endurance_s: float | None = None
    """Hover time of a full battery; None when not configured."""
    go_home_height_m: float | None = None
    """Height above takeoff to which the aircraft climbs before it flies home. Set in the aircraft
    and repeated here; an app that reports it is compared with this."""
    failsafe: Failsafe | None = None
    camera_interval_s: float | None = None
    """Interval of the camera's timer, started by the pilot: the ICD has no shutter command."""
    priority: int = 0
    """Priority in a conflict of two vehicles: the one with the lower number is held first."""
    packet_gap_s: float = 0.1
    """Least time between two packets to the app; some apps read one packet per segment."""
    pad_place: LatLon | None = field(init=False, repr=False, compare=False)
    """The pad's place alone, made once: every prediction asks where home is."""

    def __post_init__(self) -> None:
        pad = self.pad
        place = None if pad is None else LatLon(pad.latitude_deg, pad.longitude_deg)
        object.__setattr__(self, "pad_place", place)

    @property
    def display_name(self) -> str:
        """The name shown to operators: the configured one, else the serial."""
        return self.name or self.serial


@dataclass(frozen=True, slots=True)
class Attitude:
    """Yaw clockwise from north, pitch nose up, roll right side down, in degrees."""

    yaw_deg: float
    pitch_deg: float
    roll_deg: float


@dataclass(frozen=True, slots=True)
class VelocityNed:
    """Velocity in metres per second, north-east-down."""

    north_mps: float
    east_mps: float
    down_mps: float

    @property
    def speed_mps(self) -> float:
        """Length of the three-dimensional velocity."""
        return float((self.north_mps**2 + self.east_mps**2 + self.down_mps**2) ** 0.5)


@dataclass(frozen=True, slots=True)
class TrackPoint:
    """One past position of a vehicle."""

    at_ns: int
    latitude_deg: float
    longitude_deg: float
    height_above_takeoff_m: float | None


@dataclass(frozen=True, slots=True)
class GoHomeFlight:
    """A flight home by the aircraft's own go-home, as telemetry has shown it since it began.

    Begun in mode GO_HOME and until that or its landing ends. `nearest_m` is the least distance to
    home so far, `highest_m` the greatest height above takeoff; `progress_at_ns` is when either last
    grew better. `level_from` is where it set out level for home, None while it brakes and climbs.
    None: never known.
    """

    since_ns: int
    start_height_m: float | None
    start_speed_mps: float
    nearest_m: float | None
    highest_m: float | None
    progress_at_ns: int
    level_from: LatLon | None = None


@dataclass(frozen=True)
class VehicleState:
    """Telemetry of one vehicle, each value with its receive time.

    Heights are above the vehicle's own takeoff point (barometric) unless the name states another;
    `reported_altitude_m` is the app's WGS84 altitude, which may be off by tens of metres.
    """

    serial: str | None
    link_id: int | None = None
    profile: VehicleProfile | None = None
    is_simulated: bool = False
    is_flying: Stamped[bool] = Stamped()
    """Believed state (`fleet.airborne`), not the reported one; None: it may be in the air."""
    reported_is_flying: Stamped[bool] = Stamped()
    position: Stamped[LatLon] = Stamped()
    height_above_takeoff_m: Stamped[float] = Stamped()
    reported_altitude_m: Stamped[float] = Stamped()
    velocity_ned: Stamped[VelocityNed] = Stamped()
    attitude: Stamped[Attitude] = Stamped()
    battery_fraction: Stamped[float] = Stamped()
    battery_warning: Stamped[BatteryWarning] = Stamped()
    gnss_satellite_count: Stamped[int] = Stamped()
    gnss_signal_level: Stamped[int] = Stamped()
    wind_level: Stamped[int] = Stamped()
    max_height_reached: Stamped[bool] = Stamped()
    max_distance_reached: Stamped[bool] = Stamped()
    camera_state: Stamped[CameraState] = Stamped()
    flight_mode: Stamped[FlightMode] = Stamped()
    mission_id: Stamped[int] = Stamped()
    mission_numbers: MissionNumbers = MissionNumbers.UNKNOWN
    newest_mission_id: int = 0
    """Id of its newest mission; 0 if the app reported none, as one that was restarted meanwhile."""
    core_received_at_ns: int | None = None
    extended_received_at_ns: int | None = None
    image_received_at_ns: int | None = None
    image_count: int = 0
    altitude_offset_m: Stamped[float] = Stamped()
    """Altitude minus height above takeoff of one packet: the waypoint offset of a wgs84 app."""
    altitude_offset_at_takeoff_m: float | None = None
    takeoff_point: LatLon | None = None
    airborne_since_ns: int | None = None
    """Time of takeoff, or of first telemetry in flight if not observed; None on the ground."""
    rival_link_ids: tuple[int, ...] = ()
    """Other open links that claim this serial, until identity is resolved."""
    in_conflict: bool = False
    """Whether the old link kept sending after a rival appeared: the operator must resolve it."""
    track: tuple[TrackPoint, ...] = field(default=())
    trust: Trust = NO_TRUST
    go_home: GoHomeFlight | None = None
    app_facts: Stamped[AppFacts] = Stamped()
    """What its app has read of the aircraft's settings; None: it reports none."""
    photo_tally: PhotoTally | None = None
    """Its photos, if its app reports them."""

    @property
    def flies_missions(self) -> bool:
        """Whether its aircraft takes missions: what its app has told, else its profile."""
        facts = self.app_facts.value
        if facts is not None and facts.can_fly_missions is not None:
            return facts.can_fly_missions
        return self.profile is None or self.profile.max_waypoints >= DJI.min_waypoints

    @property
    def display_name(self) -> str:
        """The name shown to operators."""
        if self.profile is not None:
            return self.profile.display_name
        return self.serial if self.serial is not None else f"unidentified link {self.link_id}"
