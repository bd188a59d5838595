"""How an app handles each command packet: the acknowledgment, and the action that follows it.

The acknowledgment is sent before the action (as apps in the field do), so a positive one promises
nothing.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import Enum
from math import isfinite, isnan, nan

from recon import wire
from recon.geo import enu_from_geo
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.vehicle import AltitudeReference
from recon.sim.app.camera_feed import CameraFeed
from recon.sim.app.telemetry import HomeAltitude
from recon.sim.flight.acceptance import SdkLimits, mission_problem, stick_problem
from recon.sim.flight.aircraft import Aircraft
from recon.sim.flight.flight_modes import Stick
from recon.sim.flight.mission import MissionPoint


class HoverOnGround(Enum):
    """Effect of hover and return on an aircraft on the ground."""

    NOTHING = "nothing"
    TAKEOFF = "takeoff"
    """Behaviour of the public iOS app: it takes off (and then hovers, or returns and lands)."""


@dataclass(frozen=True, slots=True)
class AppBehaviour:
    """Differences between apps: every variant exists in the field."""

    altitude_reference: AltitudeReference = AltitudeReference.TAKEOFF
    hover_on_ground: HoverOnGround = HoverOnGround.NOTHING
    altitude_bias_m: float = 0.0
    """Bias of every absolute altitude in the app, the home altitude included."""
    reports_mission_id: bool = True
    """False: MissionID in telemetry is always 0, as from some apps in the field."""
    takes_missions: bool = True
    """False: a model that an app can steer only."""
    sdk: SdkLimits = field(default_factory=SdkLimits)
    upload_s: float = 0.1
    """Upload time of each waypoint of a mission; the aircraft holds meanwhile."""
    start_s: float = 2.0
    """Time from a mission's upload until the aircraft flies it."""
    photo_interval_s: float | None = None
    """The interval of its camera's timer, in an app that reports facts and photos; None: a plain
    app, which reports neither."""


@dataclass(frozen=True, slots=True)
class AppResponse:
    """The acknowledgment of one command packet, and the action (returning a log line).

    A mission's action begins its upload and returns after how long it starts, and the start.
    """

    source_pid: int
    is_positive: bool
    act: Callable[[int], "str | MissionStart"]
    """Takes the time in nanoseconds."""
    moves: bool = False
    """Whether it replaces what the aircraft does, and a mission that has not started."""


@dataclass(frozen=True, slots=True)
class MissionStart:
    """A mission on its way to the aircraft."""

    after_s: float
    start: Callable[[], str]


LOCK_ACTIONS = {2: True, 3: False}
"""Actions of CameraControl in the extension `recon 1`: whether exposure is locked."""


class CommandHandler:
    """Turns command packets into the responses of one app."""

    lock_camera: Callable[[bool], str] | None = None
    """Locks exposure and white balance, in an app that takes orders of the extension."""

    def __init__(
        self,
        home: GeoPoint,
        aircraft: Aircraft,
        feed: CameraFeed | None,
        behaviour: AppBehaviour,
        altitude: HomeAltitude,
    ) -> None:
        self._home = home
        self._altitude = altitude
        self._frame = LocalFrame(home)
        self._aircraft = aircraft
        self._feed = feed
        self._behaviour = behaviour

    def response(self, packet: wire.Packet) -> AppResponse | None:
        """Return the response, or None for a packet that is not a command."""
        match packet:
            case wire.EmergencyCommand():
                return self._emergency(packet)
            case wire.CameraControl():
                return self._camera(packet)
            case wire.ExecuteWaypointMission():
                return AppResponse(
                    packet.PID, True, lambda now_ns: self._upload(packet), moves=True
                )
            case wire.VirtualStickCommand():
                return AppResponse(packet.PID, True, lambda now_ns: self._stick(packet), moves=True)
            case _:
                return None

    def _emergency(self, packet: wire.EmergencyCommand) -> AppResponse:
        acts: dict[int, Callable[[], str]] = {0: self._hover, 1: self._land, 2: self._go_home}
        act = acts.get(packet.action)
        if act is None:
            return _refusal(packet.PID, f"emergency action {packet.action} unknown")
        return AppResponse(packet.PID, True, lambda now_ns: act(), moves=True)

    def _hover(self) -> str:
        if self._aircraft.is_on_ground and self._takes_off_on_hover:
            self._aircraft.take_off()
            return "hover: takes off"
        self._aircraft.hover()
        return "hover" if not self._aircraft.is_on_ground else "hover: ignored on the ground"

    def _land(self) -> str:
        self._aircraft.land()
        return "land" if not self._aircraft.is_on_ground else "land: ignored on the ground"

    def _go_home(self) -> str:
        if self._aircraft.is_on_ground and not self._takes_off_on_hover:
            return "return home: ignored on the ground"
        self._aircraft.take_off_and_go_home()
        return "return home"

    @property
    def _takes_off_on_hover(self) -> bool:
        return self._behaviour.hover_on_ground is HoverOnGround.TAKEOFF

    def _camera(self, packet: wire.CameraControl) -> AppResponse:
        lock = self.lock_camera
        if lock is not None and packet.action in LOCK_ACTIONS:
            is_locked = LOCK_ACTIONS[packet.action]
            return AppResponse(packet.PID, True, lambda now_ns: lock(is_locked))
        feed = self._feed
        if feed is None:
            return _refusal(packet.PID, "camera control: no camera")
        if packet.action == 0:
            return AppResponse(packet.PID, True, lambda now_ns: _switch_off(feed))
        fps_hz = packet.target_fps_hz
        # NaN and infinity come from the wire too.
        if packet.action != 1 or not (isfinite(fps_hz) and fps_hz > 0.0):
            return _refusal(packet.PID, f"camera control: action {packet.action}, {fps_hz:g} fps")
        return AppResponse(packet.PID, True, lambda now_ns: _switch_on(feed, fps_hz, now_ns))

    def _upload(self, packet: wire.ExecuteWaypointMission) -> str | MissionStart:
        points = self.mission_points(packet)
        is_curved = packet.curved_flight == 1
        problem = mission_problem(points, is_curved, self._limits()) or self._no_app_control()
        if not self._behaviour.takes_missions:
            problem = "this model takes none"
        if problem is not None:
            return f"mission rejected silently: {problem}"
        # A mission under way must be stopped before another one is uploaded.
        self._aircraft.hover()
        after_s = self._behaviour.upload_s * len(points) + self._behaviour.start_s
        return MissionStart(after_s, lambda: self._start(points, is_curved, packet))

    def _start(
        self, points: tuple[MissionPoint, ...], is_curved: bool, packet: wire.ExecuteWaypointMission
    ) -> str:
        problem = self._no_app_control()
        if problem is not None:
            return f"mission not started: {problem}"
        self._aircraft.fly_mission(points, is_curved, packet.land_at_end == 1)
        return f"mission of {len(points)} waypoints"

    def _stick(self, packet: wire.VirtualStickCommand) -> str:
        problem = stick_problem(packet, self._behaviour.sdk) or self._no_app_control()
        if problem is not None:
            return f"stick rejected silently: {problem}"
        self._aircraft.stick(
            Stick(
                is_body_frame=packet.mode == 1,
                yaw_deg=packet.yaw_deg,
                velocity_x_mps=packet.velocity_x_mps,
                velocity_y_mps=packet.velocity_y_mps,
                height_m=packet.height_above_takeoff_m,
                timeout_s=packet.timeout_s,
                limits=self._aircraft.settings.limits,
                drift_north_mps=self._aircraft.settings.stick_drift_north_mps,
                drift_east_mps=self._aircraft.settings.stick_drift_east_mps,
            )
        )
        return "stick" if not self._aircraft.is_on_ground else "stick: ignored on the ground"

    def _limits(self) -> SdkLimits:
        """Return the SDK's limits and, where they are lower, those set in the aircraft."""
        sdk, own = self._behaviour.sdk, self._aircraft.settings
        return replace(
            sdk,
            highest_m=min(sdk.highest_m, own.max_height_m),
            farthest_m=min(sdk.farthest_m, own.max_distance_m),
        )

    def _no_app_control(self) -> str | None:
        """Return why the flight controller ignores missions and sticks now, else None."""
        if self._aircraft.has_pilot_control:
            return "the pilot has control (mode switch)"
        return None if self._aircraft.has_gnss else "no GNSS"

    def mission_points(self, packet: wire.ExecuteWaypointMission) -> tuple[MissionPoint, ...]:
        """Return a mission's waypoints in home metres.

        An app built to the first issue of the ICD reads altitudes as WGS84 and subtracts its own
        estimate of the home altitude, which may be wrong (`HomeAltitude`).
        """
        subtracted_m = 0.0
        if self._behaviour.altitude_reference is AltitudeReference.WGS84:
            subtracted_m = self._altitude.believed_m
        return tuple(self._point(waypoint, subtracted_m) for waypoint in packet.waypoints)

    def _point(self, waypoint: wire.Waypoint, subtracted_m: float) -> MissionPoint:
        north_m, east_m = self._place(waypoint.latitude_deg, waypoint.longitude_deg)
        return MissionPoint(
            north_m=north_m,
            east_m=east_m,
            height_m=waypoint.altitude_m - subtracted_m,
            speed_mps=waypoint.speed_mps,
            corner_radius_m=waypoint.corner_radius_m,
            loiter_s=_none_if_nan(waypoint.loiter_time_s),
            gimbal_pitch_deg=_none_if_nan(waypoint.gimbal_pitch_deg),
        )

    def _place(self, latitude_deg: float, longitude_deg: float) -> tuple[float, float]:
        """Return metres north and east of home; NaN for coordinates off the globe."""
        # math.sin raises on infinity and returns noise for 1e30: check before converting.
        if not (abs(latitude_deg) <= 90.0 and abs(longitude_deg) <= 360.0):
            return nan, nan
        height_m = self._home.ellipsoid_height_m
        east, north, _ = enu_from_geo(self._frame, latitude_deg, longitude_deg, height_m)[0]
        return float(north), float(east)


def _refusal(pid: int, why: str) -> AppResponse:
    return AppResponse(pid, False, lambda now_ns: f"{why}: refused")


def _switch_on(feed: CameraFeed, fps_hz: float, now_ns: int) -> str:
    feed.switch_on(fps_hz, now_ns)
    return f"camera on at {feed.target_fps_hz:g} fps"


def _switch_off(feed: CameraFeed) -> str:
    feed.switch_off()
    return "camera off"


def _none_if_nan(value: float) -> float | None:
    return None if isnan(value) else value
