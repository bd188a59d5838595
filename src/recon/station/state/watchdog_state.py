"""What the watchdogs remember from one run to the next."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from recon.model.vehicle import VehicleState
from recon.safety.watchdogs import CommandedHold, Finding


@dataclass(frozen=True, slots=True)
class ActiveFinding:
    """A finding, and the times of its first and last occurrence."""

    finding: Finding
    since_ns: int
    seen_ns: int


@dataclass(frozen=True, slots=True)
class HoldRefused:
    """A hold that the watchdogs requested and that was not sent: when, and why."""

    at_ns: int
    why: str


@dataclass(frozen=True, slots=True)
class StickCount:
    """How many setpoints a stream has sent, and when that number last changed."""

    started_at_ns: int
    sent: int
    changed_at_ns: int


@dataclass(frozen=True)
class WatchdogState:
    """Everything by serial, or by the finding's key.

    `dismissed` has the time of the last telemetry for each hazard area that an operator dismissed:
    newer telemetry brings the vehicle back. `lost` are vehicles that flew without ever reporting a
    serial when their links ended, by the name their hazard areas are dismissed by.
    """

    run_at_ns: int | None = None
    findings: Mapping[str, ActiveFinding] = field(default_factory=dict)
    held: Mapping[str, CommandedHold] = field(default_factory=dict)
    holds_refused: Mapping[str, HoldRefused] = field(default_factory=dict)
    sticks: Mapping[str, StickCount] = field(default_factory=dict)
    dismissed: Mapping[str, int | None] = field(default_factory=dict)
    unidentified_since_ns: Mapping[int, int] = field(default_factory=dict)
    """Time since which each link has flown without a serial, by link id."""
    lost: Mapping[str, VehicleState] = field(default_factory=dict)
    is_hold_on: bool = True
    """Whether the watchdogs' findings hold vehicles; switched by an operator."""
    switched_by: str = ""
