"""Orders, alarms, preflight checks and audit entries."""

from typing import Any, Literal

from pydantic import Field

from recon.api.schema.message import Message
from recon.api.schema.vehicles import OverrideView

PhaseName = Literal[
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
    """One change of phase."""

    phase: PhaseName
    age_s: float
    note: str


class CommandView(Message):
    """One command; `history` ends with the present phase."""

    id: int
    kind: str
    serial: str | None
    link_id: int | None
    vehicle_name: str
    issued_by: str
    age_s: float
    phase: PhaseName
    is_final: bool
    note: str = Field(description="the newest phase's note; of a refused command the reason")
    rule: str | None = Field(description="the safety rule that refused it, else null")
    parameters: dict[str, float | int | str] = Field(
        description="the refusal's measured values and limits, by name with unit"
    )
    times_sent: int
    takeoff: bool
    sent_altitudes: str | None = Field(
        description="the altitude reference that a mission was sent with"
    )
    part: str | None = Field(description="the part of a mission in flight, such as 'part 2 of 3'")
    repairs: list[str] = Field(description="changes made to a mission so that DJI accepts it")
    history: list[PhaseView]


Severity = Literal["critical", "error", "warning", "info"]


class AlarmView(Message):
    """An alarm. `is_active` false: its cause has ended, but it is not acknowledged yet."""

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


class CheckView(Message):
    """One point of a preflight checklist; `to_do` is empty when it is ok."""

    key: str
    name: str
    state: Literal["ok", "attention", "unknown", "fails"]
    text: str
    to_do: str
    holds_back: bool = Field(description="whether missions are refused in this state")


class FailsafeCellView(Message):
    """One cell of the failsafe matrix; `default` is what a site that states nothing has."""

    activity: Literal["mission", "steered", "holding", "returning"]
    reaction: Literal["nothing", "alarm", "hold", "return", "land"]
    after_s: float = Field(description="how long the condition must have held")
    text: str
    default: str | None = Field(description="the default in words; null where this is the default")
    is_weaker: bool = Field(description="whether the default does more")


class FailsafeRowView(Message):
    """What the station does about one condition, by what a vehicle does."""

    condition: str
    name: str
    begins: str
    cells: list[FailsafeCellView]


class PreflightView(Message):
    """A vehicle's checklist as of now; missions are allowed when it is passed or overridden."""

    serial: str
    name: str
    is_passed: bool
    override: OverrideView | None
    points: list[CheckView]
    failsafe: list[FailsafeRowView] = Field(description="the site's failsafe matrix")


TimelineSubject = Literal["orders", "alarms", "flights", "operations", "station"]
"""What a line of the timeline is about."""


class TimelineEntryView(Message):
    """One line of the timeline."""

    n: int
    utc: str
    kind: str
    by: str
    serial: str | None
    vehicle: str
    text: str


class AuditEntryView(TimelineEntryView):
    """One entry of the audit: what happened, who asked, about which vehicle."""

    details: dict[str, Any]


class TimelineView(Message):
    """What happened in this run, the newest first, as far as it is in memory."""

    entries: list[TimelineEntryView]
    has_more: bool = Field(description="whether older ones are in memory")


class AuditPage(Message):
    """Entries of this run after a number, the oldest first.

    `first_n` is the oldest entry in memory; older ones are only in the file.
    """

    entries: list[AuditEntryView]
    first_n: int
    last_n: int
    file: str | None
    problem: str | None = Field(description="why the audit cannot be written, while it cannot")
