"""What the API says and hears. The console's types are generated from these models.

Ages are seconds at the moment the message was made (`StationState.time_ns`); a reader adds the time
since. `value: null` means unknown. Heights are above the vehicle's own takeoff point unless named
otherwise.
"""

from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator


class Message(BaseModel):
    """Base of all messages: immutable, and unknown keys are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")


# --- what the station tells --------------------------------------------------------------------


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


class GhostView(Message):
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


LeaderWord = Literal["pilot", "operator", "guidance"]


class LeadView(Message):
    """Who may set a vehicle in motion, and how that came about; anybody may stop it."""

    leader: LeaderWord
    holder: str
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
    is_eye: bool
    lead: LeadView
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
    ghost: GhostView | None


class LinkView(Message):
    """One TCP connection of a companion app, with what its bytes have been like."""

    id: int
    remote_address: str
    status: Literal["identified", "unidentified", "conflict", "closed"]
    claimed_serial: str | None
    opened_age_s: float
    last_packet_age_s: float | None
    closed_reason: str | None
    bytes_received: int
    packets_received: int
    images_received: int
    bad_hash: int
    bad_size: int
    unknown_pid: int
    meaningless: int
    bytes_skipped: int
    commands_queued: int
    answers_not_believed: int = Field(description="acknowledgments that may answer another command")


PhaseWord = Literal[
    "queued",
    "sent",
    "acknowledged",
    "confirmed",
    "started",
    "done",
    "refused_by_station",
    "refused_by_app",
    "timed_out",
    "superseded",
    "expired",
    "failed",
]


class PhaseView(Message):
    """One change in a command's life."""

    phase: PhaseWord
    age_s: float
    note: str


class CommandView(Message):
    """One command and its life so far; `history` ends with the present phase."""

    id: int
    kind: str
    serial: str | None
    link_id: int | None
    vehicle_name: str
    issued_by: str
    age_s: float
    phase: PhaseWord
    is_final: bool
    note: str
    times_sent: int
    takeoff: bool
    sent_altitudes: str | None = Field(description="which altitudes a mission was sent with")
    part: str | None = Field(description="the part of a mission flown now, as in 'part 2 of 3'")
    repairs: list[str] = Field(description="what was changed in a mission so that DJI accepts it")
    history: list[PhaseView]


Severity = Literal["critical", "error", "warning", "info"]


class AlarmView(Message):
    """An alarm stays until its cause ends; `is_active` false: ended, not yet acknowledged."""

    id: int
    severity: Severity
    rule: str
    serial: str | None
    link_id: int | None
    vehicle_name: str
    text: str
    raised_age_s: float
    is_active: bool
    is_acknowledged: bool


class GroundImageView(Message):
    """The newest frame laid on the ground; corners are (longitude, latitude) NW, NE, SE, SW."""

    frame_id: int
    serial: str
    captured_age_s: float
    captured_sigma_s: float
    registration: Literal["unregistered"]
    reference: str = Field(description="which telemetry stands for the marked frame")
    corners: list[tuple[float, float]]
    cell_m: float
    rows: int
    cols: int


class LimitsView(Message):
    """What the site allows every vehicle."""

    max_height_above_ground_m: float
    min_height_above_ground_m: float
    max_distance_from_home_m: float
    max_speed_mps: float
    min_separation_horizontal_m: float
    min_separation_vertical_m: float
    boundary_margin_m: float
    battery_reserve_fraction: float


class LayerView(Message):
    """A layer of the site, and the file in its folder that tells it."""

    name: str
    file: str


class AreaView(Message):
    """An outline to draw: closed rings of (longitude, latitude), the outer one first."""

    kind: Literal["boundary", "keep_out", "height", "survey"]
    name: str
    rings: list[list[tuple[float, float]]]
    floor_m: float | None
    ceiling_m: float | None
    datum: Literal["ground", "wgs84"] | None


class PadView(Message):
    """A place to land; `serial` is null for one that any vehicle may use."""

    name: str
    serial: str | None
    longitude_deg: float
    latitude_deg: float
    altitude_m: float = Field(description="above the WGS84 ellipsoid")


class SiteView(Message):
    """The site: its place, what holds in its air, and the quality of the eye's marked pose."""

    name: str
    latitude_deg: float | None
    longitude_deg: float | None
    ground_altitude_m: float | None
    eye_serial: str | None
    pose_rms_px: float | None
    pose_height_m: float | None
    limits: LimitsView
    terrain: Literal["model", "flat assumed"]
    layers: list[LayerView]
    areas: list[AreaView]
    areas_left_out: int = Field(description="how many areas are too many to be drawn")
    areas_drawn_within_m: float = Field(
        description="how far the outlines may be off; 0 when every corner is there"
    )
    pads: list[PadView]


class StationView(Message):
    """The station itself."""

    version: str
    link_addresses: list[str]
    uptime_s: float
    frames_dropped: int
    capture_folder: str | None
    capture_dropped_bytes: int
    connections_refused: int
    separation_hold_on: bool = Field(
        description="whether the watchdogs hold vehicles; else they only raise alarms"
    )


class ReturningView(Message):
    """One vehicle of a fleet return; without a flight (yet) wave, heights and pad are null."""

    serial: str
    vehicle_name: str
    stage: Literal["stopping", "waiting", "ordered", "flying", "landed", "released", "left_out"]
    since_age_s: float
    reason: str | None = Field(description="why it waits, was released or is left out")
    wave: int | None
    layer_height_m: float | None = Field(description="above the site's ground altitude")
    layer_height_above_takeoff_m: float | None
    pad: str | None
    hold_command_id: int
    mission_command_id: int | None


class FleetReturnView(Message):
    """The newest fleet return; vehicles by wave and height."""

    called_by: str
    age_s: float
    is_over: bool
    vehicles: list[ReturningView]


class StationState(Message):
    """Everything a console shows; the stream pushes one of these at up to 10 Hz."""

    time_ns: int
    station: StationView
    site: SiteView | None
    vehicles: list[VehicleView]
    links: list[LinkView]
    commands: list[CommandView]
    alarms: list[AlarmView]
    ground_image: GroundImageView | None
    fleet_return: FleetReturnView | None


class CheckView(Message):
    """One point of a preflight checklist; `to_do` is empty when it is ok."""

    key: str
    name: str
    state: Literal["ok", "attention", "unknown", "fails"]
    text: str
    to_do: str
    holds_back: bool = Field(description="whether missions are refused while it stands so")


class PreflightView(Message):
    """A vehicle's checklist as of now; missions fly when it is passed or overridden."""

    serial: str
    name: str
    is_passed: bool
    override: OverrideView | None
    points: list[CheckView]


class AuditEntryView(Message):
    """One entry of the audit: what happened, who asked, about which vehicle."""

    n: int
    utc: str
    kind: str
    by: str
    serial: str | None
    vehicle: str
    text: str
    details: dict[str, Any]


class AuditPage(Message):
    """Entries of this run after a number, the oldest first.

    `first_n` is the oldest entry in memory: what came before it is only in the file.
    """

    entries: list[AuditEntryView]
    first_n: int
    last_n: int
    file: str | None
    problem: str | None = Field(description="why the audit cannot be written, while it cannot")


# --- what the station is asked -----------------------------------------------------------------


class Asked(Message):
    """Base of what is asked: nothing is guessed from another type ("yes" is not true)."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class HoverOrder(Asked):
    """Stop and hold."""

    kind: Literal["hover"]


class LandOrder(Asked):
    """Land where the vehicle is."""

    kind: Literal["land"]


class ReturnHomeOrder(Asked):
    """Return at the aircraft's own go-home height and land."""

    kind: Literal["return_home"]


class CameraStartOrder(Asked):
    """Send images."""

    kind: Literal["camera_start"]
    fps_hz: float


class CameraStopOrder(Asked):
    """Stop sending images."""

    kind: Literal["camera_stop"]


class WaypointOrder(Asked):
    """One waypoint; null loiter and gimbal mean no action."""

    latitude_deg: float
    longitude_deg: float
    height_above_takeoff_m: float
    speed_mps: float
    corner_radius_m: float = 0.2
    loiter_s: float | None = None
    gimbal_pitch_deg: float | None = None


class MissionOrder(Asked):
    """Fly waypoints, replacing any mission being flown."""

    kind: Literal["mission"]
    waypoints: list[WaypointOrder] = Field(
        max_length=2000, description="more than the vehicle's app takes are flown in parts"
    )
    land_at_end: bool = False
    curved: bool = False


class StickOrder(Asked):
    """One virtual stick packet (ground: x north, y east; body: x forward, y right)."""

    kind: Literal["stick"]
    frame: Literal["ground", "body"] = "ground"
    yaw_deg: float
    velocity_x_mps: float
    velocity_y_mps: float
    height_above_takeoff_m: float
    timeout_s: float = 1.0


class GoToOrder(Asked):
    """Fly straight to a place and hold there; `yaw_deg` null keeps the heading."""

    kind: Literal["goto"]
    latitude_deg: float
    longitude_deg: float
    height_above_takeoff_m: float
    speed_mps: float = 5.0
    yaw_deg: float | None = None


class NudgeOrder(Asked):
    """Move by this much from here and hold there; `turn_deg` clockwise."""

    kind: Literal["nudge"]
    north_m: float = 0.0
    east_m: float = 0.0
    up_m: float = 0.0
    turn_deg: float = 0.0
    speed_mps: float = 2.0


class HoldPositionOrder(Asked):
    """Hold this place against wind and drift, steered by the station."""

    kind: Literal["hold_position"]


AnyOrder = Annotated[
    HoverOrder
    | LandOrder
    | ReturnHomeOrder
    | CameraStartOrder
    | CameraStopOrder
    | MissionOrder
    | StickOrder
    | GoToOrder
    | NudgeOrder
    | HoldPositionOrder,
    Field(discriminator="kind"),
]


class OrderRequest(Asked):
    """An order to named vehicles. `takeoff` is the explicit word that they may leave the ground.

    `goto`, `nudge` and `hold_position` need a `holder`: the name of an open stream of states
    (`/api/stream?holder=NAME`). When that stream ends, the vehicle is stopped and holds.
    """

    serials: list[Annotated[str, Field(max_length=2048)]] = Field(min_length=1, max_length=256)
    order: AnyOrder
    takeoff: bool = False
    holder: Annotated[str, Field(max_length=64)] | None = None

    @model_validator(mode="after")
    def _takes_off_with_what_can(self) -> Self:
        if self.takeoff and not isinstance(self.order, HoverOrder | MissionOrder | StickOrder):
            raise ValueError(
                f"takeoff was said with {self.order.kind}, which never takes off; it goes with "
                "hover, mission and stick only: give the order again without it"
            )
        return self

    @model_validator(mode="after")
    def _names_its_holder(self) -> Self:
        if isinstance(self.order, GoToOrder | NudgeOrder | HoldPositionOrder) and not self.holder:
            raise ValueError(
                f"{self.order.kind} needs a holder, the name of an open stream "
                "(/api/stream?holder=NAME) whose end stops the vehicle"
            )
        return self


class FleetReturnRequest(Asked):
    """Vehicles to call home in layers; null calls every one that flies or may."""

    serials: list[Annotated[str, Field(max_length=2048)]] | None = Field(
        default=None, min_length=1, max_length=256
    )


class AuthorityRequest(Asked):
    """Who is to lead a vehicle from now on."""

    leader: LeaderWord


class PreflightOverrideRequest(Asked):
    """Why a vehicle may fly missions although its checklist is not passed."""

    reason: str = Field(max_length=2048)


class WordResponse(Message):
    """What became of a word that is no order: taken, or refused by a rule for a reason."""

    accepted: bool
    rule: str | None
    reason: str | None


class OrderResult(Message):
    """What became of an order for one vehicle: accepted with a command id, or refused."""

    serial: str | None
    link_id: int | None
    vehicle_name: str
    is_simulated: bool
    accepted: bool
    command_id: int
    rule: str | None
    reason: str | None
    repairs: list[str] = Field(description="what was changed in a mission so that DJI accepts it")
    parts: int = Field(description="in how many parts a mission is flown; 0 for other orders")


class OrderResponse(Message):
    """One result for each vehicle named."""

    results: list[OrderResult]


class Problem(Message):
    """Why a request was not carried out."""

    error: str
