"""A vehicle's telemetry, each value with its age at the time it is returned."""

from typing import Any, Generic, TypeVar

import msgspec

from recon.model.app_report import AppFacts
from recon.model.vehicle import Staleness, staleness_at

T = TypeVar("T")

_BEST_TO_WORST = tuple(Staleness)


class Aged(msgspec.Struct, Generic[T], frozen=True):
    """A value with its age in seconds; `value` is None while it is unknown."""

    value: T | None
    age_s: float | None


class Position(msgspec.Struct, frozen=True):
    """Position (WGS84), degrees."""

    latitude_deg: float | None
    longitude_deg: float | None
    age_s: float | None


class Velocity(msgspec.Struct, frozen=True):
    """Velocity, metres per second, north-east-down."""

    north_mps: float | None
    east_mps: float | None
    down_mps: float | None
    age_s: float | None


class EulerAngles(msgspec.Struct, frozen=True):
    """Attitude: yaw clockwise from north, pitch nose up, roll right side down, degrees."""

    yaw_deg: float | None
    pitch_deg: float | None
    roll_deg: float | None
    age_s: float | None


class AuthorityStatus(msgspec.Struct, frozen=True):
    """Who may move a vehicle: pilot, operator or guidance, since when and why.

    `age_s` is None if authority has not changed since station start.
    """

    holder: str
    holder_name: str
    age_s: float | None
    reason: str


class LeaseStatus(msgspec.Struct, frozen=True):
    """The person who operates a vehicle. `absent_s` None: a stream of that person is open."""

    person: str
    age_s: float
    absent_s: float | None

    def older_by(self, seconds: float) -> "LeaseStatus":
        """Return this lease with `seconds` added to its ages."""
        return LeaseStatus(self.person, self.age_s + seconds, _older(self.absent_s, seconds))


class PhotosReported(msgspec.Struct, frozen=True):
    """The photos that a vehicle's app has reported: the newest one's index, and those without a
    report."""

    count: int
    missing: int


class FrameStatus(msgspec.Struct, frozen=True):
    """The newest camera frame: its id, and its age as of the message."""

    id: int
    received_age_s: float


class Telemetry(msgspec.Struct, frozen=True, kw_only=True):
    """One vehicle's newest telemetry. Heights are above its takeoff point (barometric), metres.

    All ages are in seconds and count to the time this value was returned, network delay included.
    `staleness` classifies the age of the core telemetry; act only on live values.
    """

    number: int = 0
    """Constant while the station runs; 0: not identified."""
    serial: str | None
    link_id: int | None
    name: str
    is_simulated: bool
    authority: AuthorityStatus
    staleness: Staleness
    telemetry_age_s: float | None
    is_flying: Aged[bool]
    position: Position
    height_above_takeoff_m: Aged[float]
    velocity_ned: Velocity
    attitude: EulerAngles
    battery_fraction: Aged[float]
    battery_warning: Aged[str]
    gnss_satellite_count: Aged[float]
    flight_mode: Aged[str]
    mission_id: Aged[float]
    camera_state: Aged[str]
    conflict_link_ids: tuple[int, ...]
    reported_altitude_m: Aged[float] = Aged(None, None)
    """What the app reports as altitude, whatever its reference."""
    frame: FrameStatus | None = None
    lease: LeaseStatus | None = None
    app_facts: AppFacts | None = None
    """What the app reports of the aircraft's settings; None: it reports none."""
    app_facts_age_s: float | None = None
    photos: PhotosReported | None = None
    newest_photo_age_s: float | None = None

    @property
    def is_live(self) -> bool:
        """Whether the core telemetry is younger than 1 s."""
        return self.staleness is Staleness.LIVE

    @property
    def is_connected(self) -> bool:
        """Whether core telemetry is live and aircraft status was received."""
        return self.is_live and self.flight_mode.value is not None

    def older_by(self, seconds: float) -> "Telemetry":
        """Return this telemetry with `seconds` added to every age, and the staleness then."""
        changes: dict[str, Any] = {
            name: msgspec.structs.replace(part, age_s=_older(part.age_s, seconds))
            for name in self.__struct_fields__
            if isinstance(
                part := getattr(self, name),
                Aged | Position | Velocity | EulerAngles | AuthorityStatus,
            )
        }
        changes["app_facts_age_s"] = _older(self.app_facts_age_s, seconds)
        changes["newest_photo_age_s"] = _older(self.newest_photo_age_s, seconds)
        if self.frame is not None:
            received_age_s = self.frame.received_age_s + seconds
            changes["frame"] = FrameStatus(self.frame.id, received_age_s)
        if self.lease is not None:
            changes["lease"] = self.lease.older_by(seconds)
        age_s = _older(self.telemetry_age_s, seconds)
        worse = max(self.staleness, staleness_at(age_s), key=_BEST_TO_WORST.index)
        return msgspec.structs.replace(self, **changes, telemetry_age_s=age_s, staleness=worse)


def _older(age_s: float | None, seconds: float) -> float | None:
    return None if age_s is None else age_s + seconds
