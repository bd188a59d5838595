"""Vehicles: telemetry, authority, hazard area, steering."""

from typing import Literal

from pydantic import Field, SkipValidation

from recon.api.schema.message import Message


class AgedNumber(Message):
    """A number with its age."""

    value: float | None
    age_s: float | None


class AgedFlag(Message):
    """A boolean with its age."""

    value: bool | None
    age_s: float | None


class AgedText(Message):
    """A text with its age."""

    value: str | None
    age_s: float | None


class PositionView(Message):
    """A vehicle's position (WGS84)."""

    latitude_deg: float | None
    longitude_deg: float | None
    age_s: float | None


class VelocityView(Message):
    """A vehicle's velocity, north-east-down."""

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


class AppFactsView(Message):
    """What a companion app reports of its aircraft (docs/icd.md); null: it does not know."""

    go_home_height_m: float | None = Field(description="above takeoff")
    failsafe: str | None
    home_latitude_deg: float | None
    home_longitude_deg: float | None
    max_height_m: float | None = Field(description="above takeoff")
    max_distance_m: float | None = Field(description="from home")
    model: str | None
    firmware: str | None
    app: str | None
    battery_cells_v: list[float] | None
    battery_temperature_c: float | None
    rtk: str | None
    storage_left_mb: int | None
    storage_left_photos: int | None
    gimbal_yaw_deg: float | None
    gimbal_pitch_deg: float | None
    gimbal_roll_deg: float | None
    camera_mode: str | None
    photo_interval_s: float | None
    exposure_locked: bool | None
    white_balance_locked: bool | None
    can_fly_missions: bool | None
    max_waypoints: int | None
    dji_check_passed: bool | None
    dji_check: str | None
    reports_photos: bool | None
    orders: list[str] | None = Field(description="of the extension, that it takes")


class PhotoTallyView(Message):
    """The photos that a vehicle's app has reported, of its newest series."""

    count: int = Field(description="index of the newest photo")
    missing: int = Field(description="photos of which no report came")


class DoubtView(Message):
    """Why telemetry of a vehicle is not believed; `text` is a sentence without its name."""

    kind: Literal[
        "ground_report",
        "flight_signs",
        "position_jump",
        "frozen_telemetry",
        "position_stands_still",
        "battery_doubted",
    ]
    text: str
    age_s: float = Field(description="since the doubt began")
    packets: int = Field(description="how many packets showed it")


class FrameView(Message):
    """The newest camera frame of a vehicle; fetch it again when the id changes."""

    id: int
    received_age_s: float
    captured_age_s: float
    captured_sigma_s: float


class HazardView(Message):
    """The hazard area of a lost vehicle: a growing circle, and a corridor returning home.

    It stays until telemetry returns, or an operator has located the vehicle and dismisses it.
    """

    dismissal_name: str = Field(description="name for dismissing it: the serial, or a link")
    age_s: float
    latitude_deg: float
    longitude_deg: float
    radius_m: float
    growth_mps: float
    largest_radius_m: float
    corridor: list[tuple[float, float]] = Field(
        description="longitude, latitude: from the last position to home; empty without a return"
    )
    corridor_half_width_m: float


HolderName = Literal["pilot", "operator", "guidance"]


class AuthorityView(Message):
    """The holder may set the vehicle in motion; any client may stop it."""

    holder: HolderName
    holder_name: str
    age_s: float | None = Field(description="null: since the station started")
    reason: str


class LeaseView(Message):
    """The operator lease: the person who operates the vehicle. Every person may stop it."""

    person: str
    age_s: float
    absent_s: float | None = Field(
        description="since that person's last stream closed or last order; null: a stream is open"
    )


class OverrideView(Message):
    """Permission to fly missions without a passed checklist; it ends with the landing."""

    by: str
    reason: str
    age_s: float


class SteeringView(Message):
    """The target of a steered order, flown with virtual sticks."""

    command_id: int
    latitude_deg: float
    longitude_deg: float
    height_above_takeoff_m: float
    speed_mps: float
    has_arrived: bool = Field(description="it holds the position")
    is_ending: bool = Field(description="the neutral setpoint has been sent, and a hold follows")


StalenessName = Literal["live", "late", "lost", "silent"]


class VehicleView(Message):
    """One vehicle. `number`, for colour and shortcut, is constant while the station runs."""

    number: int
    serial: str | None
    link_id: int | None
    name: str
    model: str
    camera: str | None = Field(description="its survey camera in site.toml")
    is_simulated: bool
    is_imager: bool
    authority: AuthorityView
    lease: LeaseView | None = Field(description="null: free, the next order to move takes it")
    is_stopped: bool = Field(
        description="held by an all stop: only hold, land and return are sent until it is released"
    )
    preflight_override: OverrideView | None
    steering: SteeringView | None
    staleness: StalenessName
    telemetry_age_s: float | None
    is_flying: AgedFlag = Field(description="as believed; null: it may be in the air")
    reported_is_flying: AgedFlag
    doubts: list[DoubtView]
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
    flies_missions: bool = Field(description="false: its model is steered along paths instead")
    conflict_link_ids: list[int]
    app_facts: AppFactsView | None = Field(description="null: its app reports none")
    app_facts_age_s: float | None
    photos: PhotoTallyView | None = Field(description="null: its app reports none")
    newest_photo_age_s: float | None
    track: SkipValidation[list[tuple[float, float]]] = Field(
        description="longitude, latitude; oldest first"
    )
    frame: FrameView | None
    hazard: HazardView | None
