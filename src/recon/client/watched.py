"""What a program reads of a station beside its vehicles: alarms, and the audit."""

from typing import Any

import msgspec


class Alarm(msgspec.Struct, frozen=True):
    """An alarm; one that is not active has ended and waits to be seen by a person."""

    id: int
    severity: str
    rule: str
    serial: str | None
    vehicle_name: str
    text: str
    raised_age_s: float
    is_active: bool
    is_acknowledged: bool


class AuditEntry(msgspec.Struct, frozen=True):
    """One entry of the audit: what happened, who asked, about which vehicle."""

    n: int
    utc: str
    kind: str
    by: str
    serial: str | None
    vehicle: str
    text: str
    details: dict[str, Any]


class AuditPage(msgspec.Struct, frozen=True):
    """Entries after a number, the oldest first; those before `first_n` are only in the file."""

    entries: tuple[AuditEntry, ...]
    first_n: int
    last_n: int
    file: str | None
    problem: str | None


class StopAnswer(msgspec.Struct, frozen=True):
    """What the station said to an all stop for one vehicle or one link without a serial."""

    serial: str | None
    link_id: int | None
    vehicle_name: str
    accepted: bool
    command_id: int
    rule: str | None
    reason: str | None


class StopMessage(msgspec.Struct, frozen=True):
    """One answer for each vehicle and link."""

    results: tuple[StopAnswer, ...]
