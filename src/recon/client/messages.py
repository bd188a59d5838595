"""API messages as the client reads them. Unknown keys are ignored."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

import msgspec

from recon.client.errors import BadAnswerError
from recon.client.telemetry import Telemetry
from recon.model.command import Phase, Refusal
from recon.model.temporary_zone import TemporaryZoneKind
from recon.model.units import seconds_to_ns

M = TypeVar("M")

SHOWN_CHARACTERS = 60

ReturnStage = Literal["stopping", "waiting", "ordered", "flying", "landed", "released", "excluded"]
MotionStageName = Literal[
    "aside", "waiting", "back", "upwind", "to_place", "maps", "done", "stopped"
]


class PhaseReport(msgspec.Struct, frozen=True):
    """One phase change of an order; `age_s` as of the message, seconds."""

    phase: Phase
    age_s: float
    note: str


_PROGRESS = {
    Phase.QUEUED: 0,
    Phase.SENT: 1,
    Phase.ACKNOWLEDGED: 2,
    Phase.CONFIRMED: 3,
    Phase.STARTED: 3,
    Phase.DONE: 4,
}
"""Order of the phases. A mission is started where other orders are confirmed."""


class OrderStatus(msgspec.Struct, frozen=True):
    """The status of an order; `history` ends with the current phase."""

    id: int
    kind: str
    serial: str | None
    vehicle_name: str
    phase: Phase
    note: str
    times_sent: int
    history: tuple[PhaseReport, ...]
    part: str | None = None
    """The mission part being flown, such as `part 2 of 3`; None for a mission of one part."""
    rule: str | None = None
    """The safety rule that refused the order; `note` is then the reason."""
    parameters: Mapping[str, float | int | str] = {}
    """The refusal's measured values and limits, by name with unit."""

    @property
    def has_taken_effect(self) -> bool:
        """Whether telemetry shows that the order is being or was executed."""
        return self.phase in (Phase.CONFIRMED, Phase.STARTED, Phase.DONE)

    @property
    def has_arrived(self) -> bool:
        """Whether the vehicle of a steered order has reached its target."""
        return self.has_reached(Phase.DONE)

    def has_reached(self, phase: Phase) -> bool:
        """Return whether the order is or was in this phase or a later one."""
        passed = (self.phase, *(report.phase for report in self.history))
        wanted = _PROGRESS.get(phase)
        if wanted is None:
            return phase in passed
        return any(_PROGRESS.get(other, -1) >= wanted for other in passed)


class VehicleReturn(msgspec.Struct, frozen=True):
    """One vehicle of a return in layers.

    `reason` states why it waits, was released or is not included. `wave` and the heights (metres)
    are None while no flight is planned; `layer_height_m` is above the site's ground altitude.
    """

    serial: str
    vehicle_name: str
    stage: ReturnStage
    reason: str | None
    wave: int | None
    layer_height_m: float | None
    layer_height_above_takeoff_m: float | None
    pad: str | None

    @property
    def is_done(self) -> bool:
        """Whether the return has finished with this vehicle: landed, released or not included."""
        return self.stage in ("landed", "released", "excluded")


class FleetReturnMessage(msgspec.Struct, frozen=True):
    """The newest return in layers."""

    vehicles: tuple[VehicleReturn, ...]


class ImagerMotionStatus(msgspec.Struct, frozen=True):
    """A motion of an imaging drone. `reason` states why it waits or has stopped."""

    serial: str
    vehicle_name: str
    stage: MotionStageName
    begun_by: str
    begun_age_s: float
    reason: str | None
    survey_id: int | None

    @property
    def is_over(self) -> bool:
        """Whether it is done or has stopped."""
        return self.stage in ("done", "stopped")


class SideStepStatus(ImagerMotionStatus, frozen=True):
    """The newest side-step of the imaging drone."""

    bearing_deg: float


class UpwindPlaceStatus(msgspec.Struct, frozen=True):
    """A place upwind; `sentence` states what is seen from it and what it costs to go there."""

    latitude_deg: float
    longitude_deg: float
    height_above_takeoff_m: float
    distance_m: float
    takes_s: float
    sentence: str


class MoveUpwindStatus(ImagerMotionStatus, frozen=True):
    """The newest move upwind of the imaging drone, for a survey that allows it."""

    place: UpwindPlaceStatus


class ImagerReliefStatus(ImagerMotionStatus, frozen=True):
    """The newest relief: `serial` takes the place of `relieved`; the same one returns to its own.

    `maps` counts the shade maps in a row that it has given there.
    """

    relieved: str
    relieved_name: str
    maps: int


class AlarmStatus(msgspec.Struct, frozen=True):
    """An alarm; an inactive one has ended but is not acknowledged yet."""

    id: int
    severity: str
    rule: str
    serial: str | None
    vehicle_name: str
    text: str
    raised_age_s: float
    is_active: bool
    is_acknowledged: bool


class AuditRecord(msgspec.Struct, frozen=True):
    """One entry of the audit log: the event, its author and its vehicle."""

    n: int
    utc: str
    kind: str
    by: str
    serial: str | None
    vehicle: str
    text: str
    details: dict[str, Any]


class AuditLogPage(msgspec.Struct, frozen=True):
    """Entries after a given number, oldest first; entries before `first_n` are only in the file."""

    entries: tuple[AuditRecord, ...]
    first_n: int
    last_n: int
    file: str | None
    problem: str | None


class PreflightPoint(msgspec.Struct, frozen=True):
    """One item of the checklist; `state` is ok, attention, unknown or fails."""

    key: str
    name: str
    state: str
    text: str
    to_do: str
    holds_back: bool


class PreflightOverride(msgspec.Struct, frozen=True):
    """An override of the checklist: by whom and why."""

    by: str
    reason: str
    age_s: float


class FailsafeCellStatus(msgspec.Struct, frozen=True):
    """One cell of the failsafe matrix; `default` is None where this is the default."""

    activity: str
    reaction: str
    after_s: float
    text: str
    default: str | None
    is_weaker: bool


class FailsafeRowStatus(msgspec.Struct, frozen=True):
    """What the station does about one condition, by what a vehicle does."""

    condition: str
    name: str
    begins: str
    cells: tuple[FailsafeCellStatus, ...]


class Preflight(msgspec.Struct, frozen=True):
    """A vehicle's checklist, evaluated on request, and the site's failsafe matrix."""

    serial: str
    name: str
    is_passed: bool
    override: PreflightOverride | None
    points: tuple[PreflightPoint, ...]
    failsafe: tuple[FailsafeRowStatus, ...]

    @property
    def unmet(self) -> tuple[PreflightPoint, ...]:
        """The items that block missions."""
        return tuple(point for point in self.points if point.holds_back)


class StationMessage(msgspec.Struct, frozen=True):
    """The station itself."""

    uptime_s: float
    apps_listed: int | None = None


class StopLatchStatus(msgspec.Struct, frozen=True):
    """The all stop in force: by whom, how long ago in seconds, and the serials released since."""

    by: str
    age_s: float
    released: tuple[str, ...]


class WaitingAppStatus(msgspec.Struct, frozen=True):
    """Why an app waits to be admitted; `serial` None: not reported yet."""

    serial: str | None
    age_s: float
    reason: str
    is_flying: bool | None


class LinkStatus(msgspec.Struct, frozen=True):
    """One connection of a companion app; `waiting` None: it does not wait to be admitted."""

    id: int
    remote_address: str
    waiting: WaitingAppStatus | None = None


class ShadeMapStatus(msgspec.Struct, frozen=True):
    """The newest shade map: its number in this run, and the age of what it shows."""

    number: int
    captured_age_s: float


class ForecastStatus(msgspec.Struct, frozen=True):
    """The newest forecast; `number` is that of its shade map."""

    number: int
    issued_age_s: float


class ShadeStatus(msgspec.Struct, frozen=True):
    """What there is of shade and sun."""

    map: ShadeMapStatus | None = None
    forecast: ForecastStatus | None = None


class TemporaryZoneStatus(msgspec.Struct, frozen=True):
    """A temporary zone in force; heights above ground, None where open-ended."""

    id: int
    name: str
    kind: TemporaryZoneKind
    ring: tuple[tuple[float, float], ...]
    """The closed outline, (longitude, latitude)."""
    radius_m: float | None
    """Radius of a circle; None for an outline."""
    floor_m: float | None
    ceiling_m: float | None
    reason: str
    by: str
    age_s: float
    ends_in_s: float | None
    """None: until a person ends it."""


class SiteArea(msgspec.Struct, frozen=True):
    """An area of the site: closed rings of (longitude, latitude), the outer one first."""

    kind: Literal["boundary", "keep_out", "height", "survey"]
    name: str
    rings: tuple[tuple[tuple[float, float], ...], ...]


class SitePad(msgspec.Struct, frozen=True):
    """A landing pad."""

    name: str
    longitude_deg: float
    latitude_deg: float


class SiteStatus(msgspec.Struct, frozen=True):
    """The site as it is drawn: outlines of many corners are simplified."""

    areas: tuple[SiteArea, ...] = ()
    pads: tuple[SitePad, ...] = ()


class StateMessage(msgspec.Struct, frozen=True):
    """The complete state at `time_ns` (station time, nanoseconds)."""

    time_ns: int
    station: StationMessage
    vehicles: tuple[Telemetry, ...]
    commands: tuple[OrderStatus, ...]
    alarms: tuple[AlarmStatus, ...]
    fleet_return: FleetReturnMessage | None = None
    side_step: SideStepStatus | None = None
    imager_relief: ImagerReliefStatus | None = None
    move_upwind: MoveUpwindStatus | None = None
    stop_latch: StopLatchStatus | None = None
    links: tuple[LinkStatus, ...] = ()
    shade: ShadeStatus | None = None
    site: SiteStatus | None = None
    temporary_zones: tuple[TemporaryZoneStatus, ...] = ()

    @property
    def run_started_ns(self) -> int:
        """Station time at which this run of the station started."""
        return self.time_ns - seconds_to_ns(self.station.uptime_s)


@dataclass(frozen=True, slots=True)
class ReceivedState:
    """A state and the time it was created, on this computer's monotonic clock."""

    number: int
    created_at_ns: int
    message: StateMessage

    def vehicle(self, serial: str) -> Telemetry | None:
        """Return the vehicle with this serial number; None if the state has none."""
        return next((v for v in self.message.vehicles if v.serial == serial), None)


class AnswerMessage(msgspec.Struct, frozen=True):
    """Whether a request was accepted; if not, the rule that refused it and why."""

    accepted: bool
    rule: str | None
    reason: str | None
    parameters: Mapping[str, float | int | str] = {}
    """The refusal's measured values and limits, by name with unit."""

    @property
    def refusal(self) -> Refusal | None:
        """The refusal; None if the request was accepted."""
        if self.accepted:
            return None
        rule, reason = self.rule or "unnamed", self.reason or "no reason given"
        return Refusal(rule, reason, parameters=self.parameters)


class ResultMessage(AnswerMessage, frozen=True, kw_only=True):
    """The result of an order for one vehicle."""

    serial: str | None
    link_id: int | None
    vehicle_name: str
    command_id: int
    repairs: tuple[str, ...] = ()
    parts: int = 0


class OrderMessage(msgspec.Struct, frozen=True):
    """One result per vehicle."""

    results: tuple[ResultMessage, ...]


class ProblemMessage(msgspec.Struct, frozen=True):
    """Why a request failed."""

    error: str


def decode(data: bytes | str, kind: type[M], expected: str) -> M:
    """Return a decoded message; raises `BadAnswerError` that names what was `expected`."""
    try:
        return msgspec.json.decode(data, type=kind)
    except (msgspec.DecodeError, UnicodeError, RecursionError, OverflowError) as problem:
        raise BadAnswerError(
            f"expected {expected} as JSON, got {shown(data)}: {problem}; is this a Recon station "
            "of the same version?"
        ) from problem


def shown(data: Any) -> str:
    """Return the beginning of received data, safe to print."""
    start = data[:SHOWN_CHARACTERS]
    return repr(start) + ("..." if len(data) > SHOWN_CHARACTERS else "")
