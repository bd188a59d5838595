"""What a companion app tells in texts of the extension `recon 1` (docs/icd.md).

Every value is None when the app does not know it. They are reports of a peer: compared with the
site and shown with their age, never taken as measured.
"""

from dataclasses import dataclass
from enum import Enum

from recon.model.geo import LatLon


class RtkState(Enum):
    """State of the aircraft's RTK receiver."""

    OFF = "off"
    NONE = "none"
    """On, without corrections."""
    SINGLE = "single"
    FLOAT = "float"
    FIXED = "fixed"


class AppOrder(Enum):
    """Orders of the extension that an app may take."""

    LOCK_CAMERA = "lock_camera"


class AppAction(Enum):
    """What an app reports the outcome of."""

    MISSION_UPLOAD = "mission_upload"
    MISSION_LOAD = "mission_load"
    MISSION_START = "mission_start"
    MISSION_FLIGHT = "mission_flight"
    LOCK_CAMERA = "lock_camera"
    UNLOCK_CAMERA = "unlock_camera"
    HOVER = "hover"
    LAND = "land"
    GO_HOME = "go_home"
    VIRTUAL_STICK = "virtual_stick"
    VIDEO = "video"


@dataclass(frozen=True, slots=True)
class AppFacts:
    """Settings and state of an aircraft as its app has read them; heights above takeoff."""

    go_home_height_m: float | None = None
    failsafe: str | None = None
    """`go_home`, `hover` or `land`."""
    home_latitude_deg: float | None = None
    home_longitude_deg: float | None = None
    max_height_m: float | None = None
    max_distance_m: float | None = None
    """The greatest distance from home, if one is set in the aircraft."""
    model: str | None = None
    firmware: str | None = None
    app: str | None = None
    battery_cells_v: tuple[float, ...] | None = None
    battery_temperature_c: float | None = None
    """The warmest battery's."""
    rtk: RtkState | None = None
    storage_left_mb: int | None = None
    storage_left_photos: int | None = None
    gimbal_yaw_deg: float | None = None
    """0 north, clockwise."""
    gimbal_pitch_deg: float | None = None
    gimbal_roll_deg: float | None = None
    camera_mode: str | None = None
    photo_interval_s: float | None = None
    """Interval of the camera's timer as it is set, running or not."""
    exposure_locked: bool | None = None
    white_balance_locked: bool | None = None
    can_fly_missions: bool | None = None
    max_waypoints: int | None = None
    dji_check_passed: bool | None = None
    dji_check: str | None = None
    """The answer of the app's check with DJI, as a sentence."""
    reports_photos: bool | None = None
    photo_series: int | None = None
    photo_count: int | None = None
    """Photos of the series so far: the index of the newest one."""
    orders: tuple[AppOrder, ...] | None = None

    @property
    def home(self) -> LatLon | None:
        """The home point, when both of its coordinates are known."""
        if self.home_latitude_deg is None or self.home_longitude_deg is None:
            return None
        return LatLon(self.home_latitude_deg, self.home_longitude_deg)


@dataclass(frozen=True, slots=True)
class ReportedPhoto:
    """One release of the shutter, as the app reports it."""

    index: int
    """1 for the first of its series; each photo has the next one."""
    age_s: float
    """Age of the photo when its report was sent."""
    time_utc_ms: int | None = None
    """Time of the app's clock, which may be wrong, in milliseconds since 1970."""
    latitude_deg: float | None = None
    longitude_deg: float | None = None
    height_above_takeoff_m: float | None = None
    yaw_deg: float | None = None
    """The aircraft's heading, 0 north, clockwise."""
    gimbal_pitch_deg: float | None = None
    lens: str | None = None
    file: str | None = None
    """Name of its file on the card."""

    @property
    def place(self) -> LatLon | None:
        """Where it was taken, when both coordinates are known."""
        if self.latitude_deg is None or self.longitude_deg is None:
            return None
        return LatLon(self.latitude_deg, self.longitude_deg)


@dataclass(frozen=True, slots=True)
class PhotosReport:
    """Photos since the last report, oldest first, all of one series."""

    series: int
    photos: tuple[ReportedPhoto, ...]
    serial: str | None = None
    """The aircraft that took them; None: that of the link."""


@dataclass(frozen=True, slots=True)
class OutcomeReport:
    """How an action of the app ended, with DJI's code where it failed."""

    action: AppAction
    ok: bool
    code: str | None = None
    text: str | None = None
    mission_id: int | None = None


@dataclass(frozen=True, slots=True)
class PhotoTally:
    """The photos that a vehicle's app has reported, of its newest series."""

    series: int
    newest_index: int = 0
    reported: int = 0
    """Photos whose report came; fewer than the newest index where reports are missing."""
    newest_at_ns: int | None = None
    """When the newest one was taken, in the station's time."""

    @property
    def missing(self) -> int:
        """Photos of the series whose place is unknown, as no report of them came."""
        return self.newest_index - self.reported
