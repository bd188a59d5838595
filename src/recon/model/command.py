"""Commands, their phases, and refusals."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import ClassVar, get_args

from recon.model.control import AuthorityHolder
from recon.model.geo import LatLon
from recon.model.mission import Mission


@dataclass(frozen=True, slots=True)
class Hover:
    """Stop and hold the position."""

    name: ClassVar[str] = "hover"


@dataclass(frozen=True, slots=True)
class LandNow:
    """Land where the vehicle is."""

    name: ClassVar[str] = "land"


@dataclass(frozen=True, slots=True)
class ReturnHome:
    """Fly home at the aircraft's own go-home height and land."""

    name: ClassVar[str] = "return_home"


@dataclass(frozen=True, slots=True)
class StartCamera:
    """Send images at about this rate."""

    name: ClassVar[str] = "camera_start"

    fps_hz: float


@dataclass(frozen=True, slots=True)
class StopCamera:
    """Stop sending images."""

    name: ClassVar[str] = "camera_stop"


@dataclass(frozen=True, slots=True)
class LockCamera:
    """Lock exposure and white balance at what they are, or unlock both. For apps that take it."""

    name: ClassVar[str] = "camera_lock"

    is_locked: bool


@dataclass(frozen=True, slots=True)
class FlyMission:
    """Fly a waypoint mission, replacing the one being flown."""

    name: ClassVar[str] = "mission"

    mission: Mission


class StickFrame(Enum):
    """Frame of a stick's velocity: ICD mode A is ground, mode B is body."""

    GROUND = "ground"
    BODY = "body"


@dataclass(frozen=True, slots=True)
class VirtualStick:
    """One virtual stick packet: yaw and height are held, the velocity for at most `timeout_s`.

    `velocity_x_mps` is north (ground) or forward (body), `velocity_y_mps` east or right.
    """

    name: ClassVar[str] = "stick"

    frame: StickFrame
    yaw_deg: float
    velocity_x_mps: float
    velocity_y_mps: float
    height_above_takeoff_m: float
    timeout_s: float


@dataclass(frozen=True, slots=True)
class GoTo:
    """Fly straight to a target and hold there, steered by the station with a setpoint stream.

    `yaw_deg` None keeps the heading.
    """

    name: ClassVar[str] = "goto"

    target: LatLon
    height_above_takeoff_m: float
    speed_mps: float
    yaw_deg: float | None = None


@dataclass(frozen=True, slots=True)
class Nudge:
    """Move by an offset from the present position and hold there; steered like `GoTo`."""

    name: ClassVar[str] = "nudge"

    north_m: float
    east_m: float
    up_m: float
    speed_mps: float = 2.0
    turn_deg: float = 0.0
    """Clockwise, added to the present heading."""


@dataclass(frozen=True, slots=True)
class HoldPosition:
    """Hold the present position against wind and drift, steered by the station, until replaced."""

    name: ClassVar[str] = "hold_position"


@dataclass(frozen=True, slots=True)
class FollowPath:
    """Fly a mission's waypoints, steered like `GoTo`, and hold at the last: for aircraft that take
    no missions. It begins in the air; no corner is rounded, and nothing but flying is done."""

    name: ClassVar[str] = "follow_path"

    mission: Mission


SteeredBody = GoTo | Nudge | HoldPosition | FollowPath
"""Orders that are not on the wire: the station steers them by `VirtualStick`."""
WireBody = (
    Hover | LandNow | ReturnHome | StartCamera | StopCamera | LockCamera | FlyMission | VirtualStick
)
Body = WireBody | SteeredBody
"""A new kind enters here; mypy names each `match` that must have it."""

EMERGENCY_BODIES = (Hover, LandNow, ReturnHome)
CAMERA_BODIES = (StartCamera, StopCamera, LockCamera)
STEERED_BODIES: tuple[type[SteeredBody], ...] = get_args(SteeredBody)
MOVING_BODIES = (FlyMission, VirtualStick, *STEERED_BODIES)
"""Bodies that set a vehicle in motion along a path of the station's choosing."""
TAKEOFF_BODIES = (Hover, FlyMission, VirtualStick)
"""Bodies that companion apps may carry out as a takeoff."""


def mission_of_body(body: Body) -> Mission | None:
    """Return the mission that an order flies, by the aircraft's own means or steered; else None."""
    return body.mission if isinstance(body, (FlyMission, FollowPath)) else None


BODY_NAMES: dict[type, str] = {kind: kind.name for kind in get_args(Body)}
"""The name of each body in the API and the audit; no other body is known."""


def issued_by_station(why: str) -> str:
    """Return the `issued_by` of an order that the station gives automatically.

    No person's begins so: a name has neither colon nor space, and its address follows it.
    """
    return f"station: {why}"


@dataclass(frozen=True, slots=True)
class Command:
    """One order to one vehicle, or (all stop only) to one link without a serial.

    `takeoff` explicitly allows the vehicle to leave the ground. `role` is the role of the
    client: only the authority holder may set the vehicle in motion. `given_at_ns` is when its
    person gave it, None if not stated; `issued_at_ns` when it reached the station. `person` is the
    name that the operator lease is compared with; whether a person gave it, `is_own` states.
    """

    id: int
    body: Body
    issued_by: str
    issued_at_ns: int
    expires_at_ns: int
    serial: str | None = None
    link_id: int | None = None
    takeoff: bool = False
    role: AuthorityHolder = AuthorityHolder.OPERATOR
    given_at_ns: int | None = None
    person: str = ""

    @property
    def name(self) -> str:
        """The body's name as the API and the audit write it."""
        return self.body.name

    @property
    def words(self) -> str:
        """What was ordered, and by whom."""
        return f"{self.name.replace('_', ' ')}, ordered by {self.issued_by}"

    @property
    def is_own(self) -> bool:
        """Whether the station gave it automatically, not a person nor what a person has started."""
        return self.issued_by.startswith(issued_by_station(""))

    @property
    def moves(self) -> bool:
        """Whether this may move its vehicle, takeoff included.

        A stick always counts; `safety.path.order_path` decides whether it only stops.
        """
        return self.takeoff or isinstance(self.body, MOVING_BODIES)

    @property
    def is_emergency(self) -> bool:
        """Whether this is sent as the ICD's Emergency Command packet."""
        return isinstance(self.body, EMERGENCY_BODIES)


class Phase(Enum):
    """Life cycle of a command. Only telemetry confirms; an acknowledgment does not."""

    QUEUED = "queued"
    SENT = "sent"
    ACKNOWLEDGED = "acknowledged"
    CONFIRMED = "confirmed"
    """Telemetry shows that it is being carried out."""
    STARTED = "started"
    """Telemetry shows that the mission is being flown."""
    DONE = "done"
    """Telemetry shows that it is complete."""
    REFUSED_BY_STATION = "refused_by_station"
    REFUSED_BY_APP = "refused_by_app"
    TIMED_OUT = "timed_out"
    SUPERSEDED = "superseded"
    EXPIRED = "expired"
    FAILED = "failed"

    @property
    def is_final(self) -> bool:
        """Whether this phase is final: no other phase follows it."""
        return self not in LIVING_PHASES


LIVING_PHASES = (Phase.QUEUED, Phase.SENT, Phase.ACKNOWLEDGED, Phase.CONFIRMED, Phase.STARTED)


@dataclass(frozen=True, slots=True)
class Refusal:
    """A command that is not sent: which rule refuses it, and why.

    `is_stale`: only because telemetry is stale or the connection is lost; a stop waits for that.
    `parameters` hold the measured value, the limit and the like, named with their units, for
    programs; two refusals with the same rule and sentence are equal.
    """

    rule: str
    reason: str
    is_stale: bool = False
    parameters: Mapping[str, float | int | str] = field(default_factory=dict, compare=False)
