"""What the station tells of orders and alarms."""

from typing import Literal

from pydantic import Field

from recon.api.schema.message import Message

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
    note: str = Field(description="the newest phase's note; of a refused command the reason")
    rule: str | None = Field(description="the safety rule that refused it, else null")
    parameters: dict[str, float | int | str] = Field(
        description="the refusal's measured values and limits, by name with unit"
    )
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
