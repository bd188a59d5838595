"""Everything that can happen to the station: one ordered queue of these drives it."""

from dataclasses import dataclass

from recon.model.authority import AuthorityHolder
from recon.model.command import Body, Phase
from recon.model.report import Report
from recon.model.survey import Survey


@dataclass(frozen=True, slots=True)
class LinkOpened:
    """A companion app connected."""

    link_id: int
    remote_address: str


@dataclass(frozen=True, slots=True)
class LinkClosed:
    """A connection ended, with the reason in words."""

    link_id: int
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class PacketReceived:
    """An app said something."""

    link_id: int
    report: Report


@dataclass(frozen=True, slots=True)
class CommandSent:
    """A command's packet was handed to the socket."""

    link_id: int
    command_id: int


@dataclass(frozen=True, slots=True)
class CommandAnswered:
    """An app acknowledged (or refused) a command; `positive` None: the ack missed its time."""

    link_id: int
    command_id: int
    positive: bool | None


@dataclass(frozen=True, slots=True)
class CommandDropped:
    """A command left a link's queue without being sent."""

    link_id: int
    command_id: int
    phase: Phase
    reason: str


@dataclass(frozen=True, slots=True)
class Tick:
    """Time went on."""


@dataclass(frozen=True, slots=True)
class SticksDue:
    """The time of the next stick of a stream has come: beats come exact, ticks only often."""


@dataclass(frozen=True, slots=True)
class OperatorOrder:
    """Somebody orders one body for one vehicle (or one link without identity).

    `command_id` is given by whoever asks, so that the answer can be told apart. `owner` names the
    connection whose end ends a stream of sticks; None for orders that outlive their giver.
    """

    command_id: int
    body: Body
    issued_by: str
    serial: str | None = None
    link_id: int | None = None
    takeoff: bool = False
    asked_as: AuthorityHolder = AuthorityHolder.OPERATOR
    owner: str | None = None


@dataclass(frozen=True, slots=True)
class AuthorityTaken:
    """Somebody explicitly takes a vehicle over, or gives it away: `holder` leads it from now on."""

    serial: str
    holder: AuthorityHolder
    by: str


@dataclass(frozen=True, slots=True)
class OwnerConnected:
    """A connection has opened that may hold streams of sticks."""

    owner: str


@dataclass(frozen=True, slots=True)
class OwnerDisconnected:
    """The connection that held streams of sticks has ended."""

    owner: str


@dataclass(frozen=True, slots=True)
class ClockRead:
    """The computer's clock was looked at: the station's own time does not follow it."""

    wall_ns: int


@dataclass(frozen=True, slots=True)
class PreflightOverridden:
    """Somebody lets a vehicle fly missions although its checklist is not passed, and says why."""

    serial: str
    by: str
    reason: str


@dataclass(frozen=True, slots=True)
class HazardDismissed:
    """Somebody has seen where a stale vehicle is, and takes it out of the air."""

    serial: str
    by: str


@dataclass(frozen=True, slots=True)
class SeparationHoldSwitched:
    """Somebody switches the holds of the separation watchdog on or off."""

    is_on: bool
    by: str


@dataclass(frozen=True, slots=True)
class FleetReturnOrdered:
    """Somebody calls vehicles home in layers, as landing missions.

    The holds that it begins with get the ids from `first_command_id` on, in the order of `serials`;
    the missions that follow have the station's own.
    """

    first_command_id: int
    serials: tuple[str, ...]
    by: str


@dataclass(frozen=True, slots=True, eq=False)
class SurveyAsked:
    """Somebody asks for a survey; its id is given by whoever asks. Nothing flies by it."""

    survey: Survey
    by: str


@dataclass(frozen=True, slots=True)
class SurveyStarted:
    """Somebody starts a survey with these vehicles, and by that gives them to guidance.

    `takeoff` is the explicit word that each may leave the ground, once.
    """

    survey_id: int
    serials: tuple[str, ...]
    by: str
    takeoff: bool = False


@dataclass(frozen=True, slots=True)
class SurveyStopped:
    """Somebody pauses a survey, or aborts it for good; its vehicles hold."""

    survey_id: int
    by: str
    is_aborted: bool


@dataclass(frozen=True, slots=True)
class AuditTroubled:
    """The audit cannot be written, for this reason; None: it can again."""

    problem: str | None


@dataclass(frozen=True, slots=True)
class StationFaulted:
    """The station's own code failed: doing what, and what came of it, in words."""

    where: str
    what: str


@dataclass(frozen=True, slots=True)
class AlarmAcknowledged:
    """A person has seen an alarm."""

    alarm_id: int
    by: str


@dataclass(frozen=True, slots=True, eq=False)
class WorkerResult:
    """Heavy work came back; `result` is a value of the room that did it, or the error's text."""

    job_id: int
    kind: str
    result: object | None
    error: str | None = None


@dataclass(frozen=True, slots=True)
class DeadlineMissed:
    """Heavy work was not done in time, or was dropped for newer work."""

    job_id: int
    kind: str
    reason: str


Event = (
    LinkOpened
    | LinkClosed
    | PacketReceived
    | CommandSent
    | CommandAnswered
    | CommandDropped
    | Tick
    | SticksDue
    | OperatorOrder
    | AuthorityTaken
    | OwnerConnected
    | OwnerDisconnected
    | ClockRead
    | PreflightOverridden
    | HazardDismissed
    | SeparationHoldSwitched
    | FleetReturnOrdered
    | SurveyAsked
    | SurveyStarted
    | SurveyStopped
    | AlarmAcknowledged
    | AuditTroubled
    | StationFaulted
    | WorkerResult
    | DeadlineMissed
)
