"""The station, its links, and the state that the stream sends."""

from typing import Literal

from pydantic import Field

from recon.api.schema.message import Message
from recon.api.schema.orders import AlarmView, CommandView
from recon.api.schema.replay import ReplayView
from recon.api.schema.site import GroundImageView, ShadeLineView, SiteView, UpwindPlaceView
from recon.api.schema.surveys import SurveyView
from recon.api.schema.vehicles import VehicleView
from recon.api.schema.zones import TemporaryZoneView


class StopLatchView(Message):
    """The all stop in force: nothing sets a vehicle in motion until a person releases it."""

    by: str
    age_s: float
    released: list[str] = Field(description="serials released since; every other one is latched")


class WaitingAppView(Message):
    """An app that the list does not admit: watched as traffic, stopped, but not moved."""

    serial: str | None = Field(description="null: not reported yet")
    age_s: float
    reason: str
    is_flying: bool | None


class LinkFiguresView(Message):
    """How regularly core telemetry arrives."""

    rate_hz: float
    jitter_s: float
    longest_gap_s: float = Field(description="of about the last minute, present silence included")
    bars: int = Field(description="0 to 4: lost, gaps under 3 s, 2 s, 1 s, 0.5 s")


class LinkView(Message):
    """One TCP connection of a companion app, with its error counters."""

    id: int
    remote_address: str
    status: Literal["identified", "unidentified", "waiting", "conflict", "closed"]
    claimed_serial: str | None
    waiting: WaitingAppView | None
    opened_age_s: float
    last_packet_age_s: float | None
    closed_reason: str | None
    bytes_received: int
    packets_received: int
    images_received: int
    bad_hash: int
    bad_size: int
    unknown_pid: int
    ignored_reports: int
    bytes_skipped: int
    commands_queued: int
    ignored_answers: int = Field(
        description="acknowledgments ignored because they may answer another command"
    )
    figures: LinkFiguresView | None = Field(description="null: not two packets of telemetry yet")


class StationView(Message):
    """The station itself."""

    version: str
    link_addresses: list[str]
    app_url: str | None = Field(
        description="the first address for apps on other devices, as QR codes have it; null: none"
    )
    uptime_s: float
    frames_dropped: int
    capture_folder: str | None
    capture_dropped_bytes: int
    connections_refused: int
    apps_listed: int | None = Field(
        description="entries of the list of admitted apps; null: no list, any app is admitted"
    )
    guard_stop_url: str | None = Field(
        description="all stop at the station's guard, for pages on this computer; null: no guard"
    )
    separation_hold_on: bool = Field(
        description="whether the watchdogs hold vehicles; if not, they only raise alarms"
    )
    repeats_surveys: bool = Field(
        description="a demonstration: another survey begins when all batteries are good"
    )


class ReturningView(Message):
    """One vehicle of a fleet return; wave, heights and pad are null before it is planned."""

    serial: str
    vehicle_name: str
    stage: Literal["stopping", "waiting", "ordered", "flying", "landed", "released", "excluded"]
    since_age_s: float
    reason: str | None = Field(description="why it waits, was released or is excluded")
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


class ImagerMotionView(Message):
    """A motion of an imaging drone under guidance."""

    serial: str
    vehicle_name: str
    stage: Literal["aside", "waiting", "back", "upwind", "to_place", "maps", "done", "stopped"]
    since_age_s: float
    begun_by: str
    begun_age_s: float
    reason: str | None = Field(description="why it waits beside its place, or has stopped")
    survey_id: int | None = Field(
        description="the survey it began for automatically; null: ordered"
    )


class SideStepView(ImagerMotionView):
    """The newest side-step of the imaging drone."""

    bearing_deg: float


class MoveUpwindView(ImagerMotionView):
    """The newest move upwind of the imaging drone for a survey."""

    place: UpwindPlaceView = Field(description="as it was proposed when the move began")


class ImagerReliefView(ImagerMotionView):
    """The newest relief of an imaging drone; `relieved` is the same one if it returns."""

    relieved: str
    relieved_name: str
    maps: int = Field(description="shade maps in a row at the place")


Light = Literal["sun", "shade", "unknown"]


class LightSensorView(Message):
    """A light sensor on the ground, beside what the shade map says where it is."""

    name: str
    source: str = Field(description="its logger: an address, or a file")
    latitude_deg: float | None = Field(description="null: its logger has not stated a place")
    longitude_deg: float | None
    value: float = Field(description="the newest, in the sensor's own unit")
    age_s: float
    is_live: bool = Field(description="false: silent for too long, or its clock is wrong")
    shows: Light = Field(description="unknown: not live, or it has not seen sun and shade yet")
    map_says: Light = Field(description="unknown too where the newest map is over 10 s old")
    right: int = Field(description="shade maps that said what it showed")
    compared: int = Field(description="shade maps that knew its place, while it showed either")


class LightSensorsView(Message):
    """Loggers at the field: for people and the record; nothing is ordered or refused by them."""

    sensors: list[LightSensorView]
    refused_lines: int
    problem: str = Field(description="why the newest of them was refused; empty: none was")
    problem_age_s: float | None = Field(description="since then; null: none was refused")


class StationState(Message):
    """Everything a console shows; the stream pushes one of these at up to 10 Hz."""

    time_ns: int
    station: StationView
    site: SiteView | None
    vehicles: list[VehicleView]
    links: list[LinkView]
    commands: list[CommandView]
    alarms: list[AlarmView]
    stop_latch: StopLatchView | None
    temporary_zones: list[TemporaryZoneView]
    ground_image: GroundImageView | None
    fleet_return: FleetReturnView | None
    side_step: SideStepView | None
    move_upwind: MoveUpwindView | None
    imager_relief: ImagerReliefView | None
    shade: ShadeLineView | None
    light_sensors: LightSensorsView | None = Field(description="null: no logger has sent a line")
    surveys: list[SurveyView]
    replay: ReplayView | None = Field(description="null: a live station")
