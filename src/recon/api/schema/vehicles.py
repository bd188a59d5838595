"""What the station tells of vehicles."""

from typing import Literal

from pydantic import Field

from recon.api.schema.message import Message


class AgedNumber(Message):
    """A number with its age."""

    value: float | None
    age_s: float | None


class AgedFlag(Message):
    """A yes or no with its age."""

    value: bool | None
    age_s: float | None


class AgedText(Message):
    """A word with its age."""

    value: str | None
    age_s: float | None


class PositionView(Message):
    """Where a vehicle is (WGS84)."""

    latitude_deg: float | None
    longitude_deg: float | None
    age_s: float | None


class VelocityView(Message):
    """How a vehicle moves: metres per second, north-east-down."""

    north_mps: float | None
    east_mps: float | None
    down_mps: float | None
    age_s: float | None


class AttitudeView(Message):
    """Yaw clockwise from north, pitch nose up, roll right side down."""

    yaw_deg: float | None
    pitch_deg: float | None
    roll_deg: float | None
    age_s: float | None


class FrameView(Message):
    """The newest camera frame of a vehicle, to be fetched by its id."""

    id: int
    received_age_s: float
    captured_age_s: float
    captured_sigma_s: float


class HazardView(Message):
    """Where a vehicle may be that is not heard any more: a circle that grows, and its way home.

    It stays until telemetry comes, or until somebody who knows where the vehicle is dismisses it.
    """

    dismissed_as: str = Field(description="what to name when dismissing it: the serial, or a link")
    age_s: float
    latitude_deg: float
    longitude_deg: float
    radius_m: float
    growth_mps: float
    largest_radius_m: float
    corridor: list[tuple[float, float]] = Field(
        description="longitude, latitude: from the last place to home; empty when it goes nowhere"
    )
    corridor_half_width_m: float


AuthorityWord = Literal["pilot", "operator", "guidance"]


class AuthorityView(Message):
    """Who may set a vehicle in motion, and how that came about; anybody may stop it."""

    holder: AuthorityWord
    holder_name: str
    age_s: float | None = Field(description="null: since the station began")
    reason: str


class OverrideView(Message):
    """Somebody's word that a vehicle may fly missions without its checklist; it ends with the
    landing."""

    by: str
    reason: str
    age_s: float


class SteeringView(Message):
    """Where the station steers a vehicle with sticks, for the order of this number."""

    command_id: int
    latitude_deg: float
    longitude_deg: float
    height_above_takeoff_m: float
    speed_mps: float
    has_arrived: bool = Field(description="it holds the place")
    is_ending: bool = Field(description="zero has been sent, and a hold follows")


StalenessWord = Literal["live", "late", "lost", "silent"]


class VehicleView(Message):
    """One vehicle. `number` is stable for the life of the station: colour and shortcut."""

    number: int
    serial: str | None
    link_id: int | None
    name: str
    model: str
    is_simulated: bool
    is_imager: bool
    authority: AuthorityView
    preflight_override: OverrideView | None
    steering: SteeringView | None
    staleness: StalenessWord
    telemetry_age_s: float | None
    is_flying: AgedFlag
    position: PositionView
    height_above_takeoff_m: AgedNumber
    reported_altitude_m: AgedNumber
    velocity_ned: VelocityView
    attitude: AttitudeView
    battery_fraction: AgedNumber
    battery_warning: AgedText
    gnss_satellite_count: AgedNumber
    gnss_signal_level: AgedNumber
    wind_level: AgedNumber
    flight_mode: AgedText
    mission_id: AgedNumber
    camera_state: AgedText
    waypoint_altitude: Literal["unset", "wgs84", "takeoff"]
    conflict_link_ids: list[int]
    track: list[tuple[float, float]] = Field(description="longitude, latitude; oldest first")
    frame: FrameView | None
    hazard: HazardView | None
