"""What the station tells of preflight checks and the audit."""

from typing import Any, Literal

from pydantic import Field

from recon.api.schema.message import Message
from recon.api.schema.vehicles import OverrideView


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
