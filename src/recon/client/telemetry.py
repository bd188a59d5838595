"""What is known of a vehicle, each value with its age at the moment it is handed out."""

from typing import Any, Generic, TypeVar

import msgspec

from recon.model.vehicle import Staleness, staleness_at

T = TypeVar("T")

_GROWING_WORSE = tuple(Staleness)


class Aged(msgspec.Struct, Generic[T], frozen=True):
    """A value with its age in seconds; `value` is None while it is unknown."""

    value: T | None
    age_s: float | None


class Position(msgspec.Struct, frozen=True):
    """Where a vehicle is (WGS84), in degrees."""

    latitude_deg: float | None
    longitude_deg: float | None
    age_s: float | None


class Velocity(msgspec.Struct, frozen=True):
    """How a vehicle moves: metres per second, north-east-down."""

    north_mps: float | None
    east_mps: float | None
    down_mps: float | None
    age_s: float | None


class Heading(msgspec.Struct, frozen=True):
    """Yaw clockwise from north, pitch nose up, roll right side down, in degrees."""

    yaw_deg: float | None
    pitch_deg: float | None
    roll_deg: float | None
    age_s: float | None


class ControlAuthority(msgspec.Struct, frozen=True):
    """Who may set a vehicle in motion: pilot, operator or guidance, and how that came about.

    `age_s` is None when nobody has taken it since the station began.
    """

    holder: str
    holder_name: str
    age_s: float | None
    reason: str


class Telemetry(msgspec.Struct, frozen=True, kw_only=True):
    """One vehicle's newest state. Heights are above its own takeoff point (barometric).

    All ages count to the moment this value was handed out, the way from the station included.
    `staleness` says how old the core telemetry is; act only on what is live.
    """

    serial: str | None
    link_id: int | None
    name: str
    is_simulated: bool
    authority: ControlAuthority
    staleness: Staleness
    telemetry_age_s: float | None
    is_flying: Aged[bool]
    position: Position
    height_above_takeoff_m: Aged[float]
    velocity_ned: Velocity
    attitude: Heading
    battery_fraction: Aged[float]
    battery_warning: Aged[str]
    gnss_satellite_count: Aged[float]
    flight_mode: Aged[str]
    mission_id: Aged[float]
    camera_state: Aged[str]
    conflict_link_ids: tuple[int, ...]

    @property
    def is_live(self) -> bool:
        """Whether the core telemetry is younger than a second."""
        return self.staleness is Staleness.LIVE

    @property
    def is_connected(self) -> bool:
        """Whether both kinds of telemetry came and the core one is live."""
        return self.is_live and self.flight_mode.value is not None

    def older_by(self, seconds: float) -> "Telemetry":
        """Return the same state with every age grown, and the staleness that follows from it."""
        changes: dict[str, Any] = {
            name: msgspec.structs.replace(part, age_s=_older(part.age_s, seconds))
            for name in self.__struct_fields__
            if isinstance(
                part := getattr(self, name), Aged | Position | Velocity | Heading | ControlAuthority
            )
        }
        age_s = _older(self.telemetry_age_s, seconds)
        worse = max(self.staleness, staleness_at(age_s), key=_GROWING_WORSE.index)
        return msgspec.structs.replace(self, **changes, telemetry_age_s=age_s, staleness=worse)


def _older(age_s: float | None, seconds: float) -> float | None:
    return None if age_s is None else age_s + seconds
