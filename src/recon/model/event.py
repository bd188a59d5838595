"""The events that drive the station, in one ordered queue."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from recon.model.airspace import ElevationModel, LandingPad, Region, SiteLayer, Zone
from recon.model.command import Body, Phase, Refusal
from recon.model.control import AuthorityHolder
from recon.model.imagery import CameraPose, Outlook, TelemetryReference
from recon.model.light import LightRead
from recon.model.report import Report
from recon.model.survey import Survey
from recon.model.temporary_zone import DrawnZone
from recon.model.vehicle import VehicleProfile


@dataclass(frozen=True, slots=True)
class LinkOpened:
    """A companion app connected."""

    link_id: int
    remote_address: str


@dataclass(frozen=True, slots=True)
class LinkClosed:
    """A connection closed; `reason` is a sentence for the operator."""

    link_id: int
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class PacketReceived:
    """A packet arrived from a companion app.

    `arrived_at_ns` is when its last byte was read from the socket, which can be seconds before this
    event: damaged or false bytes in front withhold a packet. None means now. `stream_start`
    and `stream_end` count the bytes from the app before the packet and up to its end: the record
    finds a frame's bytes by them.
    """

    link_id: int
    report: Report
    arrived_at_ns: int | None = None
    stream_start: int = 0
    stream_end: int = 0

    def received_at_ns(self, now_ns: int) -> int:
        """Return the time that the ages of its values count from."""
        return now_ns if self.arrived_at_ns is None else min(self.arrived_at_ns, now_ns)


@dataclass(frozen=True, slots=True)
class CommandSent:
    """A command's packet was handed to the socket."""

    link_id: int
    command_id: int


@dataclass(frozen=True, slots=True)
class CommandAnswered:
    """An app acknowledged or refused a command; `positive` is None when the ack timed out."""

    link_id: int
    command_id: int
    positive: bool | None


@dataclass(frozen=True, slots=True)
class CommandDropped:
    """A command left a link's queue without being sent.

    `refusal` is the gate's, if it refused the command at the moment of sending.
    """

    link_id: int
    command_id: int
    phase: Phase
    reason: str
    refusal: Refusal | None = None


@dataclass(frozen=True, slots=True)
class Tick:
    """Periodic timer event."""


@dataclass(frozen=True, slots=True)
class ClockGap:
    """The station did not run for this long: its computer slept, or its process was stopped."""

    seconds: float


@dataclass(frozen=True, slots=True)
class SetpointsDue:
    """The next setpoint of a stream is due. Its own event, because ticks are not precise enough."""


@dataclass(frozen=True, slots=True)
class OperatorOrder:
    """One order for one vehicle, or for one link without a serial.

    `command_id` is chosen by the client, to match the answer. `owner` names the API stream whose
    end stops a setpoint stream; None for orders that do not depend on a connection. `given_at_ns`
    is when its person gave it, in station time; None if not stated. `person` is as in `Command`.
    """

    command_id: int
    body: Body
    issued_by: str
    serial: str | None = None
    link_id: int | None = None
    takeoff: bool = False
    role: AuthorityHolder = AuthorityHolder.OPERATOR
    owner: str | None = None
    given_at_ns: int | None = None
    person: str = ""


@dataclass(frozen=True, slots=True)
class AuthorityTaken:
    """Control authority over a vehicle is explicitly given to `holder`.

    `person` is the name of the person who does so, and then operates the vehicle; `takes_over`:
    also from another person who operates it.
    """

    serial: str
    holder: AuthorityHolder
    by: str
    person: str = ""
    takes_over: bool = False


@dataclass(frozen=True, slots=True)
class AppAdmitted:
    """A person admits the app that waits on a link as the vehicle with this serial.

    `is_for_good`: on the list, else for this run only. `any_address`: wherever it connects from,
    else from its present address only.
    """

    link_id: int
    serial: str
    by: str
    is_for_good: bool = True
    any_address: bool = False


@dataclass(frozen=True, slots=True)
class AppRefused:
    """A person refuses the app that waits on a link: it is closed, and again for a while."""

    link_id: int
    by: str


@dataclass(frozen=True, slots=True)
class AppListFailed:
    """The list of apps cannot be written; `problem` is None when it is written again."""

    problem: str | None


@dataclass(frozen=True, slots=True)
class AllStopped:
    """A person stopped every vehicle. It stays in force until released; the holds are orders."""

    by: str


@dataclass(frozen=True, slots=True)
class StopReleased:
    """A person releases vehicles from an all stop; `serials` None releases all."""

    serials: tuple[str, ...] | None
    by: str


@dataclass(frozen=True, slots=True)
class PersonConnected:
    """A person opened a stream of states; several at once are counted."""

    person: str


@dataclass(frozen=True, slots=True)
class PersonDisconnected:
    """A stream of states of a person closed."""

    person: str


@dataclass(frozen=True, slots=True)
class OwnerConnected:
    """An API stream opened that setpoint streams may depend on."""

    owner: str


@dataclass(frozen=True, slots=True)
class OwnerDisconnected:
    """An API stream closed; the setpoint streams that depend on it end."""

    owner: str


@dataclass(frozen=True, slots=True)
class ClockRead:
    """The computer's clock was read; station time does not follow its adjustments."""

    wall_ns: int


@dataclass(frozen=True, slots=True)
class PreflightOverridden:
    """An operator allows missions despite a failed preflight checklist, with a reason."""

    serial: str
    by: str
    reason: str


@dataclass(frozen=True, slots=True)
class HazardDismissed:
    """An operator has located a lost vehicle and clears its hazard area."""

    serial: str
    by: str


@dataclass(frozen=True, slots=True)
class SeparationHoldSwitched:
    """Holds by the separation watchdog are switched on or off."""

    is_on: bool
    by: str


@dataclass(frozen=True, slots=True)
class ZoneDrawn:
    """A person draws a temporary zone; it acts at once."""

    drawn: DrawnZone
    by: str


@dataclass(frozen=True, slots=True)
class ZoneEnded:
    """A person ends a temporary zone."""

    zone_id: int
    by: str


@dataclass(frozen=True, slots=True, eq=False)
class SiteRedrawn:
    """A person has drawn the site's layers or edited its vehicles, and they are saved.

    `profiles` are those of its vehicles, by serial. `layers` names those that have changed.
    `elevation` covers the new boundary; None: the model in force still does.
    """

    boundary: Region | None
    zones: tuple[Zone, ...]
    landing_pads: tuple[LandingPad, ...]
    profiles: Mapping[str, VehicleProfile]
    layers: tuple[SiteLayer, ...]
    by: str
    is_undo: bool = False
    elevation: ElevationModel | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ImagerMarked:
    """A person has marked control points on a frame of an imaging drone, and they are saved.

    `pose` is the camera's in that frame, `telemetry` the aircraft's; None, as in a site without
    them, when an undo takes that back. `rms_px` is None without control points.
    """

    serial: str
    pose: CameraPose
    telemetry: TelemetryReference | None
    outlook: Outlook
    rms_px: float | None
    by: str

    @property
    def is_placed_by_telemetry(self) -> bool:
        """Whether telemetry alone places the camera."""
        return self.rms_px is None


@dataclass(frozen=True, slots=True)
class FleetReturnOrdered:
    """Vehicles return home in height layers, as landing missions.

    The initial holds take the ids from `first_command_id` on, in the order of `serials`; the
    missions that follow take ids of the station's own. `given_at_ns` is when its person gave the
    command, in station time; None if not stated.
    """

    first_command_id: int
    serials: tuple[str, ...]
    by: str
    given_at_ns: int | None = None
    person: str = ""


@dataclass(frozen=True, slots=True)
class SideStepOrdered:
    """An imaging drone is to fly a little aside and back, so that a flat scene is decided.

    `given_at_ns` is when its person gave the command, in station time; None if not stated.
    `survey_id` is the survey for which the station itself orders it; None: a person does.
    """

    by: str
    given_at_ns: int | None = None
    person: str = ""
    survey_id: int | None = None
    serial: str | None = None
    """Imaging drone; None: the one whose light is unknown, or the site's first."""


@dataclass(frozen=True, slots=True)
class ReliefOrdered:
    """An imaging drone is to take the place of another; the same serial twice: its own place.

    `takeoff` allows `serial` to leave the ground, for this relief only. `given_at_ns` is when its
    person gave the command, in station time; None if not stated. `survey_id` is the survey for
    which the station itself orders it; None: a person does.
    """

    relieved: str
    serial: str
    by: str
    takeoff: bool = False
    given_at_ns: int | None = None
    person: str = ""
    survey_id: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class SurveyRequested:
    """A survey is to be planned; its id is chosen by the client. Nothing flies yet."""

    survey: Survey
    by: str


@dataclass(frozen=True, slots=True)
class SurveyStarted:
    """A survey starts with these vehicles, which gives guidance control authority over them.

    `takeoff` allows each vehicle to leave the ground, for this start only. `given_at_ns` is when
    its person gave the command, in station time; None if not stated.
    """

    survey_id: int
    serials: tuple[str, ...]
    by: str
    takeoff: bool = False
    given_at_ns: int | None = None
    person: str = ""


@dataclass(frozen=True, slots=True)
class SurveyStopped:
    """A survey is paused, or aborted for good; its vehicles hold."""

    survey_id: int
    by: str
    is_aborted: bool


@dataclass(frozen=True, slots=True)
class AuditFailed:
    """The audit cannot be written; `problem` is None when it can be written again."""

    problem: str | None


@dataclass(frozen=True, slots=True)
class RecordFailed:
    """A part of the flight is not recorded; `problem` is None when everything is again."""

    problem: str | None


@dataclass(frozen=True, slots=True)
class LinkLimitReached:
    """The link server reached a limit; `problem` is None when it is no longer reached."""

    limit: str
    problem: str | None


@dataclass(frozen=True, slots=True)
class LoginAccepted:
    """A person used a token from an address for the first time in this run."""

    by: str
    role: str


@dataclass(frozen=True, slots=True)
class LoginRefused:
    """A wrong token came from an address; `is_repeated` at the limit, after which no more events
    come in the same minute."""

    address: str
    failures: int
    is_repeated: bool


@dataclass(frozen=True, slots=True)
class UsersChanged:
    """The users file was read again: what changed, or why it cannot be used."""

    change: str
    problem: str | None = None


@dataclass(frozen=True, slots=True)
class StationFaulted:
    """The station's own code raised: what it was doing, and the error."""

    where: str
    what: str


@dataclass(frozen=True, slots=True)
class GuardActed:
    """The guard held vehicles automatically; `by` is the person of an all stop at its port.

    `names` were sent a hover, `refused` may fly and were not; `serials` are of all of them.
    """

    why: str
    serials: tuple[str, ...]
    names: tuple[str, ...]
    refused: tuple[str, ...]
    by: str | None


@dataclass(frozen=True, slots=True)
class AlarmAcknowledged:
    """An operator acknowledged an alarm."""

    alarm_id: int
    by: str


@dataclass(frozen=True, slots=True, eq=False)
class JobEnded:
    """A job of the worker ended; the station's `state/steps.py` has a subclass for each way."""

    job_id: int
    input_digest: str = field(default="", kw_only=True, compare=False)
    """Digest of all inputs of the job, for the record; empty where it was not run or recorded."""


Event = (
    LinkOpened
    | LinkClosed
    | PacketReceived
    | CommandSent
    | CommandAnswered
    | CommandDropped
    | Tick
    | ClockGap
    | SetpointsDue
    | OperatorOrder
    | AuthorityTaken
    | AppAdmitted
    | AppRefused
    | AppListFailed
    | AllStopped
    | StopReleased
    | PersonConnected
    | PersonDisconnected
    | OwnerConnected
    | OwnerDisconnected
    | ClockRead
    | PreflightOverridden
    | HazardDismissed
    | SeparationHoldSwitched
    | ZoneDrawn
    | LoginAccepted
    | LoginRefused
    | UsersChanged
    | ZoneEnded
    | SiteRedrawn
    | ImagerMarked
    | FleetReturnOrdered
    | SideStepOrdered
    | ReliefOrdered
    | SurveyRequested
    | SurveyStarted
    | SurveyStopped
    | AlarmAcknowledged
    | AuditFailed
    | RecordFailed
    | LinkLimitReached
    | StationFaulted
    | GuardActed
    | LightRead
    | JobEnded
)
