"""What a watchdog finds: an alarm, and perhaps the wish to hold a vehicle."""

from dataclasses import dataclass

from recon.model.severity import Severity


@dataclass(frozen=True, slots=True)
class Finding:
    """Something wrong now. The same `key` is the same cause.

    `holds` is the serial of a vehicle to be held for it. `after_s` is how long it must last before
    it is an alarm.
    """

    key: str
    rule: str
    severity: Severity
    vehicle_name: str
    text: str
    serial: str | None = None
    link_id: int | None = None
    holds: str | None = None
    after_s: float = 0.0
